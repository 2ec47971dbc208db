//! The real boats of a game, which require real time.

use super::{Scenario, Source};
use primitives::id::VehicleId;
use thiserror::Error;

/// The error for a game with real boats that would run without a clock.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "{} (source = \"external\") can run in real time only: use --pace realtime, or --rehearse to simulate every boat",
    .names.join(", ")
)]
pub struct RealBoats {
    /// The names of the real boats.
    pub names: Vec<String>,
}

impl Scenario {
    /// The vehicles that are real boats, in order.
    pub fn externals(&self) -> impl Iterator<Item = VehicleId> {
        let is_external = |i: &usize| self.vehicles[*i].source == Source::External;
        (0..self.vehicles.len())
            .filter(is_external)
            .map(VehicleId::at)
    }

    /// Checks that the game can run without a clock: all boats are simulated.
    ///
    /// # Errors
    /// [`RealBoats`] with the names of the real boats.
    pub fn has_no_real_boats(&self) -> Result<(), RealBoats> {
        let names = self
            .externals()
            .map(|v| self.vehicles[v.index()].name.clone());
        let names: Vec<String> = names.collect();
        if names.is_empty() {
            Ok(())
        } else {
            Err(RealBoats { names })
        }
    }
}
