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
        self.at(grid.speed_m_s(j))
    }

    /// Utility of a speed, m/s.
    #[inline(always)]
    pub(super) fn at(&self, speed_m_s: f64) -> f32 {
        let beyond_m_s = speed_m_s - self.high_m_s;
        let near = 100.0 * (1.0 - beyond_m_s / self.base_m_s);
        let beyond = if beyond_m_s < self.base_m_s { near } else { 0.0 };
        let any = if beyond_m_s <= 0.0 { 100.0 } else { beyond };
        // NaN fails every comparison, and would be taken for a speed far beyond the limit in
        // silence.
        let is_unknown = beyond_m_s.is_nan() || self.base_m_s.is_nan();
        fixed::utility(if is_unknown { f64::NAN } else { any })
    }
}
