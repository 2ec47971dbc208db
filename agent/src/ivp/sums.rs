//! The functions of a decision added up: lists by course and by speed, formulas, and a table.

use super::fixed::{self, FUNCTIONS_MAX, NOWHERE, Weight};
use super::grid::Grid;
use super::instructions::{Instructions, Kernel};
use super::lanes::{LANES, Lanes};
use super::limit::SpeedLimit;
use super::objective::{Field, Objective, Parts};
use super::peak::{CoursePeak, Peak};

/// Weighted utilities, added up as far as they can be before a point is known. Its lists are used again for the next decision.
#[derive(Clone, Debug)]
pub(super) struct Sums {
    /// What functions of course alone come to, in quanta by course; beyond the last course, [`NOWHERE`].
    pub(super) courses: Vec<Lanes<i32>>,
    /// What functions of speed alone come to, in quanta by speed; beyond the last speed, [`NOWHERE`].
    pub(super) speeds: Vec<Lanes<i32>>,
    /// Formulas in both.
    pub(super) fields: Vec<(Weight, Field)>,
    /// Weighted tables in both, in quanta: rows of as many speeds as stand side by side, one for each place of `courses`, and
    /// so on for the next speeds. Empty before the first. Beyond the last speed it has utilities of other points: what is
    /// there counts nothing, since `speeds` has [`NOWHERE`] there.
    table: Vec<Lanes<i32>>,
    /// Whether there is any table in it.
    has_table: bool,
}

impl Sums {
    /// Of no functions.
    pub(super) fn new(grid: &Grid) -> Sums {
        let lists = |count: usize| vec![Lanes::splat(0); count.div_ceil(LANES)];
        let (courses, speeds) = (lists(grid.courses()), lists(grid.speeds()));
        // Programs have up to one table for each obstacle and a formula for each contact: no list grows later.
        let mut sums = Sums {
            courses,
            speeds,
            fields: Vec::with_capacity(FUNCTIONS_MAX / 8),
            table: Vec::new(),
            has_table: false,
        };
        sums.clear(grid);
        sums
    }

    /// Forgets all functions.
    pub(super) fn clear(&mut self, grid: &Grid) {
        clear_lanes(&mut self.courses, grid.courses());
        clear_lanes(&mut self.speeds, grid.speeds());
        self.fields.clear();
        self.has_table = false;
    }

    /// Adds a function.
    pub(super) fn add(&mut self, grid: &Grid, instructions: Instructions, weight: Weight, objective: &Objective) {
        match objective.parts(grid) {
            Parts::Separable => instructions.run(AddSeparable { sums: self, grid, weight, objective }),
            Parts::Field(field) => self.fields.push((weight, field)),
            Parts::Table(table) => {
                let is_first = !std::mem::replace(&mut self.has_table, true);
                self.table.resize(self.speeds.len() * LANES * self.courses.len(), Lanes::splat(0));
                instructions.run(AddTable { sums: self, grid, weight, table, is_first });
            }
            Parts::Nothing => {}
        }
    }

    /// The table, if there is any.
    #[inline(always)]
    pub(super) fn table(&self) -> Option<&[Lanes<i32>]> {
        self.has_table.then_some(&self.table)
    }

    /// The weighted sum at one point, in quanta.
    pub(super) fn at(&self, grid: &Grid, k: usize, j: usize) -> i32 {
        let (north, east) = grid.direction(k);
        let speed = grid.speed_m_s(j) as f32;
        let of_fields: i32 = self.fields.iter().map(|(w, field)| w.quanta(field.utility(north, east, speed))).sum();
        let rows = LANES * self.courses.len();
        let of_table = self.table().map_or(0, |table| table[j / LANES * rows + k].0[j % LANES]);
        self.courses[k / LANES].0[k % LANES] + self.speeds[j / LANES].0[j % LANES] + of_fields + of_table
    }
}

/// Adds a function of course and one of speed.
struct AddSeparable<'a> {
    sums: &'a mut Sums,
    grid: &'a Grid,
    weight: Weight,
    objective: &'a Objective<'a>,
}

impl Kernel for AddSeparable<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let AddSeparable { sums, grid, weight, objective } = self;
        let (of_course, of_speed) = objective.weights(weight);
        if let Some(peak) = objective.course_peak().filter(|_| !of_course.is_zero()) {
            let peak = peak.on_courses(grid);
            for (i, sums) in sums.courses.iter_mut().enumerate() {
                add_peak(sums, LANES * i, of_course, &peak, grid);
            }
        }
        if of_speed.is_zero() {
            return;
        }
        for (i, speeds) in grid.speeds_m_s().chunks(LANES).enumerate() {
            let mut speed_m_s = Lanes::splat(0.0);
            speed_m_s.0[..speeds.len()].copy_from_slice(speeds);
            let quanta = match objective {
                Objective::Speed(peak) | Objective::Coupled { speed: peak, .. } => of_peak(of_speed, peak, &speed_m_s),
                Objective::Limit(limit) => of_limit(of_speed, limit, &speed_m_s),
                _ => return,
            };
            for (sum, quanta) in sums.speeds[i].0.iter_mut().zip(quanta.0).take(speeds.len()) {
                *sum += quanta;
            }
        }
    }
}

/// Adds a peak with its weight on courses side by side, from the first on.
#[inline(always)]
fn add_peak(sums: &mut Lanes<i32>, first: usize, weight: Weight, peak: &CoursePeak, grid: &Grid) {
    for i in 0..LANES {
        let quanta = weight.quanta(peak.at(grid, first + i));
        sums.0[i] += if first + i < grid.courses() { quanta } else { 0 };
    }
}

/// A peak with its weight, by speed, m/s.
#[inline(always)]
fn of_peak(weight: Weight, peak: &Peak, speed_m_s: &Lanes<f64>) -> Lanes<i32> {
    let mut quanta = Lanes::splat(0);
    for i in 0..LANES {
        quanta.0[i] = weight.quanta(peak.at(speed_m_s.0[i] - peak.summit));
    }
    quanta
}

/// A limit with its weight, by speed, m/s.
#[inline(always)]
fn of_limit(weight: Weight, limit: &SpeedLimit, speed_m_s: &Lanes<f64>) -> Lanes<i32> {
    let mut quanta = Lanes::splat(0);
    for i in 0..LANES {
        quanta.0[i] = weight.quanta(limit.at(speed_m_s.0[i]));
    }
    quanta
}

/// Adds a table.
struct AddTable<'a> {
    sums: &'a mut Sums,
    grid: &'a Grid,
    weight: Weight,
    table: &'a [f32],
    /// There is none yet: its places need not be read.
    is_first: bool,
}

impl Kernel for AddTable<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let AddTable { sums, grid, weight, table, is_first } = self;
        let rows = LANES * sums.courses.len();
        let speeds = grid.speeds();
        for (i, first) in (0..speeds).step_by(LANES).enumerate() {
            for k in 0..grid.courses() {
                let (sum, at) = (&mut sums.table[i * rows + k], k * speeds + first);
                if let Some(utilities) = table[at..].first_chunk() {
                    add_weighted(sum, weight, &Lanes(*utilities), is_first);
                } else {
                    let mut utilities = Lanes::splat(0.0);
                    utilities.0[..speeds - first].copy_from_slice(&table[at..][..speeds - first]);
                    add_weighted(sum, weight, &utilities, is_first);
                }
            }
        }
    }
}

/// Adds utilities with their weight, or puts them in place of what was there.
#[inline(always)]
fn add_weighted(sum: &mut Lanes<i32>, weight: Weight, utilities: &Lanes<f32>, is_first: bool) {
    let mut quanta = Lanes::splat(0);
    for i in 0..LANES {
        quanta.0[i] = weight.quanta(fixed::single(utilities.0[i]));
    }
    if !is_first {
        for i in 0..LANES {
            quanta.0[i] += sum.0[i];
        }
    }
    *sum = quanta;
}

/// Nothing on so many places, side by side, and [`NOWHERE`] beyond them.
fn clear_lanes(list: &mut [Lanes<i32>], count: usize) {
    list.fill(Lanes::splat(0));
    if !count.is_multiple_of(LANES) {
        list[count / LANES].0[count % LANES..].fill(NOWHERE);
    }
}
