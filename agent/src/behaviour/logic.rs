//! The interface of a behaviour's logic.

use super::output::BehaviourOutput;
use crate::policy::BoardPolicy;
use crate::situation::Situation;

/// What a behaviour does while it runs; when it runs is the helm's matter.
pub(crate) trait BehaviourLogic: Send {
    /// Takes in the situation of a decision, whether it runs or not.
    fn observe(&mut self, _situation: &Situation) {}

    /// The variable that it sets, and to which of its texts, whether it runs or not.
    fn option(&self) -> Option<(u16, usize)> {
        None
    }

    /// It begins to run: forgets what was.
    fn begin(&mut self, _situation: &Situation) {}

    /// Produces the objective functions of this decision.
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>);

    /// The trained policy that it asks, if it does.
    fn policy(&self) -> Option<&BoardPolicy> {
        None
    }
}
