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
pub use situation::TeamView;
pub use turning_circle::warnings;

use primitives::VehicleId;
use scenario::Scenario;
use scenario::strategy::{Program, Strategy, Task};

/// The mind that the scenario's strategy assigns to this vehicle, for the scenario's seed.
pub fn mind_of(scenario: &Scenario, vehicle: VehicleId) -> Box<dyn Mind> {
    mind(scenario, vehicle, roles::role_of(scenario, vehicle))
}

/// The mind that `strategy` assigns to this vehicle, whatever the scenario's own strategy.
pub fn mind_by(scenario: &Scenario, vehicle: VehicleId, strategy: &Strategy) -> Box<dyn Mind> {
    let program = roles::role_in(scenario, vehicle, strategy);
    mind(scenario, vehicle, program)
}

/// A helm, or a policy that steers without one.
fn mind(scenario: &Scenario, vehicle: VehicleId, program: &Program) -> Box<dyn Mind> {
    let direct = program
        .behaviours
        .iter()
        .find_map(|behaviour| match &behaviour.task {
            Task::Policy(policy) if policy.direct => Some((policy.model.clone()?, policy.sampled)),
            _ => None,
        });
    let Some((model, is_sampled)) = direct else {
        return Box::new(HelmMind::restarting(scenario, vehicle, program));
    };
    let spaces = Spaces {
        observation: model.spec.observation,
        action: model.spec.action,
    };
    Box::new(Pilot::direct(scenario, vehicle, spaces).by_model(model, is_sampled))
}

/// The minds of all vehicles, in the scenario's order.
pub fn minds_of(scenario: &Scenario) -> Vec<Box<dyn Mind>> {
    (0..scenario.vehicles.len())
        .map(|i| mind_of(scenario, VehicleId::at(i)))
        .collect()
}
