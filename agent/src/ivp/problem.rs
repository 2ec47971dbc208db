//! One decision: functions go in, the best course and speed come out.

use super::fixed::{FUNCTIONS_MAX, NOWHERE, QUANTUM, Weight};
use super::grid::{Grid, LANES};
use super::objective::{Field, Objective, Parts};
use wide::{f32x8, i32x8};

/// A point of the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Decision {
    /// Number of the course.
    pub course: u16,
    /// Number of the speed.
    pub speed: u16,
}

/// What decides between candidates that are equally good, or nearly so.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wish {
    /// Present course of the own ship, rad.
    pub course_rad: f64,
    /// Present speed of the own ship, m/s.
    pub speed_m_s: f64,
    /// An earlier decision, which stays as long as it misses the best by no more than this share (0 to 1) of 100 for each
    /// point of weight.
    pub keep: Option<(Decision, f64)>,
}

/// What was decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The chosen point.
    pub decision: Decision,
    /// Its weighted sum.
    pub value: f64,
    /// The largest weighted sum; more than `value` only when an earlier decision was kept.
    pub best: f64,
    /// Whether an earlier decision was kept though another is better.
    pub is_kept: bool,
    /// Courses of which the speeds were asked; the others could not win.
    pub courses_asked: usize,
}

/// The functions of one decision, ready to be added up; its lists are used again for the next one.
#[derive(Clone, Debug)]
pub struct Problem {
    grid: Grid,
    /// What functions of course alone come to, in quanta by course.
    courses: Vec<i32>,
    /// What functions of speed alone come to, in quanta by speed; beyond the last speed, [`NOWHERE`].
    speeds: Vec<i32x8>,
    /// Formulas in both.
    fields: Vec<(Weight, Field)>,
    /// Weighted tables in both, added up, in quanta: rows of speeds by course; empty without any.
    table: Vec<i32x8>,
    /// What no speed of a course exceeds, in quanta by course.
    bounds: Vec<i32>,
    /// The course that is being asked.
    row: Vec<i32x8>,
    functions: usize,
    weight: f64,
    decides_course: bool,
    decides_speed: bool,
}

/// The best point found so far.
#[derive(Clone, Copy, Debug)]
struct Best {
    value: i32,
    course: usize,
    speed: usize,
}

impl Problem {
    /// A problem on this grid, without functions.
    #[must_use]
    pub fn new(grid: Grid) -> Problem {
        let rows = grid.courses().next_multiple_of(LANES);
        let mut problem = Problem {
            courses: vec![0; grid.courses()],
            speeds: grid.speed_lanes().iter().map(|_| i32x8::ZERO).collect(),
            fields: Vec::new(),
            table: Vec::new(),
            bounds: vec![0; rows],
            row: grid.speed_lanes().iter().map(|_| i32x8::ZERO).collect(),
            functions: 0,
            weight: 0.0,
            decides_course: false,
            decides_speed: false,
            grid,
        };
        problem.clear();
        problem
    }

    /// The grid.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Forgets all functions.
    pub fn clear(&mut self) {
        self.courses.fill(0);
        for (i, speeds) in self.speeds.iter_mut().enumerate() {
            let count = self.grid.speeds();
            *speeds = i32x8::new(std::array::from_fn(|lane| if LANES * i + lane < count { 0 } else { NOWHERE }));
        }
        self.fields.clear();
        self.table.clear();
        self.functions = 0;
        self.weight = 0.0;
        self.decides_course = false;
        self.decides_speed = false;
    }

    /// Adds a function with its priority weight, 0 to [`WEIGHT_MAX`](super::WEIGHT_MAX).
    ///
    /// # Panics
    /// Beyond [`FUNCTIONS_MAX`] functions, and with a table that is not of the grid's size.
    pub fn add(&mut self, weight: f64, objective: &Objective) {
        assert!(self.functions < FUNCTIONS_MAX, "more than {FUNCTIONS_MAX} functions");
        let weight = Weight::new(weight);
        self.functions += 1;
        self.weight += weight.value();
        if weight.is_zero() {
            return;
        }
        self.decides_course |= objective.decides_course();
        self.decides_speed |= objective.decides_speed();
        match objective.parts(&self.grid) {
            Parts::Separable => self.add_separable(weight, objective),
            Parts::Field(field) => self.fields.push((weight, field)),
            Parts::Table(table) => self.add_table(weight, table),
            Parts::Nothing => {}
        }
    }

    /// How many functions were added.
    #[must_use]
    pub fn len(&self) -> usize {
        self.functions
    }

    /// Whether none was added.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.functions == 0
    }

    /// Whether a function tells courses from each other.
    #[must_use]
    pub fn decides_course(&self) -> bool {
        self.decides_course
    }

    /// Whether a function tells speeds from each other.
    #[must_use]
    pub fn decides_speed(&self) -> bool {
        self.decides_speed
    }

    /// The weighted sum at course `k` and speed `j`.
    ///
    /// # Panics
    /// Beyond the grid.
    #[must_use]
    pub fn collective(&self, k: usize, j: usize) -> f64 {
        f64::from(self.quanta(k, j)) * QUANTUM
    }

    /// The best decision: exactly the largest weighted sum on the grid.
    ///
    /// Of equal ones it is the course with the smallest angle from the present one, of two such the one to starboard; on
    /// that course the speed nearest to the present one, of two such the lower. If an earlier decision is nearly as good
    /// and the wish is to keep it, it is that.
    pub fn solve(&mut self, wish: Wish) -> Choice {
        self.bound_courses();
        let present = self.grid.ticks_of(wish.course_rad);
        let mut best = Best { value: NOWHERE, course: 0, speed: 0 };
        let likely = (1..self.grid.courses()).fold(0, |a, k| if self.bounds[k] > self.bounds[a] { k } else { a });
        self.ask(likely, present, wish.speed_m_s, &mut best);
        let mut courses_asked = 1;
        for k in 0..self.grid.courses() {
            if k != likely && self.bounds[k] >= best.value {
                self.ask(k, present, wish.speed_m_s, &mut best);
                courses_asked += 1;
            }
        }
        let found = Decision { course: best.course as u16, speed: best.speed as u16 };
        let kept = wish.keep.and_then(|(old, share)| self.kept(old, share, best.value));
        Choice {
            decision: kept.map_or(found, |(old, _)| old),
            value: f64::from(kept.map_or(best.value, |(_, value)| value)) * QUANTUM,
            best: f64::from(best.value) * QUANTUM,
            is_kept: kept.is_some(),
            courses_asked,
        }
    }

    /// An earlier decision and its value, if it is on the grid, worse than the best and near enough to it.
    fn kept(&self, old: Decision, share: f64, best: i32) -> Option<(Decision, i32)> {
        let (k, j) = (usize::from(old.course), usize::from(old.speed));
        if k >= self.grid.courses() || j >= self.grid.speeds() {
            return None;
        }
        let value = self.quanta(k, j);
        let missed = f64::from(best - value) * QUANTUM;
        (missed <= share * self.weight * 100.0).then_some((old, value))
    }

    /// The weighted sum at one point, in quanta.
    fn quanta(&self, k: usize, j: usize) -> i32 {
        assert!(k < self.grid.courses() && j < self.grid.speeds(), "course {k}, speed {j}");
        let (lanes, lane) = (j / LANES, j % LANES);
        let (north, east) = self.grid.direction(k);
        let mut sum = self.speeds[lanes] + i32x8::splat(self.courses[k]);
        for (weight, field) in &self.fields {
            let speed = self.grid.speed_lanes()[lanes];
            sum += weight.quanta(field.utility(f32x8::splat(north), f32x8::splat(east), speed));
        }
        if !self.table.is_empty() {
            sum += self.table[k * self.speeds.len() + lanes];
        }
        sum.as_array()[lane]
    }

    fn add_separable(&mut self, weight: Weight, objective: &Objective) {
        let (of_course, of_speed) = objective.weights(weight);
        if !of_course.is_zero() {
            objective.each_course(&self.grid, |k, utility| self.courses[k] += of_course.quanta_of_one(utility));
        }
        if !of_speed.is_zero() {
            for j in 0..self.grid.speeds() {
                let quanta = of_speed.quanta_of_one(objective.of_speed(&self.grid, j));
                self.speeds[j / LANES].as_mut_array()[j % LANES] += quanta;
            }
        }
    }

    fn add_table(&mut self, weight: Weight, table: &[f32]) {
        let lanes = self.speeds.len();
        self.table.resize(lanes * self.grid.courses(), i32x8::ZERO);
        for (k, row) in table.chunks(self.grid.speeds()).enumerate() {
            for (j, &utility) in row.iter().enumerate() {
                let quanta = weight.quanta_of_one(super::fixed::utility(f64::from(utility)));
                self.table[k * lanes + j / LANES].as_mut_array()[j % LANES] += quanta;
            }
        }
    }

    /// Fills in what no speed of a course exceeds.
    fn bound_courses(&mut self) {
        let fastest = self.speeds.iter().fold(i32x8::splat(NOWHERE), |a, &b| a.max(b)).reduce_max();
        let (north, east) = self.grid.directions();
        for (i, bounds) in self.bounds.chunks_mut(LANES).enumerate() {
            let mut sum = i32x8::splat(fastest);
            for (weight, field) in &self.fields {
                sum += weight.quanta(field.bound(north[i], east[i]));
            }
            bounds.copy_from_slice(&sum.as_array()[..bounds.len()]);
        }
        let lanes = self.speeds.len();
        for (k, &course) in self.courses.iter().enumerate() {
            self.bounds[k] += course;
            if !self.table.is_empty() {
                let row = &self.table[k * lanes..][..lanes];
                self.bounds[k] += row.iter().fold(i32x8::ZERO, |a, &b| a.max(b)).reduce_max();
            }
        }
    }

    /// Asks all speeds of a course, and takes the best of them if it is better than what was found.
    fn ask(&mut self, k: usize, present: i64, speed_m_s: f64, best: &mut Best) {
        let course = i32x8::splat(self.courses[k]);
        for (row, &speeds) in self.row.iter_mut().zip(&self.speeds) {
            *row = speeds + course;
        }
        if !self.table.is_empty() {
            let lanes = self.row.len();
            for (row, &table) in self.row.iter_mut().zip(&self.table[k * lanes..]) {
                *row += table;
            }
        }
        let (north, east) = self.grid.direction(k);
        let (north, east) = (f32x8::splat(north), f32x8::splat(east));
        for (weight, field) in &self.fields {
            for (row, &speed) in self.row.iter_mut().zip(self.grid.speed_lanes()) {
                *row += weight.quanta(field.utility(north, east, speed));
            }
        }
        let value = self.row.iter().fold(i32x8::splat(NOWHERE), |a, &b| a.max(b)).reduce_max();
        if value > best.value || value == best.value && self.is_nearer(k, best.course, present) {
            *best = Best { value, course: k, speed: self.speed_with(value, speed_m_s) };
        }
    }

    /// Whether course `k` is nearer to the present one than `other` is, or as near and to starboard.
    fn is_nearer(&self, k: usize, other: usize, present: i64) -> bool {
        let (one, other) = (self.grid.ticks_between(present, k), self.grid.ticks_between(present, other));
        (one.abs(), one < 0) < (other.abs(), other < 0)
    }

    /// The speed of the course that was asked which has this value and is nearest to the present one; of two the lower.
    fn speed_with(&self, value: i32, speed_m_s: f64) -> usize {
        let speed_m_s = if speed_m_s.is_finite() { speed_m_s } else { 0.0 };
        let mut nearest = (f64::INFINITY, 0);
        for j in 0..self.grid.speeds() {
            let away_m_s = (self.grid.speed_m_s(j) - speed_m_s).abs();
            if self.row[j / LANES].as_array()[j % LANES] == value && away_m_s < nearest.0 {
                nearest = (away_m_s, j);
            }
        }
        nearest.1
    }
}
