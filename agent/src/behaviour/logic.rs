//! The interface of a behaviour's logic.

use super::output::BehaviourOutput;
use crate::policy::BoardPolicy;
use crate::situation::Situation;

/// The logic of a behaviour; the helm decides when it runs.
pub(crate) trait BehaviourLogic: Send {
    /// Observes the situation of a decision, whether the behaviour runs or not.
    fn observe(&mut self, _situation: &Situation) {}

    /// The variable that this behaviour sets and the index of its text, whether it runs or not.
    fn option(&self) -> Option<(u16, usize)> {
        None
    }

    /// Resets the memory when the behaviour starts running.
    fn begin(&mut self, _situation: &Situation) {}

    /// Adds the objective functions of this decision.
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>);

    /// The trained policy of this behaviour, if any.
    fn policy(&self) -> Option<&BoardPolicy> {
        None
    }
}
