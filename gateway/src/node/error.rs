//! Why a gateway cannot work.

use crate::declination::DeclinationError;
use crate::geofence::GeofenceError;
use crate::link::LinkError;
use bus::game_search::NotFound;
use bus::{BusError, LinkLockError};
use scenario::UnknownVehicle;
use std::net::SocketAddr;
use std::time::Duration;
use thiserror::Error;

/// Why a gateway cannot work.
#[derive(Debug, Error)]
pub enum NodeError {
    /// The network failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// There is no game, or it refuses.
    #[error(transparent)]
    NotFound(#[from] NotFound),
    /// The link cannot be opened.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The control port cannot be opened.
    #[error("the control port {listen}: {source}")]
    ControlPort {
        /// Where it was to listen.
        listen: SocketAddr,
        /// Why.
        source: std::io::Error,
    },
    /// Another gateway has the link.
    #[error(transparent)]
    Locked(#[from] LinkLockError),
    /// The recording is incomplete.
    #[error("{0}")]
    Recording(String),
    /// The declination is not known.
    #[error("{0}; set declination_deg in the gateway's file")]
    Declination(#[from] DeclinationError),
    /// The game has no such boat.
    #[error(transparent)]
    UnknownVehicle(#[from] UnknownVehicle),
    /// The geofence does not go with the game.
    #[error("the gateway file {file}: geofence: {source}")]
    Geofence {
        /// The file's stem.
        file: String,
        /// Why.
        source: GeofenceError,
    },
    /// The game and the gateway do not go together.
    #[error("{0}")]
    Refused(String),
    /// The sim has died or fallen silent, and with it the emulated boat.
    #[error("the sim is gone: no picture for {0:.1?}")]
    SimGone(Duration),
    /// Another sim serves a game of the same name, and knows nothing of us.
    #[error("the sim is gone, and another one serves the game: join again")]
    SimReplaced,
}
