//! Trail: keeps a position relative to a moving boat.

use super::steering::steer;
use super::{BehaviourLogic, BehaviourOutput};
use crate::situation::Situation;
use primitives::{Ned, math};
use scenario::strategy::Trail;

/// Extra speed per distance from the position, m/s per m.
const CATCH_UP_PER_S: f64 = 0.2;

impl BehaviourLogic for Trail {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let Some(contact) = situation.boat(self.contact).copied() else {
            return;
        };
        let direction_rad = contact.psi_rad + self.angle_deg.value(situation).to_radians();
        let (east, north) = math::sin_cos(direction_rad);
        let place = contact.at + Ned { north, east }.scaled(self.range_m.value(situation));
        let contact_m_s = contact.velocity().length();
        let distance_m = situation.at.distance(place);
        let fastest_m_s = self.speed_m_s.value(situation);
        // Within the radius, match the contact's motion: steering for the exact position would turn
        // the boat for each small error.
        let (course_rad, speed_m_s) = if distance_m <= self.radius_m.value(situation) {
            (contact.psi_rad, contact_m_s)
        } else {
            (
                situation.at.bearing_rad(place),
                contact_m_s + CATCH_UP_PER_S * distance_m,
            )
        };
        let objective = steer(situation, course_rad, speed_m_s.min(fastest_m_s), 0.5);
        output.add_share(1.0, Some(contact.vehicle), &objective);
    }
}
