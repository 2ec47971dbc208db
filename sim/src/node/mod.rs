//! The sim on the network: lets nodes join, paces the game and publishes it.
//!
//! [`serve`] plays one game from the first join to the last frame. [`Contest`], [`membership`],
//! [`agents`] and [`gateways`] make all decisions; this module has the sockets and the clocks.

pub mod agents;
mod control_inbox;
pub mod gateways;
mod lockstep;
pub mod membership;
mod message_inbox;
mod observers;
mod pacing;
mod realtime;
mod server;
mod subscriptions;
mod throttle;
mod working_time;

pub use crate::progress::{Progress, ProgressMessage, Reporter};
pub use crate::recorder::GameRecorder;
pub use crate::report::{Report, Run};

use crate::contest::Contest;
use crate::spawn::NoStart;
use bus::{BusError, Net, clock};
use messages::topic::GameName;
use scenario::Scenario;
use server::GameServer;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use thiserror::Error;

/// The pace of a game.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// Every decision waits for every agent: as fast as the slowest agent, and reproducible.
    Lockstep,
    /// Follows the clock times this factor and waits for no agent.
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
    /// Set externally to end the game early.
    pub stop: Arc<AtomicBool>,
}

/// Why a game could not be served.
#[derive(Debug, Error)]
pub enum NodeError {
    /// The boats do not fit on the field, or are real in lockstep.
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
            // In a form that can be parsed: a recording's pace can be passed to another run.
            Pace::Realtime { factor } if *factor == 1.0 => f.write_str("realtime"),
            Pace::Realtime { factor } => write!(f, "{factor}x"),
        }
    }
}

impl std::str::FromStr for Pace {
    type Err = String;
    fn from_str(text: &str) -> Result<Pace, String> {
        let wrong =
            || format!("pace is {text:?}, expected lockstep, realtime, or a factor from 0.01x to 1000x such as 4x");
        match text {
            "lockstep" => Ok(Pace::Lockstep),
            "realtime" => Ok(Pace::Realtime { factor: 1.0 }),
            _ => {
                let factor: f64 = text.strip_suffix('x').and_then(|n| n.parse().ok()).ok_or_else(wrong)?;
                if (0.01..=1000.0).contains(&factor) { Ok(Pace::Realtime { factor }) } else { Err(wrong()) }
            }
        }
    }
}

/// Serves the game of `scenario` with this seed to its end. `recorder` records it.
///
/// # Errors
/// [`NodeError`] if the boats do not fit on the field, the network fails, or a lockstep game has real
/// boats, which cannot wait.
pub fn serve(
    scenario: &Scenario,
    seed: u64,
    settings: &Settings,
    recorder: Option<&mut GameRecorder>,
    tell: &mut dyn FnMut(ProgressMessage),
) -> Result<Report, NodeError> {
    if settings.pace == Pace::Lockstep {
        // A real boat does not wait while agents compute.
        scenario.has_no_real_boats().map_err(NoStart::from)?;
    }
    // Before the hub opens: a game whose boats do not fit is refused before any node joins.
    let contest = Contest::new(scenario, seed)?;
    let mut server = GameServer::open(contest, settings, recorder)?;
    tell(ProgressMessage::Open {
        game: settings.game.as_str().to_owned(),
        endpoint: settings.net.local_endpoint().unwrap_or_default(),
    });
    // Simulated time starts when all are present: the start-up of programs is not part of a game.
    server.wait_for_everybody(settings.join_limit, tell)?;
    tell(ProgressMessage::Started);
    let started = clock::now();
    match settings.pace {
        Pace::Lockstep => lockstep::play(&mut server, tell)?,
        Pace::Realtime { .. } => realtime::play(&mut server, tell)?,
    }
    let cut_short = !server.contest.is_over();
    let wall_s = clock::since(started).as_secs_f64();
    // The result is final before the agents leave, because leaving is not part of the game.
    let outcome = server.contest.outcome();
    std::mem::take(&mut server.reporter).rest(&outcome, tell);
    server.shut_down()?;
    let overruns = server.overruns;
    let run = Run {
        pace: settings.pace.to_string(),
        wall_s,
        refused: server.refusals(),
        overruns,
        cut_short,
        ..Run::default()
    };
    Ok(Report { outcome, run })
}
