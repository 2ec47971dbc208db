//! Shield: keeps between what it guards and the nearest enemy.

use super::{Conduct, head};
use crate::helm::{Bid, Scene};
use game::strategy::Shield;

/// Extra speed for each metre off the station, 1/s.
const CATCH_UP_PER_S: f64 = 0.5;

pub(super) struct Conductor(pub(super) Shield);

impl Conduct for Conductor {
    fn act(&mut self, scene: &Scene, bid: &mut Bid<'_>) {
        let Some(guarded) = scene.spot(&self.0.guarded) else { return };
        let Some(enemy) = scene.boat(self.0.against).copied() else { return };
        let line = enemy.at - guarded.at;
        let range_m = line.length();
        let ahead_m = self.0.distance_m.value(scene).min(0.5 * range_m);
        let station = if range_m > 1e-6 { guarded.at + line.scaled(ahead_m / range_m) } else { guarded.at };
        let distance_m = scene.at.distance(station);
        let (guarded_m_s, fastest_m_s) = (guarded.velocity.length(), self.0.speed_m_s.value(scene));
        if distance_m <= self.0.radius_m.value(scene) {
            // On station: as what it guards, bow to the enemy where that lies still.
            let course_rad = if guarded_m_s > 0.1 {
                game::math::atan2(guarded.velocity.east, guarded.velocity.north)
            } else {
                scene.at.bearing_rad(enemy.at)
            };
            bid.ask_for(1.0, Some(enemy.vehicle), &head(scene, course_rad, guarded_m_s.min(fastest_m_s), 0.5));
        } else {
            let speed_m_s = (guarded_m_s + CATCH_UP_PER_S * distance_m).min(fastest_m_s);
            bid.ask_for(1.0, Some(enemy.vehicle), &head(scene, scene.at.bearing_rad(station), speed_m_s, 0.5));
        }
    }
}
