//! Timer: runs for a set time without objective functions.

use super::logic::BehaviourLogic;
use super::output::BehaviourOutput;
use crate::situation::Situation;
use scenario::strategy::Timer;

/// Runs until its duration is over; the helm ends it.
impl BehaviourLogic for Timer {
    fn run(&mut self, _situation: &Situation, _output: &mut BehaviourOutput<'_>) {}
}
