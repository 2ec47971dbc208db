//! Errors that prevent a gateway from running.

use crate::declination::DeclinationError;
use crate::geofence::GeofenceError;
use crate::link::LinkError;
use bus::game_search::NotFound;
use bus::{BusError, LinkLockError};
use scenario::UnknownVehicle;
use std::net::SocketAddr;
use std::time::Duration;
use thiserror::Error;

/// An error that prevents a gateway from running.
#[derive(Debug, Error)]
pub enum NodeError {
    /// The network failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// No game was found, or the game refuses the boat.
    #[error(transparent)]
    NotFound(#[from] NotFound),
    /// The link cannot be opened.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The control port cannot be opened.
    #[error("cannot open the control port {listen}: {source}")]
    ControlPort {
        /// The address.
        listen: SocketAddr,
        /// The cause.
        source: std::io::Error,
    },
    /// The port for ArduPilot's firmware cannot be opened.
    #[error("cannot open the SITL port {listen}: {source}; choose another with --listen")]
    SitlPort {
        /// The address.
        listen: SocketAddr,
        /// The cause.
        source: std::io::Error,
    },
    /// Another gateway holds the link.
    #[error(transparent)]
    Locked(#[from] LinkLockError),
    /// The recording is incomplete.
    #[error("{0}")]
    Recording(String),
    /// The declination is unknown.
    #[error("{0}; set declination_deg in the gateway's file")]
    Declination(#[from] DeclinationError),
    /// The game has no such boat.
    #[error(transparent)]
    UnknownVehicle(#[from] UnknownVehicle),
    /// The geofence does not suit the game.
    #[error("the gateway file {file}: geofence: {source}")]
    Geofence {
        /// The file's stem.
        file: String,
        /// The cause.
        source: GeofenceError,
    },
    /// The game and the gateway do not match.
    #[error("{0}")]
    Refused(String),
    /// The sim has died or is silent, so the emulated boat is lost too.
    #[error("lost the sim: no picture for {0:.1?}")]
    SimGone(Duration),
    /// A different sim serves a game with the same name, and does not know us.
    #[error("lost the sim, and another one now serves the game: join again")]
    SimReplaced,
}
