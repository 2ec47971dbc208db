//! Full stop: prefers zero speed, but safety may outweigh it.

use super::logic::BehaviourLogic;
use super::output::BehaviourOutput;
use crate::ivp::{Objective, Peak};
use crate::situation::Situation;
use scenario::strategy::FullStop;

impl BehaviourLogic for FullStop {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        // A preference, not a command: a stationary boat cannot avoid an approaching one. It has no
        // preference for a course.
        output.add(&Objective::Speed(Peak::tent(0.0, situation.model.speed_max_m_s)));
    }
}
