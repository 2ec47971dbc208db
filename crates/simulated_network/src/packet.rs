//! Packets, and the links over which they travel.

use bus::Parcel;
use std::collections::{BTreeMap, VecDeque};
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

/// The subject of a query.
#[derive(Clone, Debug)]
pub(crate) enum Asked {
    Payload(Parcel),
    /// The tokens present, as a JSON list.
    Tokens,
}

/// The kinds of declarations, as distinguished by the hub.
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

/// A link, open until both of its ends are closed.
#[derive(Default)]
pub(crate) struct Link {
    /// The sessions at its ends.
    pub(crate) leaf: usize,
    pub(crate) hub: usize,
    pub(crate) leaf_open: bool,
    pub(crate) hub_open: bool,
    /// The leaf's declarations that have reached the hub.
    pub(crate) known: BTreeMap<u64, (Kind, String)>,
    pub(crate) down: Direction,
    pub(crate) up: Direction,
    /// Since when each end has received nothing: the leaf, then the hub.
    pub(crate) silent_since_ns: [Option<u64>; 2],
}

/// The packets in flight in one direction, oldest first, each with its arrival time.
#[derive(Default)]
pub(crate) struct Direction {
    pub(crate) queue: VecDeque<(u64, Packet)>,
    /// Whether an arrival is scheduled, and its number: earlier ones are void.
    pub(crate) is_due: bool,
    pub(crate) arrival: u64,
    pub(crate) last_ns: u64,
}

impl Link {
    /// The packets in flight in one direction.
    pub(crate) fn direction(&mut self, up: bool) -> &mut Direction {
        if up { &mut self.up } else { &mut self.down }
    }
}
