//! Derives commanded thrust from the servo outputs of an ArduPilot boat, which are pulse widths in
//! µs.

use std::collections::BTreeMap;

/// SERVOn_FUNCTION of the left and the right thruster.
const LEFT: f64 = 73.0;
const RIGHT: f64 = 74.0;

/// The parameters of the servo outputs, by name: `SERVO1_MIN` and so on.
#[derive(Default)]
pub(crate) struct Servos(BTreeMap<String, f64>);

impl Servos {
    /// Stores a parameter if it belongs to a servo output.
    pub(crate) fn set(&mut self, name: &str, value: f64) {
        if name.starts_with("SERVO") {
            self.0.insert(name.to_owned(), value);
        }
    }

    /// The note for a boat with servo outputs but without these parameters.
    pub(crate) const UNKNOWN: &'static str =
        "no SERVOn_FUNCTION; outputs 1 and 3 are assumed to be the left and the right thruster";

    /// Whether the log contains the functions of the outputs.
    pub(crate) fn are_known(&self) -> bool {
        self.0.keys().any(|name| name.ends_with("_FUNCTION"))
    }

    /// Commanded thrust of the left and the right thruster, per cent, from the outputs in order;
    /// `None` if the boat does not steer by its thrust. Without parameters, outputs 1 and 3 are
    /// used, the defaults of Rover.
    pub(crate) fn thrusts_pct(&self, outputs: &[u16]) -> Option<[f64; 2]> {
        let output_of = |function, default| {
            if !self.are_known() {
                return Some(default);
            }
            (1..=16).find(|n| self.0.get(&format!("SERVO{n}_FUNCTION")) == Some(&function))
        };
        let pct = |n: usize| {
            let of = |key: &str, default: f64| {
                let known = self.0.get(&format!("SERVO{n}_{key}"));
                known.copied().unwrap_or(default)
            };
            let width = f64::from(*outputs.get(n - 1)?);
            // 0: no pulses, as when disarmed.
            if width == 0.0 {
                return Some(0.0);
            }
            let (least, rest, most) = (of("MIN", 1100.0), of("TRIM", 1500.0), of("MAX", 1900.0));
            let range = if width < rest {
                rest - least
            } else {
                most - rest
            };
            let sign = if of("REVERSED", 0.0) == 1.0 {
                -1.0
            } else {
                1.0
            };
            let share = (width - rest) / range;
            (range > 0.0).then(|| 100.0 * (sign * share).clamp(-1.0, 1.0))
        };
        Some([pct(output_of(LEFT, 1)?)?, pct(output_of(RIGHT, 3)?)?])
    }
}
