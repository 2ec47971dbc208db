//! Squall minds: what decides for a boat. One mind a boat; it sees a [`Picture`] and gives an [`Order`].
//!
//! A mind cannot tell the sea from simulation: this crate never imports `sim`. Open [`Mind`] first, then [`MindRunner`],
//! which runs minds, then [`HelmMind`], which follows a strategy, then the behaviours, then [`ivp`], which weighs them.

mod behaviour;
mod helm;
pub mod ivp;
#[cfg(feature = "net")]
pub mod node;
pub mod roles;
mod runner;

pub use helm::HelmMind;
pub use runner::MindRunner;

use game::helm::HelmReport;
use game::message::Word;
use game::scenario::Scenario;
use game::strategy::{Proposer, Strategy};
use game::{Order, Picture, SimTime, VehicleId};

/// What decides for one boat.
///
/// The same pictures, words and proposals, from the first on, must give the same orders on every machine: a mind reads no
/// clock and takes randomness only from its own [`game::stream::Stream`].
pub trait Mind: Send {
    /// Decides on the newest picture.
    fn decide(&mut self, picture: &Picture) -> Order;

    /// Whether the boat tells its team anything, ever: then it hears its mates too.
    fn talks(&self) -> bool {
        false
    }

    /// Who may propose courses and speeds to it, if anybody.
    fn proposer(&self) -> Option<Proposer> {
        None
    }

    /// Adds what the boat tells its team after deciding.
    fn say(&self, _words: &mut Vec<Word>) {}

    /// Hears what mates said after the decision before.
    fn hear(&mut self, _words: &[Word]) {}

    /// Hears what a policy proposes, and as of when.
    fn propose(&mut self, _at: SimTime, _proposal: Proposal) {}

    /// Whether somebody looks inside: from the next decision on the utilities of all functions are kept for
    /// [`Mind::report`].
    fn show(&mut self, _shown: bool) {}

    /// What the mind thinks, if it goes by a helm.
    fn report(&self) -> Option<HelmReport> {
        None
    }
}

/// A course and a speed that somebody proposes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proposal {
    /// Desired course, rad clockwise from north.
    pub course_rad: f64,
    /// Desired speed, m/s.
    pub speed_m_s: f64,
}

/// The mind that the scenario's strategy gives this vehicle in the game that the scenario's seed chooses.
#[must_use]
pub fn mind_of(scenario: &Scenario, vehicle: VehicleId) -> Box<dyn Mind> {
    Box::new(HelmMind::new(scenario, vehicle, roles::role_of(scenario, vehicle)))
}

/// The mind that `strategy` gives this vehicle, whatever the scenario's own strategy for it is.
#[must_use]
pub fn mind_by(scenario: &Scenario, vehicle: VehicleId, strategy: &Strategy) -> Box<dyn Mind> {
    Box::new(HelmMind::new(scenario, vehicle, roles::role_in(scenario, vehicle, strategy)))
}

/// The minds of all vehicles, in the scenario's order.
#[must_use]
pub fn minds_of(scenario: &Scenario) -> Vec<Box<dyn Mind>> {
    (0..scenario.vehicles.len()).map(|i| mind_of(scenario, VehicleId::at(i))).collect()
}
