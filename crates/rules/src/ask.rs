//! Requests of boats to the referee, for rules that require requests.

/// The requests of one boat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Asks {
    /// Requests a tag.
    pub tag: bool,
    /// Requests a flag.
    pub grab: bool,
}
