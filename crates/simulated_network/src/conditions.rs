//! The conditions of a simulated network.

use std::time::Duration;

/// How the network is while it works.
#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    /// Every message takes at least this long over a link.
    pub delay: Duration,
    /// And up to this much longer. Over one link messages keep their order.
    pub jitter: Duration,
    /// The share of published messages that a congested link drops.
    pub loss: f64,
    /// The share of published messages that arrive damaged, and how.
    pub damaged: (f64, Damage),
    /// After this long without a sign of the other side a link is closed.
    pub lease: Duration,
    /// How long a leaf without a link waits between two attempts to connect, at most.
    pub retry: Duration,
    /// Messages that a link keeps while it is cut; more are dropped.
    pub queue: usize,
    /// A node that publishes is held up for at most this long, now and then: it computes, or others do.
    pub pause: Duration,
}

/// How messages are damaged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damage {
    /// Cut short: whoever checks lengths notices.
    Truncated,
    /// One bit is another.
    BitFlip,
    /// Random bytes.
    Noise,
}
