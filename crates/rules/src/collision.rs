//! Collisions: boats closer than the collision distance.

use super::{Notes, Referee, Standing};
use crate::event::Event;
use primitives::id::VehicleId;
use primitives::near::Pair;

impl Referee {
    /// Records new collisions, once per encounter. Boats out of play count, too.
    pub(super) fn watch_collisions(
        &self,
        standing: &mut Standing,
        notes: &mut Notes,
        near: &[Pair],
        events: &mut Vec<Event>,
    ) {
        let reach_squared = self.rules.collision_distance_m * self.rules.collision_distance_m;
        notes.touching.clear();
        // Both lists have the same order, so one pass over the old list is enough.
        let mut before = standing.touching.iter().peekable();
        for pair in near
            .iter()
            .filter(|pair| pair.distance_squared < reach_squared)
        {
            let first = VehicleId(pair.a);
            let second = VehicleId(pair.b);
            while before.next_if(|old| **old < (first, second)).is_some() {}
            if before.next_if(|old| **old == (first, second)).is_none() {
                events.push(Event::Collided { first, second });
            }
            notes.touching.push((first, second));
        }
        std::mem::swap(&mut standing.touching, &mut notes.touching);
    }
}
