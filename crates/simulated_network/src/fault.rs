//! Faults of a simulated network.

use std::time::Duration;

/// A fault. Nodes are numbered in the order in which they were added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// No traffic between this node and the others for a while.
    Cut {
        /// The index of the node.
        node: usize,
        /// The duration of the cut.
        time: Duration,
    },
    /// The process is stopped (`SIGSTOP`) and continues after this time.
    Suspend {
        /// The index of the node.
        node: usize,
        /// The duration of the suspension.
        time: Duration,
    },
    /// The process dies.
    Kill {
        /// The index of the node.
        node: usize,
        /// How long after its end it is restarted, if at all.
        restart: Option<Duration>,
    },
}

/// The kind of fault that has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FaultEnd {
    Cut,
    Suspension,
}
