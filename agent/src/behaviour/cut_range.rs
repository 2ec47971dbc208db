//! Cut range: closes in on a boat, weighing the current closing speed against the later closest
//! point of approach.

use super::{BehaviourLogic, BehaviourOutput};
use crate::ivp::{Approach, Closest, Closing, Objective};
use crate::situation::Situation;
use scenario::strategy::CutRange;

impl BehaviourLogic for CutRange {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let Some(contact) = situation.boat(self.contact).copied() else {
            return;
        };
        let line = contact.at - situation.at;
        let distance_m = line.length();
        let giveup_m = self.giveup_m.value(situation);
        if giveup_m > 0.0 && distance_m > giveup_m {
            return;
        }
        let patience = self.patience.value(situation) / 100.0;
        // Candidates are relative to the water, so use the contact's velocity through the water.
        let velocity = contact.velocity() - situation.motion.drift();
        let closing = Closing {
            offset: line,
            velocity,
        };
        let closest = Closest {
            offset: line,
            velocity,
            horizon_s: self.time_on_leg_s.value(situation),
            min_m: 0.0,
            // Only getting closer counts, so scale the utility by the current distance.
            max_m: distance_m.max(1.0),
            touch_m: 0.0,
            approach: Approach::Seek,
            lag: None,
        };
        // As in MOOS-IvP's CutRange, patience 0 closes in as fast as possible now, and patience 1
        // heads for the meeting point.
        output.add_share(
            1.0 - patience,
            Some(contact.vehicle),
            &Objective::Closing(closing),
        );
        output.add_share(
            patience,
            Some(contact.vehicle),
            &Objective::Closest(closest),
        );
    }
}
