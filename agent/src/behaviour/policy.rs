//! Policy: lets somebody outside of the helm propose course and speed, weighed with everything else.

use super::Conduct;
use crate::helm::{Bid, Scene};
use crate::ivp::{Objective, Peak, Peaks};
use game::strategy::Policy;

/// From the peak of the proposed speed down to nothing, m/s.
const SPEED_BASE_M_S: f64 = 1.0;

pub(super) struct Conductor(pub(super) Policy);

impl Conduct for Conductor {
    fn act(&mut self, scene: &Scene, bid: &mut Bid<'_>) {
        let Some(proposed) = scene.proposed else { return };
        if (scene.now - proposed.at).as_s() > self.0.ttl_s.value(scene) {
            return;
        }
        let proposal = proposed.proposal;
        bid.ask(&Objective::Coupled {
            course: Peaks::one(Peak {
                summit: proposal.course_rad,
                peak_width: self.0.peak_width_deg.value(scene).to_radians(),
                base_width: self.0.base_width_deg.value(scene).to_radians(),
                summit_delta: 10.0,
                height: 100.0,
            }),
            speed: Peaks::one(Peak::tent(proposal.speed_m_s.clamp(0.0, scene.chart.speed_max_m_s), SPEED_BASE_M_S)),
            course_share: self.0.course_share.value(scene),
        });
    }
}
