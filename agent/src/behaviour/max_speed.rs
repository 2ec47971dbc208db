//! Maximum speed: limits the speed, always or near other boats.

use super::nearest::is_meant;
use super::{BehaviourLogic, BehaviourOutput};
use crate::ivp::{Objective, Peak};
use crate::situation::{OtherBoat, Situation};
use primitives::angle::wrap_pi;
use scenario::strategy::MaxSpeed;

impl BehaviourLogic for MaxSpeed {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let always = self.range_m.value(situation) <= 0.0;
        if always
            || situation
                .others()
                .any(|other| is_near(self, situation, other))
        {
            let peak_width = self.speed_m_s.value(situation);
            let base_width = self.tolerance_m_s.value(situation);
            // Half of a peak at zero speed: full utility up to the limit, as in MOOS-IvP's
            // `ZAIC_LEQ`.
            output.add(&Objective::speed(Peak {
                peak_width,
                ..Peak::tent(0.0, base_width)
            }));
        }
    }
}

/// Whether a boat is near enough, and close enough to the bow, to limit the speed.
fn is_near(task: &MaxSpeed, situation: &Situation, other: &OtherBoat) -> bool {
    let off_bow_rad = wrap_pi(situation.at.bearing_rad(other.at) - situation.own.nav.psi_rad).abs();
    is_meant(task.contacts, situation, other)
        && situation.at.distance(other.at) < task.range_m.value(situation)
        && off_bow_rad <= task.angle_deg.value(situation).to_radians()
}
