//! A speed limit: full utility within it, falling off beyond.

use super::fixed;
use super::grid::Grid;

/// Speeds up to `high_m_s` are worth 100; beyond, utility falls linearly to nothing over `base_m_s`.
///
/// This is the shape that MOOS-IvP calls `ZAIC_LEQ`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedLimit {
    /// The fastest speed of full utility, m/s.
    pub high_m_s: f64,
    /// How far beyond the limit nothing is left, m/s.
    pub base_m_s: f64,
}

impl SpeedLimit {
    /// Utility of speed `j`.
    #[must_use]
    pub fn of_speed(&self, grid: &Grid, j: usize) -> f32 {
        let beyond_m_s = grid.speed_m_s(j) - self.high_m_s;
        fixed::utility(match beyond_m_s {
            unknown if unknown.is_nan() || self.base_m_s.is_nan() => f64::NAN,
            within if within <= 0.0 => 100.0,
            near if near < self.base_m_s => 100.0 * (1.0 - near / self.base_m_s),
            _ => 0.0,
        })
    }
}
