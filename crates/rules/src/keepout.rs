//! Keep-out circles: while a flag is home, its own defenders must keep their distance.

use super::{Referee, Standing};
use crate::event::Event;
use primitives::frame::Ned;
use primitives::id::{TeamId, VehicleId};

impl Referee {
    /// The circle that a boat at `at` must stay out of, if any: centre and radius in m. If several
    /// flags of its team are home, the circle is that of the nearest.
    pub fn keepout(&self, standing: &Standing, vehicle: VehicleId, at: Ned) -> Option<(Ned, f64)> {
        let radius_m = self.rules.flag_keepout_m;
        if radius_m <= 0.0 || !standing.vehicles[vehicle.index()].in_play {
            return None;
        }
        at.nearest_of(self.own_flags_home(standing, self.team_of[vehicle.index()]))
            .map(|centre| (centre, radius_m))
    }

    /// Records boats that entered a keep-out circle, or were inside one when the flag came home.
    pub(super) fn watch_keepouts(
        &self,
        standing: &mut Standing,
        at: &impl Fn(usize) -> Ned,
        events: &mut Vec<Event>,
    ) {
        let radius_m = self.rules.flag_keepout_m;
        if radius_m <= 0.0 {
            return;
        }
        for i in 0..standing.vehicles.len() {
            let here = at(i);
            let is_inside = |centre| here.distance_squared(centre) < radius_m * radius_m;
            let inside = self
                .own_flags_home(standing, self.team_of[i])
                .any(is_inside);
            let boat = &mut standing.vehicles[i];
            if inside && !boat.in_keepout && boat.in_play {
                events.push(Event::EnteredKeepout(VehicleId::at(i)));
            }
            boat.in_keepout = inside;
        }
    }

    /// The home positions of `team`'s flags that no boat carries.
    #[inline]
    fn own_flags_home(&self, standing: &Standing, team: TeamId) -> impl Iterator<Item = Ned> {
        self.field
            .own_flags(team)
            .filter(|(flag, _)| standing.flags[flag.index()].carrier.is_none())
            .map(|(_, home)| home)
    }
}
