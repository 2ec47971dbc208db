//! Requests of boats to the referee, under rules that require them.

/// The requests of one boat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Asks {
    /// Requests a tag.
    pub tag: bool,
    /// Requests a flag.
    pub grab: bool,
}
