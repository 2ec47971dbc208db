//! The functions of a decision as sums: lists by course and by speed, formulas, and a table.

use super::fixed::{self, FUNCTIONS_MAX, NOWHERE, Weight};
use super::grid::Grid;
use super::lanes::{LANES, Lanes};
use super::objective::{Field, Objective, Parts, Separable};
use super::peak::{CoursePeak, Peak};
use super::table::Table;
use primitives::instructions::{Instructions, Kernel};

/// Weighted utilities, added up as far as possible before a point is known. The lists are reused
/// for the next decision.
#[derive(Clone, Debug)]
pub(super) struct Sums {
    /// The sums of course-only functions, in quanta by course; beyond the last course, [`NOWHERE`].
    pub(super) courses: Vec<Lanes<i32>>,
    /// The sums of speed-only functions, in quanta by speed; beyond the last speed, [`NOWHERE`].
    pub(super) speeds: Vec<Lanes<i32>>,
    /// Formulas in both course and speed.
    pub(super) fields: Vec<(Weight, Field)>,
    /// The sum of the formulas if all have full utility, in quanta.
    pub(super) full: i32,
    /// The sum of weighted tables, in quanta: for each group of speeds, a row of speeds per lane of
    /// `courses`. Undefined for groups of courses that no table lowers.
    table: Vec<Lanes<i32>>,
    /// By group of courses: whether a table lowers any course in it.
    lowered: Vec<bool>,
}

impl Sums {
    /// A sum of no functions.
    pub(super) fn new(grid: &Grid) -> Sums {
        let lists = |count: usize| vec![Lanes::splat(0); count.div_ceil(LANES)];
        let courses = lists(grid.courses());
        let speeds = lists(grid.speeds());
        let lowered = vec![false; courses.len()];
        // Programs have up to one table per obstacle and one formula per contact, so no list has to
        // grow later.
        let mut sums = Sums {
            courses,
            speeds,
            fields: Vec::with_capacity(FUNCTIONS_MAX / 8),
            full: 0,
            table: Vec::new(),
            lowered,
        };
        sums.clear(grid);
        sums
    }

    /// Removes all functions.
    pub(super) fn clear(&mut self, grid: &Grid) {
        clear_lanes(&mut self.courses, grid.courses());
        clear_lanes(&mut self.speeds, grid.speeds());
        self.fields.clear();
        self.full = 0;
        self.lowered.fill(false);
    }

    /// Adds a function.
    pub(super) fn add(
        &mut self,
        grid: &Grid,
        instructions: Instructions,
        weight: Weight,
        objective: &Objective,
    ) {
        match objective.parts(grid) {
            Parts::Separable(separable) => instructions.run(AddSeparable {
                sums: self,
                grid,
                weight,
                separable,
            }),
            Parts::Field(field) => self.add_field(weight, field),
            Parts::Table(table) => {
                // The first table allocates for all tables; later decisions allocate nothing.
                self.table.resize(
                    self.speeds.len() * LANES * self.courses.len(),
                    Lanes::splat(0),
                );
                instructions.run(AddTable {
                    sums: self,
                    grid,
                    weight,
                    table,
                });
            }
            Parts::Nothing => {}
        }
    }

    /// Adds a formula. Formulas with the same distances are adjacent, so that the distances are
    /// computed only once.
    fn add_field(&mut self, weight: Weight, mut field: Field) {
        let mut place = self.fields.len();
        if let Field::Closest(ready) = &mut field {
            ready.group = place;
            for (i, (_, other)) in self.fields.iter().enumerate() {
                if let Field::Closest(other) = other
                    && ready.has_distances_of(other)
                {
                    // Insert it next to functions with the same distances: sums are integers, so
                    // the order does not matter.
                    (place, ready.group) = (i + 1, other.group);
                }
            }
        }
        self.full += weight.quanta(100.0);
        self.fields.insert(place, (weight, field));
    }

    /// The rows of the table for a group of courses and a group of speeds, if any of these courses
    /// is lowered.
    #[inline(always)]
    pub(super) fn rows(&self, across: usize, along: usize) -> Option<&[Lanes<i32>]> {
        let first = LANES * (along * self.courses.len() + across);
        self.lowered[across].then(|| &self.table[first..][..LANES])
    }
}

/// Adds a function of course and a function of speed.
struct AddSeparable<'a> {
    sums: &'a mut Sums,
    grid: &'a Grid,
    weight: Weight,
    separable: Separable<'a>,
}

impl Kernel for AddSeparable<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let AddSeparable {
            sums,
            grid,
            weight,
            separable,
        } = self;
        let (of_course, of_speed) = separable.weights(weight);
        if !of_course.is_zero() {
            let peak = separable.course.on_courses(grid);
            for (i, sums) in sums.courses.iter_mut().enumerate() {
                // Most peaks have no `peak_width`, which saves a division for each course.
                match peak.may_reach(grid, LANES * i) {
                    true if peak.has_width() => {
                        add_peak(sums, LANES * i, of_course, (&peak, true), grid);
                    }
                    true => add_peak(sums, LANES * i, of_course, (&peak, false), grid),
                    false => {}
                }
            }
        }
        if of_speed.is_zero() {
            return;
        }
        for (i, speeds) in grid.speeds_m_s().chunks(LANES).enumerate() {
            let mut speed_m_s = Lanes::splat(0.0);
            speed_m_s.0[..speeds.len()].copy_from_slice(speeds);
            let quanta = of_peak(of_speed, separable.speed, &speed_m_s);
            for (sum, quanta) in sums.speeds[i].0.iter_mut().zip(quanta.0).take(speeds.len()) {
                *sum += quanta;
            }
        }
    }
}

/// Adds a weighted peak to a group of courses from `first` on.
#[inline(always)]
fn add_peak(
    sums: &mut Lanes<i32>,
    first: usize,
    weight: Weight,
    (peak, has_width): (&CoursePeak, bool),
    grid: &Grid,
) {
    for i in 0..LANES {
        let quanta = weight.quanta(peak.at_with(grid, first + i, has_width));
        sums.0[i] += if first + i < grid.courses() {
            quanta
        } else {
            0
        };
    }
}

/// A weighted peak by speed (m/s).
#[inline(always)]
fn of_peak(weight: Weight, peak: &Peak, speed_m_s: &Lanes<f64>) -> Lanes<i32> {
    let mut quanta = Lanes::splat(0);
    for i in 0..LANES {
        quanta.0[i] = weight.quanta(peak.at(speed_m_s.0[i] - peak.summit));
    }
    quanta
}

struct AddTable<'a> {
    sums: &'a mut Sums,
    grid: &'a Grid,
    weight: Weight,
    table: &'a Table,
}

impl Kernel for AddTable<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let AddTable {
            sums,
            grid,
            weight,
            table,
        } = self;
        for (across, lowered) in table.lowered.iter().enumerate() {
            let first = LANES * across;
            let count = (grid.courses() - first).min(LANES);
            for (i, sum) in sums.courses[across].0.iter_mut().enumerate().take(count) {
                // Courses that no table lowers get 100 at all speeds, so most of the 360 courses by
                // 36 speeds need no work. Skipping them sped up a game of `surveyor_2v2` from 1,220
                // to 2,600 times real time.
                *sum += if lowered >> i & 1 == 0 {
                    weight.quanta(100.0)
                } else {
                    0
                };
            }
            // Clear the table on first use in a decision, not before each decision: most of the
            // table stays unused.
            if *lowered != 0 && !sums.lowered[across] {
                sums.lowered[across] = true;
                for rows in sums.table.chunks_mut(LANES * sums.courses.len()) {
                    rows[first..][..LANES].fill(Lanes::splat(0));
                }
            }
            for i in (0..count).filter(|i| lowered >> i & 1 == 1) {
                for (along, utilities) in table.row(first + i).iter().enumerate() {
                    let row = along * LANES * sums.courses.len() + first + i;
                    add_weighted(&mut sums.table[row], weight, utilities);
                }
            }
        }
    }
}

#[inline(always)]
fn add_weighted(sum: &mut Lanes<i32>, weight: Weight, utilities: &Lanes<f32>) {
    for i in 0..LANES {
        sum.0[i] += weight.quanta(fixed::single(utilities.0[i]));
    }
}

/// Sets zeros in the first `count` lanes, and [`NOWHERE`] beyond them.
fn clear_lanes(list: &mut [Lanes<i32>], count: usize) {
    list.fill(Lanes::splat(0));
    if !count.is_multiple_of(LANES) {
        list[count / LANES].0[count % LANES..].fill(NOWHERE);
    }
}
