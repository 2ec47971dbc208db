//! Trail: keeps a place relative to a boat that moves.

use super::{Conduct, head};
use crate::helm::{Bid, Scene};
use game::strategy::Trail;
use game::{Ned, math};

/// Extra speed for each metre off the place, 1/s.
const CATCH_UP_PER_S: f64 = 0.2;

pub(super) struct Conductor(pub(super) Trail);

impl Conduct for Conductor {
    fn act(&mut self, scene: &Scene, bid: &mut Bid<'_>) {
        let Some(contact) = scene.boat(self.0.contact).copied() else { return };
        let direction_rad = contact.psi_rad + self.0.angle_deg.value(scene).to_radians();
        let (east, north) = math::sin_cos(direction_rad);
        let place = contact.at + Ned { north, east }.scaled(self.0.range_m.value(scene));
        let contact_m_s = contact.velocity.length();
        let distance_m = scene.at.distance(place);
        let fastest_m_s = self.0.speed_m_s.value(scene);
        if distance_m <= self.0.radius_m.value(scene) {
            bid.ask_for(1.0, Some(contact.vehicle), &head(scene, contact.psi_rad, contact_m_s.min(fastest_m_s), 0.5));
        } else {
            let speed_m_s = (contact_m_s + CATCH_UP_PER_S * distance_m).min(fastest_m_s);
            bid.ask_for(1.0, Some(contact.vehicle), &head(scene, scene.at.bearing_rad(place), speed_m_s, 0.5));
        }
    }
}
