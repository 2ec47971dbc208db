//! Finding a game and joining it: what agents, gateways and observers do alike.

use crate::{Bus, BusError, Net, clock};
use game::VehicleId;
use game::message::{GameInfo, JoinReply, JoinRequest, Role};
use game::topic::{self, GameName, Part};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use thiserror::Error;

/// How often to look again for what is not there.
const LOOK_AGAIN: Duration = Duration::from_millis(100);
/// How long to wait for an answer.
pub const ANSWER: Duration = Duration::from_secs(2);

/// Why something is not there.
#[derive(Debug, Error)]
pub enum Missing {
    /// It may come.
    #[error("{0}")]
    Yet(String),
    /// It will not.
    #[error(transparent)]
    Forever(#[from] Refusal),
}

/// Why a game cannot be joined, and asking again will not help.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Refusal {
    /// The sim says no.
    #[error("{0}")]
    Refused(String),
    /// It speaks another version of Squall; this is what is known of it.
    #[error("not of one version: this program is {ours}, {0}", ours = game::VERSION)]
    Version(String),
}

/// Why a search ended without success.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NotFound {
    /// The time is up; this was missing last.
    #[error("no game to join after {0:.0?}: {1}")]
    InTime(Duration, String),
    /// It will never be there.
    #[error(transparent)]
    Refused(#[from] Refusal),
}

impl From<BusError> for Missing {
    fn from(error: BusError) -> Missing {
        match error {
            BusError::NeedsToken | BusError::WrongToken => Missing::Forever(Refusal::Refused(error.to_string())),
            BusError::Request { .. } => Missing::Forever(Refusal::Version(error.to_string())),
            other => Missing::Yet(other.to_string()),
        }
    }
}

/// A search with a limit.
pub struct GameSearch<'a> {
    wait: Duration,
    stop: &'a AtomicBool,
    start: Instant,
    last: String,
}

impl<'a> GameSearch<'a> {
    /// A search that ends after this time, or when `stop` is set.
    #[must_use]
    pub fn new(wait: Duration, stop: &'a AtomicBool) -> GameSearch<'a> {
        GameSearch { wait, stop, start: clock::now(), last: String::new() }
    }

    /// Tries again until it works, the time is up, or it never will; reports what is missing whenever that changes.
    ///
    /// # Errors
    /// [`NotFound`] says what was missing to the end.
    pub fn until<T>(
        &mut self,
        tell: &mut dyn FnMut(&str),
        mut attempt: impl FnMut() -> Result<T, Missing>,
    ) -> Result<T, NotFound> {
        loop {
            let reason = match attempt() {
                Ok(found) => return Ok(found),
                Err(Missing::Forever(refusal)) => return Err(refusal.into()),
                Err(Missing::Yet(reason)) => reason,
            };
            if reason != self.last {
                tell(&reason);
                self.last.clone_from(&reason);
            }
            let passed = clock::since(self.start);
            if self.stop.load(Ordering::Relaxed) || passed >= self.wait {
                return Err(NotFound::InTime(passed, reason));
            }
            clock::rest(LOOK_AGAIN);
        }
    }

    /// A session at the hub that `net` leads to, and the game (this one, or the only one there is) with what it is.
    ///
    /// # Errors
    /// [`NotFound`] says what was missing to the end.
    pub fn game(
        &mut self,
        tell: &mut dyn FnMut(&str),
        net: &Net,
        game: Option<&GameName>,
    ) -> Result<(Bus, GameName, GameInfo), NotFound> {
        let bus = self.until(tell, || Ok(Bus::leaf(net)?))?;
        let (game, info) = self.until(tell, || choose_game(&bus, game))?;
        Ok((bus, game, info))
    }
}

/// The game of this name, or the only one on the network, with what it is.
///
/// # Errors
/// [`Missing`] if it is not there yet, if there are several to choose from, or if its sim is of another version.
pub fn choose_game(bus: &Bus, named: Option<&GameName>) -> Result<(GameName, GameInfo), Missing> {
    let game = named.map_or_else(|| only_game(bus), |game| Ok(game.clone()))?;
    let info = game_info(bus, &game)?;
    Ok((game, info))
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
            Err(Missing::Forever(Refusal::Refused(format!("choose with --game among {}", names.join(", ")))))
        }
    }
}

/// What the game is, from the sim.
fn game_info(bus: &Bus, game: &GameName) -> Result<GameInfo, Missing> {
    let answer = bus.ask(&topic::scenario(game), Vec::new(), ANSWER)?;
    let bytes = answer.ok_or_else(|| Missing::Yet(format!("no sim answers for game {:?}", game.as_str())))?;
    // The version first: of another version we may not understand the rest.
    let value: serde_json::Value = serde_json::from_slice(&bytes).unwrap_or_default();
    let version = value.get("version").and_then(serde_json::Value::as_str).unwrap_or("unknown");
    if version != game::VERSION {
        return Err(Missing::Forever(Refusal::Version(format!("the sim is {version}"))));
    }
    let not_understood = |e| Missing::Forever(Refusal::Version(format!("the sim's scenario is not understood: {e}")));
    serde_json::from_slice(&bytes).map_err(not_understood)
}

/// Joins with these vehicles in this role: the ticket, and the vehicles' numbers.
///
/// # Errors
/// [`Missing`] if the sim does not answer, if somebody else has a vehicle, or if it says no.
pub fn join(bus: &Bus, game: &GameName, role: Role, vehicles: &[String]) -> Result<(u64, Vec<VehicleId>), Missing> {
    let (version, node) = (game::VERSION.to_owned(), bus.id());
    let request = JoinRequest { version, role, node, vehicles: vehicles.to_vec() };
    match bus.request(&topic::join(game), &request, ANSWER)? {
        None => Err(Missing::Yet("the sim does not answer the join request".to_owned())),
        Some(JoinReply::Granted { ticket, vehicles }) => Ok((ticket, vehicles)),
        Some(JoinReply::Busy { vehicle }) => Err(Missing::Yet(format!("{vehicle} has another {role}"))),
        Some(JoinReply::Refused { reason }) => Err(Missing::Forever(Refusal::Refused(reason))),
    }
}
