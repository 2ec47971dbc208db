//! Vectorised contact distances, computed once for all functions that share them.

use super::cell::{CourseSpans, SpeedSpans, cell};
use super::closest::Ready;
use super::lanes::{LANES, Lanes};
use super::turn::{Fan, Turn};

/// Turns to a group of courses.
struct Turns {
    duration: Lanes<f32>,
    by_north: Lanes<f32>,
    by_east: Lanes<f32>,
}

impl Turns {
    #[inline(always)]
    fn new() -> Turns {
        Turns {
            duration: Lanes::splat(0.0),
            by_north: Lanes::splat(0.0),
            by_east: Lanes::splat(0.0),
        }
    }

    #[inline(always)]
    fn set(&mut self, i: usize, turn: &Turn) {
        self.duration.0[i] = turn.duration;
        (self.by_north.0[i], self.by_east.0[i]) = turn.by;
    }

    #[inline(always)]
    fn at(&self, i: usize) -> Turn {
        Turn {
            duration: self.duration.0[i],
            by: (self.by_north.0[i], self.by_east.0[i]),
        }
    }
}

/// Contact distances at a group of points. Caches the last result.
pub(super) struct Distances<'a> {
    known: Option<&'a Ready>,
    turns: Turns,
    /// Distances at the closest point of approach, m.
    pub(super) distances: Lanes<f32>,
}

impl<'a> Distances<'a> {
    #[inline(always)]
    pub(super) fn new() -> Distances<'a> {
        Distances {
            known: None,
            turns: Turns::new(),
            distances: Lanes::splat(0.0),
        }
    }

    /// Computes the distances for courses (unit vectors, north and east) at speeds.
    #[inline(always)]
    pub(super) fn measure(
        &mut self,
        ready: &'a Ready,
        (north, east, speed): (&Lanes<f32>, &Lanes<f32>, &Lanes<f32>),
    ) {
        // Functions of a group are stored consecutively, so only the last distances are cached.
        if self.known.is_some_and(|known| ready.group == known.group) {
            return;
        }
        let turning = ready.turning;
        // Own ship's turns are the same for all contacts; each costs a square root.
        if self.known.is_none_or(|known| turning != known.turning) {
            for i in 0..LANES {
                self.turns.set(i, &turning.to((north.0[i], east.0[i])));
            }
        }
        self.known = Some(ready);
        for i in 0..LANES {
            self.distances.0[i] =
                ready.distance(&self.turns.at(i), (north.0[i], east.0[i]), speed.0[i]);
        }
    }
}

/// Bounds of contact distances over a group of cells. Caches the last result.
pub(super) struct Bounded<'a> {
    /// The formula whose turns are known, and the group of the last result.
    known: Option<&'a Ready>,
    group: Option<usize>,
    first: Turns,
    last: Turns,
    off: Lanes<f32>,
    off_s: Lanes<f32>,
    /// Lower bounds of the distances, m.
    pub(super) least: Lanes<f32>,
    pub(super) most: Lanes<f32>,
}

impl<'a> Bounded<'a> {
    #[inline(always)]
    pub(super) fn new() -> Bounded<'a> {
        let zeros = Lanes::splat(0.0);
        let first = Turns::new();
        let last = Turns::new();
        Bounded {
            known: None,
            group: None,
            first,
            last,
            off: zeros,
            off_s: zeros,
            least: zeros,
            most: zeros,
        }
    }

    /// Computes the lower bound of the distances, whether the contact is avoided or approached.
    #[inline(always)]
    pub(super) fn measure_least(&mut self, ready: &'a Ready, cells: (&CourseSpans, &SpeedSpans)) {
        if self.turn(ready, cells) {
            for i in 0..LANES {
                self.least.0[i] =
                    ready.least(&ready.ways(&self.fan(i), &cell(cells.0, cells.1, i)));
            }
        }
    }

    /// The bound with the higher utility, once computed.
    #[inline(always)]
    pub(super) fn best(&self, ready: &Ready) -> &Lanes<f32> {
        if ready.seek { &self.least } else { &self.most }
    }

    /// Clears the last result, but not the turns, for a different kind of bound.
    #[inline(always)]
    pub(super) fn forget(&mut self) {
        self.group = None;
    }

    /// Computes the bound with the higher utility.
    #[inline(always)]
    pub(super) fn measure_best(&mut self, ready: &'a Ready, cells: (&CourseSpans, &SpeedSpans)) {
        if !self.turn(ready, cells) {
            return;
        }
        if ready.seek {
            for i in 0..LANES {
                self.least.0[i] =
                    ready.least(&ready.ways(&self.fan(i), &cell(cells.0, cells.1, i)));
            }
        } else {
            for i in 0..LANES {
                self.most.0[i] = ready.most(&ready.ways(&self.fan(i), &cell(cells.0, cells.1, i)));
            }
        }
    }

    /// Computes the turns unless cached. Returns whether distances must be measured.
    #[inline(always)]
    fn turn(&mut self, ready: &'a Ready, cells: (&CourseSpans, &SpeedSpans)) -> bool {
        if self.group.replace(ready.group) == Some(ready.group) {
            return false;
        }
        let turning = ready.turning;
        if self.known.is_none_or(|known| turning != known.turning) {
            for i in 0..LANES {
                let fan = turning.fan(&cell(cells.0, cells.1, i));
                self.first.set(i, &fan.first);
                self.last.set(i, &fan.last);
                self.off.0[i] = fan.off;
                self.off_s.0[i] = fan.off_s;
            }
        }
        self.known = Some(ready);
        true
    }

    #[inline(always)]
    fn fan(&self, i: usize) -> Fan {
        Fan {
            first: self.first.at(i),
            last: self.last.at(i),
            off: self.off.0[i],
            off_s: self.off_s.0[i],
        }
    }
}
