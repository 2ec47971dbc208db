//! The output of behaviours at one decision: weighted objective functions and task status.

use crate::ivp::{Grid, Objective, Problem};
use primitives::VehicleId;

/// A function that a behaviour added.
#[derive(Clone, Debug)]
pub(crate) struct WeightedFunction {
    /// Index of the behaviour.
    pub(crate) behaviour: usize,
    /// The contact concerned.
    pub(crate) contact: Option<VehicleId>,
    pub(crate) weight: f64,
    /// All utilities, a row of speeds for each course; kept only on request.
    pub(crate) utilities: Vec<f32>,
}

/// The functions of all behaviours at one decision.
#[derive(Clone)]
pub(crate) struct Functions {
    pub(crate) problem: Problem,
    pub(crate) list: Vec<WeightedFunction>,
    /// Whether to keep utilities for helm reports.
    pub(crate) shown: bool,
}

impl Functions {
    pub(crate) fn new(grid: Grid) -> Functions {
        Functions {
            problem: Problem::new(grid),
            list: Vec::new(),
            shown: false,
        }
    }

    pub(crate) fn clear(&mut self) {
        self.problem.clear();
        self.list.clear();
    }
}

pub(crate) struct BehaviourOutput<'a> {
    functions: &'a mut Functions,
    behaviour: usize,
    weight: f64,
    /// Whether the behaviour influences the helm.
    pub(crate) active: bool,
    /// Whether the behaviour has reached a waypoint.
    pub(crate) reached: bool,
    pub(crate) complete: bool,
    /// Whether the behaviour requires the boat to stop, whatever other behaviours want.
    pub(crate) stop: bool,
}

impl<'a> BehaviourOutput<'a> {
    pub(crate) fn new(
        functions: &'a mut Functions,
        behaviour: usize,
        weight: f64,
    ) -> BehaviourOutput<'a> {
        BehaviourOutput {
            functions,
            behaviour,
            weight,
            active: false,
            reached: false,
            complete: false,
            stop: false,
        }
    }

    /// Adds a function at the behaviour's full weight.
    pub(crate) fn add(&mut self, objective: &Objective<'_>) {
        self.add_share(1.0, None, objective);
    }

    /// Adds a function at a fraction (0 to 1) of the behaviour's weight; larger values are clamped.
    pub(crate) fn add_share(
        &mut self,
        share: f64,
        contact: Option<VehicleId>,
        objective: &Objective<'_>,
    ) {
        let weight = self.weight * share.clamp(0.0, 1.0);
        if weight <= 0.0 {
            return;
        }
        self.active = true;
        self.functions.problem.add(weight, objective);
        let mut utilities = Vec::new();
        // The functions of a decision amount to 100,000 numbers, ten times a second per boat, and
        // are rarely requested.
        if self.functions.shown {
            let grid = self.grid();
            utilities.extend(grid.points().map(|(k, j)| objective.utility(grid, k, j)));
        }
        self.functions.list.push(WeightedFunction {
            behaviour: self.behaviour,
            contact,
            weight,
            utilities,
        });
    }

    /// Requires the boat to stop.
    pub(crate) fn stop(&mut self) {
        self.active = true;
        self.stop = true;
    }

    pub(crate) fn grid(&self) -> &Grid {
        self.functions.problem.grid()
    }
}
