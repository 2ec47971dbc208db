//! Behaviours without a goal: constant heading, constant speed, full stop, and the timer.

use super::{BehaviourLogic, BehaviourOutput};
use crate::ivp::{Objective, Peak};
use crate::situation::Situation;
use primitives::angle::rad_from_compass_deg;
use scenario::strategy::{ConstantHeading, ConstantSpeed, FullStop, Timer};

/// Utility drop from the summit of a peak to its edge.
const SUMMIT_DELTA: f64 = 25.0;

impl BehaviourLogic for ConstantHeading {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        output.add(&Objective::course(Peak {
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
        output.add(&Objective::speed(Peak {
            // A summit above the top speed would lower the utility of the top speed, and the course
            // would outweigh it.
            summit: self
                .speed_m_s
                .value(situation)
                .min(situation.model.speed_max_m_s),
            peak_width: self.peak_width_m_s.value(situation),
            base_width: self.base_width_m_s.value(situation),
            summit_delta: SUMMIT_DELTA,
            height: 100.0,
        }));
    }
}

impl BehaviourLogic for FullStop {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        // This is a preference, not a command: a stationary boat cannot avoid an approaching one.
        // Any course will do.
        output.add(&Objective::speed(Peak::tent(
            0.0,
            situation.model.speed_max_m_s,
        )));
    }
}

/// Runs until its duration has elapsed; the helm ends it.
impl BehaviourLogic for Timer {
    fn run(&mut self, _situation: &Situation, _output: &mut BehaviourOutput<'_>) {}
}
