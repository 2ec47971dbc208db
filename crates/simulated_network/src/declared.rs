//! Declarations and queries of sessions, with their callbacks.

use crate::packet::{Kind, Packet};
use bus::Parcel;
use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

/// A callback for an event, called with no lock held.
pub(crate) type Call = Box<dyn FnOnce() + Send>;
/// Callbacks for the bytes of a message, for a query, and for a token that has appeared or
/// disappeared.
pub(crate) type TakeBytes = Arc<dyn Fn(&[u8]) + Send + Sync>;
pub(crate) type TakeQuery = Arc<dyn Fn(RoutedQuery) + Send + Sync>;
pub(crate) type TakeToken = Arc<dyn Fn(&str, bool) + Send + Sync>;

/// A declaration of a session, with its callback.
pub(crate) struct Declared {
    pub(crate) key: String,
    pub(crate) what: What,
}

pub(crate) enum What {
    Subscriber {
        take: TakeBytes,
        hears_own: bool,
    },
    Queryable(TakeQuery),
    Token,
    /// Includes the tokens known to be present.
    Watch(TakeToken, BTreeSet<String>),
}

impl Declared {
    pub(crate) fn packet(&self, id: u64) -> Packet {
        let kind = match self.what {
            What::Subscriber { .. } => Kind::Subscriber,
            What::Queryable(_) => Kind::Queryable,
            What::Token => Kind::Token,
            What::Watch(..) => Kind::Watch,
        };
        Packet::Declare {
            id,
            kind,
            key: self.key.clone(),
        }
    }
}

impl fmt::Debug for Declared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.key)
    }
}

/// A query that has reached a session with a matching queryable.
pub(crate) struct RoutedQuery {
    pub(crate) session: usize,
    pub(crate) query: u64,
    pub(crate) key: String,
    pub(crate) payload: Parcel,
}

/// A query that still awaits answers.
pub(crate) struct PendingQuery {
    pub(crate) asker: usize,
    /// Number of sessions that may still answer.
    pub(crate) open: usize,
    /// Called with each answer, and with `None` after the last one.
    pub(crate) take: Arc<dyn Fn(Option<Parcel>) + Send + Sync>,
}
