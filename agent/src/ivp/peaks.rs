//! Functions with one or a few peaks, of course or of speed.

use super::fixed;
use super::grid::Grid;

/// The most peaks a function has.
const PEAKS_MAX: usize = 3;

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

    /// Utility so far away from the summit.
    fn at(&self, distance: f64) -> f64 {
        let distance = distance.abs();
        let delta = if self.peak_width > 0.0 { self.summit_delta } else { 0.0 };
        let shape = if distance <= self.peak_width {
            if self.peak_width > 0.0 { 100.0 - delta * (distance / self.peak_width) } else { 100.0 }
        } else if distance < self.peak_width + self.base_width {
            (100.0 - delta) * (1.0 - (distance - self.peak_width) / self.base_width)
        } else {
            0.0
        };
        shape * (self.height / 100.0)
    }
}

/// What becomes of several peaks at one place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Combine {
    /// The highest counts.
    #[default]
    Max,
    /// They add up, to 100 at most.
    Sum,
}

/// Up to three peaks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peaks {
    peaks: [Peak; PEAKS_MAX],
    count: usize,
    combine: Combine,
}

impl Peaks {
    /// A single peak.
    #[must_use]
    pub fn one(peak: Peak) -> Peaks {
        Peaks { peaks: [peak, Peak::default(), Peak::default()], count: 1, combine: Combine::Max }
    }

    /// With another peak.
    ///
    /// # Panics
    /// Beyond three.
    #[must_use]
    pub fn and(mut self, peak: Peak) -> Peaks {
        assert!(self.count < PEAKS_MAX, "more than {PEAKS_MAX} peaks");
        self.peaks[self.count] = peak;
        self.count += 1;
        self
    }

    /// With this way of combining; the highest counts otherwise.
    #[must_use]
    pub fn combined(mut self, combine: Combine) -> Peaks {
        self.combine = combine;
        self
    }

    /// The peaks.
    #[must_use]
    pub fn peaks(&self) -> &[Peak] {
        &self.peaks[..self.count]
    }

    /// The same peaks with their summits elsewhere.
    #[must_use]
    pub fn moved(mut self, summit: impl Fn(f64) -> f64) -> Peaks {
        for peak in &mut self.peaks[..self.count] {
            peak.summit = summit(peak.summit);
        }
        self
    }

    /// Utility of course `k`; angles go round.
    #[must_use]
    pub fn of_course(&self, grid: &Grid, k: usize) -> f32 {
        self.courses(grid)(k)
    }

    /// Utility of speed `j`.
    #[must_use]
    pub fn of_speed(&self, grid: &Grid, j: usize) -> f32 {
        let speed_m_s = grid.speed_m_s(j);
        self.total(|i| speed_m_s - self.peaks[i].summit)
    }

    /// Utility by course, with what is the same for all courses done once.
    pub(super) fn courses(&self, grid: &Grid) -> impl Fn(usize) -> f32 {
        let summits = self.peaks.map(|peak| grid.ticks_of(peak.summit));
        let tick_rad = grid.tick_rad();
        move |k| {
            self.total(|i| {
                let distance_rad = grid.ticks_between(summits[i], k) as f64 * tick_rad;
                // A summit that is nowhere must not be taken for one to the north.
                if self.peaks[i].summit.is_finite() { distance_rad } else { f64::NAN }
            })
        }
    }

    /// All peaks together, given how far away each is.
    #[inline]
    fn total(&self, distance: impl Fn(usize) -> f64) -> f32 {
        let mut total = 0.0_f64;
        for (i, peak) in self.peaks().iter().enumerate() {
            let distance = distance(i);
            // Nor for one that is far away.
            let utility = if distance.is_finite() { peak.at(distance) } else { f64::NAN };
            total = match self.combine {
                Combine::Max if utility <= total => total,
                Combine::Max => utility,
                Combine::Sum => total + utility,
            };
            if total.is_nan() {
                break;
            }
        }
        fixed::utility(total)
    }
}
