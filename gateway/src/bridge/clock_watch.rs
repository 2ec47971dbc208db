//! Watches the receiver's time of day for steps against our clock.

use crate::nmea::TimeOfDay;
use primitives::SimTime;

/// A step that is worth a warning, s.
const CLOCK_STEP_S: f64 = 2.0;

/// The receiver's time of day, and when it came.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ClockWatch(Option<(SimTime, TimeOfDay)>);

impl ClockWatch {
    /// Takes a time of day; returns by how much it stepped, s, if that is worth a warning.
    pub(super) fn step_s(&mut self, now: SimTime, time: TimeOfDay) -> Option<f64> {
        let (at, before) = self.0.replace((now, time))?;
        // A warning and no failsafe: ages go by the gateway's monotonic clock, so a receiver
        // that steps its time (a leap second, a week rollover, a new fix) changes nothing that
        // drives the boat.
        let step_s = time.since_s(before.later(now - at));
        (step_s.abs() > CLOCK_STEP_S).then_some(step_s)
    }
}
