//! The boat's battery, according to its own reports.

use crate::config::BatteryWatch;
use crate::lithium;
use crate::protocol::Power;
use primitives::SimTime;

/// Time without a battery report before a warning, s.
pub(super) const SILENCE_S: f64 = 10.0;

/// The latest battery reports.
#[derive(Clone, Debug)]
pub(super) struct BatteryLog {
    watch: BatteryWatch,
    /// The voltage, V, and when it was received.
    volts: Option<(SimTime, f64)>,
    /// Charge left as last reported by the boat, per cent.
    left_pct: Option<f64>,
    /// Start of the current low-voltage period.
    low_since: Option<SimTime>,
    /// Time of the last battery sentence, and whether the silence has been reported.
    silence: (SimTime, bool),
}

impl BatteryLog {
    /// A log without data, for a new link.
    pub(super) fn new(watch: BatteryWatch, now: SimTime) -> BatteryLog {
        BatteryLog {
            watch,
            volts: None,
            left_pct: None,
            low_since: None,
            silence: (now, false),
        }
    }

    pub(super) fn observe(&mut self, now: SimTime, power: &Power) {
        // Any battery sentence ends the silence, even without a voltage: the warning concerns boats
        // that do not report at all.
        self.silence = (now, false);
        self.left_pct = power.left_pct.or(self.left_pct);
        if let Some(volts) = power.volts {
            self.volts = Some((now, volts));
            let low = volts < self.watch.volts_min;
            // Voltage sags under thrust. The debounce time keeps a burst of full power from ending
            // the game.
            self.low_since = low.then(|| self.low_since.unwrap_or(now));
        }
    }

    /// The voltage, V, and its age, s.
    pub(super) fn volts(&self, now: SimTime) -> Option<(f64, f64)> {
        self.volts.map(|(at, volts)| (volts, (now - at).as_s()))
    }

    /// The charge left, per cent: as reported by the boat, or else estimated from the voltage.
    pub(super) fn left_pct(&self) -> Option<f64> {
        let cells = f64::from(self.watch.cells);
        let estimate = || Some(100.0 * lithium::charge_left(self.volts?.1 / cells)?);
        self.left_pct.or_else(estimate)
    }

    pub(super) fn is_low(&self, now: SimTime) -> bool {
        self.low_since
            .is_some_and(|since| (now - since).as_s() >= self.watch.debounce_s)
    }

    /// Returns true once when a monitored battery falls silent.
    pub(super) fn falls_silent(&mut self, now: SimTime) -> bool {
        let (since, said) = self.silence;
        // A limit of zero disables the monitor and this warning.
        let silent = self.watch.volts_min > 0.0 && (now - since).as_s() > SILENCE_S;
        self.silence.1 |= silent;
        silent && !said
    }
}
