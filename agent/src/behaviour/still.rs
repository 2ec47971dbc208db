//! Behaviours that steer nowhere: one waits, one stops the boat.

use super::Conduct;
use crate::helm::{Bid, Scene};

/// Waits until its time is over, which the helm sees to.
pub(super) struct Waits;

impl Conduct for Waits {
    fn act(&mut self, _scene: &Scene, _bid: &mut Bid<'_>) {}
}

/// Stops the boat.
pub(super) struct Stops;

impl Conduct for Stops {
    fn act(&mut self, _scene: &Scene, bid: &mut Bid<'_>) {
        bid.stop();
    }
}
