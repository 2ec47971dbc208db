//! Settings of a sim node, and its errors.

use crate::spawn::NoStart;
use bus::{BusError, Net};
use messages::topic::GameName;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use thiserror::Error;

/// The pace of a game.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// Every decision waits for every agent: as fast as the slowest agent, and reproducible.
    Lockstep,
    /// Runs at this multiple of real time, without waiting for agents.
    Realtime {
        /// Simulated seconds per second.
        factor: f64,
    },
}

/// Settings of a sim node besides the scenario.
pub struct Settings {
    /// The game's name on the network.
    pub game: GameName,
    /// The network endpoints.
    pub net: Net,
    /// The pace of the game.
    pub pace: Pace,
    /// How long to wait for agents, and for gateways of real boats, before starting without them.
    pub join_limit: Duration,
    /// In lockstep: maximum simulated seconds per second, until an operator changes it.
    pub speed: Option<f64>,
    /// Set by the caller to end the game early.
    pub stop: Arc<AtomicBool>,
}

/// A reason why a game could not be served.
#[derive(Debug, Error)]
pub enum NodeError {
    /// The game cannot start: for example, the boats do not fit on the field, or there are real
    /// boats in a lockstep game.
    #[error(transparent)]
    NoStart(#[from] NoStart),
    /// The network failed.
    #[error(transparent)]
    Bus(#[from] BusError),
}

impl std::fmt::Display for Pace {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Pace::Lockstep => f.write_str("lockstep"),
            // Use a form that can be parsed: a recording's pace can be passed to a new run.
            Pace::Realtime { factor } if *factor == 1.0 => f.write_str("realtime"),
            Pace::Realtime { factor } => write!(f, "{factor}x"),
        }
    }
}

impl std::str::FromStr for Pace {
    type Err = String;
    fn from_str(text: &str) -> Result<Pace, String> {
        let wrong = || {
            format!(
                "pace is {text:?}, expected lockstep, realtime, or a factor from 0.01x to 1000x, such as 4x"
            )
        };
        match text {
            "lockstep" => Ok(Pace::Lockstep),
            "realtime" => Ok(Pace::Realtime { factor: 1.0 }),
            _ => {
                let factor: f64 = text
                    .strip_suffix('x')
                    .and_then(|n| n.parse().ok())
                    .ok_or_else(wrong)?;
                if (0.01..=1000.0).contains(&factor) {
                    Ok(Pace::Realtime { factor })
                } else {
                    Err(wrong())
                }
            }
        }
    }
}
