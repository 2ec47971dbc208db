//! Behaviours that steer nowhere: one waits, one lies still.

use super::Conduct;
use crate::helm::{Bid, Scene};
use crate::ivp::{Objective, Peak, Peaks};

/// Waits until its time is over, which the helm sees to.
pub(super) struct Waits;

impl Conduct for Waits {
    fn act(&mut self, _scene: &Scene, _bid: &mut Bid<'_>) {}
}

/// Would like the boat to lie still.
pub(super) struct Stops;

impl Conduct for Stops {
    fn act(&mut self, scene: &Scene, bid: &mut Bid<'_>) {
        bid.ask(&Objective::Speed(Peaks::one(Peak::tent(0.0, scene.chart.speed_max_m_s))));
    }
}
