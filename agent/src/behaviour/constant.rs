//! Constant heading and constant speed.

use super::logic::BehaviourLogic;
use super::output::BehaviourOutput;
use crate::ivp::{Objective, Peak};
use crate::situation::Situation;
use primitives::angle::rad_from_compass_deg;
use scenario::strategy::{ConstantHeading, ConstantSpeed};

/// Utility drop from the summit of a peak to its edge.
const SUMMIT_DELTA: f64 = 25.0;

impl BehaviourLogic for ConstantHeading {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        output.add(&Objective::Course(Peak {
            summit: rad_from_compass_deg(self.heading_deg.value(situation)),
            peak_width: self.peak_width_deg.value(situation).to_radians(),
            base_width: self.base_width_deg.value(situation).to_radians(),
            summit_delta: SUMMIT_DELTA,
            height: 100.0,
        }));
    }
}

impl BehaviourLogic for ConstantSpeed {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        output.add(&Objective::Speed(Peak {
            // A summit beyond the top speed would lower the utility of the top speed, and the
            // course would outweigh it.
            summit: self.speed_m_s.value(situation).min(situation.model.speed_max_m_s),
            peak_width: self.peak_width_m_s.value(situation),
            base_width: self.base_width_m_s.value(situation),
            summit_delta: SUMMIT_DELTA,
            height: 100.0,
        }));
    }
}
