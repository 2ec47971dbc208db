//! The boundary: a boat that leaves the field loses its flag and, with `boundary_tags`, is tagged.

use super::{Referee, Standing};
use crate::event::{Event, TagCause};
use primitives::frame::Ned;
use primitives::id::VehicleId;

impl Referee {
    /// Records boats that left the field or returned. Outside the field no boat carries a flag and,
    /// with `boundary_tags`, every boat is tagged.
    pub(super) fn watch_boundary(
        &self,
        standing: &mut Standing,
        at: &impl Fn(usize) -> Ned,
        events: &mut Vec<Event>,
    ) {
        for i in 0..standing.vehicles.len() {
            let boat = &mut standing.vehicles[i];
            if !boat.in_play {
                continue;
            }
            let vehicle = VehicleId::at(i);
            let outside = !self.field.contains(at(i));
            match (boat.outside, outside) {
                (false, true) => events.push(Event::LeftField(vehicle)),
                (true, false) => events.push(Event::ReturnedToField(vehicle)),
                _ => {}
            }
            boat.outside = outside;
            if !outside {
                continue;
            }
            if self.rules.boundary_tags && !boat.tagged {
                standing.put_tag(vehicle, TagCause::Boundary, events);
            }
            standing.drop_flag(vehicle, events);
        }
    }
}
