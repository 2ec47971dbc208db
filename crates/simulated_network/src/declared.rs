//! What sessions declare.

use crate::packet::{Kind, Packet};
use crate::query::RoutedQuery;
use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

/// What is called with the bytes of a message, with a query, and with a token that has come or gone.
pub(crate) type TakeBytes = Arc<dyn Fn(&[u8]) + Send + Sync>;
pub(crate) type TakeQuery = Arc<dyn Fn(RoutedQuery) + Send + Sync>;
pub(crate) type TakeToken = Arc<dyn Fn(&str, bool) + Send + Sync>;

/// Something that a session has declared, with what to call.
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
    /// With the tokens that are known to be there.
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
        Packet::Declare { id, kind, key: self.key.clone() }
    }
}

impl fmt::Debug for Declared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.key)
    }
}
