//! What a behaviour does while it runs.

use super::output::BehaviourOutput;
use crate::situation::Situation;

/// What a behaviour does while it runs; when it runs is the helm's matter.
pub(crate) trait BehaviourLogic: Send {
    /// It begins to run: forgets what was.
    fn begin(&mut self, _situation: &Situation) {}

    /// Produces the objective functions of this decision.
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>);
}
