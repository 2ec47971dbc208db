//! The drift of a boat: the velocity that wind, waves and current add to its velocity through the
//! water, and how much it varies.
//!
//! Thrusters push a boat only along its heading, so its velocity across the heading is the drift's
//! component in that direction. A Kalman filter combines these components from all headings into a
//! vector over the ground. The drift d is a random walk, and a decision measures it along the
//! starboard unit vector h:
//!
//! ```text
//! d' = d + w,  w ~ N(0, q dt I)          z = h.d + e,  e ~ N(0, r / dt)
//! P' = P + q dt I       k = P h / (h.P h + r / dt)       d += k (z - h.d)       P -= k (h.P)
//! ```
//!
//! Along one axis the Riccati equation settles at the gain sqrt(q / r) per second (Kalman and Bucy
//! 1961): the calmer the water, the faster the filter. Wave disturbance is not white noise: with
//! the variance s² and the correlation time T it has the density r = 2 s² T at frequencies far
//! below those of the waves. s² is the mean square of the innovation.
//!
//! In a turn a boat slides outwards even without drift: the force Y = -(m + A11) u r acts against
//! the resistance in sway, with values from the boat file (Fossen 2021, ch. 6). Part of this slide
//! counts as noise.
//!
//! The component along a constant heading is unobservable. A boat that steers by speed over the
//! ground does not need it, and the first turn reveals it.

use super::handling::Handling;
use messages::picture::Nav;
use primitives::{Ned, math};

/// Variance of the drift's change per second, m²/s³: a gust, or turning beam-on, changes the drift
/// by 0.2 m/s in four seconds.
const WALK_M2_S3: f64 = 0.01;
/// Variance of an unknown drift, and upper bound of the variance, m²/s².
const UNKNOWN_M2_S2: f64 = 1.0;
/// Correlation time of the wave disturbance, s.
const WAVE_TIME_S: f64 = 0.5;
/// Minimum standard deviation of the velocity across the heading, m/s: that of a satellite
/// receiver.
const NOISE_M_S: f64 = 0.05;
/// Time constant of the mean square, s.
const SPREAD_TIME_S: f64 = 20.0;
/// Relative error of the slide computed from the boat file.
const SLIDE_ERROR: f64 = 0.5;
/// Correlation time of that error, s: about one turn.
const SLIDE_TIME_S: f64 = 4.0;

/// The estimate. The default is for an unknown boat.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DriftEstimate {
    /// The drift over the ground, m/s.
    pub(super) drift: Ned,
    /// Variances towards north and east, and their covariance, m²/s².
    variance: (f64, f64, f64),
    /// Mean square of the innovation, m²/s².
    square_m2_s2: f64,
    /// The boat's slide in its turn, to starboard, m/s.
    slide_m_s: f64,
}

impl Default for DriftEstimate {
    fn default() -> DriftEstimate {
        DriftEstimate {
            drift: Ned::default(),
            variance: (UNKNOWN_M2_S2, UNKNOWN_M2_S2, 0.0),
            square_m2_s2: NOISE_M_S * NOISE_M_S,
            slide_m_s: 0.0,
        }
    }
}

impl DriftEstimate {
    /// Processes navigation data that is `step_s` newer than the last.
    pub(crate) fn observe(&mut self, nav: &Nav, handling: &Handling, step_s: f64) {
        if step_s <= 0.0 || !(nav.sway_m_s.is_finite() && nav.psi_rad.is_finite()) {
            return;
        }
        let (north, east, both) = self.variance;
        // The variance is bounded, so that a single wave does not determine the drift along an axis
        // that was unobserved for an hour.
        let grown = |variance: f64| (variance + WALK_M2_S3 * step_s).min(UNKNOWN_M2_S2);
        let north = grown(north);
        let east = grown(east);
        let (sin, cos) = math::sin_cos(nav.psi_rad);
        let starboard = Ned {
            north: -sin,
            east: cos,
        };
        let of_starboard = Ned {
            north: north * starboard.north + both * starboard.east,
            east: both * starboard.north + east * starboard.east,
        };
        let sliding_m_s = -handling.slide_s * nav.yaw_rate_rad_s * nav.surge_m_s;
        self.slide_m_s +=
            step_s / (handling.slide_decay_s + step_s) * (sliding_m_s - self.slide_m_s);
        let error_m_s = SLIDE_ERROR * self.slide_m_s;
        let density =
            2.0 * (self.square_m2_s2 * WAVE_TIME_S + error_m_s * error_m_s * SLIDE_TIME_S);
        let expected = of_starboard.dot(starboard) + density / step_s;
        let surprise_m_s = nav.sway_m_s - self.slide_m_s - self.drift.dot(starboard);
        let gain = of_starboard.scaled(1.0 / expected);
        self.drift = self.drift + gain.scaled(surprise_m_s);
        self.variance = (
            north - gain.north * of_starboard.north,
            east - gain.east * of_starboard.east,
            both - gain.north * of_starboard.east,
        );
        // In a turn, part of the innovation is due to the error of the slide.
        let own_m2_s2 =
            (surprise_m_s * surprise_m_s - error_m_s * error_m_s).max(NOISE_M_S * NOISE_M_S);
        self.square_m2_s2 += (step_s / SPREAD_TIME_S).min(1.0) * (own_m2_s2 - self.square_m2_s2);
    }

    /// Standard deviation of the velocity around the drift, m/s: waves and gusts, without the
    /// receiver's noise.
    pub(crate) fn spread_m_s(&self) -> f64 {
        (self.square_m2_s2 - NOISE_M_S * NOISE_M_S).max(0.0).sqrt()
    }
}
