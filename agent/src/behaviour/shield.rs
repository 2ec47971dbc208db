//! Shield: stays between the guarded place and the nearest enemy.

use super::steering::{speed_to_turn_onto, steer};
use super::{BehaviourLogic, BehaviourOutput};
use crate::situation::Situation;
use scenario::strategy::Shield;

/// Extra speed per distance from the station, m/s per m.
const CATCH_UP_PER_S: f64 = 0.5;

impl BehaviourLogic for Shield {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let Some(guarded) = situation.locate(&self.guarded) else {
            return;
        };
        let Some(enemy) = situation.boat(self.against).copied() else {
            return;
        };
        let line = enemy.at - guarded.at;
        let range_m = line.length();
        // Stay at most half-way, so that a close enemy never gets between the boat and the place.
        let ahead_m = self.distance_m.value(situation).min(0.5 * range_m);
        let station = if range_m > 1e-6 {
            guarded.at + line.scaled(ahead_m / range_m)
        } else {
            guarded.at
        };
        let distance_m = situation.at.distance(station);
        let guarded_m_s = guarded.velocity.length();
        let fastest_m_s = self.speed_m_s.value(situation);
        let (course_rad, speed_m_s) = if distance_m > self.radius_m.value(situation) {
            (
                situation.at.bearing_rad(station),
                guarded_m_s + CATCH_UP_PER_S * distance_m,
            )
        } else if guarded_m_s > 0.1 {
            // On station: match the motion of the guarded place; if it is stationary, point the bow
            // at the enemy.
            (
                primitives::math::atan2(guarded.velocity.east, guarded.velocity.north),
                guarded_m_s,
            )
        } else {
            (situation.at.bearing_rad(enemy.at), guarded_m_s)
        };
        let turning_m_s = speed_to_turn_onto(situation, station).max(guarded_m_s);
        let objective = steer(
            situation,
            course_rad,
            speed_m_s.min(fastest_m_s).min(turning_m_s),
            0.5,
        );
        output.add_share(1.0, Some(enemy.vehicle), &objective);
    }
}
