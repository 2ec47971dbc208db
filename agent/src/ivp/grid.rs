//! The decision grid: the courses and speeds a helm chooses from.

use std::f64::consts::TAU;

/// Ticks from one course to the next: angles from a course are integers of these, so that a scene that is turned or
/// mirrored has exactly the same ones. An `f64` holds them exactly.
const TICKS: f64 = 65_536.0;

/// Courses all round, and speeds from rest to the fastest, both evenly spaced.
///
/// Course `k` is `k` times a full turn divided by the number of courses, clockwise from north; speed `j` is `j` times
/// the fastest divided by one less than the number of speeds.
#[derive(Clone, Debug)]
pub struct Grid {
    courses: usize,
    speeds: usize,
    speed_max_m_s: f64,
    directions: Vec<(f32, f32)>,
    speed_m_s: Vec<f64>,
}

impl Grid {
    /// A grid of so many courses and speeds, the fastest in m/s.
    ///
    /// # Panics
    /// With less than one course or two speeds, more than 65,536 of either, or a fastest speed that is not a positive
    /// number.
    #[must_use]
    pub fn new(courses: usize, speeds: usize, speed_max_m_s: f64) -> Grid {
        assert!((1..=1 << 16).contains(&courses), "{courses} courses, allowed are 1 to 65536");
        assert!((2..=1 << 16).contains(&speeds), "{speeds} speeds, allowed are 2 to 65536");
        assert!(speed_max_m_s.is_finite() && speed_max_m_s > 0.0, "a fastest speed of {speed_max_m_s} m/s");
        let directions = (0..courses).map(|k| direction(k, courses)).collect();
        let speed_m_s = (0..speeds).map(|j| j as f64 * speed_max_m_s / (speeds - 1) as f64).collect();
        Grid { courses, speeds, speed_max_m_s, directions, speed_m_s }
    }

    /// The number of courses.
    #[must_use]
    pub fn courses(&self) -> usize {
        self.courses
    }

    /// The number of speeds.
    #[must_use]
    pub fn speeds(&self) -> usize {
        self.speeds
    }

    /// The fastest speed, m/s.
    #[must_use]
    pub fn speed_max_m_s(&self) -> f64 {
        self.speed_max_m_s
    }

    /// Course `k`, rad clockwise from north, 0 to a full turn.
    #[must_use]
    pub fn course_rad(&self, k: usize) -> f64 {
        k as f64 * TAU / self.courses as f64
    }

    /// Speed `j`, m/s.
    #[must_use]
    pub fn speed_m_s(&self, j: usize) -> f64 {
        self.speed_m_s[j]
    }

    /// The unit vector of course `k`: north, east.
    ///
    /// Courses that are mirror images in an axis or a diagonal, or turned by a quarter or half, have exactly the same
    /// components but for order and sign, where the number of courses allows it.
    #[must_use]
    pub fn direction(&self, k: usize) -> (f32, f32) {
        self.directions[k]
    }

    /// All speeds, m/s.
    #[must_use]
    pub fn speeds_m_s(&self) -> &[f64] {
        &self.speed_m_s
    }

    /// Where an angle lies on the circle of ticks, 0 to below `circle`.
    pub(super) fn ticks_of(&self, angle_rad: f64) -> f64 {
        let turns = angle_rad / TAU;
        let part = turns - turns.trunc();
        ((part * self.circle()).round() as i64).rem_euclid(self.circle() as i64) as f64
    }

    /// Ticks from an angle (as ticks) to course `k`, the short way: positive to starboard, and exactly half a turn is
    /// to starboard.
    #[inline(always)]
    pub(super) fn ticks_between(&self, from: f64, k: usize) -> f64 {
        // Both are below a full turn: no division is needed.
        let (circle, ahead) = (self.circle(), f64::from(k as i32) * TICKS - from);
        let ahead = if ahead < 0.0 { ahead + circle } else { ahead };
        if 2.0 * ahead > circle { ahead - circle } else { ahead }
    }

    /// One tick, rad.
    pub(super) fn tick_rad(&self) -> f64 {
        TAU / self.circle()
    }

    /// Ticks all round.
    #[inline(always)]
    pub(super) fn circle(&self) -> f64 {
        self.courses as f64 * TICKS
    }
}

/// The unit vector of course `k` of `n`, made of one in the first octant by mirroring.
fn direction(k: usize, n: usize) -> (f32, f32) {
    if 2 * k > n {
        let (north, east) = direction(n - k, n);
        return (north, -east);
    }
    if n.is_multiple_of(2) && 4 * k > n {
        let (north, east) = direction(n / 2 - k, n);
        return (-north, east);
    }
    if n.is_multiple_of(4) && 8 * k > n {
        let (north, east) = direction(n / 4 - k, n);
        return (east, north);
    }
    if 8 * k == n {
        return (std::f32::consts::FRAC_1_SQRT_2, std::f32::consts::FRAC_1_SQRT_2);
    }
    let (sin, cos) = game::math::sin_cos(k as f64 * TAU / n as f64);
    (cos as f32, sin as f32)
}
