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
    /// The game; `None` means the only one available.
    pub game: Option<GameName>,
    /// The location of the sim.
    pub place: Place,
    /// Whether the gateway's clock runs at the game's pace, for emulated boats.
    pub at_game_pace: bool,
    /// The commit from which the program was built.
    pub commit: &'static str,
    /// How long to look for the game.
    pub wait: Duration,
    /// Set by the caller to end the gateway.
    pub stop: Arc<AtomicBool>,
}
