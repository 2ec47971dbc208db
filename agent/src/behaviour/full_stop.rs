//! Full stop: prefers no speed, and lets safety have its way.

use super::logic::BehaviourLogic;
use super::output::BehaviourOutput;
use crate::ivp::{Objective, Peak};
use crate::situation::Situation;
use scenario::strategy::FullStop;

impl BehaviourLogic for FullStop {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        // A preference, not a command: a boat that lies still cannot keep clear of one that
        // comes, so safety may outweigh it. It asks for no course.
        output.add(&Objective::Speed(Peak::tent(0.0, situation.model.speed_max_m_s)));
    }
}
