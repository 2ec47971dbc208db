//! Timer: runs for a while and wants nothing.

use super::logic::BehaviourLogic;
use super::output::BehaviourOutput;
use crate::situation::Situation;
use scenario::strategy::Timer;

/// Runs until its duration is over, which the helm sees to.
impl BehaviourLogic for Timer {
    fn run(&mut self, _situation: &Situation, _output: &mut BehaviourOutput<'_>) {}
}
