//! Maximum speed: slows down near other boats, or always.

use super::logic::BehaviourLogic;
use super::nearest::is_meant;
use super::output::BehaviourOutput;
use crate::ivp::{Objective, SpeedLimit};
use crate::situation::{OtherBoat, Situation};
use game::angle::wrap_pi;
use game::strategy::MaxSpeed;

pub(super) struct MaxSpeedBehaviour(pub(super) MaxSpeed);

impl MaxSpeedBehaviour {
    /// Whether a boat is near enough ahead.
    fn is_near(&self, situation: &Situation, other: &OtherBoat) -> bool {
        let off_bow_rad = wrap_pi(situation.at.bearing_rad(other.at) - situation.own.nav.psi_rad).abs();
        is_meant(self.0.contacts, situation, other)
            && situation.at.distance(other.at) < self.0.range_m.value(situation)
            && off_bow_rad <= self.0.angle_deg.value(situation).to_radians()
    }
}

impl BehaviourLogic for MaxSpeedBehaviour {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let always = self.0.range_m.value(situation) <= 0.0;
        if always || situation.others.iter().any(|other| self.is_near(situation, other)) {
            let (high_m_s, base_m_s) = (self.0.speed_m_s.value(situation), self.0.tolerance_m_s.value(situation));
            output.add(&Objective::Limit(SpeedLimit { high_m_s, base_m_s }));
        }
    }
}
