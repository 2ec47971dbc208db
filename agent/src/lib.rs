//! Squall minds: the decision-makers of boats. Each boat has one; it receives a
//! [`messages::Picture`] and returns an [`messages::Order`].
//!
//! A mind cannot tell a real sea from a simulated one: this crate never imports `sim`. Open
//! [`Mind`] first, then [`MindRunner`], which runs minds, then [`HelmMind`], which follows a
//! strategy, and finally the behaviours and [`ivp`], which weighs them.

mod behaviour;
mod helm;
mod host;
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

use host::{Entries, HostMind};
use primitives::VehicleId;
use scenario::Scenario;
use scenario::strategy::{Program, Strategy, Task};

/// The mind that the scenario's strategy assigns to this vehicle, for the scenario's seed.
pub fn mind_of(scenario: &Scenario, vehicle: VehicleId) -> Box<dyn Mind> {
    let role = roles::role_of(scenario, vehicle);
    mind(scenario, vehicle, role, &mut Entries::default())
}

/// The mind that `strategy` assigns to this vehicle, whatever its own strategy in the scenario.
pub fn mind_by(scenario: &Scenario, vehicle: VehicleId, strategy: &Strategy) -> Box<dyn Mind> {
    let role = roles::role_in(scenario, vehicle, strategy);
    mind(scenario, vehicle, role, &mut Entries::default())
}

/// The minds that the scenario's strategies, or else `strategy`, assign to these vehicles. Boats of
/// a team share the process of their competition entry.
pub fn minds_for(
    scenario: &Scenario,
    vehicles: impl IntoIterator<Item = VehicleId>,
    strategy: Option<&Strategy>,
) -> Vec<(VehicleId, Box<dyn Mind>)> {
    let mut entries = Entries::default();
    let mut mind = |vehicle| {
        let role = match strategy {
            Some(strategy) => roles::role_in(scenario, vehicle, strategy),
            None => roles::role_of(scenario, vehicle),
        };
        (vehicle, mind(scenario, vehicle, role, &mut entries))
    };
    vehicles.into_iter().map(&mut mind).collect()
}

/// A helm, or a policy that steers without a helm.
fn mind(
    scenario: &Scenario,
    vehicle: VehicleId,
    program: &Program,
    entries: &mut Entries,
) -> Box<dyn Mind> {
    let mut policies = program
        .behaviours
        .iter()
        .filter_map(|behaviour| match &behaviour.task {
            Task::Policy(policy) => Some(policy),
            _ => None,
        });
    if let Some(host) = program.host() {
        let is_direct = policies.any(|policy| policy.direct);
        let entry = entries.entry(scenario, vehicle, host);
        return Box::new(HostMind::new(
            scenario,
            vehicle,
            (program, is_direct),
            entry,
        ));
    }
    let direct = policies.find(|policy| policy.direct);
    let Some((model, is_sampled)) =
        direct.and_then(|policy| Some((policy.model.clone()?, policy.sampled)))
    else {
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
    let vehicles = (0..scenario.vehicles.len()).map(VehicleId::at);
    let minds = minds_for(scenario, vehicles, None);
    minds.into_iter().map(|(_, mind)| mind).collect()
}
