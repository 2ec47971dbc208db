//! The settings of an agent node.

use bus::Place;
use messages::topic::GameName;
use scenario::strategy::Strategy;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// What an agent node needs to know.
pub struct Settings {
    /// The game to join; without a name, the only one there is.
    pub game: Option<GameName>,
    /// Where the sim is.
    pub place: Place,
    /// The vehicles to decide for, by name.
    pub vehicles: Vec<String>,
    /// How long to look for the sim and to wait until the vehicles are free.
    pub wait: Duration,
    /// After this long without a picture the sim counts as dead.
    pub silence: Duration,
    /// How to play, in place of what the scenario says.
    pub strategy: Option<Strategy>,
    /// In lockstep: how long the proposal of a policy is waited for at every decision, where a strategy uses one. No
    /// longer than half of the scenario's patience, though.
    pub policy_wait: Duration,
    /// Set from outside to leave the game.
    pub stop: Arc<AtomicBool>,
}
