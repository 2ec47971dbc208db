//! The result of a simulation: its published messages, and how it and its nodes ended.

use std::time::Duration;

/// How a simulation ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// All nodes ended on their own.
    Ended,
    /// These nodes were waiting for something that could not happen.
    Deadlock(Vec<String>),
    /// These nodes were still running at the limit.
    OutOfTime(Vec<String>),
    /// A node panicked.
    Panic(String),
}

/// The end of a node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeEnd {
    /// The name of the node.
    pub node: String,
    /// The virtual time of the end.
    pub at: Duration,
    /// Whether a fault ended it.
    pub was_killed: bool,
}

/// A published message, when the hub sends or receives it, or when a leaf receives it.
#[derive(Clone, Copy, Debug)]
pub struct Published<'a> {
    /// Virtual time since the start.
    pub at: Duration,
    /// The node that publishes or receives it.
    pub node: &'a str,
    /// The message's key.
    pub key: &'a str,
    /// The message's content.
    pub bytes: &'a [u8],
}
