//! The boat's battery, by its own report.

use crate::config::BatteryWatch;
use primitives::SimTime;

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
        // Any battery sentence ends the silence, even one without a voltage: the boat reports,
        // and that is what the warning is about.
        self.silence = (now, false);
        if let Some(volts) = volts {
            self.volts = Some((now, volts));
            let low = volts < self.watch.volts_min;
            // Voltage sags under thrust: the debounce keeps a burst of full power from ending
            // the game.
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
        // Who has switched the watch off by a limit of zero need not hear that nothing is
        // watched.
        let silent = self.watch.volts_min > 0.0 && (now - since).as_s() > SILENCE_S;
        self.silence.1 |= silent;
        silent && !said
    }
}
