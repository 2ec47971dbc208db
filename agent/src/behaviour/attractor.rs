//! Attractor: draws the boat to a place, the more the nearer it is.

use super::{Conduct, drive, nearness};
use crate::helm::{Bid, Scene};
use game::strategy::Attractor;

pub(super) struct Conductor(pub(super) Attractor);

impl Conduct for Conductor {
    fn act(&mut self, scene: &Scene, bid: &mut Bid<'_>) {
        let Some(spot) = scene.spot(&self.0.to) else { return };
        let share = nearness(scene.at.distance(spot.at), self.0.inner_m.value(scene), self.0.outer_m.value(scene));
        bid.ask_for(share, None, &drive(scene, spot.at, self.0.speed_m_s.value(scene)));
    }
}
