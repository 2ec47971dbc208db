//! The decision grid: the courses and speeds a helm chooses from.

use std::f64::consts::TAU;
use wide::f32x8;

/// Speeds or courses side by side.
pub(super) const LANES: usize = 8;

/// Ticks from one course to the next: angles from a course are integers of these, so that a scene that is turned or
/// mirrored has exactly the same ones.
const TICKS: i64 = 1 << 16;

/// Courses all round, and speeds from rest to the fastest, both evenly spaced.
///
/// Course `k` is `k` times a full turn divided by the number of courses, clockwise from north; speed `j` is `j` times
/// the fastest divided by one less than the number of speeds.
#[derive(Clone, Debug)]
pub struct Grid {
    courses: usize,
    speeds: usize,
    speed_max_m_s: f64,
    north: Vec<f32x8>,
    east: Vec<f32x8>,
    speed_m_s: Vec<f32x8>,
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
        let mut grid = Grid { courses, speeds, speed_max_m_s, north: vec![], east: vec![], speed_m_s: vec![] };
        let directions: Vec<(f32, f32)> = (0..courses).map(|k| direction(k, courses)).collect();
        let last = |i: usize, count: usize| i.min(count - 1);
        grid.north = lanes(courses, |k| directions[last(k, courses)].0);
        grid.east = lanes(courses, |k| directions[last(k, courses)].1);
        grid.speed_m_s = lanes(speeds, |j| (last(j, speeds) as f64 * speed_max_m_s / (speeds - 1) as f64) as f32);
        grid
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
        j as f64 * self.speed_max_m_s / (self.speeds - 1) as f64
    }

    /// The unit vector of course `k`: north, east.
    ///
    /// Courses that are mirror images in an axis or a diagonal, or turned by a quarter or half, have exactly the same
    /// components but for order and sign, where the number of courses allows it.
    #[must_use]
    pub fn direction(&self, k: usize) -> (f32, f32) {
        assert!(k < self.courses, "course {k} of {}", self.courses);
        (self.north[k / LANES].as_array()[k % LANES], self.east[k / LANES].as_array()[k % LANES])
    }

    /// Unit vectors of eight courses side by side, the last one repeated at the end: north, east.
    pub(super) fn directions(&self) -> (&[f32x8], &[f32x8]) {
        (&self.north, &self.east)
    }

    /// Speeds in m/s, eight side by side, the last one repeated at the end.
    pub(super) fn speed_lanes(&self) -> &[f32x8] {
        &self.speed_m_s
    }

    /// Where an angle lies on the circle of ticks, 0 to below `circle`.
    pub(super) fn ticks_of(&self, angle_rad: f64) -> i64 {
        let turns = angle_rad / TAU;
        let part = turns - turns.trunc();
        ((part * self.circle() as f64).round() as i64).rem_euclid(self.circle())
    }

    /// Ticks from an angle (as ticks) to course `k`, the short way: positive to starboard, and exactly half a turn is
    /// to starboard.
    pub(super) fn ticks_between(&self, from: i64, k: usize) -> i64 {
        // Both are below a full turn: no division is needed.
        let ahead = k as i64 * TICKS - from;
        let ahead = if ahead < 0 { ahead + self.circle() } else { ahead };
        if 2 * ahead > self.circle() { ahead - self.circle() } else { ahead }
    }

    /// One tick, rad.
    pub(super) fn tick_rad(&self) -> f64 {
        TAU / self.circle() as f64
    }

    /// Ticks all round.
    fn circle(&self) -> i64 {
        self.courses as i64 * TICKS
    }
}

/// Numbers by index, eight side by side.
fn lanes(count: usize, number: impl Fn(usize) -> f32) -> Vec<f32x8> {
    (0..count.div_ceil(LANES)).map(|i| f32x8::new(std::array::from_fn(|lane| number(LANES * i + lane)))).collect()
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
