//! A game found for a boat.

use crate::bridge::Site;
use bus::Bus;
use messages::GameInfo;
use messages::topic::GameName;
use primitives::VehicleId;

/// A game that the boat has joined.
pub(super) struct FoundGame {
    pub(super) bus: Bus,
    pub(super) game: GameName,
    pub(super) info: GameInfo,
    pub(super) vehicle: VehicleId,
    /// Seconds of game time per second of real time.
    pub(super) factor: f64,
    pub(super) site: Site,
}
