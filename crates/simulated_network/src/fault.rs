//! Faults of a simulated network.

use std::time::Duration;

/// What goes wrong. Nodes are numbered in the order in which they were added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Nothing goes between this node and the others for this long.
    Cut {
        /// Which.
        node: usize,
        /// How long.
        time: Duration,
    },
    /// The process is stopped (`SIGSTOP`) and goes on after this time.
    Suspend {
        /// Which.
        node: usize,
        /// How long.
        time: Duration,
    },
    /// The process dies.
    Kill {
        /// Which.
        node: usize,
        /// How long after its end it is started again, if at all.
        restart: Option<Duration>,
    },
}

/// What has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FaultEnd {
    Cut,
    Suspension,
}
