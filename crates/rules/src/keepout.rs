//! Keep-out circles: while a flag is home, its own defenders must keep their distance.

use super::{Referee, Standing};
use crate::event::Event;
use primitives::frame::Ned;
use primitives::id::{TeamId, VehicleId};

impl Referee {
    /// The circle that a boat at `at` must stay out of, if any: centre and radius in m. If several
    /// flags of its team are home, it is the circle that the boat is deepest in or nearest to.
    pub fn keepout(&self, standing: &Standing, vehicle: VehicleId, at: Ned) -> Option<(Ned, f64)> {
        if !standing.vehicles[vehicle.index()].in_play {
            return None;
        }
        let circles = self.keepouts(standing, self.team_of[vehicle.index()]);
        circles.min_by(|a, b| beyond(at, *a).total_cmp(&beyond(at, *b)))
    }

    /// Records boats that entered a keep-out circle, or were inside one when the flag came home.
    pub(super) fn watch_keepouts(
        &self,
        standing: &mut Standing,
        at: &impl Fn(usize) -> Ned,
        events: &mut Vec<Event>,
    ) {
        let flags = &self.field.flags;
        if flags
            .iter()
            .all(|flag| self.rules.radii_of(flag).keepout_m <= 0.0)
        {
            return;
        }
        for i in 0..standing.vehicles.len() {
            let here = at(i);
            let inside = self
                .keepouts(standing, self.team_of[i])
                .any(|circle| beyond(here, circle) < 0.0);
            let boat = &mut standing.vehicles[i];
            if inside && !boat.in_keepout && boat.in_play {
                events.push(Event::EnteredKeepout(VehicleId::at(i)));
            }
            boat.in_keepout = inside;
        }
    }

    /// The circles around the home positions of `team`'s flags that no boat carries: centre and
    /// radius in m.
    #[inline]
    fn keepouts(&self, standing: &Standing, team: TeamId) -> impl Iterator<Item = (Ned, f64)> {
        self.field
            .own_flags(team)
            .filter(|(id, _)| standing.flags[id.index()].carrier.is_none())
            .map(|(_, flag)| (flag.home(standing.now), self.rules.radii_of(flag).keepout_m))
            .filter(|(_, radius_m)| *radius_m > 0.0)
    }
}

/// How far `at` is beyond a circle, as the square of its distance from the centre minus that of
/// the radius, m²; negative inside.
fn beyond(at: Ned, (centre, radius_m): (Ned, f64)) -> f64 {
    at.distance_squared(centre) - radius_m * radius_m
}
