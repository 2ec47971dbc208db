//! The settings of a gateway to a real boat.

use crate::bridge::Preflight;
use crate::config::Gateway;
use bus::Place;
use messages::topic::GameName;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// The settings of a gateway to a real boat.
pub struct Settings {
    /// The game; without a name, the only one there is.
    pub game: Option<GameName>,
    /// Where the sim is.
    pub place: Place,
    /// The boat's name in the game.
    pub vehicle: String,
    /// How it is driven and stopped.
    pub gateway: Gateway,
    /// Whether it arms itself, once.
    pub arms_itself: bool,
    /// Whether the boat receives only standby.
    pub dry_run: bool,
    /// Whether its pre-flight check allows arming.
    pub preflight: Preflight,
    /// Whether its clock runs at the game's pace: for emulated boats.
    pub at_game_pace: bool,
    /// The commit that the program was built from.
    pub commit: &'static str,
    /// How long to look for the game.
    pub wait: Duration,
    /// Set by the caller to end the gateway.
    pub stop: Arc<AtomicBool>,
}
