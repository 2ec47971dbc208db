//! The easy defender: cycles round an ellipse in front of its flag and reacts to nobody.

use crate::Mind;
use crate::helm::{Chart, steer_to};
use game::scenario::{EasyDefender, Scenario};
use game::{Ned, Order, Picture, VehicleId, math};

/// The point steered for lies this far ahead on the ellipse, as an angle of its parametrisation, rad.
const LEAD_RAD: f64 = 0.6;

/// The easy defender's mind.
pub(crate) struct EasyDefenderMind {
    chart: Chart,
    speed_m_s: f64,
    centre: Ned,
    along: Ned,
    across: Ned,
    half_along_m: f64,
    half_across_m: f64,
}

impl EasyDefenderMind {
    pub(crate) fn new(scenario: &Scenario, vehicle: VehicleId, params: &EasyDefender) -> EasyDefenderMind {
        let team = scenario.vehicles[vehicle.index()].team;
        let field = &scenario.field;
        EasyDefenderMind {
            chart: Chart::new(scenario, vehicle),
            speed_m_s: params.speed_m_s,
            centre: field.point(team, &params.centre).expect("a checked strategy names a point of the field"),
            along: field.along,
            across: field.across,
            half_along_m: 0.5 * params.along_m,
            half_across_m: 0.5 * params.across_m,
        }
    }

    /// The point of the ellipse a little ahead, clockwise.
    fn next_point(&self, at: Ned) -> Ned {
        let from_centre = at - self.centre;
        let x = from_centre.dot(self.along) / self.half_along_m;
        let y = from_centre.dot(self.across) / self.half_across_m;
        let (sin, cos) = math::sin_cos(math::atan2(y, x) - LEAD_RAD);
        self.centre + self.along.scaled(self.half_along_m * cos) + self.across.scaled(self.half_across_m * sin)
    }
}

impl Mind for EasyDefenderMind {
    fn decide(&mut self, picture: &Picture) -> Order {
        let Some(own) = picture.own(self.chart.me) else { return Order::Hold };
        let at = own.nav.at();
        if own.tagged {
            return self.chart.untag(at, self.speed_m_s);
        }
        steer_to(at, self.next_point(at), self.speed_m_s)
    }
}
