//! Steadiness: of two nearly equal decisions, the helm prefers the one nearer to the last decision.
//!
//! If a scene has two ways out, noise favours one, then the other, and a boat that switches at once
//! takes neither. Candidates near the last decision therefore get a small bonus. The best of them
//! may still move with the scene, so only changes of mind are delayed.

use crate::ivp::{Choice, Decision, FUNCTIONS_MAX, Grid, Objective, Peak, Problem};

/// Courses within this angle of the last one count as near, rad.
const NEAR_RAD: f64 = std::f64::consts::FRAC_PI_6;
/// Speeds within this difference of the last one count as near, m/s.
const NEAR_M_S: f64 = 0.75;
/// Width over which the bonus falls to zero, rad or m/s: a step, apart from rounding.
const STEP: f64 = 1e-6;

/// The bonus for candidates near the last decision.
pub(super) struct Steadiness {
    objective: Objective<'static>,
    weight: f64,
}

impl Steadiness {
    /// Adds the bonus to a problem, half of the weight for course and half for speed; `None` at
    /// weight 0.
    pub(super) fn new(problem: &mut Problem, last: Decision, weight: f64) -> Option<Steadiness> {
        // A full problem has no space for the bonus; a checked program never has that many
        // functions.
        if weight <= 0.0 || problem.len() >= FUNCTIONS_MAX {
            return None;
        }
        // The bonus applies near the last decision, not only at it: a bonus for the exact decision
        // made boats lag behind moving targets.
        let near = |summit, peak_width| Peak {
            summit,
            peak_width,
            base_width: STEP,
            summit_delta: 0.0,
            height: 100.0,
        };
        let grid = problem.grid();
        let objective = Objective::Coupled {
            course: near(grid.course_rad(last.course), NEAR_RAD),
            speed: near(grid.speed_m_s(last.speed), NEAR_M_S),
            course_share: 0.5,
        };
        problem.add(weight, &objective);
        Some(Steadiness { objective, weight })
    }

    /// The choice with its value from behaviours alone, without the bonus.
    pub(super) fn without(&self, grid: &Grid, choice: Choice) -> Choice {
        let Decision { course, speed } = choice.decision;
        let extra = f64::from(
            self.objective
                .contribution(grid, self.weight, course, speed),
        ) * crate::ivp::QUANTUM;
        Choice {
            value: choice.value - extra,
            ..choice
        }
    }
}
