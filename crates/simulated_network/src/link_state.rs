//! The state of a link, and the packets in flight over it.

use crate::packet::{Kind, Packet};
use std::collections::{BTreeMap, VecDeque};

/// A link, open until both of its ends are closed.
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
    /// Since when its ends hear nothing: the leaf, then the hub.
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
