//! Steadiness: of two decisions that are nearly as good, the helm takes the one near the last.
//!
//! Where a scene has two ways out, noise makes now one the better and now the other, and a boat that obeys at once follows
//! neither. What is near the last decision is therefore worth a little more. The best near it is free to move as things go on,
//! so that nothing is held up but a change of mind.

use crate::ivp::{Choice, Decision, FUNCTIONS_MAX, Grid, Objective, Peak, Problem};

/// Courses within this of the last one are near it, rad.
const NEAR_RAD: f64 = std::f64::consts::FRAC_PI_6;
/// Speeds within this of the last one are near it, m/s.
const NEAR_M_S: f64 = 0.75;
/// From what is near down to nothing, rad or m/s: a step, but for rounding.
const STEP: f64 = 1e-6;

/// What is near the last decision is worth more by this.
pub(super) struct Steadiness {
    objective: Objective<'static>,
    weight: f64,
}

impl Steadiness {
    /// Adds it to a problem, of half this weight for course and half for speed; nothing without a weight.
    pub(super) fn new(problem: &mut Problem, last: Decision, weight: f64) -> Option<Steadiness> {
        // A full problem has no room for it; a checked program never asks for so many.
        if weight <= 0.0 || problem.len() >= FUNCTIONS_MAX {
            return None;
        }
        // What is near the last decision, not the decision itself: holding that made a boat lag
        // behind whatever moves.
        let near = |summit, peak_width| Peak { summit, peak_width, base_width: STEP, summit_delta: 0.0, height: 100.0 };
        let grid = problem.grid();
        let objective = Objective::Coupled {
            course: near(grid.course_rad(usize::from(last.course)), NEAR_RAD),
            speed: near(grid.speed_m_s(usize::from(last.speed)), NEAR_M_S),
            course_share: 0.5,
        };
        problem.add(weight, &objective);
        Some(Steadiness { objective, weight })
    }

    /// A choice by the value that behaviours give it.
    pub(super) fn without(&self, grid: &Grid, choice: Choice) -> Choice {
        let (course, speed) = (usize::from(choice.decision.course), usize::from(choice.decision.speed));
        let extra = f64::from(self.objective.contribution(grid, self.weight, course, speed)) * crate::ivp::QUANTUM;
        Choice { value: choice.value - extra, ..choice }
    }
}
