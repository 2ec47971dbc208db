//! The sensor data of an emulated boat, for both protocols.

use messages::picture::OwnBoat;
use primitives::SimTime;

/// Maximum age of a fix before the receiver reports none, s.
// The period of a receiver that measures once a second.
const FIX_AGE_MAX_S: f64 = 1.0;

/// The latest sensor measurements.
#[derive(Clone, Debug, Default)]
pub(super) struct Sensed {
    pub(super) own: Option<OwnBoat>,
    /// When the fix in `own` was first seen.
    pub(super) fix_seen: Option<SimTime>,
}

impl Sensed {
    /// Updates the sensor measurements.
    pub(super) fn observe(&mut self, now: SimTime, own: &OwnBoat) {
        if self.own.is_none_or(|before| before.fix_ns != own.fix_ns) {
            self.fix_seen = Some(now);
        }
        self.own = Some(*own);
    }

    /// Whether the receiver has a fix.
    pub(super) fn has_fix(&self, now: SimTime) -> bool {
        self.fix_seen
            .is_some_and(|seen| (now - seen).as_s() <= FIX_AGE_MAX_S)
    }
}
