//! Squall minds: what decides for a boat. One mind a boat; it sees a [`messages::Picture`] and gives an [`messages::Order`].
//!
//! A mind cannot tell the sea from simulation: this crate never imports `sim`. Open [`Mind`] first, then [`MindRunner`],
//! which runs minds, then [`HelmMind`], which follows a strategy, then the behaviours, then [`ivp`], which weighs them.

mod behaviour;
mod helm;
pub mod ivp;
mod mind;
#[cfg(feature = "net")]
pub mod node;
mod observation;
mod own_motion;
mod pilot;
mod policy;
mod restart;
pub mod roles;
mod runner;
mod situation;
mod turning_circle;

pub use helm::HelmMind;
pub use mind::{Mind, Proposal};
pub use pilot::{Pilot, Spaces};
pub use runner::MindRunner;
pub use scenario::action::{Action, ActionSpace, SetPoint};
pub use scenario::observation::ObservationSpace;
pub use turning_circle::warnings;

use primitives::VehicleId;
use scenario::Scenario;
use scenario::strategy::Strategy;

/// The mind that the scenario's strategy gives this vehicle in the game that the scenario's seed chooses.
#[must_use]
pub fn mind_of(scenario: &Scenario, vehicle: VehicleId) -> Box<dyn Mind> {
    restart::helm_of(scenario, vehicle, roles::role_of(scenario, vehicle))
}

/// The mind that `strategy` gives this vehicle, whatever the scenario's own strategy for it is.
#[must_use]
pub fn mind_by(scenario: &Scenario, vehicle: VehicleId, strategy: &Strategy) -> Box<dyn Mind> {
    restart::helm_of(scenario, vehicle, roles::role_in(scenario, vehicle, strategy))
}

/// The minds of all vehicles, in the scenario's order.
#[must_use]
pub fn minds_of(scenario: &Scenario) -> Vec<Box<dyn Mind>> {
    (0..scenario.vehicles.len()).map(|i| mind_of(scenario, VehicleId::at(i))).collect()
}
