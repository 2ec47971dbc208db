//! The events of a simulation, in the order of virtual time.

use crate::fault::{Fault, FaultEnd};
use crate::packet::Local;
use std::cmp::Ordering;
use std::time::Duration;

/// Something that happens at its time.
#[derive(Clone, Debug)]
pub(crate) enum Event {
    /// A thread that waits has waited long enough.
    Wake {
        thread: usize,
        wait: u64,
    },
    /// A node is started, for the first time or again.
    Start {
        node: usize,
    },
    Fault(Fault),
    /// The end of a fault.
    FaultEnd {
        node: usize,
        what: FaultEnd,
    },
    /// What has travelled long enough arrives at one end of a link.
    Arrive {
        link: usize,
        up: bool,
        arrival: u64,
    },
    /// An end of a link has heard nothing for the lease, if the link is still as it was then.
    LeaseOver {
        link: usize,
        at_hub: bool,
        since_ns: u64,
    },
    /// A leaf without a link tries to connect.
    Reconnect {
        session: usize,
    },
    /// A session hears what it published itself, or what was there before it asked.
    Local {
        session: usize,
        local: Local,
    },
}

/// An event in the queue. Of several at one moment the one that was put in first comes first.
pub(crate) struct Queued {
    pub(crate) at_ns: u64,
    pub(crate) order: u64,
    pub(crate) event: Event,
}

impl PartialEq for Queued {
    fn eq(&self, other: &Queued) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Queued {}

impl PartialOrd for Queued {
    fn partial_cmp(&self, other: &Queued) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Queued {
    fn cmp(&self, other: &Queued) -> Ordering {
        // The earliest is the greatest: the queue is a max-heap.
        // The order of insertion decides among events of one moment: a heap by time alone would
        // be free to take either, and the same seed would give two traces.
        (other.at_ns, other.order).cmp(&(self.at_ns, self.order))
    }
}

/// A time in ns; what is longer than five centuries is as long.
pub(crate) fn nanos(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}
