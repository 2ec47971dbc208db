//! Attractor: draws the boat to a place, more strongly the nearer the place is.

use super::nearest::nearness;
use super::steering::toward;
use super::{BehaviourLogic, BehaviourOutput};
use crate::situation::Situation;
use scenario::strategy::Attractor;

impl BehaviourLogic for Attractor {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        // If the place is unknown, such as that of a boat out of sight, this behaviour adds no
        // function and leaves the decision to the others.
        let Some(point) = situation.locate(&self.to) else {
            return;
        };
        let share = nearness(
            situation.at.distance(point.at),
            self.inner_m.value(situation),
            self.outer_m.value(situation),
        );
        output.add_share(
            share,
            None,
            &toward(situation, point.at, self.speed_m_s.value(situation)),
        );
    }
}
