//! The peer at the other end of a connection: its port, its outbox, and why the connection ends.

use super::outbox::Outbox;
use super::port::Port;
use parking_lot::Mutex;
use std::fmt;

/// Why a connection ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// The link is closing.
    Stopped,
    /// The connection broke.
    Lost(String),
}

/// The other end of a connection.
pub(super) struct Peer {
    pub(super) number: u32,
    pub(super) outbox: Outbox,
    pub(super) port: Port,
    end: Mutex<Option<End>>,
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            End::Stopped => write!(f, "closed here"),
            End::Lost(reason) => write!(f, "{reason}"),
        }
    }
}

impl Peer {
    pub(super) fn new(number: u32, port: Port) -> Peer {
        Peer {
            number,
            outbox: Outbox::new(),
            port,
            end: Mutex::new(None),
        }
    }

    /// Ends the connection. Only the first reason is kept.
    pub(super) fn end(&self, end: End) {
        // The first reason is the cause; the other thread's errors follow from it.
        self.end.lock().get_or_insert(end);
        self.outbox.shut();
    }

    /// Why the connection must end, if it must.
    pub(super) fn is_to_end(&self) -> Option<End> {
        self.end.lock().clone()
    }
}
