//! A bid: what one behaviour asks of the helm at one decision.

use crate::ivp::{Grid, Objective, Problem};
use game::VehicleId;

/// A function that a behaviour added.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    /// The behaviour, by index.
    pub(crate) behaviour: usize,
    /// The contact it is about.
    pub(crate) contact: Option<VehicleId>,
    pub(crate) weight: f64,
    /// All its utilities, a row of speeds for each course; kept only while somebody looks.
    pub(crate) utilities: Vec<f32>,
}

/// What one behaviour asks for.
pub(crate) struct Bid<'a> {
    problem: &'a mut Problem,
    entries: &'a mut Vec<Entry>,
    behaviour: usize,
    weight: f64,
    /// Whether utilities are kept for those who look.
    shown: bool,
    /// Whether it asked for anything.
    pub(crate) active: bool,
    /// Reached a point.
    pub(crate) reached: bool,
    /// Is done.
    pub(crate) complete: bool,
    /// Wants the boat stopped, whatever others want.
    pub(crate) stop: bool,
}

impl<'a> Bid<'a> {
    pub(crate) fn new(
        problem: &'a mut Problem,
        entries: &'a mut Vec<Entry>,
        (behaviour, weight): (usize, f64),
        shown: bool,
    ) -> Bid<'a> {
        Bid { problem, entries, behaviour, weight, shown, active: false, reached: false, complete: false, stop: false }
    }

    /// Asks for something with all of the behaviour's weight.
    pub(crate) fn ask(&mut self, objective: &Objective<'_>) {
        self.ask_for(1.0, None, objective);
    }

    /// Asks for something with a share (0 to 1) of the behaviour's weight: never with more than that.
    pub(crate) fn ask_for(&mut self, share: f64, contact: Option<VehicleId>, objective: &Objective<'_>) {
        let weight = self.weight * share.clamp(0.0, 1.0);
        if weight <= 0.0 {
            return;
        }
        self.active = true;
        self.problem.add(weight, objective);
        let grid = self.problem.grid();
        let mut utilities = Vec::new();
        if self.shown {
            let points = (0..grid.courses()).flat_map(|k| (0..grid.speeds()).map(move |j| (k, j)));
            utilities.extend(points.map(|(k, j)| objective.utility(grid, k, j)));
        }
        self.entries.push(Entry { behaviour: self.behaviour, contact, weight, utilities });
    }

    /// Wants the boat stopped.
    pub(crate) fn stop(&mut self) {
        self.active = true;
        self.stop = true;
    }

    /// The decision grid.
    pub(crate) fn grid(&self) -> &Grid {
        self.problem.grid()
    }
}
