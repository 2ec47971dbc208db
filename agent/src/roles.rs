//! Role assignment: deals a strategy's roles to the boats of a team.

use primitives::VehicleId;
use primitives::stream::Stream;
use scenario::Scenario;
use scenario::strategy::{Assignment, Program, Strategy};

/// The role of a vehicle in the game with the scenario's seed.
///
/// The roles are dealt to the boats of the team that follow the same strategy, in the scenario's
/// order, restarting from the first role when they run out. A seeded deal shuffles them with the
/// team's own stream. Every mind of a team computes the same result on its own.
pub fn role_of(scenario: &Scenario, vehicle: VehicleId) -> &Program {
    let me = &scenario.vehicles[vehicle.index()];
    dealt(scenario, vehicle, scenario.strategy_of(vehicle), |i| {
        scenario.vehicles[i].strategy == me.strategy
    })
}

/// The role that `strategy` would give a vehicle if its whole team followed `strategy`, whatever
/// strategy the scenario gives it.
pub fn role_in<'a>(scenario: &Scenario, vehicle: VehicleId, strategy: &'a Strategy) -> &'a Program {
    dealt(scenario, vehicle, strategy, |_| true)
}

fn dealt<'a>(
    scenario: &Scenario,
    vehicle: VehicleId,
    strategy: &'a Strategy,
    follows: impl Fn(usize) -> bool,
) -> &'a Program {
    let team = scenario.team_of(vehicle);
    let boats: Vec<usize> = (0..scenario.vehicles.len())
        .filter(|i| scenario.vehicles[*i].team == team && follows(*i))
        .collect();
    let mut roles: Vec<usize> = (0..strategy.roles.len())
        .cycle()
        .take(boats.len())
        .collect();
    if strategy.assignment == Assignment::Seeded {
        let team = &scenario.teams[team.index()].name;
        // Use one stream per team name, so that neither another team nor other draws change this
        // deal.
        Stream::new(scenario.seed, &format!("roles/{team}")).shuffle(&mut roles);
    }
    let place = boats
        .iter()
        .position(|i| *i == vehicle.index())
        .expect("the vehicle follows the strategy");
    &strategy.roles[roles[place]]
}
