//! Who may do things to others, and who may tag: the same for the referee and for whoever reckons with it.

use super::{Rules, VehicleStanding};
use primitives::time::SimTime;

/// What decides whether a boat may act.
#[derive(Clone, Copy, Debug)]
pub struct Ability {
    /// It is tagged and not home again.
    pub tagged: bool,
    /// It is out of action for a while (power play).
    pub disabled: bool,
    /// It is outside of the field.
    pub outside: bool,
    /// It may tag from this time on.
    pub tag_ready: SimTime,
}

impl Ability {
    /// Whether it may do things to others: tag, grab, capture.
    #[inline]
    #[must_use]
    pub fn acts(self) -> bool {
        !(self.tagged || self.disabled || self.outside)
    }

    /// Whether it may tag an opponent that it can reach.
    #[inline]
    #[must_use]
    pub fn may_tag(self, now: SimTime) -> bool {
        self.acts() && now >= self.tag_ready
    }
}

impl Rules {
    /// From when on a boat may tag again that tagged at `tagged_at`.
    #[must_use]
    pub fn tag_ready_after(&self, tagged_at: SimTime) -> SimTime {
        tagged_at + self.tag_cooldown
    }

    /// The share of the time between two tags for which a boat that may tag from `tag_ready` on must still wait, 0 to 1. Below a
    /// cooldown of 1 s it is a share of 1 s.
    #[must_use]
    pub fn tag_wait_share(&self, tag_ready: SimTime, now: SimTime) -> f64 {
        (tag_wait_s(tag_ready, now) / self.tag_cooldown.as_s().max(1.0)).min(1.0)
    }
}

/// How long a boat that may tag from `tag_ready` on must still wait, s; never below 0.
#[must_use]
pub fn tag_wait_s(tag_ready: SimTime, now: SimTime) -> f64 {
    (tag_ready - now).as_s().max(0.0)
}

impl From<&VehicleStanding> for Ability {
    #[inline]
    fn from(boat: &VehicleStanding) -> Ability {
        let VehicleStanding { tagged, disabled, outside, tag_ready, .. } = *boat;
        Ability { tagged, disabled, outside, tag_ready }
    }
}
