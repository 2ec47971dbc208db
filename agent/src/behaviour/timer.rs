//! Timer: runs for a while and wants nothing.

use super::logic::BehaviourLogic;
use super::output::BehaviourOutput;
use crate::situation::Situation;

/// Runs until its duration is over, which the helm sees to.
pub(super) struct TimerBehaviour;

impl BehaviourLogic for TimerBehaviour {
    fn run(&mut self, _situation: &Situation, _output: &mut BehaviourOutput<'_>) {}
}
