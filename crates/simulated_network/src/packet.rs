//! Packets, which travel over links.

use crate::query::Asked;
use bus::Parcel;
use std::sync::Arc;

/// A packet on a link.
#[derive(Clone, Debug)]
pub(crate) enum Packet {
    Publish {
        key: Arc<str>,
        bytes: Arc<[u8]>,
    },
    Declare {
        id: u64,
        kind: Kind,
        key: String,
    },
    Undeclare {
        id: u64,
    },
    /// To the hub.
    Ask {
        query: u64,
        key: String,
        asked: Asked,
    },
    /// To the leaf that has declared the queryable.
    Query {
        query: u64,
        id: u64,
        key: String,
        payload: Parcel,
    },
    /// An answer, or the end of the answers.
    Answer {
        query: u64,
        answer: Option<Parcel>,
    },
    Token {
        key: String,
        is_there: bool,
    },
    Close,
}

/// The kinds of declarations, as the hub distinguishes them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Subscriber,
    Queryable,
    Token,
    Watch,
}

/// A delivery from a session to itself.
#[derive(Clone, Debug)]
pub(crate) enum Local {
    Publish { key: Arc<str>, bytes: Arc<[u8]> },
    Token { watch: u64, key: String },
}
