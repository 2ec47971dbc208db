//! A game that was found for a boat.

use crate::bridge::Site;
use bus::Bus;
use messages::GameInfo;
use messages::topic::GameName;
use primitives::VehicleId;

/// A game that has let the boat join.
pub(super) struct FoundGame {
    pub(super) bus: Bus,
    pub(super) game: GameName,
    pub(super) info: GameInfo,
    pub(super) vehicle: VehicleId,
    /// How many seconds of the game pass in a second of real time.
    pub(super) factor: f64,
    pub(super) site: Site,
}
