//! The conditions of a simulated network, and its faults.

use std::time::Duration;

/// Delays, losses and limits of a working network.
#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    /// Minimum delay of a message over a link.
    pub delay: Duration,
    /// Maximum extra delay. Messages over one link stay in order.
    pub jitter: Duration,
    /// Fraction of published messages that a link drops, as if congested.
    pub loss: f64,
    /// Fraction of published messages that arrive corrupted, from 0 to 1, and the kind of
    /// corruption.
    pub damaged: (f64, Damage),
    /// A link closes if one side receives nothing from the other for this long.
    pub lease: Duration,
    /// Maximum wait of a leaf without a link between two attempts to connect.
    pub retry: Duration,
    /// Maximum number of published messages queued on a cut link; further ones are dropped.
    pub queue: usize,
    /// Maximum pause before some published messages, as if the node or another process were busy
    /// computing.
    pub pause: Duration,
}

/// How messages are corrupted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damage {
    /// Truncated, which a length check detects.
    Truncated,
    /// One bit flipped.
    BitFlip,
    /// Random bytes.
    Noise,
}

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
    /// The process is stopped (`SIGSTOP`) and resumes after this time.
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
        /// Time from its death to its restart, if any.
        restart: Option<Duration>,
    },
}
