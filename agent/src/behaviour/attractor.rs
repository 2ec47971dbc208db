//! Attractor: draws the boat to a place, the more the nearer it is.

use super::logic::BehaviourLogic;
use super::nearest::nearness;
use super::output::BehaviourOutput;
use super::steering::toward;
use crate::situation::Situation;
use game::strategy::Attractor;

pub(super) struct AttractorBehaviour(pub(super) Attractor);

impl BehaviourLogic for AttractorBehaviour {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let Some(point) = situation.locate(&self.0.to) else { return };
        let share =
            nearness(situation.at.distance(point.at), self.0.inner_m.value(situation), self.0.outer_m.value(situation));
        output.add_share(share, None, &toward(situation, point.at, self.0.speed_m_s.value(situation)));
    }
}
