//! The settings of a gateway to a real boat.

use crate::bridge::Plan;
use bus::Place;
use messages::topic::GameName;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// The settings of a gateway to a real boat.
#[derive(Clone)]
pub struct Settings {
    /// The boat, and how it is driven and stopped; its site comes from the game.
    pub plan: Plan,
    /// The game; without a name, the only one there is.
    pub game: Option<GameName>,
    /// Where the sim is.
    pub place: Place,
    /// Whether its clock runs at the game's pace: for emulated boats.
    pub at_game_pace: bool,
    /// The commit that the program was built from.
    pub commit: &'static str,
    /// How long to look for the game.
    pub wait: Duration,
    /// Set by the caller to end the gateway.
    pub stop: Arc<AtomicBool>,
}
