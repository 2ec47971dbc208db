//! Home: where tagged boats are freed.

use super::{Referee, Standing, UntagAt, UntagOn};
use crate::event::Event;
use primitives::frame::Ned;
use primitives::id::{TeamId, VehicleId};

impl Referee {
    /// Frees the tagged boats that have come home, at the next look after the tag at the earliest.
    ///
    /// Home ends at the boundary, although the corners' circles reach over it: a boat that was tagged for
    /// leaving the field is not freed before it is back on it.
    pub(super) fn untag(&self, standing: &mut Standing, at: &impl Fn(usize) -> Ned, events: &mut Vec<Event>) {
        for (i, boat) in standing.vehicles.iter_mut().enumerate() {
            let was_at_home = boat.at_home;
            boat.at_home = !boat.outside && self.is_home(self.team_of[i], at(i));
            let freed = match self.rules.untag_on {
                UntagOn::Entering => boat.at_home && !was_at_home,
                UntagOn::Inside => boat.at_home,
            };
            if freed && boat.tagged && boat.in_play && boat.tagged_at != standing.now {
                boat.tagged = false;
                events.push(Event::Untagged(VehicleId::at(i)));
            }
        }
    }

    #[inline]
    fn is_home(&self, team: TeamId, at: Ned) -> bool {
        let reach_squared = self.rules.untag_radius_m * self.rules.untag_radius_m;
        let near = |place: Ned| at.distance_squared(place) < reach_squared;
        match self.rules.untag_at {
            UntagAt::OwnFlag => self.own_flags(team).any(|(_, home)| near(home)),
            UntagAt::OwnCorners => self.own_corners(team).iter().any(|corner| near(*corner)),
        }
    }

    /// Where a boat of `team` at `at` steers to be freed: the nearest such place.
    pub(super) fn home(&self, team: TeamId, at: Ned) -> Option<Ned> {
        match self.rules.untag_at {
            UntagAt::OwnFlag => nearest(at, self.own_flags(team).map(|(_, home)| home)),
            UntagAt::OwnCorners => self.field.inside_own_corner(team, at, corner_inset_m(self.rules.untag_radius_m)),
        }
    }
}

/// How far inside of both edges boats steer that must come within `radius_m` of a corner, m. Half of it is 10 m where
/// the competition of 2026 has 20 m, and leaves 3 tenths of the radius to spare.
#[must_use]
pub fn corner_inset_m(radius_m: f64) -> f64 {
    0.5 * radius_m
}

/// The one of `places` that is nearest to `at`; the first of equals.
pub(super) fn nearest(at: Ned, places: impl Iterator<Item = Ned>) -> Option<Ned> {
    places.min_by(|x, y| at.distance_squared(*x).total_cmp(&at.distance_squared(*y)))
}
