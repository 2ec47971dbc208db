//! Packets: what travels over links.

use crate::query::Asked;
use bus::Parcel;
use std::sync::Arc;

/// What travels over a link.
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
    /// An answer, or that no more will come.
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

/// What a session can declare, as the hub knows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Subscriber,
    Queryable,
    Token,
    Watch,
}

/// Something that a session takes from itself.
#[derive(Clone, Debug)]
pub(crate) enum Local {
    Publish { key: Arc<str>, bytes: Arc<[u8]> },
    Token { watch: u64, key: String },
}
