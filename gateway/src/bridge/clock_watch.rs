//! Watches the receiver's time of day for steps against our clock.

use crate::nmea::TimeOfDay;
use primitives::SimTime;

/// Steps larger than this cause a warning, s.
const CLOCK_STEP_S: f64 = 2.0;

/// The receiver's last time of day, and when it was received.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ClockWatch(Option<(SimTime, TimeOfDay)>);

impl ClockWatch {
    /// Records a time of day; returns the step (s) if it is large enough for a warning.
    pub(super) fn step_s(&mut self, now: SimTime, time: TimeOfDay) -> Option<f64> {
        let (at, before) = self.0.replace((now, time))?;
        // A warning, not a failsafe: ages are measured by the gateway's monotonic clock, so a
        // receiver that steps its time (leap second, week rollover, new fix) does not affect the
        // boat.
        let step_s = time.since_s(before.later(now - at));
        (step_s.abs() > CLOCK_STEP_S).then_some(step_s)
    }
}
