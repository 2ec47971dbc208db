//! Cut range: closes in on a boat, by rate of closure now and closest point of approach later.

use super::Conduct;
use crate::helm::{Bid, Scene};
use crate::ivp::{Approach, Closest, Closing, Objective};
use game::strategy::CutRange;

pub(super) struct Conductor(pub(super) CutRange);

impl Conduct for Conductor {
    fn act(&mut self, scene: &Scene, bid: &mut Bid<'_>) {
        let Some(contact) = scene.boat(self.0.contact).copied() else { return };
        let line = contact.at - scene.at;
        let (distance_m, giveup_m) = (line.length(), self.0.giveup_m.value(scene));
        if giveup_m > 0.0 && distance_m > giveup_m {
            return;
        }
        let patience = self.0.patience.value(scene) / 100.0;
        let closing = Closing {
            north_m: line.north,
            east_m: line.east,
            velocity_north_m_s: contact.velocity.north,
            velocity_east_m_s: contact.velocity.east,
            flee: false,
        };
        let closest = Closest {
            touch_m: 0.0,
            north_m: line.north,
            east_m: line.east,
            velocity_north_m_s: contact.velocity.north,
            velocity_east_m_s: contact.velocity.east,
            horizon_s: self.0.time_on_leg_s.value(scene),
            min_m: 0.0,
            max_m: distance_m.max(1.0),
            approach: Approach::Seek,
            lag: None,
        };
        bid.ask_for(1.0 - patience, Some(contact.vehicle), &Objective::Closing(closing));
        bid.ask_for(patience, Some(contact.vehicle), &Objective::Closest(closest));
    }
}
