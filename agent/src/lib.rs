//! Squall minds: what decides for a boat. One mind a boat; it sees a [`Picture`] and gives an [`Order`].
//!
//! A mind cannot tell the sea from simulation: this crate never imports `sim`. Open [`Mind`] first,
//! then [`mind_of`], then the roles.

mod easy_attacker;
mod easy_defender;
mod helm;
mod idle;
pub mod ivp;
#[cfg(feature = "net")]
pub mod node;
pub mod roles;

use game::scenario::{Role, Scenario};
use game::{Order, Picture, VehicleId};

/// What decides for one boat.
///
/// The same pictures, from the first on, must give the same orders on every machine: a mind reads no
/// clock and takes randomness only from its own [`game::stream::Stream`].
pub trait Mind: Send {
    /// Decides on the newest picture.
    fn decide(&mut self, picture: &Picture) -> Order;
}

/// The mind that the scenario's strategy gives this vehicle in the game that the scenario's seed chooses.
#[must_use]
pub fn mind_of(scenario: &Scenario, vehicle: VehicleId) -> Box<dyn Mind> {
    let strategy = &scenario.strategies[scenario.vehicles[vehicle.index()].strategy];
    match roles::role_of(scenario, vehicle) {
        Role::EasyAttacker => {
            Box::new(easy_attacker::EasyAttackerMind::new(scenario, vehicle, &strategy.easy_attacker))
        }
        Role::EasyDefender => {
            Box::new(easy_defender::EasyDefenderMind::new(scenario, vehicle, &strategy.easy_defender))
        }
        Role::Idle => Box::new(idle::IdleMind),
    }
}

/// The minds of all vehicles, in the scenario's order.
#[must_use]
pub fn minds_of(scenario: &Scenario) -> Vec<Box<dyn Mind>> {
    (0..scenario.vehicles.len()).map(|i| mind_of(scenario, VehicleId::at(i))).collect()
}
