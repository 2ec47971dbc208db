//! Constant heading and constant speed.

use super::Conduct;
use crate::helm::{Bid, Scene};
use crate::ivp::{Objective, Peak, Peaks};
use game::angle::rad_from_compass_deg;
use game::strategy::{ConstantHeading, ConstantSpeed};

/// How much less the edge of a peak is worth than its summit.
const SUMMIT_DELTA: f64 = 25.0;

pub(super) struct Heading(pub(super) ConstantHeading);

impl Conduct for Heading {
    fn act(&mut self, scene: &Scene, bid: &mut Bid<'_>) {
        bid.ask(&Objective::Course(Peaks::one(Peak {
            summit: rad_from_compass_deg(self.0.heading_deg.value(scene)),
            peak_width: self.0.peak_width_deg.value(scene).to_radians(),
            base_width: self.0.base_width_deg.value(scene).to_radians(),
            summit_delta: SUMMIT_DELTA,
            height: 100.0,
        })));
    }
}

pub(super) struct Speed(pub(super) ConstantSpeed);

impl Conduct for Speed {
    fn act(&mut self, scene: &Scene, bid: &mut Bid<'_>) {
        bid.ask(&Objective::Speed(Peaks::one(Peak {
            summit: self.0.speed_m_s.value(scene).min(scene.chart.speed_max_m_s),
            peak_width: self.0.peak_width_m_s.value(scene),
            base_width: self.0.base_width_m_s.value(scene),
            summit_delta: SUMMIT_DELTA,
            height: 100.0,
        })));
    }
}
