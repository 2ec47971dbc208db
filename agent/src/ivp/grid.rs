//! The decision grid: the candidate courses and speeds of a helm.

use super::lanes::{LANES, Lanes};
use std::f64::consts::TAU;

/// Number of ticks between neighbouring courses. Angles from a course are whole ticks, so that a
/// turned or mirrored scene has exactly the same angles. An `f64` represents them exactly.
const TICKS: f64 = 65_536.0;

/// Courses over the full circle, and speeds from rest to the top speed, both evenly spaced.
///
/// Course `k` is `k` times a full turn divided by the number of courses, clockwise from north.
/// Speed `j` is `j` times the top speed divided by one less than the number of speeds.
#[derive(Clone, Debug)]
pub struct Grid {
    courses: usize,
    speeds: usize,
    speed_max_m_s: f64,
    directions: Vec<(f32, f32)>,
    speed_m_s: Vec<f64>,
    side_by_side: Vec<Courses>,
    speeds_side_by_side: Vec<Lanes<f32>>,
}

/// A group of courses; lanes beyond the last course repeat it.
#[derive(Clone, Debug)]
pub(crate) struct Courses {
    /// The courses in rad, clockwise from north.
    pub(crate) rad: Lanes<f64>,
    /// Unit vectors.
    pub(crate) north: Lanes<f64>,
    pub(crate) east: Lanes<f64>,
}

impl Grid {
    /// A grid of `courses` by `speeds`, up to `speed_max_m_s`.
    ///
    /// # Panics
    /// If there is no course or fewer than two speeds, if there are more than 65,536 of either, or
    /// if the top speed is not positive and finite.
    pub fn new(courses: usize, speeds: usize, speed_max_m_s: f64) -> Grid {
        assert!(
            (1..=1 << 16).contains(&courses),
            "{courses} courses, expected 1 to 65536"
        );
        assert!(
            (2..=1 << 16).contains(&speeds),
            "{speeds} speeds, expected 2 to 65536"
        );
        assert!(
            speed_max_m_s.is_finite() && speed_max_m_s > 0.0,
            "top speed is {speed_max_m_s} m/s, expected a positive number"
        );
        let directions: Vec<(f32, f32)> = (0..courses).map(|k| direction(k, courses)).collect();
        let of = |first: usize, i: usize| (first + i).min(courses - 1);
        let side_by_side = (0..courses)
            .step_by(LANES)
            .map(|first| Courses {
                rad: Lanes::each(|i| course_rad(of(first, i), courses)),
                north: Lanes::each(|i| directions[of(first, i)].0.into()),
                east: Lanes::each(|i| directions[of(first, i)].1.into()),
            })
            .collect();
        let speed_m_s: Vec<f64> = (0..speeds)
            .map(|j| j as f64 * speed_max_m_s / (speeds - 1) as f64)
            .collect();
        let of = |first: usize, i: usize| (first + i).min(speeds - 1);
        let speeds_side_by_side = (0..speeds)
            .step_by(LANES)
            .map(|first| Lanes::each(|i| speed_m_s[of(first, i)] as f32))
            .collect();
        Grid {
            courses,
            speeds,
            speed_max_m_s,
            directions,
            speed_m_s,
            side_by_side,
            speeds_side_by_side,
        }
    }

    /// Whether the other grid has the same points.
    pub(super) fn is_same(&self, other: &Grid) -> bool {
        let size = |grid: &Grid| (grid.courses, grid.speeds, grid.speed_max_m_s);
        size(self) == size(other)
    }

    /// The number of courses.
    pub fn courses(&self) -> usize {
        self.courses
    }

    /// The number of speeds.
    pub fn speeds(&self) -> usize {
        self.speeds
    }

    /// All points: the indices of course and speed, speeds varying fastest.
    pub fn points(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let speeds = self.speeds;
        (0..self.courses).flat_map(move |k| (0..speeds).map(move |j| (k, j)))
    }

    /// The top speed, m/s.
    pub fn speed_max_m_s(&self) -> f64 {
        self.speed_max_m_s
    }

    /// Course `k`, rad clockwise from north, 0 to a full turn.
    pub fn course_rad(&self, k: usize) -> f64 {
        course_rad(k, self.courses)
    }

    /// Speed `j`, m/s.
    pub fn speed_m_s(&self, j: usize) -> f64 {
        self.speed_m_s[j]
    }

    /// The unit vector of course `k`: north, east.
    ///
    /// Courses that are mirror images in an axis or a diagonal, or rotated by a quarter or half
    /// turn, have exactly the same components except for order and sign, if the number of courses
    /// allows it.
    pub fn direction(&self, k: usize) -> (f32, f32) {
        self.directions[k]
    }

    /// All courses in groups of [`LANES`].
    pub(crate) fn courses_side_by_side(&self) -> &[Courses] {
        &self.side_by_side
    }

    /// All speeds, m/s, in groups of [`LANES`]; lanes beyond the last speed repeat it.
    pub(crate) fn speeds_side_by_side(&self) -> &[Lanes<f32>] {
        &self.speeds_side_by_side
    }

    /// All speeds, m/s.
    pub fn speeds_m_s(&self) -> &[f64] {
        &self.speed_m_s
    }

    /// An angle in ticks, 0 to below `circle`.
    pub(super) fn ticks_of(&self, angle_rad: f64) -> f64 {
        let turns = angle_rad / TAU;
        let part = turns - turns.trunc();
        ((part * self.circle()).round() as i64).rem_euclid(self.circle() as i64) as f64
    }

    /// Ticks from an angle (in ticks) to course `k`, the shorter way, positive to starboard. Half a
    /// turn counts as starboard.
    #[inline(always)]
    pub(super) fn ticks_between(&self, from: f64, k: usize) -> f64 {
        // Both are below a full turn, so no division is needed.
        let circle = self.circle();
        let ahead = f64::from(k as i32) * TICKS - from;
        let ahead = if ahead < 0.0 { ahead + circle } else { ahead };
        if 2.0 * ahead > circle {
            ahead - circle
        } else {
            ahead
        }
    }

    pub(super) fn tick_rad(&self) -> f64 {
        TAU / self.circle()
    }

    /// Ticks in a full turn.
    #[inline(always)]
    pub(super) fn circle(&self) -> f64 {
        self.courses as f64 * TICKS
    }
}

/// Course `k` of `n`, rad clockwise from north.
fn course_rad(k: usize, n: usize) -> f64 {
    k as f64 * TAU / n as f64
}

/// The unit vector of course `k` of `n`, mirrored from a course in the first octant.
fn direction(k: usize, n: usize) -> (f32, f32) {
    // Directions are mirrored rather than computed for each course: library cosines of mirrored
    // angles may differ in the last bit, and a mirrored game would then take a different course.
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
        return (
            std::f32::consts::FRAC_1_SQRT_2,
            std::f32::consts::FRAC_1_SQRT_2,
        );
    }
    let (sin, cos) = primitives::math::sin_cos(k as f64 * TAU / n as f64);
    (cos as f32, sin as f32)
}
