//! One decision: functions go in, the best course and speed come out.

use super::fixed::{FUNCTIONS_MAX, NOWHERE, QUANTUM, Weight};
use super::grid::{Grid, LANES};
use super::objective::{Field, Objective, Parts};
use std::cmp::Ordering;
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
pub struct Preference {
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
    /// Whether an earlier decision was kept; it may be the best one itself.
    pub is_kept: bool,
    /// How many points were evaluated; the others could not win.
    pub evaluated: usize,
}

/// The functions of one decision, ready to be added up; its lists are used again for the next one.
#[derive(Clone, Debug)]
pub struct Problem {
    grid: Grid,
    /// What functions of course alone come to, in quanta by course; beyond the last course, [`NOWHERE`].
    courses: Vec<i32x8>,
    /// What functions of speed alone come to, in quanta by speed; beyond the last speed, [`NOWHERE`].
    speeds: Vec<i32x8>,
    /// Formulas in both.
    fields: Vec<(Weight, Field)>,
    /// Weighted tables in both, added up, in quanta: rows of speeds by course; empty without any.
    table: Vec<i32x8>,
    /// What no speed of a block exceeds, in quanta. A block is a course and eight speeds that stand side by side; all
    /// courses with the first eight come first, eight side by side.
    bounds: Vec<i32x8>,
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

/// What the own ship is doing.
#[derive(Clone, Copy, Debug)]
struct Present {
    /// Its course, in ticks.
    course: i64,
    speed_m_s: f64,
}

impl Problem {
    /// A problem on this grid, without functions.
    #[must_use]
    pub fn new(grid: Grid) -> Problem {
        let blocks = grid.directions().0.len() * grid.speed_lanes().len();
        let mut problem = Problem {
            courses: vec![i32x8::ZERO; grid.directions().0.len()],
            speeds: vec![i32x8::ZERO; grid.speed_lanes().len()],
            fields: Vec::new(),
            table: Vec::new(),
            bounds: vec![i32x8::ZERO; blocks],
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
        clear_lanes(&mut self.courses, self.grid.courses());
        clear_lanes(&mut self.speeds, self.grid.speeds());
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
    /// that course the speed nearest to the present one, of two such the lower. An earlier decision that is
    /// nearly as good and is to be kept comes before all of them.
    pub fn solve(&mut self, preference: Preference) -> Choice {
        self.bound_blocks();
        let present = Present { course: self.grid.ticks_of(preference.course_rad), speed_m_s: preference.speed_m_s };
        let mut best = Best { value: NOWHERE, course: 0, speed: 0 };
        let mut evaluated = 0;
        // The most promising block first: what it reaches rules out most others.
        let most = self.bounds.iter().fold(i32x8::splat(NOWHERE), |a, &b| a.max(b)).reduce_max();
        self.evaluate_blocks(most, present, &mut best, &mut evaluated);
        self.evaluate_blocks(best.value, present, &mut best, &mut evaluated);
        let found = Decision { course: best.course as u16, speed: best.speed as u16 };
        let kept = preference.keep.and_then(|(old, share)| self.kept(old, share, best.value));
        Choice {
            decision: kept.map_or(found, |(old, _)| old),
            value: f64::from(kept.map_or(best.value, |(_, value)| value)) * QUANTUM,
            best: f64::from(best.value) * QUANTUM,
            is_kept: kept.is_some(),
            evaluated,
        }
    }

    /// An earlier decision and its value, if it is on the grid and near enough to the best one.
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
        self.block(k, j / LANES).as_array()[j % LANES]
    }

    /// The weighted sums of a block, in quanta.
    fn block(&self, k: usize, lanes: usize) -> i32x8 {
        let course = i32x8::splat(self.courses[k / LANES].as_array()[k % LANES]);
        let (north, east) = self.grid.direction(k);
        let (north, east, speed) = (f32x8::splat(north), f32x8::splat(east), self.grid.speed_lanes()[lanes]);
        let mut sum = self.speeds[lanes] + course;
        for (weight, field) in &self.fields {
            sum += weight.quanta(field.utility(north, east, speed));
        }
        if !self.table.is_empty() {
            sum += self.table[k * self.speeds.len() + lanes];
        }
        sum
    }

    fn add_separable(&mut self, weight: Weight, objective: &Objective) {
        let (of_course, of_speed) = objective.weights(weight);
        if !of_course.is_zero() {
            objective.each_course(&self.grid, |lanes, utilities| self.courses[lanes] += of_course.quanta(utilities));
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
            let sums = &mut self.table[k * lanes..][..lanes];
            let (eights, rest) = row.as_chunks::<LANES>();
            let mut add =
                |lanes: usize, eight| sums[lanes] += weight.quanta(super::fixed::utilities(f32x8::new(eight)));
            for (i, eight) in eights.iter().enumerate() {
                add(i, *eight);
            }
            if !rest.is_empty() {
                // Beyond the last speed nothing is added.
                add(eights.len(), std::array::from_fn(|lane| rest.get(lane).copied().unwrap_or(0.0)));
            }
        }
    }

    /// Fills in what no speed of a block exceeds.
    fn bound_blocks(&mut self) {
        let (north, east) = self.grid.directions();
        let courses = self.courses.len();
        for (lanes, speeds) in self.grid.speed_lanes().iter().enumerate() {
            let most = i32x8::splat(self.speeds[lanes].reduce_max());
            let (slow, fast) = (f32x8::splat(speeds.as_array()[0]), f32x8::splat(speeds.as_array()[LANES - 1]));
            let bounds = &mut self.bounds[lanes * courses..][..courses];
            for (bound, &course) in bounds.iter_mut().zip(&self.courses) {
                *bound = course + most;
            }
            for (weight, field) in &self.fields {
                for (i, bound) in bounds.iter_mut().enumerate() {
                    *bound += weight.quanta(field.bound(north[i], east[i], slow, fast));
                }
            }
            for k in 0..if self.table.is_empty() { 0 } else { self.grid.courses() } {
                let row = self.table[k * self.speeds.len() + lanes];
                bounds[k / LANES].as_mut_array()[k % LANES] += row.reduce_max();
            }
        }
    }

    /// Evaluates the blocks whose bound reaches `least` and the best found, unless that was done before.
    fn evaluate_blocks(&mut self, least: i32, present: Present, best: &mut Best, evaluated: &mut usize) {
        let courses = self.courses.len();
        for i in 0..self.bounds.len() {
            let bounds = self.bounds[i];
            if bounds.reduce_max() < least.max(best.value) {
                continue;
            }
            let (lanes, first) = (i / courses, LANES * (i % courses));
            for (lane, &bound) in bounds.as_array().iter().enumerate() {
                if bound >= least.max(best.value) && first + lane < self.grid.courses() {
                    self.evaluate(first + lane, lanes, present, best);
                    self.bounds[i].as_mut_array()[lane] = NOWHERE;
                    *evaluated += LANES.min(self.grid.speeds() - LANES * lanes);
                }
            }
        }
    }

    /// Evaluates a block, and takes its best point if that is better than what was found.
    fn evaluate(&self, k: usize, lanes: usize, present: Present, best: &mut Best) {
        let sums = self.block(k, lanes);
        let value = sums.reduce_max();
        if value < best.value {
            return;
        }
        for (lane, &sum) in sums.as_array().iter().enumerate() {
            let point = Best { value, course: k, speed: LANES * lanes + lane };
            if sum == value && (value > best.value || self.is_nearer(&point, best, present)) {
                *best = point;
            }
        }
    }

    /// Whether of two equal points the first is to be taken.
    fn is_nearer(&self, point: &Best, other: &Best, present: Present) -> bool {
        let turn = |k: usize| {
            let ticks = self.grid.ticks_between(present.course, k);
            (ticks.abs(), ticks < 0)
        };
        let away_m_s = |j: usize| (self.grid.speed_m_s(j) - present.speed_m_s).abs();
        let speeds = || (away_m_s(point.speed), point.speed) < (away_m_s(other.speed), other.speed);
        match turn(point.course).cmp(&turn(other.course)) {
            Ordering::Less => true,
            Ordering::Equal => speeds(),
            Ordering::Greater => false,
        }
    }
}

/// Nothing on so many places, side by side, and [`NOWHERE`] beyond them.
fn clear_lanes(lanes: &mut [i32x8], count: usize) {
    for (i, eight) in lanes.iter_mut().enumerate() {
        *eight = i32x8::new(std::array::from_fn(|lane| if LANES * i + lane < count { 0 } else { NOWHERE }));
    }
}
