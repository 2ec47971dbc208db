//! The state of a link, and what is on its way over it.

use super::packet::{Kind, Packet};
use std::collections::{BTreeMap, VecDeque};

/// A link, open until both of its ends are closed.
pub(super) struct Link {
    /// The sessions at its ends.
    pub(super) leaf: usize,
    pub(super) hub: usize,
    pub(super) leaf_open: bool,
    pub(super) hub_open: bool,
    /// What the leaf has declared, as far as the hub knows.
    pub(super) known: BTreeMap<u64, (Kind, String)>,
    pub(super) down: Direction,
    pub(super) up: Direction,
    /// Since when nothing comes to its ends, the leaf and the hub.
    pub(super) silent_since_ns: [Option<u64>; 2],
}

/// What is on its way in one direction, oldest first, each with the time of its arrival.
#[derive(Default)]
pub(super) struct Direction {
    pub(super) queue: VecDeque<(u64, Packet)>,
    /// Whether an arrival is due, and its number: an older one does not count any more.
    pub(super) is_due: bool,
    pub(super) arrival: u64,
    pub(super) last_ns: u64,
}

impl Link {
    /// What is on its way in one direction.
    pub(super) fn direction(&mut self, up: bool) -> &mut Direction {
        if up { &mut self.up } else { &mut self.down }
    }
}
