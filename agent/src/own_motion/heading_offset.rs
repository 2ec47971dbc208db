//! The heading offset: the steady difference between the boat's heading and the ordered one.
//!
//! A front seat that steers only by the heading error and its rate has a steady error under a
//! lasting moment, such as from wind on the beam or unequal thrusters. The offset is observed with
//! a model of the boat's turning (Luenberger 1964) without any moment:
//!
//! ```text
//! model' = rate(order - model) + L1 e       offset' = L2 e       e = heading - model - offset
//! ```

use super::handling::Handling;
use primitives::angle::wrap_pi;
use primitives::math;

/// Gain of the model's tracking of the boat, 1/s.
const MODEL_GAIN_PER_S: f64 = 0.6;
/// Learning rate of the offset, 1/s.
const OFFSET_GAIN_PER_S: f64 = 0.25;
/// Remaining turn of the model above which the offset is not updated, because the difference comes
/// from the turn, rad.
const TURNING_RAD: f64 = 0.35;
/// Change of heading over which an offset decays by a factor of e, because the wind acts at a
/// different angle, rad.
const FORGOTTEN_RAD: f64 = 0.8;
/// Upper bound of the offset, rad.
const OFFSET_MAX_RAD: f64 = 0.7;

/// The estimate. The default is no offset.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct HeadingOffset {
    /// The offset, rad clockwise.
    pub(super) offset_rad: f64,
    /// The modelled heading without the offset; `None` before the first measurement.
    model_rad: Option<f64>,
}

impl HeadingOffset {
    /// Updates the estimate with the heading measured after `step_s` under a steering order.
    pub(crate) fn observe(
        &mut self,
        ordered_rad: f64,
        heading_rad: f64,
        handling: &Handling,
        step_s: f64,
    ) {
        let model_rad = self.model_rad.get_or_insert(heading_rad);
        let error_rad = wrap_pi(ordered_rad - *model_rad);
        let surprise_rad = wrap_pi(heading_rad - *model_rad - self.offset_rad);
        // The model never turns past the order, whatever the length of a decision.
        let turn_rad =
            (handling.yaw_rate_rad_s(error_rad) * step_s).clamp(-error_rad.abs(), error_rad.abs());
        *model_rad =
            wrap_pi(*model_rad + turn_rad + (MODEL_GAIN_PER_S * step_s).min(1.0) * surprise_rad);
        if error_rad.abs() < TURNING_RAD {
            let learned_rad = (OFFSET_GAIN_PER_S * step_s).min(1.0) * surprise_rad;
            self.offset_rad =
                (self.offset_rad + learned_rad).clamp(-OFFSET_MAX_RAD, OFFSET_MAX_RAD);
        }
    }

    /// Decays the offset when the order turns by this angle.
    pub(crate) fn turn(&mut self, by_rad: f64) {
        self.offset_rad *= math::exp(-by_rad.abs() / FORGOTTEN_RAD);
    }

    /// Resets the estimate when the boat is not steered as ordered.
    pub(crate) fn forget(&mut self) {
        *self = HeadingOffset::default();
    }
}
