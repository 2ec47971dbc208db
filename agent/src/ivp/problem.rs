//! One decision: collects functions and finds the best course and speed.

use super::cell::Cells;
use super::fixed::{FUNCTIONS_MAX, QUANTUM, Weight};
use super::grid::Grid;
use super::objective::Objective;
use super::search::{Bounds, Present, Search};
use super::sums::Sums;
use primitives::instructions::Instructions;
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// A point of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decision {
    /// Index of the course.
    pub course: usize,
    /// Index of the speed.
    pub speed: usize,
}

/// Tie-breaker between equally good candidates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Preference {
    /// Own ship's current course, rad.
    pub course_rad: f64,
    /// Own ship's current speed, m/s.
    pub speed_m_s: f64,
}

/// The result of a decision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The chosen point.
    pub decision: Decision,
    /// The point's weighted sum: the largest on the grid.
    pub value: f64,
    /// Number of points evaluated, some counted twice; no other point could win.
    pub evaluated: usize,
}

/// A grid and its cells, shared by all problems on equal grids, so that a large fleet's grids fit
/// in the processor's cache.
#[derive(Debug)]
struct Layout {
    grid: Grid,
    cells: Cells,
    /// Buffers for later searches; at most as many as searches have run at the same time.
    spare: Mutex<Vec<Bounds>>,
}

static LAYOUTS: Mutex<Vec<Weak<Layout>>> = Mutex::new(Vec::new());

impl Layout {
    fn of(grid: Grid) -> Arc<Layout> {
        let mut known = LAYOUTS.lock().unwrap_or_else(PoisonError::into_inner);
        known.retain(|layout| layout.strong_count() > 0);
        let mut in_use = known.iter().filter_map(Weak::upgrade);
        in_use
            .find(|layout| layout.grid.is_same(&grid))
            .unwrap_or_else(|| {
                let cells = Cells::new(&grid);
                let spare = Mutex::default();
                let new = Arc::new(Layout { grid, cells, spare });
                known.push(Arc::downgrade(&new));
                new
            })
    }
}

/// The functions of one decision, prepared for summation. The lists are reused for the next
/// decision.
#[derive(Clone, Debug)]
pub struct Problem {
    layout: Arc<Layout>,
    instructions: Instructions,
    sums: Sums,
    functions: usize,
    /// Whether any function distinguishes courses.
    pub decides_course: bool,
    /// Whether any function distinguishes speeds.
    pub decides_speed: bool,
    /// The last result, which is usually nearly as good at the next decision.
    found: Option<Decision>,
}

impl Problem {
    /// A problem on this grid, without functions.
    pub fn new(grid: Grid) -> Problem {
        Problem::with_instructions(grid, Instructions::best())
    }

    /// A problem on this grid, without functions, solved with this instruction set, which affects
    /// only the speed.
    pub fn with_instructions(grid: Grid, instructions: Instructions) -> Problem {
        let layout = Layout::of(grid);
        Problem {
            sums: Sums::new(&layout.grid),
            instructions,
            functions: 0,
            decides_course: false,
            decides_speed: false,
            found: None,
            layout,
        }
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.layout.grid
    }

    /// Removes all functions.
    pub fn clear(&mut self) {
        self.sums.clear(&self.layout.grid);
        self.functions = 0;
        self.decides_course = false;
        self.decides_speed = false;
    }

    /// Adds a function with its priority weight, 0 to [`WEIGHT_MAX`](super::WEIGHT_MAX).
    ///
    /// # Panics
    /// With more than [`FUNCTIONS_MAX`] functions, or with a table whose size differs from the
    /// grid's.
    pub fn add(&mut self, weight: f64, objective: &Objective) {
        assert!(
            self.functions < FUNCTIONS_MAX,
            "more than {FUNCTIONS_MAX} functions"
        );
        let weight = Weight::new(weight);
        self.functions += 1;
        // Count the function anyway: whether a helm has a preference must not depend on weights
        // that happen to be zero.
        if weight.is_zero() {
            return;
        }
        self.decides_course |= objective.decides_course();
        self.decides_speed |= objective.decides_speed();
        self.sums
            .add(&self.layout.grid, self.instructions, weight, objective);
    }

    /// The number of functions.
    pub fn len(&self) -> usize {
        self.functions
    }

    /// Whether there are no functions.
    pub fn is_empty(&self) -> bool {
        self.functions == 0
    }

    /// The best decision, with exactly the largest weighted sum on the grid.
    ///
    /// Ties go to the course with the smallest angle from the current one, then to starboard; on
    /// that course, to the speed nearest to the current one, then to the lower speed.
    pub fn solve(&mut self, preference: Preference) -> Choice {
        let Layout { grid, cells, spare } = &*self.layout;
        let spare = || spare.lock().unwrap_or_else(PoisonError::into_inner);
        let bounds = spare().pop();
        let mut bounds = bounds.unwrap_or_else(|| Bounds::new(cells));
        let search = Search {
            grid,
            cells,
            sums: &self.sums,
            bounds: &mut bounds,
            present: Present {
                course: grid.ticks_of(preference.course_rad),
                speed_m_s: preference.speed_m_s,
            },
            // With a good first guess, most cells are skipped at once. The guess changes how many
            // points are evaluated, but never the result.
            guess: self.found,
        };
        let (best, evaluated) = self.instructions.run(search);
        spare().push(bounds);
        self.found = Some(best.decision);
        Choice {
            decision: best.decision,
            value: f64::from(best.value) * QUANTUM,
            evaluated,
        }
    }
}
