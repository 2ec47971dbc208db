//! The easy attacker: drives straight at the flag, home when carrying or tagged.

use crate::Mind;
use crate::helm::{Chart, steer_to};
use game::scenario::{EasyAttacker, Scenario};
use game::{Ned, Order, Picture, VehicleId};

/// The easy attacker's mind.
pub(crate) struct EasyAttackerMind {
    chart: Chart,
    speed_m_s: f64,
}

impl EasyAttackerMind {
    pub(crate) fn new(scenario: &Scenario, vehicle: VehicleId, params: &EasyAttacker) -> EasyAttackerMind {
        EasyAttackerMind { chart: Chart::new(scenario, vehicle), speed_m_s: params.speed_m_s }
    }

    /// The nearest opponent's flag.
    fn target(&self, at: Ned) -> Option<Ned> {
        let homes = self.chart.targets.iter().map(|(_, home)| *home);
        homes.min_by(|a, b| at.distance_squared(*a).total_cmp(&at.distance_squared(*b)))
    }
}

impl Mind for EasyAttackerMind {
    fn decide(&mut self, picture: &Picture) -> Order {
        let Some(own) = picture.own(self.chart.me) else { return Order::Hold };
        let at = own.nav.at();
        if own.tagged {
            return self.chart.untag(at, self.speed_m_s);
        }
        if own.carried_flag().is_some() {
            return steer_to(at, self.chart.capture_point(at), self.speed_m_s);
        }
        self.target(at).map_or(Order::Hold, |flag| steer_to(at, flag, self.speed_m_s))
    }
}
