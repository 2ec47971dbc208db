//! The state of a link, and what is on its way over it.

use crate::packet::{Kind, Packet};
use std::collections::{BTreeMap, VecDeque};

/// A link, open until both of its ends are closed.
pub(crate) struct Link {
    /// The sessions at its ends.
    pub(crate) leaf: usize,
    pub(crate) hub: usize,
    pub(crate) leaf_open: bool,
    pub(crate) hub_open: bool,
    /// What the leaf has declared, as far as the hub knows.
    pub(crate) known: BTreeMap<u64, (Kind, String)>,
    pub(crate) down: Direction,
    pub(crate) up: Direction,
    /// Since when nothing comes to its ends, the leaf and the hub.
    pub(crate) silent_since_ns: [Option<u64>; 2],
}

/// What is on its way in one direction, oldest first, each with the time of its arrival.
#[derive(Default)]
pub(crate) struct Direction {
    pub(crate) queue: VecDeque<(u64, Packet)>,
    /// Whether an arrival is due, and its number: an older one does not count any more.
    pub(crate) is_due: bool,
    pub(crate) arrival: u64,
    pub(crate) last_ns: u64,
}

impl Link {
    /// What is on its way in one direction.
    pub(crate) fn direction(&mut self, up: bool) -> &mut Direction {
        if up { &mut self.up } else { &mut self.down }
    }
}
