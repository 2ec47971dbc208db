//! An agent on the network: finds a game, joins it, and decides for its vehicles until the game is over.
//!
//! Everything but the vehicles' names comes from the sim: field, rules, strategies, seed.

mod advice;
mod clock;
mod ignored;
mod mailbag;
mod table;
mod talk;
mod window;

pub use ignored::Ignored;

use bus::{Bus, BusError, Net};
use game::VehicleId;
use game::message::{JoinReply, JoinRequest, Notice};
use game::strategy::Strategy;
use game::topic::{self, GameName, Part};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use table::Table;
use thiserror::Error;

/// What an agent node needs to know.
pub struct Settings {
    /// The game to join; without a name, the only one there is.
    pub game: Option<GameName>,
    /// Where the sim is.
    pub net: Net,
    /// The vehicles to mind, by name.
    pub vehicles: Vec<String>,
    /// How long to look for the sim and to wait for a free seat.
    pub wait: Duration,
    /// After this long without a picture the sim counts as dead.
    pub silence: Duration,
    /// How to play, in place of what the scenario says.
    pub strategy: Option<Strategy>,
    /// In lockstep: how long the proposal of a policy is waited for at every decision, where a strategy heeds one. No
    /// longer than half of the scenario's patience, though.
    pub policy_wait: Duration,
    /// Set from outside to leave the game.
    pub stop: Arc<AtomicBool>,
}

/// What a node tells the shell that runs it.
pub enum News<'a> {
    /// The sim is not there (yet).
    Looking {
        /// What is missing.
        reason: &'a str,
    },
    /// The agent is in the game.
    Joined {
        /// Its name.
        game: &'a str,
    },
    /// The game is over, or left.
    Left {
        /// What others said in it that was not heeded, and what never came.
        ignored: Ignored,
    },
}

/// Why an agent could not play to the end.
#[derive(Debug, Error)]
pub enum NodeError {
    /// The network failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// No sim within the time allowed.
    #[error("no game to join after {0:.0?}: {1}")]
    NoGame(Duration, String),
    /// The sim said no.
    #[error("the sim refuses: {0}")]
    Refused(String),
    /// The sim speaks another version.
    #[error("agent and sim are not of one version: the agent is {ours}, {theirs}", ours = game::VERSION)]
    Version {
        /// What is known of the sim's.
        theirs: String,
    },
    /// The sim fell silent.
    #[error("the sim is gone: no picture for {0:.1?}")]
    SimGone(Duration),
}

/// How often to look again for what is not there.
const LOOK_AGAIN: Duration = Duration::from_millis(100);
/// How long to wait for an answer.
const ANSWER: Duration = Duration::from_secs(2);
/// How long the sim may be silent once its sign of life is gone.
const SILENCE_AFTER_DEATH: Duration = Duration::from_secs(3);

/// Joins a game and plays until it is over.
///
/// # Errors
/// [`NodeError`] says what went wrong; a sim that dies is an error.
pub fn serve(settings: &Settings, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
    let start = clock::now();
    let mut look = Look { settings, start, last: String::new(), tell };
    let bus = look.until(|| Bus::leaf(&settings.net).map_err(|e| Missing::Yet(e.to_string())))?;
    let game = match &settings.game {
        Some(game) => game.clone(),
        None => look.until(|| only_game(&bus))?,
    };
    let agent = bus.id();
    let _alive = bus.show_alive(topic::alive(&game, Part::Agent, &agent))?;
    let notice = look.until(|| ask_notice(&bus, &game))?;
    let mut table = Table::lay(&bus, &game, &notice, settings)?;
    let seat = look.until(|| ask_seat(&bus, &game, &agent, &settings.vehicles))?;
    table.seat(&bus, &game, &notice.scenario, seat)?;
    (look.tell)(News::Joined { game: game.as_str() });
    let played = table.play(settings);
    (look.tell)(News::Left { ignored: table.ignored() });
    bus.close();
    played
}

/// Why something is not there.
enum Missing {
    /// It may come.
    Yet(String),
    /// It will not.
    Forever(NodeError),
}

impl From<BusError> for Missing {
    fn from(error: BusError) -> Missing {
        Missing::Yet(error.to_string())
    }
}

/// The search for a game, with its limit.
struct Look<'a, 'b> {
    settings: &'a Settings,
    start: Instant,
    last: String,
    tell: &'a mut (dyn FnMut(News<'_>) + 'b),
}

impl Look<'_, '_> {
    /// Tries again until it works, the time is up, or it never will.
    fn until<T>(&mut self, mut attempt: impl FnMut() -> Result<T, Missing>) -> Result<T, NodeError> {
        loop {
            let reason = match attempt() {
                Ok(found) => return Ok(found),
                Err(Missing::Forever(error)) => return Err(error),
                Err(Missing::Yet(reason)) => reason,
            };
            if reason != self.last {
                (self.tell)(News::Looking { reason: &reason });
                self.last.clone_from(&reason);
            }
            let stopped = self.settings.stop.load(Ordering::Relaxed);
            if stopped || clock::since(self.start) >= self.settings.wait {
                return Err(NodeError::NoGame(clock::since(self.start), reason));
            }
            clock::pause(LOOK_AGAIN);
        }
    }
}

/// The only game on the network.
fn only_game(bus: &Bus) -> Result<GameName, Missing> {
    let keys = bus.who_is_alive(&topic::everyone_alive(), ANSWER)?;
    let sims = keys.iter().filter_map(|key| topic::parse_alive(key)).filter(|(_, part, _)| *part == Part::Sim);
    let games: Vec<GameName> = sims.map(|(game, _, _)| game).collect();
    match games.as_slice() {
        [game] => Ok(game.clone()),
        [] => Err(Missing::Yet("no sim is on the network".to_owned())),
        several => {
            let names: Vec<&str> = several.iter().map(GameName::as_str).collect();
            Err(Missing::Forever(NodeError::Refused(format!("choose with --game among {}", names.join(", ")))))
        }
    }
}

/// What the game is, from the sim.
fn ask_notice(bus: &Bus, game: &GameName) -> Result<Notice, Missing> {
    let answer = bus.ask(&topic::scenario(game), Vec::new(), ANSWER)?;
    let bytes = answer.ok_or_else(|| Missing::Yet(format!("no sim answers for game {:?}", game.as_str())))?;
    // The version first: of another version we may not understand the rest.
    let value: serde_json::Value = serde_json::from_slice(&bytes).unwrap_or_default();
    let version = value.get("version").and_then(serde_json::Value::as_str).unwrap_or("unknown");
    if version != game::VERSION {
        return Err(Missing::Forever(NodeError::Version { theirs: format!("the sim is {version}") }));
    }
    let notice: Result<Notice, _> = serde_json::from_slice(&bytes);
    match notice {
        Ok(notice) => Ok(notice),
        Err(e) => {
            Err(Missing::Forever(NodeError::Version { theirs: format!("the sim's scenario is not understood: {e}") }))
        }
    }
}

/// A ticket for the vehicles, from the sim.
fn ask_seat(bus: &Bus, game: &GameName, agent: &str, vehicles: &[String]) -> Result<(u64, Vec<VehicleId>), Missing> {
    let request =
        JoinRequest { version: game::VERSION.to_owned(), agent: agent.to_owned(), vehicles: vehicles.to_vec() };
    let request = serde_json::to_vec(&request).expect("a request is JSON");
    let answer = bus.ask(&topic::join(game), request, ANSWER)?;
    let bytes = answer.ok_or_else(|| Missing::Yet("the sim does not answer at the door".to_owned()))?;
    match serde_json::from_slice(&bytes) {
        Ok(JoinReply::Granted { ticket, vehicles }) => Ok((ticket, vehicles)),
        Ok(JoinReply::Busy { vehicle }) => Err(Missing::Yet(format!("{vehicle} has another mind"))),
        Ok(JoinReply::Refused { reason }) => Err(Missing::Forever(NodeError::Refused(reason))),
        Err(e) => {
            Err(Missing::Forever(NodeError::Version { theirs: format!("the sim's answer is not understood: {e}") }))
        }
    }
}
