//! The events of a simulation, in the order of virtual time.

use crate::conditions::Fault;
use crate::packet::Local;
use std::time::Duration;

/// An event at a virtual time.
#[derive(Clone, Debug)]
pub(crate) enum Event {
    /// The wait of a thread has timed out.
    Wake {
        thread: usize,
        wait: u64,
    },
    /// A node starts, for the first time or again.
    Start {
        node: usize,
    },
    Fault(Fault),
    CutEnd {
        node: usize,
    },
    SuspensionEnd {
        node: usize,
    },
    /// A packet arrives at one end of a link.
    Arrive {
        link: usize,
        up: bool,
        arrival: u64,
    },
    /// The lease of one end of a link has expired. The end closes unless it has received something
    /// since.
    LeaseOver {
        link: usize,
        at_hub: bool,
        since_ns: u64,
    },
    /// A leaf without a link tries to connect.
    Reconnect {
        session: usize,
    },
    /// A session receives its own message, or a token that was present when its watch began.
    Local {
        session: usize,
        local: Local,
    },
}

/// A time in ns, capped at about five centuries.
pub(crate) fn nanos(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}
