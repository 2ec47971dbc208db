//! Home: where tagged boats are untagged.

use super::{Referee, Standing, UntagOn};
use crate::event::Event;
use primitives::frame::Ned;
use primitives::id::VehicleId;

impl Referee {
    /// Untags the tagged boats that are home, no earlier than the next check after the tag.
    ///
    /// Home ends at the boundary, although the corners' circles extend beyond it: a boat tagged for
    /// leaving the field is not untagged outside.
    pub(super) fn untag(
        &self,
        standing: &mut Standing,
        at: &impl Fn(usize) -> Ned,
        events: &mut Vec<Event>,
    ) {
        for (i, boat) in standing.vehicles.iter_mut().enumerate() {
            let was_at_home = boat.at_home;
            boat.at_home = !boat.outside
                && self
                    .rules
                    .is_untag_place(&self.field, self.team_of[i], at(i), standing.now);
            let freed = match self.rules.untag_on {
                UntagOn::Entering => boat.at_home && !was_at_home,
                UntagOn::Inside => boat.at_home,
                UntagOn::Never => false,
            };
            if freed && boat.tagged && boat.in_play && boat.tagged_at != standing.now {
                boat.tagged = false;
                events.push(Event::Untagged(VehicleId::at(i)));
            }
        }
    }
}
