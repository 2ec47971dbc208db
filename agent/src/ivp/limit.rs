//! A speed limit: full utility within it, falling off outside.

use super::fixed;
use super::grid::Grid;

/// Speeds from `low_m_s` to `high_m_s` are worth 100; outside, utility falls linearly to nothing over `base_m_s`.
///
/// These are the shapes that MOOS-IvP calls `ZAIC_LEQ`, `ZAIC_HEQ` and `ZAIC_HLEQ`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedLimit {
    /// The slowest speed of full utility, m/s; minus infinity for no limit below.
    pub low_m_s: f64,
    /// The fastest speed of full utility, m/s; infinity for no limit above.
    pub high_m_s: f64,
    /// How far outside of the limit nothing is left, m/s.
    pub base_m_s: f64,
}

impl SpeedLimit {
    /// No faster than this.
    #[must_use]
    pub fn at_most(high_m_s: f64, base_m_s: f64) -> SpeedLimit {
        SpeedLimit { low_m_s: f64::NEG_INFINITY, high_m_s, base_m_s }
    }

    /// No slower than this.
    #[must_use]
    pub fn at_least(low_m_s: f64, base_m_s: f64) -> SpeedLimit {
        SpeedLimit { low_m_s, high_m_s: f64::INFINITY, base_m_s }
    }

    /// No slower and no faster.
    #[must_use]
    pub fn between(low_m_s: f64, high_m_s: f64, base_m_s: f64) -> SpeedLimit {
        SpeedLimit { low_m_s, high_m_s, base_m_s }
    }

    /// Utility of speed `j`.
    #[must_use]
    pub fn of_speed(&self, grid: &Grid, j: usize) -> f32 {
        if self.low_m_s.is_nan() || self.high_m_s.is_nan() || self.base_m_s.is_nan() {
            return fixed::utility(f64::NAN);
        }
        let speed_m_s = grid.speed_m_s(j);
        let outside_m_s = (self.low_m_s - speed_m_s).max(speed_m_s - self.high_m_s);
        fixed::utility(match outside_m_s {
            within if within <= 0.0 => 100.0,
            near if near < self.base_m_s => 100.0 * (1.0 - near / self.base_m_s),
            _ => 0.0,
        })
    }
}
