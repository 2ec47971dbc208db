//! The heading offset: by how much a boat lies beside the heading that it is told.
//!
//! A front seat that steers by the heading error and its rate alone is off by as much as it takes to hold against a
//! lasting moment: that of wind on the beam, of thrusters that differ. The offset is observed against a model of the
//! boat's turning (Luenberger 1964) that knows of no moment:
//!
//! ```text
//! model' = rate(order - model) + L1 e       offset' = L2 e       e = heading - model - offset
//! ```

use super::handling::Handling;
use primitives::angle::wrap_pi;
use primitives::math;

/// How fast the model follows the boat, 1/s.
const MODEL_GAIN_PER_S: f64 = 0.6;
/// How fast the offset is learned, 1/s.
const OFFSET_GAIN_PER_S: f64 = 0.25;
/// While the model turns by more than this, the offset is not learned, rad: what differs is how the boat turns.
const TURNING_RAD: f64 = 0.35;
/// A change of heading after which an offset means little, rad: the wind comes from elsewhere.
const FORGOTTEN_RAD: f64 = 0.8;
/// No offset is taken to be larger, rad.
const OFFSET_MAX_RAD: f64 = 0.7;

/// The estimate. The default is no offset.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct HeadingOffset {
    offset_rad: f64,
    /// The heading that the boat would have without the offset; none before the first.
    model_rad: Option<f64>,
}

impl HeadingOffset {
    /// Takes in the heading after `step_s` under an order to steer.
    pub(crate) fn observe(&mut self, ordered_rad: f64, heading_rad: f64, handling: &Handling, step_s: f64) {
        let model_rad = self.model_rad.get_or_insert(heading_rad);
        let error_rad = wrap_pi(ordered_rad - *model_rad);
        let surprise_rad = wrap_pi(heading_rad - *model_rad - self.offset_rad);
        // The model never turns beyond the order, whatever the length of a decision.
        let turn_rad = (handling.yaw_rate_rad_s(error_rad) * step_s).clamp(-error_rad.abs(), error_rad.abs());
        *model_rad = wrap_pi(*model_rad + turn_rad + (MODEL_GAIN_PER_S * step_s).min(1.0) * surprise_rad);
        if error_rad.abs() < TURNING_RAD {
            let learned_rad = (OFFSET_GAIN_PER_S * step_s).min(1.0) * surprise_rad;
            self.offset_rad = (self.offset_rad + learned_rad).clamp(-OFFSET_MAX_RAD, OFFSET_MAX_RAD);
        }
    }

    /// The order changes: by so much the wind comes from elsewhere.
    pub(crate) fn turn(&mut self, by_rad: f64) {
        self.offset_rad *= math::exp(-by_rad.abs() / FORGOTTEN_RAD);
    }

    /// Nothing steers the boat as ordered.
    pub(crate) fn forget(&mut self) {
        *self = HeadingOffset::default();
    }

    /// Clockwise, rad.
    pub(crate) fn offset_rad(&self) -> f64 {
        self.offset_rad
    }
}
