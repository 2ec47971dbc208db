//! A function with a peak, of course or of speed.

use super::fixed;
use super::grid::Grid;

/// One peak: highest at the summit, sloping gently to the edge of the peak proper and from there to nothing.
///
/// ```text
/// height ............ /\
///                    /  \   summit_delta
///                   /    \
///                  / |  | \
///   0 ____________/  |  |  \___________
///               base peak^ summit
/// ```
///
/// This is the shape that MOOS-IvP calls `ZAIC_PEAK`. Lengths along the axis are in rad for courses and in m/s for speeds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    /// Where it is highest, rad or m/s.
    pub summit: f64,
    /// From the summit to the edge of the peak proper, on either side, rad or m/s.
    pub peak_width: f64,
    /// From there to where nothing is left, rad or m/s.
    pub base_width: f64,
    /// How much lower the edge of the peak proper is than the summit, of 100. With no peak width it has no effect.
    pub summit_delta: f64,
    /// Utility at the summit, 0 to 100.
    pub height: f64,
}

impl Peak {
    /// A plain tent of full height.
    #[must_use]
    pub fn tent(summit: f64, base_width: f64) -> Peak {
        Peak { summit, base_width, height: 100.0, ..Peak::default() }
    }

    /// Utility of speed `j`.
    #[must_use]
    pub fn of_speed(&self, grid: &Grid, j: usize) -> f32 {
        self.at(grid.speed_m_s(j) - self.summit)
    }

    /// Utility by course, with what is the same for all courses done once; angles go round.
    pub fn courses(&self, grid: &Grid) -> impl Fn(usize) -> f32 {
        let (summit, tick_rad) = (grid.ticks_of(self.summit), grid.tick_rad());
        move |k| {
            let distance_rad = grid.ticks_between(summit, k) as f64 * tick_rad;
            // A summit that is not finite must not be taken for one to the north.
            self.at(if self.summit.is_finite() { distance_rad } else { f64::NAN })
        }
    }

    /// Utility so far away from the summit; 0 for a distance that is not finite.
    #[inline]
    fn at(&self, distance: f64) -> f32 {
        let distance = if distance.is_finite() { distance.abs() } else { f64::NAN };
        let delta = if self.peak_width > 0.0 { self.summit_delta } else { 0.0 };
        let shape = if distance.is_nan() {
            f64::NAN
        } else if distance <= self.peak_width {
            if self.peak_width > 0.0 { 100.0 - delta * (distance / self.peak_width) } else { 100.0 }
        } else if distance < self.peak_width + self.base_width {
            (100.0 - delta) * (1.0 - (distance - self.peak_width) / self.base_width)
        } else {
            0.0
        };
        fixed::utility(shape * (self.height / 100.0))
    }
}
