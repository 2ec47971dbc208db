//! A speed limit: full utility up to it, falling beyond.

use super::fixed;
use super::grid::Grid;

/// Speeds up to `high_m_s` get 100; beyond, utility falls linearly to 0 over `base_m_s`.
///
/// This shape is MOOS-IvP's `ZAIC_LEQ`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedLimit {
    /// The fastest speed of full utility, m/s.
    pub high_m_s: f64,
    /// Width of the fall from the limit to zero utility, m/s.
    pub base_m_s: f64,
}

impl SpeedLimit {
    /// Utility of speed `j`.
    #[must_use]
    pub fn of_speed(&self, grid: &Grid, j: usize) -> f32 {
        self.at(grid.speed_m_s(j))
    }

    #[inline(always)]
    pub(super) fn at(&self, speed_m_s: f64) -> f32 {
        let beyond_m_s = speed_m_s - self.high_m_s;
        let near = 100.0 * (1.0 - beyond_m_s / self.base_m_s);
        let beyond = if beyond_m_s < self.base_m_s { near } else { 0.0 };
        let any = if beyond_m_s <= 0.0 { 100.0 } else { beyond };
        // NaN fails every comparison and would silently count as a speed far beyond the limit.
        let is_unknown = beyond_m_s.is_nan() || self.base_m_s.is_nan();
        fixed::utility(if is_unknown { f64::NAN } else { any })
    }
}
