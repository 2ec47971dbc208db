//! The search for the largest sum: sectors whose bound reaches the best point found, their tiles, and the points of those.

use super::cell::{Cells, CourseSpans, SpeedSpans, cell};
use super::fixed::{FUNCTIONS_MAX, Weight};
use super::grid::Grid;
use super::lanes::{LANES, Lanes, SIDE, larger};
use super::measured::{Bounded, Distances};
use super::objective::Field;
use super::sums::Sums;
use super::{closest, closing};
use primitives::instructions::Kernel;
use std::cmp::Ordering;

/// A sector, tile or point that is done, or that is not on the grid.
const DONE: i32 = i32::MIN;

/// The best point found so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Best {
    pub(super) value: i32,
    pub(super) course: usize,
    pub(super) speed: usize,
}

/// What the own ship is doing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Present {
    /// Its course, in ticks.
    pub(super) course: f64,
    pub(super) speed_m_s: f64,
}

/// What is known of each cell during a search; used again for the next one.
#[derive(Clone, Debug)]
pub(super) struct Bounds {
    /// By sector: what lists and tables come to at most in each of its tiles, in quanta.
    lists: Vec<Lanes<i32>>,
    /// What no point of a sector exceeds, in quanta, by sector.
    sectors: Vec<Lanes<i32>>,
    /// By sectors side by side and by formula: which of them the formula is clear of, a bit for each.
    clear: Vec<u16>,
}

impl Bounds {
    pub(super) fn new(cells: &Cells) -> Bounds {
        let sectors = cells.sector_courses * cells.sector_speeds;
        let chunks = cells.sectors.len();
        Bounds {
            lists: vec![Lanes::splat(DONE); sectors],
            sectors: vec![Lanes::splat(DONE); chunks],
            clear: Vec::with_capacity(chunks * FUNCTIONS_MAX / 8),
        }
    }
}

/// A search.
pub(super) struct Search<'a> {
    pub(super) grid: &'a Grid,
    pub(super) cells: &'a Cells,
    pub(super) sums: &'a Sums,
    pub(super) bounds: &'a mut Bounds,
    pub(super) present: Present,
    /// A point that may be good: what it reaches rules out most others at once.
    pub(super) guess: Option<(usize, usize)>,
}

impl Kernel for Search<'_> {
    /// The best point, and how many were evaluated.
    type Output = (Best, usize);

    #[inline(always)]
    fn run(mut self) -> (Best, usize) {
        self.bound_lists();
        self.bound_sectors();
        // Above what is marked as done, so that no such place is ever taken, and below every
        // sum.
        let mut best = Best { value: DONE + 1, course: 0, speed: 0 };
        let mut evaluated = 0;
        if let Some((k, j)) = self.guess {
            self.evaluate((k / SIDE, j / SIDE), &mut best);
            evaluated += LANES;
        }
        // The most promising first.
        while let Some(sector) = take_most(&mut self.bounds.sectors, best.value) {
            let (across, along) = (sector % self.cells.sector_courses, sector / self.cells.sector_courses);
            let mut tiles = [self.tiles(sector)];
            while let Some(tile) = take_most(&mut tiles, best.value) {
                self.evaluate((SIDE * across + tile % SIDE, SIDE * along + tile / SIDE), &mut best);
                evaluated += LANES;
            }
        }
        (best, evaluated)
    }
}

/// The place of the largest number that reaches `least`, and strikes it out.
#[inline(always)]
fn take_most(list: &mut [Lanes<i32>], least: i32) -> Option<usize> {
    let mut side_by_side = list[0];
    for lanes in &list[1..] {
        for i in 0..LANES {
            side_by_side.0[i] = larger(side_by_side.0[i], lanes.0[i]);
        }
    }
    let most = side_by_side.most();
    // Not where it is equal: a cell with an equal sum may hold the point that is nearer to how
    // the boat goes now.
    if most < least {
        return None;
    }
    for (i, lanes) in list.iter_mut().enumerate() {
        let place = lanes.place_of(most);
        if place < LANES {
            lanes.0[place] = DONE;
            return Some(LANES * i + place);
        }
    }
    None
}

impl Search<'_> {
    /// Fills in what lists and tables come to at most.
    #[inline(always)]
    fn bound_lists(&mut self) {
        let courses = self.sums.courses.len();
        for along in 0..self.sums.speeds.len() {
            for across in 0..courses {
                self.bounds.lists[along * courses + across] = self.sums.most_in_lists(across, along);
            }
        }
    }

    /// Fills in what no point of a sector exceeds, and which formulas are clear of it.
    #[inline(always)]
    fn bound_sectors(&mut self) {
        let Bounds { lists, sectors, clear } = &mut *self.bounds;
        let formulas = self.sums.fields.len();
        clear.resize(formulas * sectors.len(), 0);
        for (chunk, bounds) in sectors.iter_mut().enumerate() {
            let cells = (&self.cells.sectors[chunk].0, &self.cells.sectors[chunk].1);
            let mut sums = Lanes::splat(DONE);
            for (sum, tiles) in sums.0.iter_mut().zip(&lists[LANES * chunk..]) {
                *sum = tiles.most();
            }
            *bounds = self.sums.bound_sectors(sums, cells, &mut clear[formulas * chunk..][..formulas]);
        }
    }

    /// Which formulas are clear of a sector.
    #[inline(always)]
    fn clear(&self, sector: usize) -> Clear<'_> {
        let formulas = self.sums.fields.len();
        Clear {
            of_formulas: &self.bounds.clear[formulas * (sector / LANES)..][..formulas],
            sectors: 1 << (sector % LANES),
        }
    }

    /// What no point of each tile of a sector exceeds.
    #[inline(always)]
    fn tiles(&self, sector: usize) -> Lanes<i32> {
        let courses = &self.cells.tile_courses[sector % self.cells.sector_courses];
        let speeds = &self.cells.tile_speeds[sector / self.cells.sector_courses];
        self.sums.add_bounds(self.bounds.lists[sector], (courses, speeds), self.clear(sector))
    }

    /// Evaluates a tile, and takes its best point if that is better than what was found.
    #[inline(always)]
    fn evaluate(&self, (course_tile, speed_tile): (usize, usize), best: &mut Best) {
        let sector = speed_tile / SIDE * self.cells.sector_courses + course_tile / SIDE;
        let sums = self.sums.tile(self.cells, (course_tile, speed_tile), self.clear(sector));
        let value = sums.most();
        // Most tiles end here, by one comparison; only equal or better ones are looked at point
        // by point.
        if value >= best.value {
            self.keep_best(&sums, value, (SIDE * course_tile, SIDE * speed_tile), best);
        }
    }

    /// Takes the best of points that are as good as what was found or better.
    #[inline(never)]
    fn keep_best(&self, sums: &Lanes<i32>, value: i32, (course, speed): (usize, usize), best: &mut Best) {
        for (lane, &sum) in sums.0.iter().enumerate() {
            let point = Best { value, course: course + lane / SIDE, speed: speed + lane % SIDE };
            if sum == value && (value > best.value || self.is_nearer(&point, best)) {
                *best = point;
            }
        }
    }

    /// Whether of two equal points the first is to be taken.
    fn is_nearer(&self, point: &Best, other: &Best) -> bool {
        let turn = |k: usize| {
            let ticks = self.grid.ticks_between(self.present.course, k) as i64;
            // Some rule there must be, or the choice would hang on the order of the search.
            (ticks.abs(), ticks < 0)
        };
        let away_m_s = |j: usize| (self.grid.speed_m_s(j) - self.present.speed_m_s).abs();
        let speeds = || (away_m_s(point.speed), point.speed) < (away_m_s(other.speed), other.speed);
        match turn(point.course).cmp(&turn(other.course)) {
            Ordering::Less => true,
            Ordering::Equal => speeds(),
            Ordering::Greater => false,
        }
    }
}

impl Sums {
    /// What lists and tables come to at most in each tile of a sector.
    #[inline(always)]
    fn most_in_lists(&self, across: usize, along: usize) -> Lanes<i32> {
        let (of_courses, of_speeds) = (&self.courses[across], &self.speeds[along]);
        let (most_courses, most_speeds) = (of_courses.most_of_fours(), of_speeds.most_of_fours());
        let mut tiles = Lanes::splat(0);
        for i in 0..LANES {
            tiles.0[i] = most_courses[i % SIDE] + most_speeds[i / SIDE];
        }
        if let Some(rows) = self.rows(across, along) {
            // One by one: a loop over them would be done side by side in the wrong direction.
            let (a, b) = (most_of_rows(rows, of_courses, of_speeds, 0), most_of_rows(rows, of_courses, of_speeds, 1));
            let (c, d) = (most_of_rows(rows, of_courses, of_speeds, 2), most_of_rows(rows, of_courses, of_speeds, 3));
            for i in 0..LANES {
                let first = if i % SIDE < 1 { a.0[i] } else { b.0[i] };
                let last = if i % SIDE < 3 { c.0[i] } else { d.0[i] };
                tiles.0[i] = if i % SIDE < 2 { first } else { last };
            }
        }
        for i in 0..LANES {
            let is_there = most_courses[i % SIDE] >= 0 && most_speeds[i / SIDE] >= 0;
            // Places beyond the grid have sums far below zero, but the bounds of functions
            // could lift them: they are marked again at the end.
            tiles.0[i] = if is_there { tiles.0[i] } else { DONE };
        }
        tiles
    }

    /// What comes to so much at most in each of these tiles without formulas, with them. Of those that `clear` names nothing is
    /// below the most that they can be.
    #[inline(always)]
    fn add_bounds(&self, mut sums: Lanes<i32>, cells: (&CourseSpans, &SpeedSpans), clear: Clear<'_>) -> Lanes<i32> {
        let mut bounded = Bounded::new();
        for (i, (weight, field)) in self.fields.iter().enumerate() {
            match field {
                _ if clear.is_so(i) => add_full(&mut sums, *weight),
                Field::Closest(ready) => {
                    bounded.measure_best(ready, cells);
                    add_worth(&mut sums, *weight, ready, if ready.seeks() { &bounded.least } else { &bounded.most });
                }
                Field::Closing(ready) => add_closing_bounds(&mut sums, *weight, ready, cells),
            }
        }
        sums
    }

    /// The same of sectors; fills in which of them each formula is clear of, a bit for each.
    #[inline(always)]
    fn bound_sectors(&self, mut sums: Lanes<i32>, cells: (&CourseSpans, &SpeedSpans), clear: &mut [u16]) -> Lanes<i32> {
        let mut bounded = Bounded::new();
        // A contact that cannot come near in a whole sector adds its full weight there: most
        // contacts do, and their points need no distance.
        for ((weight, field), clear) in self.fields.iter().zip(clear) {
            *clear = 0;
            match field {
                Field::Closest(ready) => {
                    bounded.measure(ready, cells);
                    if ready.seeks() {
                        add_worth(&mut sums, *weight, ready, &bounded.least);
                    } else {
                        add_worth(&mut sums, *weight, ready, &bounded.most);
                        *clear = clear_bits(ready, &bounded.least);
                    }
                }
                Field::Closing(ready) => add_closing_bounds(&mut sums, *weight, ready, cells),
            }
        }
        sums
    }

    /// The weighted sums of a tile's points, in quanta.
    #[inline(always)]
    fn tile(&self, cells: &Cells, (course_tile, speed_tile): (usize, usize), clear: Clear<'_>) -> Lanes<i32> {
        let of_courses = &self.courses[course_tile / SIDE].0[SIDE * (course_tile % SIDE)..][..SIDE];
        let first_speed = SIDE * (speed_tile % SIDE);
        let of_speeds = &self.speeds[speed_tile / SIDE].0[first_speed..][..SIDE];
        let mut sums = Lanes::splat(0);
        for i in 0..LANES {
            sums.0[i] = of_courses[i / SIDE] + of_speeds[i % SIDE];
        }
        if let Some(rows) = self.rows(course_tile / SIDE, speed_tile / SIDE) {
            let rows = &rows[SIDE * (course_tile % SIDE)..][..SIDE];
            for i in 0..LANES {
                sums.0[i] += rows[i / SIDE].0[first_speed + i % SIDE];
            }
        }
        let ((north, east), speed) = (&cells.points[course_tile], &cells.point_speeds[speed_tile]);
        let mut measured = Distances::new();
        for (i, (weight, field)) in self.fields.iter().enumerate() {
            match field {
                _ if clear.is_so(i) => add_full(&mut sums, *weight),
                Field::Closest(ready) => {
                    measured.measure(ready, (north, east, speed));
                    add_worth(&mut sums, *weight, ready, &measured.distances);
                }
                Field::Closing(ready) => {
                    for i in 0..LANES {
                        sums.0[i] += weight.quanta(ready.utility(north.0[i], east.0[i], speed.0[i]));
                    }
                }
            }
        }
        for i in 0..LANES {
            let is_there = of_courses[i / SIDE] >= 0 && of_speeds[i % SIDE] >= 0;
            sums.0[i] = if is_there { sums.0[i] } else { DONE };
        }
        sums
    }
}

/// Which formulas are worth everything in all of a sector: those that keep away from what comes near on no way in it.
#[derive(Clone, Copy)]
struct Clear<'a> {
    /// By formula, a bit for each sector side by side.
    of_formulas: &'a [u16],
    /// The bits of the sectors that are meant.
    sectors: u16,
}

impl Clear<'_> {
    #[inline(always)]
    fn is_so(self, formula: usize) -> bool {
        self.of_formulas[formula] & self.sectors == self.sectors
    }
}

/// Adds what distances are worth.
#[inline(always)]
fn add_worth(sums: &mut Lanes<i32>, weight: Weight, ready: &closest::Ready, distances: &Lanes<f32>) {
    if ready.seeks() {
        for i in 0..LANES {
            sums.0[i] += weight.quanta(ready.worth_near(distances.0[i]));
        }
    } else {
        for i in 0..LANES {
            sums.0[i] += weight.quanta(ready.worth_far(distances.0[i]));
        }
    }
}

/// Adds what no rate of closure in cells side by side exceeds.
#[inline(always)]
fn add_closing_bounds(
    sums: &mut Lanes<i32>,
    weight: Weight,
    ready: &closing::Ready,
    cells: (&CourseSpans, &SpeedSpans),
) {
    for i in 0..LANES {
        sums.0[i] += weight.quanta(ready.bound(&cell(cells.0, cells.1, i)));
    }
}

/// Which of cells side by side a function is clear of, a bit for each: nothing in them comes nearer than this, m.
#[inline(always)]
fn clear_bits(ready: &closest::Ready, least: &Lanes<f32>) -> u16 {
    let mut bits = Lanes::splat(0);
    for i in 0..LANES {
        bits.0[i] = if ready.worth_far(least.0[i]) >= 100.0 { 1 << i } else { 0 };
    }
    bits.0.iter().fold(0, |all, bit| all | bit) as u16
}

/// Adds a formula that is worth everything.
#[inline(always)]
fn add_full(sums: &mut Lanes<i32>, weight: Weight) {
    let full = weight.quanta(100.0);
    for i in 0..LANES {
        sums.0[i] += full;
    }
}

/// What lists and a table come to at most on the courses of one tile, and the speeds of each.
#[inline(always)]
fn most_of_rows(rows: &[Lanes<i32>], of_courses: &Lanes<i32>, of_speeds: &Lanes<i32>, tile: usize) -> Lanes<i32> {
    let (k, mut most, mut pairs) = (SIDE * tile, Lanes::splat(DONE), Lanes::splat(DONE));
    let (a, b, c, d) = (&rows[k].0, &rows[k + 1].0, &rows[k + 2].0, &rows[k + 3].0);
    let of = &of_courses.0;
    for i in 0..LANES {
        let first = larger(a[i] + of[k], b[i] + of[k + 1]);
        let last = larger(c[i] + of[k + 2], d[i] + of[k + 3]);
        most.0[i] = larger(first, last) + of_speeds.0[i];
    }
    // Of pairs, then of pairs of these.
    for i in 0..LANES {
        pairs.0[i] = larger(most.0[i], most.0[i ^ 1]);
    }
    for i in 0..LANES {
        most.0[i] = larger(pairs.0[i], pairs.0[i ^ 2]);
    }
    most
}
