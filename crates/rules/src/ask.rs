//! Requests: what a boat asks the referee for, where the rules want it to ask.

/// What a boat asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Asks {
    /// For a tag.
    pub tag: bool,
    /// For a flag.
    pub grab: bool,
}
