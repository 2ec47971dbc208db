//! Trail: keeps a place relative to a boat that moves.

use super::logic::BehaviourLogic;
use super::output::BehaviourOutput;
use super::steering::steer;
use crate::situation::Situation;
use primitives::{Ned, math};
use scenario::strategy::Trail;

/// Extra speed for each metre off the place, 1/s.
const CATCH_UP_PER_S: f64 = 0.2;

impl BehaviourLogic for Trail {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let Some(contact) = situation.boat(self.contact).copied() else { return };
        let direction_rad = contact.psi_rad + self.angle_deg.value(situation).to_radians();
        let (east, north) = math::sin_cos(direction_rad);
        let place = contact.at + Ned { north, east }.scaled(self.range_m.value(situation));
        let contact_m_s = contact.velocity().length();
        let distance_m = situation.at.distance(place);
        let fastest_m_s = self.speed_m_s.value(situation);
        // Within the radius it goes as the contact goes: to steer for the place itself would
        // turn the boat at each small error.
        let (course_rad, speed_m_s) = if distance_m <= self.radius_m.value(situation) {
            (contact.psi_rad, contact_m_s)
        } else {
            (situation.at.bearing_rad(place), contact_m_s + CATCH_UP_PER_S * distance_m)
        };
        let objective = steer(situation, course_rad, speed_m_s.min(fastest_m_s), 0.5);
        output.add_share(1.0, Some(contact.vehicle), &objective);
    }
}
