//! Whether a boat may act on others, and whether it may tag; shared by the referee and the minds.

use super::{Rules, VehicleStanding};
use primitives::time::SimTime;

/// The facts that decide whether a boat may act.
#[derive(Clone, Copy, Debug)]
pub struct Ability {
    /// The boat is tagged.
    pub tagged: bool,
    /// The boat is out of action: power play, or it has not joined yet.
    pub disabled: bool,
    /// The boat is outside the field.
    pub outside: bool,
    /// The time from which the boat may tag.
    pub tag_ready: SimTime,
}

impl Ability {
    /// Whether the boat may act on others: tag, grab, capture.
    #[inline]
    pub fn acts(self) -> bool {
        !(self.tagged || self.disabled || self.outside)
    }

    /// Whether the boat may tag an opponent that it can reach.
    #[inline]
    pub fn may_tag(self, now: SimTime) -> bool {
        self.acts() && now >= self.tag_ready
    }
}

impl Rules {
    /// The time from which a boat that tagged at `tagged_at` may tag again.
    pub fn tag_ready_after(&self, tagged_at: SimTime) -> SimTime {
        tagged_at + self.tag_cooldown
    }

    /// Remaining wait until `tag_ready` as a fraction of the tag cooldown, 0 to 1. A cooldown below
    /// 1 s counts as 1 s.
    pub fn tag_wait_share(&self, tag_ready: SimTime, now: SimTime) -> f64 {
        (tag_wait_s(tag_ready, now) / self.tag_cooldown.as_s().max(1.0)).min(1.0)
    }
}

/// Remaining wait until `tag_ready`, s; at least 0.
pub fn tag_wait_s(tag_ready: SimTime, now: SimTime) -> f64 {
    (tag_ready - now).as_s().max(0.0)
}

impl From<&VehicleStanding> for Ability {
    #[inline]
    fn from(boat: &VehicleStanding) -> Ability {
        let VehicleStanding {
            tagged,
            disabled,
            outside,
            tag_ready,
            ..
        } = *boat;
        Ability {
            tagged,
            disabled,
            outside,
            tag_ready,
        }
    }
}
