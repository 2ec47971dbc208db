//! The verdict on a simulation: how it ended, and its nodes.

use std::time::Duration;

/// How a simulation ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// All nodes came to their end.
    Ended,
    /// These nodes waited for something that could not come.
    Deadlock(Vec<String>),
    /// These nodes were still there at the limit.
    OutOfTime(Vec<String>),
    /// A node panicked.
    Panic(String),
}

/// The end of a node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeEnd {
    /// Which.
    pub node: String,
    /// When.
    pub at: Duration,
    /// Whether a fault was the reason.
    pub was_killed: bool,
}
