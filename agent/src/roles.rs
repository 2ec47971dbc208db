//! Who plays which role: a strategy's roles dealt to the boats of a team.

use game::VehicleId;
use game::scenario::{Assignment, Role, Scenario};
use game::stream::Stream;

/// The role of a vehicle in the game that the scenario's seed chooses.
///
/// The roles are dealt to the team's boats of the same strategy, in the scenario's order, and again
/// from the first role when they run out; a seeded deal shuffles them by the team's own stream. Every
/// mind of a team comes to the same result by itself.
#[must_use]
pub fn role_of(scenario: &Scenario, vehicle: VehicleId) -> Role {
    let me = &scenario.vehicles[vehicle.index()];
    let strategy = &scenario.strategies[me.strategy];
    let dealt_to = |i: &usize| scenario.vehicles[*i].team == me.team && scenario.vehicles[*i].strategy == me.strategy;
    let boats: Vec<usize> = (0..scenario.vehicles.len()).filter(dealt_to).collect();
    let mut roles: Vec<Role> = strategy.roles.iter().copied().cycle().take(boats.len()).collect();
    if strategy.assignment == Assignment::Seeded {
        let team = &scenario.teams[me.team.index()].name;
        Stream::new(scenario.seed, &format!("roles/{team}")).shuffle(&mut roles);
    }
    let place = boats.iter().position(|i| *i == vehicle.index());
    place.and_then(|place| roles.get(place)).copied().unwrap_or(Role::Idle)
}
