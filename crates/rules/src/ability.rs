//! Who may do things to others, and who may tag: the same for the referee and for whoever reckons with it.

use super::VehicleStanding;
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

impl From<&VehicleStanding> for Ability {
    #[inline]
    fn from(boat: &VehicleStanding) -> Ability {
        let VehicleStanding { tagged, disabled, outside, tag_ready, .. } = *boat;
        Ability { tagged, disabled, outside, tag_ready }
    }
}
