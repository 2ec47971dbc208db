//! Policy: lets somebody outside of the helm propose course and speed, weighed with everything else.

use super::{BehaviourLogic, BehaviourOutput};
use crate::ivp::{Objective, Peak};
use crate::situation::Situation;
use game::strategy::Policy;

/// From the peak of the proposed speed down to nothing, m/s.
const SPEED_BASE_M_S: f64 = 1.0;

impl BehaviourLogic for Policy {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let Some(proposal) = situation.proposed else { return };
        if (situation.now - proposal.at).as_s() > self.ttl_s.value(situation) {
            return;
        }
        let speed_m_s = proposal.speed_m_s.clamp(0.0, situation.model.speed_max_m_s);
        let (heading_rad, speed_m_s) = situation.motion.steer(proposal.course_rad, speed_m_s);
        output.add(&Objective::Coupled {
            course: Peak {
                summit: heading_rad,
                peak_width: self.peak_width_deg.value(situation).to_radians(),
                base_width: self.base_width_deg.value(situation).to_radians(),
                summit_delta: 10.0,
                height: 100.0,
            },
            speed: Peak::tent(speed_m_s, SPEED_BASE_M_S),
            course_share: self.course_share.value(situation),
        });
    }
}
