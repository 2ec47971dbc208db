//! Maximum speed: slows down near other boats, or always.

use super::{Conduct, is_meant};
use crate::helm::{Bid, Other, Scene};
use crate::ivp::{Objective, SpeedLimit};
use game::angle::wrap_pi;
use game::strategy::MaxSpeed;

pub(super) struct Conductor(pub(super) MaxSpeed);

impl Conductor {
    /// Whether a boat is near enough ahead.
    fn is_near(&self, scene: &Scene, other: &Other) -> bool {
        let off_bow_rad = wrap_pi(scene.at.bearing_rad(other.at) - scene.own.nav.psi_rad).abs();
        is_meant(self.0.contacts, scene, other)
            && scene.at.distance(other.at) < self.0.range_m.value(scene)
            && off_bow_rad <= self.0.angle_deg.value(scene).to_radians()
    }
}

impl Conduct for Conductor {
    fn act(&mut self, scene: &Scene, bid: &mut Bid<'_>) {
        let always = self.0.range_m.value(scene) <= 0.0;
        if always || scene.others.iter().any(|other| self.is_near(scene, other)) {
            let (limit_m_s, tolerance_m_s) = (self.0.speed_m_s.value(scene), self.0.tolerance_m_s.value(scene));
            bid.ask(&Objective::Limit(SpeedLimit::at_most(limit_m_s, tolerance_m_s)));
        }
    }
}
