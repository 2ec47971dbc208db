//! The search for the largest sum: first the sectors whose bound reaches the best point so far,
//! then their tiles and points.

use super::cell::{Cells, CourseSpans, SpeedSpans, cell};
use super::fixed::{FUNCTIONS_MAX, Weight};
use super::grid::Grid;
use super::lanes::{LANES, Lanes, SIDE, larger};
use super::measured::{Bounded, Distances};
use super::objective::Field;
use super::problem::Decision;
use super::sums::Sums;
use super::{closest, closing};
use primitives::instructions::Kernel;
use std::cmp::Ordering;

/// Marks a sector, tile or point that is finished or outside the grid.
const DONE: i32 = i32::MIN;

/// The best point found so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Best {
    pub(super) value: i32,
    pub(super) decision: Decision,
}

/// Own ship's current motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Present {
    /// The current course, ticks.
    pub(super) course: f64,
    pub(super) speed_m_s: f64,
}

/// Bounds of all cells during a search. Reused in the next search.
#[derive(Clone, Debug)]
pub(super) struct Bounds {
    /// By sector: the upper bounds of lists and tables in its tiles, in quanta.
    lists: Vec<Lanes<i32>>,
    /// The upper bound of each sector, in quanta.
    sectors: Vec<Lanes<i32>>,
    /// By group of sectors and by formula: a bit for each sector in which the formula has full
    /// utility. Undefined for groups without a sector that reaches the best point so far.
    clear: Vec<u16>,
    /// By formula: its upper bounds in the tiles of the current sector, in quanta.
    parts: Vec<Lanes<i32>>,
}

impl Bounds {
    pub(super) fn new(cells: &Cells) -> Bounds {
        let sectors = cells.sector_courses * cells.sector_speeds;
        let chunks = cells.sectors.len();
        Bounds {
            lists: vec![Lanes::splat(DONE); sectors],
            sectors: vec![Lanes::splat(DONE); chunks],
            clear: Vec::with_capacity(chunks * FUNCTIONS_MAX / 8),
            parts: Vec::with_capacity(FUNCTIONS_MAX / 8),
        }
    }
}

pub(super) struct Search<'a> {
    pub(super) grid: &'a Grid,
    pub(super) cells: &'a Cells,
    pub(super) sums: &'a Sums,
    pub(super) bounds: &'a mut Bounds,
    pub(super) present: Present,
    /// A point that is probably good: its value excludes most other points at once.
    pub(super) guess: Option<Decision>,
}

impl Kernel for Search<'_> {
    /// The best point, and the number of evaluated points.
    type Output = (Best, usize);

    #[inline(always)]
    fn run(mut self) -> (Best, usize) {
        let formulas = self.sums.fields.len();
        self.bounds.parts.resize(formulas, Lanes::splat(0));
        // Start above `DONE`, so that no finished cell is taken, and below every sum.
        let mut best = Best {
            value: DONE + 1,
            decision: Decision {
                course: 0,
                speed: 0,
            },
        };
        let mut evaluated = 0;
        // The guess comes first: its value excludes most sectors after few formulas have been
        // evaluated.
        let guess = self.guess;
        let guess = guess.map(|Decision { course, speed }| (course / SIDE, speed / SIDE));
        if let Some(tile) = guess {
            for (part, (weight, _)) in self.bounds.parts.iter_mut().zip(&self.sums.fields) {
                *part = Lanes::splat(weight.quanta(100.0));
            }
            self.evaluate(tile, (None, 0), &mut best);
            evaluated += LANES;
        }
        self.bound_lists();
        self.bound_sectors(best.value);
        // Search the most promising sectors first.
        while let Some(sector) = take_most(&mut self.bounds.sectors, best.value) {
            let across = sector / self.cells.sector_speeds;
            let along = sector % self.cells.sector_speeds;
            let mut tiles = [self.tiles(sector, best.value)];
            while let Some(tile) = take_most(&mut tiles, best.value) {
                let at = (SIDE * across + tile % SIDE, SIDE * along + tile / SIDE);
                if Some(at) != guess {
                    self.evaluate(at, (Some(sector), tile), &mut best);
                    evaluated += LANES;
                }
            }
        }
        (best, evaluated)
    }
}

/// Returns the place of the largest number, if that is at least `least`, and marks it as finished.
#[inline(always)]
fn take_most(list: &mut [Lanes<i32>], least: i32) -> Option<usize> {
    let mut side_by_side = list[0];
    for lanes in &list[1..] {
        for i in 0..LANES {
            side_by_side.0[i] = larger(side_by_side.0[i], lanes.0[i]);
        }
    }
    let most = side_by_side.most();
    // Cells whose bound equals the best sum are searched, too: one may contain an equally good
    // point nearer to the boat's current motion.
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
    /// Computes the upper bounds of lists and tables.
    #[inline(always)]
    fn bound_lists(&mut self) {
        let speeds = self.cells.sector_speeds;
        for (across, sectors) in self.bounds.lists.chunks_mut(speeds).enumerate() {
            for (along, tiles) in sectors.iter_mut().enumerate() {
                *tiles = self.sums.most_in_lists(across, along);
            }
        }
    }

    /// Computes the upper bounds of sectors that reach `least`, and the formulas with full utility
    /// in them.
    #[inline(always)]
    fn bound_sectors(&mut self, least: i32) {
        let Bounds {
            lists,
            sectors,
            clear,
            ..
        } = &mut *self.bounds;
        let formulas = self.sums.fields.len();
        clear.resize(formulas * sectors.len(), 0);
        for (chunk, bounds) in sectors.iter_mut().enumerate() {
            let cells = (&self.cells.sectors[chunk].0, &self.cells.sectors[chunk].1);
            let mut sums = Lanes::splat(DONE);
            for (sum, tiles) in sums.0.iter_mut().zip(&lists[LANES * chunk..]) {
                *sum = tiles.most();
            }
            let clear = &mut clear[formulas * chunk..][..formulas];
            *bounds = self.sums.bound_sectors(sums, cells, clear, least);
        }
    }

    /// The formulas with full utility in a sector.
    #[inline(always)]
    fn clear<'b>(bounds: &'b Bounds, formulas: usize, sector: usize) -> Clear<'b> {
        Clear {
            of_formulas: &bounds.clear[formulas * (sector / LANES)..][..formulas],
            sectors: 1 << (sector % LANES),
        }
    }

    /// The upper bounds of a sector's tiles that reach `least`.
    #[inline(always)]
    fn tiles(&mut self, sector: usize, least: i32) -> Lanes<i32> {
        let courses = &self.cells.tile_courses[sector / self.cells.sector_speeds];
        let speeds = &self.cells.tile_speeds[sector % self.cells.sector_speeds];
        // Take the parts out of the bounds, so that the sector's bounds can be read while the parts
        // are written.
        let mut parts = std::mem::take(&mut self.bounds.parts);
        let clear = Search::clear(self.bounds, parts.len(), sector);
        let lists = self.bounds.lists[sector];
        let tiles = self
            .sums
            .add_bounds(lists, (courses, speeds), clear, (&mut parts, least));
        self.bounds.parts = parts;
        tiles
    }

    /// Evaluates a tile, given its place in the current sector, if any. Keeps its best point if
    /// that beats the best so far.
    #[inline(always)]
    fn evaluate(
        &self,
        (course_tile, speed_tile): (usize, usize),
        (sector, place): (Option<usize>, usize),
        best: &mut Best,
    ) {
        let parts = &self.bounds.parts;
        let none = Clear {
            of_formulas: &[],
            sectors: 0,
        };
        let clear = sector.map_or(none, |sector| {
            Search::clear(self.bounds, parts.len(), sector)
        });
        let sums = self.sums.tile(
            self.cells,
            (course_tile, speed_tile),
            clear,
            (parts, place, best.value),
        );
        let value = sums.most();
        // Most tiles end here, after one comparison; only equal or better tiles are checked point
        // by point.
        if value >= best.value {
            self.keep_best(&sums, value, (SIDE * course_tile, SIDE * speed_tile), best);
        }
    }

    /// Keeps the best of the points that equal or beat the best so far.
    #[inline(never)]
    fn keep_best(
        &self,
        sums: &Lanes<i32>,
        value: i32,
        (course, speed): (usize, usize),
        best: &mut Best,
    ) {
        for (lane, &sum) in sums.0.iter().enumerate() {
            let decision = Decision {
                course: course + lane / SIDE,
                speed: speed + lane % SIDE,
            };
            if sum == value && (value > best.value || self.is_nearer(decision, best.decision)) {
                *best = Best { value, decision };
            }
        }
    }

    /// Whether the first of two equally good points wins.
    fn is_nearer(&self, point: Decision, other: Decision) -> bool {
        let turn = |k: usize| {
            let ticks = self.grid.ticks_between(self.present.course, k) as i64;
            // A fixed tie-break: otherwise the choice would depend on the search order.
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
    /// The upper bounds of lists and tables in each tile of a sector.
    #[inline(always)]
    fn most_in_lists(&self, across: usize, along: usize) -> Lanes<i32> {
        let of_courses = &self.courses[across];
        let of_speeds = &self.speeds[along];
        let most_courses = of_courses.most_of_fours();
        let most_speeds = of_speeds.most_of_fours();
        let mut tiles = Lanes::splat(0);
        for i in 0..LANES {
            tiles.0[i] = most_courses[i % SIDE] + most_speeds[i / SIDE];
        }
        if let Some(rows) = self.rows(across, along) {
            // Unrolled: the compiler would vectorise a loop in the wrong direction.
            let a = most_of_rows(rows, of_courses, of_speeds, 0);
            let b = most_of_rows(rows, of_courses, of_speeds, 1);
            let c = most_of_rows(rows, of_courses, of_speeds, 2);
            let d = most_of_rows(rows, of_courses, of_speeds, 3);
            for i in 0..LANES {
                let first = if i % SIDE < 1 { a.0[i] } else { b.0[i] };
                let last = if i % SIDE < 3 { c.0[i] } else { d.0[i] };
                tiles.0[i] = if i % SIDE < 2 { first } else { last };
            }
        }
        for i in 0..LANES {
            let is_there = most_courses[i % SIDE] >= 0 && most_speeds[i / SIDE] >= 0;
            // Lanes beyond the grid have sums far below zero, but the functions' bounds could raise
            // them, so mark them again at the end.
            tiles.0[i] = if is_there { tiles.0[i] } else { DONE };
        }
        tiles
    }

    /// Adds the formulas' bounds to the tiles' sums, and records them. Formulas in `clear` add
    /// their full utility. Stops when no tile can reach `least`.
    #[inline(always)]
    fn add_bounds(
        &self,
        mut sums: Lanes<i32>,
        cells: (&CourseSpans, &SpeedSpans),
        clear: Clear<'_>,
        (parts, least): (&mut [Lanes<i32>], i32),
    ) -> Lanes<i32> {
        let mut bounded = Bounded::new();
        let mut left = self.full;
        for (i, ((weight, field), part)) in self.fields.iter().zip(parts).enumerate() {
            if !reaches(&sums, left, least) {
                return Lanes::splat(DONE);
            }
            left -= weight.quanta(100.0);
            let before = sums;
            match field {
                _ if clear.is_so(i) => add_full(&mut sums, *weight),
                Field::Closest(ready) => {
                    bounded.measure_best(ready, cells);
                    add_worth(&mut sums, *weight, ready, bounded.best(ready));
                }
                Field::Closing(ready) => add_closing_bounds(&mut sums, *weight, ready, cells),
            }
            for i in 0..LANES {
                part.0[i] = sums.0[i] - before.0[i];
            }
        }
        sums
    }

    /// Like [`Sums::add_bounds`], for sectors. Also sets a bit in `clear` for each sector in which
    /// a formula has full utility.
    #[inline(always)]
    fn bound_sectors(
        &self,
        mut sums: Lanes<i32>,
        cells: (&CourseSpans, &SpeedSpans),
        clear: &mut [u16],
        least: i32,
    ) -> Lanes<i32> {
        let mut bounded = Bounded::new();
        let mut left = self.full;
        for ((weight, field), clear) in self.fields.iter().zip(&mut *clear) {
            if !reaches(&sums, left, least) {
                return Lanes::splat(DONE);
            }
            left -= weight.quanta(100.0);
            *clear = 0;
            match field {
                Field::Closest(ready) => {
                    bounded.measure_best(ready, cells);
                    add_worth(&mut sums, *weight, ready, bounded.best(ready));
                    if !ready.seek {
                        *clear = clear_bits(ready, &bounded.most);
                    }
                }
                Field::Closing(ready) => add_closing_bounds(&mut sums, *weight, ready, cells),
            }
        }
        if !reaches(&sums, 0, least) {
            return Lanes::splat(DONE);
        }
        // A contact that stays far away throughout a sector adds its full weight there. Most
        // contacts do, and their points need no distance.
        bounded.forget();
        for ((_, field), clear) in self.fields.iter().zip(clear) {
            // So far, `clear` has the sectors in which the upper bound of the utility is full. Keep
            // those in which every path has full utility.
            if let Field::Closest(ready) = field
                && *clear != 0
            {
                bounded.measure_least(ready, cells);
                *clear &= clear_bits(ready, &bounded.least);
            }
        }
        sums
    }

    /// The weighted sums of a tile's points, in quanta. Stops when the formulas' bounds at this
    /// place show that none can reach `least`.
    #[inline(always)]
    fn tile(
        &self,
        cells: &Cells,
        (course_tile, speed_tile): (usize, usize),
        clear: Clear<'_>,
        (parts, place, least): (&[Lanes<i32>], usize, i32),
    ) -> Lanes<i32> {
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
        let (north, east) = &cells.points[course_tile];
        let speed = &cells.point_speeds[speed_tile];
        let mut measured = Distances::new();
        let mut left: i32 = parts.iter().map(|part| part.0[place]).sum();
        for (i, ((weight, field), part)) in self.fields.iter().zip(parts).enumerate() {
            if !reaches(&sums, left, least) {
                return Lanes::splat(DONE);
            }
            left -= part.0[place];
            match field {
                _ if clear.is_so(i) => add_full(&mut sums, *weight),
                Field::Closest(ready) => {
                    measured.measure(ready, (north, east, speed));
                    add_worth(&mut sums, *weight, ready, &measured.distances);
                }
                Field::Closing(ready) => {
                    for i in 0..LANES {
                        sums.0[i] +=
                            weight.quanta(ready.utility(north.0[i], east.0[i], speed.0[i]));
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

/// Formulas with full utility throughout a sector: those that avoid a contact that no path in the
/// sector comes near.
#[derive(Clone, Copy)]
struct Clear<'a> {
    /// By formula, a bit for each sector of the group.
    of_formulas: &'a [u16],
    /// The bits of the current sectors.
    sectors: u16,
}

impl Clear<'_> {
    #[inline(always)]
    fn is_so(self, formula: usize) -> bool {
        self.of_formulas
            .get(formula)
            .is_some_and(|clear| clear & self.sectors != 0)
    }
}

/// Whether any sum reaches `least` if up to `left` is added.
#[inline(always)]
fn reaches(sums: &Lanes<i32>, left: i32, least: i32) -> bool {
    let least = least.saturating_sub(left);
    let mut reaches = false;
    for i in 0..LANES {
        reaches |= sums.0[i] >= least;
    }
    reaches
}

/// Adds the utilities of distances.
#[inline(always)]
fn add_worth(
    sums: &mut Lanes<i32>,
    weight: Weight,
    ready: &closest::Ready,
    distances: &Lanes<f32>,
) {
    for i in 0..LANES {
        sums.0[i] += weight.quanta(ready.worth(distances.0[i]));
    }
}

/// Adds the upper bounds of closing speeds over a group of cells.
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

/// A bit for each cell of a group in which this distance (m) has full utility.
#[inline(always)]
fn clear_bits(ready: &closest::Ready, least: &Lanes<f32>) -> u16 {
    let mut bits = 0_u32;
    for i in 0..LANES {
        bits |= u32::from(ready.worth(least.0[i]) >= 100.0) << i;
    }
    bits as u16
}

/// Adds a formula at full utility.
#[inline(always)]
fn add_full(sums: &mut Lanes<i32>, weight: Weight) {
    let full = weight.quanta(100.0);
    for i in 0..LANES {
        sums.0[i] += full;
    }
}

/// The upper bounds of lists and a table on the courses of one tile, for the speeds of each tile.
#[inline(always)]
fn most_of_rows(
    rows: &[Lanes<i32>],
    of_courses: &Lanes<i32>,
    of_speeds: &Lanes<i32>,
    tile: usize,
) -> Lanes<i32> {
    let k = SIDE * tile;
    let mut most = Lanes::splat(DONE);
    let mut pairs = Lanes::splat(DONE);
    let a = &rows[k].0;
    let b = &rows[k + 1].0;
    let c = &rows[k + 2].0;
    let d = &rows[k + 3].0;
    let of = &of_courses.0;
    for i in 0..LANES {
        let first = larger(a[i] + of[k], b[i] + of[k + 1]);
        let last = larger(c[i] + of[k + 2], d[i] + of[k + 3]);
        most.0[i] = larger(first, last) + of_speeds.0[i];
    }
    // The largest of each pair, then of each pair of pairs.
    for i in 0..LANES {
        pairs.0[i] = larger(most.0[i], most.0[i ^ 1]);
    }
    for i in 0..LANES {
        most.0[i] = larger(pairs.0[i], pairs.0[i ^ 2]);
    }
    most
}
