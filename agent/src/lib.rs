//! Squall minds: the decision-makers of boats. Each boat has one; it receives a
//! [`messages::Picture`] and returns an [`messages::Order`].
//!
//! A mind cannot tell a real sea from a simulated one: this crate never imports `sim`. Open
//! [`Mind`] first, then [`MindRunner`], which runs minds, then [`HelmMind`], which follows a
//! strategy, then the behaviours, and then [`ivp`], which weighs them.

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

/// The mind that the scenario's strategy assigns to this vehicle, for the scenario's seed.
pub fn mind_of(scenario: &Scenario, vehicle: VehicleId) -> Box<dyn Mind> {
    Box::new(HelmMind::restarting(
        scenario,
        vehicle,
        roles::role_of(scenario, vehicle),
    ))
}

/// The mind that `strategy` assigns to this vehicle, whatever the scenario's own strategy.
pub fn mind_by(scenario: &Scenario, vehicle: VehicleId, strategy: &Strategy) -> Box<dyn Mind> {
    Box::new(HelmMind::restarting(
        scenario,
        vehicle,
        roles::role_in(scenario, vehicle, strategy),
    ))
}

/// The minds of all vehicles, in the scenario's order.
pub fn minds_of(scenario: &Scenario) -> Vec<Box<dyn Mind>> {
    (0..scenario.vehicles.len())
        .map(|i| mind_of(scenario, VehicleId::at(i)))
        .collect()
}
