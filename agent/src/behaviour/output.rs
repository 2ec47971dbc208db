//! What behaviours produce at one decision: weighted objective functions, and what has become of their tasks.

use crate::ivp::{Grid, Objective, Problem};
use primitives::VehicleId;

/// A function that a behaviour added.
#[derive(Clone, Debug)]
pub(crate) struct WeightedFunction {
    /// The behaviour, by index.
    pub(crate) behaviour: usize,
    /// The contact it is about.
    pub(crate) contact: Option<VehicleId>,
    pub(crate) weight: f64,
    /// All its utilities, a row of speeds for each course; kept only while somebody looks.
    pub(crate) utilities: Vec<f32>,
}

/// The functions of all behaviours at one decision.
pub(crate) struct Functions {
    pub(crate) problem: Problem,
    pub(crate) list: Vec<WeightedFunction>,
    /// Whether utilities are kept, for those who look.
    pub(crate) shown: bool,
}

impl Functions {
    pub(crate) fn new(grid: Grid) -> Functions {
        Functions { problem: Problem::new(grid), list: Vec::new(), shown: false }
    }

    pub(crate) fn clear(&mut self) {
        self.problem.clear();
        self.list.clear();
    }
}

/// What one behaviour produces.
pub(crate) struct BehaviourOutput<'a> {
    functions: &'a mut Functions,
    behaviour: usize,
    weight: f64,
    /// Whether it influences the helm.
    pub(crate) active: bool,
    /// Reached a point.
    pub(crate) reached: bool,
    /// Is done.
    pub(crate) complete: bool,
    /// Wants the boat stopped, whatever others want.
    pub(crate) stop: bool,
}

impl<'a> BehaviourOutput<'a> {
    pub(crate) fn new(functions: &'a mut Functions, behaviour: usize, weight: f64) -> BehaviourOutput<'a> {
        BehaviourOutput { functions, behaviour, weight, active: false, reached: false, complete: false, stop: false }
    }

    /// Adds a function with all of the behaviour's weight.
    pub(crate) fn add(&mut self, objective: &Objective<'_>) {
        self.add_share(1.0, None, objective);
    }

    /// Adds a function with a share (0 to 1) of the behaviour's weight: never with more than that.
    pub(crate) fn add_share(&mut self, share: f64, contact: Option<VehicleId>, objective: &Objective<'_>) {
        let weight = self.weight * share.clamp(0.0, 1.0);
        if weight <= 0.0 {
            return;
        }
        self.active = true;
        self.functions.problem.add(weight, objective);
        let mut utilities = Vec::new();
        // A decision with its functions is a hundred thousand numbers, ten times a second and
        // boat, and most of the time nobody looks.
        if self.functions.shown {
            let grid = self.grid();
            let points = (0..grid.courses()).flat_map(|k| (0..grid.speeds()).map(move |j| (k, j)));
            utilities.extend(points.map(|(k, j)| objective.utility(grid, k, j)));
        }
        self.functions.list.push(WeightedFunction { behaviour: self.behaviour, contact, weight, utilities });
    }

    /// Wants the boat stopped.
    pub(crate) fn stop(&mut self) {
        self.active = true;
        self.stop = true;
    }

    /// The decision grid.
    pub(crate) fn grid(&self) -> &Grid {
        self.functions.problem.grid()
    }
}
