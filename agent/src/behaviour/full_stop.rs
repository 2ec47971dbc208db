//! Full stop: prefers no speed, and lets safety have its way.

use super::logic::BehaviourLogic;
use super::output::BehaviourOutput;
use crate::ivp::{Objective, Peak};
use crate::situation::Situation;
use game::strategy::FullStop;

impl BehaviourLogic for FullStop {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        output.add(&Objective::Speed(Peak::tent(0.0, situation.model.speed_max_m_s)));
    }
}
