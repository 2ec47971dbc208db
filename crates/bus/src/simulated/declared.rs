//! What sessions declare.

use super::packet::{Kind, Packet};
use super::query::RoutedQuery;
use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

/// What is called with the bytes of a message, with a query, and with a token that has come or gone.
pub(super) type TakeBytes = Arc<dyn Fn(&[u8]) + Send + Sync>;
pub(super) type TakeQuery = Arc<dyn Fn(RoutedQuery) + Send + Sync>;
pub(super) type TakeToken = Arc<dyn Fn(&str, bool) + Send + Sync>;

/// Something that a session has declared, with what to call.
pub(super) struct Declared {
    pub(super) key: String,
    pub(super) what: What,
}

pub(super) enum What {
    Subscriber {
        take: TakeBytes,
        hears_own: bool,
    },
    Queryable(TakeQuery),
    Token,
    /// With the tokens that are known to be there.
    Watch(TakeToken, BTreeSet<String>),
}

impl Declared {
    pub(super) fn packet(&self, id: u64) -> Packet {
        let kind = match self.what {
            What::Subscriber { .. } => Kind::Subscriber,
            What::Queryable(_) => Kind::Queryable,
            What::Token => Kind::Token,
            What::Watch(..) => Kind::Watch,
        };
        Packet::Declare { id, kind, key: self.key.clone() }
    }
}

impl fmt::Debug for Declared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.key)
    }
}
