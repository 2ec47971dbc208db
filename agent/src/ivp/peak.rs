//! A function with a peak, of course or of speed.

use super::fixed;
use super::grid::Grid;
use super::lanes::LANES;

/// One peak: highest at the summit, sloping gently to the edges of the peak, and from there to
/// zero.
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
/// This shape is MOOS-IvP's `ZAIC_PEAK`. Lengths along the axis are in rad for courses and in m/s
/// for speeds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    /// Position of the summit, rad or m/s.
    pub summit: f64,
    /// Distance from the summit to the edge of the peak, on either side, rad or m/s.
    pub peak_width: f64,
    /// Distance from that edge to zero utility, rad or m/s.
    pub base_width: f64,
    /// Utility drop from the summit to the edge of the peak, 0 to 100. No effect without a peak
    /// width.
    pub summit_delta: f64,
    /// Utility at the summit, 0 to 100.
    pub height: f64,
}

impl Peak {
    /// A plain tent of full height.
    pub fn tent(summit: f64, base_width: f64) -> Peak {
        Peak {
            summit,
            base_width,
            height: 100.0,
            ..Peak::default()
        }
    }

    /// Utility of speed `j`.
    pub(super) fn of_speed(&self, grid: &Grid, j: usize) -> f32 {
        self.at(grid.speed_m_s(j) - self.summit)
    }

    /// Utility of course `k`; angles wrap.
    pub(super) fn of_course(&self, grid: &Grid, k: usize) -> f32 {
        self.on_courses(grid).at(grid, k)
    }

    /// The peak as a function of course, with course-independent values precomputed.
    pub(super) fn on_courses(&self, grid: &Grid) -> CoursePeak {
        // In ticks the angle between a summit and a course is an integer, the same in a rotated or
        // mirrored scene. A non-finite summit must not count as north.
        let summit = if self.summit.is_finite() {
            grid.ticks_of(self.summit)
        } else {
            f64::NAN
        };
        CoursePeak {
            peak: *self,
            summit,
            tick_rad: grid.tick_rad(),
        }
    }

    /// Utility at this distance from the summit; 0 for a non-finite distance.
    #[inline(always)]
    pub(super) fn at(&self, distance: f64) -> f32 {
        self.at_with(distance, self.peak_width > 0.0)
    }

    #[inline(always)]
    fn at_with(&self, distance: f64, has_width: bool) -> f32 {
        let distance = distance.abs();
        let delta = if has_width { self.summit_delta } else { 0.0 };
        // All cases are computed without branches, so that this vectorises.
        let within = if has_width {
            100.0 - delta * (distance / self.peak_width)
        } else {
            100.0
        };
        let beside = (100.0 - delta) * (1.0 - (distance - self.peak_width) / self.base_width);
        let outside = if distance < self.peak_width + self.base_width {
            beside
        } else {
            0.0
        };
        let shape = if distance <= self.peak_width {
            within
        } else {
            outside
        };
        let shape = if distance < f64::INFINITY {
            shape
        } else {
            f64::NAN
        };
        fixed::utility(shape * (self.height / 100.0))
    }
}

/// A peak as a function of course.
pub(super) struct CoursePeak {
    peak: Peak,
    /// Summit, ticks.
    summit: f64,
    tick_rad: f64,
}

impl CoursePeak {
    /// Whether any of the [`LANES`] courses from `first` on may have a utility above 0.
    pub(super) fn may_reach(&self, grid: &Grid, first: usize) -> bool {
        let middle = (first + LANES / 2).min(grid.courses() - 1);
        let from_middle = grid.ticks_between(self.summit, middle).abs() * self.tick_rad;
        let to_ends =
            grid.circle() / grid.courses() as f64 * self.tick_rad * (LANES / 2 + 1) as f64;
        // With a NaN summit the comparison is false, which is correct: every utility is zero.
        from_middle - to_ends < self.peak.peak_width + self.peak.base_width.max(0.0)
    }

    /// Utility of course `k`.
    #[inline(always)]
    pub(super) fn at(&self, grid: &Grid, k: usize) -> f32 {
        self.at_with(grid, k, self.has_width())
    }

    pub(super) fn has_width(&self) -> bool {
        self.peak.peak_width > 0.0
    }

    /// Like [`CoursePeak::at`], given whether the peak has a width.
    #[inline(always)]
    pub(super) fn at_with(&self, grid: &Grid, k: usize, has_width: bool) -> f32 {
        let distance = grid.ticks_between(self.summit, k) * self.tick_rad;
        self.peak.at_with(distance, has_width)
    }
}
