//! The settings of an agent node.

use crate::Mind;
use bus::Place;
use messages::topic::GameName;
use primitives::VehicleId;
use scenario::Scenario;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Creates the minds of vehicles.
pub type MindMaker = dyn Fn(&Scenario, &[VehicleId]) -> Vec<(VehicleId, Box<dyn Mind>)> + Send;

/// Settings of an agent node.
pub struct Settings {
    /// The game to join; `None` means the only one available.
    pub game: Option<GameName>,
    /// The address of the sim.
    pub place: Place,
    /// Names of the vehicles for which to decide.
    pub vehicles: Vec<String>,
    /// Maximum time to search for the sim and to wait for free vehicles.
    pub wait: Duration,
    /// Time without a picture after which the sim is treated as lost.
    pub silence: Duration,
    /// Creates the minds; `None` uses the scenario's strategies.
    pub minds: Option<Box<MindMaker>>,
    /// In lockstep: maximum wait for a policy's proposal at every decision, limited to half of the
    /// scenario's `patience_s`.
    pub policy_wait: Duration,
    /// Set by the caller to leave the game.
    pub stop: Arc<AtomicBool>,
}
