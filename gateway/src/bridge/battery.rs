//! The boat's battery, by its own report.

use game::SimTime;
use game::gateway::BatteryWatch;

/// A battery that is not reported for this long is worth a warning, s.
pub(super) const SILENCE_S: f64 = 10.0;

/// What the boat last reported.
#[derive(Clone, Debug)]
pub(super) struct BatteryLog {
    watch: BatteryWatch,
    /// The voltage, and when it came.
    volts: Option<(SimTime, f64)>,
    /// Since when it has been low.
    low_since: Option<SimTime>,
    /// Since when nothing has come, and whether that was said.
    silence: (SimTime, bool),
}

impl BatteryLog {
    /// Nothing is known yet: there is a new link.
    pub(super) fn new(watch: BatteryWatch, now: SimTime) -> BatteryLog {
        BatteryLog { watch, volts: None, low_since: None, silence: (now, false) }
    }

    /// Forgets everything: the boat may be another one now.
    pub(super) fn forget(&mut self, now: SimTime) {
        *self = BatteryLog::new(self.watch, now);
    }

    pub(super) fn observe(&mut self, now: SimTime, volts: Option<f64>) {
        self.silence = (now, false);
        if let Some(volts) = volts {
            self.volts = Some((now, volts));
            let low = volts < self.watch.volts_min;
            self.low_since = low.then(|| self.low_since.unwrap_or(now));
        }
    }

    /// The voltage, and its age, s.
    pub(super) fn volts(&self, now: SimTime) -> Option<(f64, f64)> {
        self.volts.map(|(at, volts)| (volts, (now - at).as_s()))
    }

    pub(super) fn is_low(&self, now: SimTime) -> bool {
        self.low_since.is_some_and(|since| (now - since).as_s() >= self.watch.debounce_s)
    }

    /// Whether a battery that is watched has become silent: once.
    pub(super) fn falls_silent(&mut self, now: SimTime) -> bool {
        let (since, said) = self.silence;
        let silent = self.watch.volts_min > 0.0 && (now - since).as_s() > SILENCE_S;
        self.silence.1 |= silent;
        silent && !said
    }
}
