//! Finding and joining a game, shared by agents, gateways and observers.

use crate::keys::Identity;
use crate::{Bus, BusError, Place, PlacedSession, clock};
use messages::topic::{self, GameName};
use messages::{GameInfo, JoinReply, JoinRequest, Role};
use primitives::{SimTime, VehicleId};
use scenario::Scenario;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use thiserror::Error;

/// Interval between the attempts of a search.
const LOOK_AGAIN: Duration = Duration::from_millis(100);
/// Timeout of a query.
pub const ANSWER: Duration = Duration::from_secs(2);

/// Why a game or a part of it is missing.
#[derive(Debug, Error)]
pub enum Missing {
    /// The missing part may appear later.
    #[error("{0}")]
    Yet(String),
    /// The missing part will never appear.
    #[error(transparent)]
    Forever(#[from] Refusal),
}

/// Why a game cannot be joined even after retries.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Refusal {
    /// The sim refuses, for the given reason.
    #[error("{0}")]
    Refused(String),
    /// The sim has a different version of Squall, as described.
    #[error("different Squall versions (this program is {ours}): {0}", ours = primitives::VERSION)]
    Version(String),
}

/// Why a search failed.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NotFound {
    /// The search timed out; the message names what was still missing.
    #[error("found no game to join within {0:.0?}: {1}")]
    InTime(Duration, String),
    /// The search can never succeed.
    #[error(transparent)]
    Refused(#[from] Refusal),
}

impl From<BusError> for Missing {
    fn from(error: BusError) -> Missing {
        match error {
            BusError::NeedsToken
            // Waiting does not fix these; they require human intervention. All others may be
            // temporary, such as an unplugged cable or a sim that starts later.
            | BusError::WrongToken
            | BusError::Keys(_)
            | BusError::NeedsKeys(_)
            | BusError::NotAllowed { .. } => Missing::Forever(Refusal::Refused(error.to_string())),
            // An unreadable answer comes from a different version, which waiting does not change.
            BusError::Request { .. } => Missing::Forever(Refusal::Version(error.to_string())),
            other => Missing::Yet(other.to_string()),
        }
    }
}

/// A search with a time limit.
pub struct GameSearch<'a> {
    wait: Duration,
    stop: &'a AtomicBool,
    start: Instant,
    last: String,
}

impl<'a> GameSearch<'a> {
    /// A search that ends after this time, or when `stop` is set.
    pub fn new(wait: Duration, stop: &'a AtomicBool) -> GameSearch<'a> {
        GameSearch {
            wait,
            stop,
            start: clock::now(),
            last: String::new(),
        }
    }

    /// Repeats `attempt` until it succeeds, fails for good or the search times out. Calls `tell`
    /// with what is missing whenever that changes.
    ///
    /// # Errors
    /// [`NotFound`] names what was still missing at the end.
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

    /// A session at the place of the game (the named one, or the only one running), and the game
    /// with its details.
    ///
    /// # Errors
    /// [`NotFound`] names what was still missing at the end.
    pub fn game(
        &mut self,
        tell: &mut dyn FnMut(&str),
        place: &Place,
        game: Option<&GameName>,
    ) -> Result<(Bus, GameName, GameInfo), NotFound> {
        let mut session = None;
        self.until(tell, || find_game(place, game, &mut session))
    }
}

/// One attempt of [`GameSearch::game`]; pass the same `session` to the next attempt.
///
/// # Errors
/// As for [`choose_game`], or if no hub listens there.
pub fn find_game(
    place: &Place,
    named: Option<&GameName>,
    session: &mut PlacedSession,
) -> Result<(Bus, GameName, GameInfo), Missing> {
    let bus = place.session(named, session)?;
    let (game, info) = choose_game(&bus, named)?;
    // The sim may have started after the session was opened. Look up the token again by the game's
    // name: without a name, the registry was searched for any game.
    let token = place.net(Some(&game))?.token;
    Ok((bus.with_token(token), game, info))
}

/// The game with this name, or the only one on the network, with its details.
///
/// # Errors
/// [`Missing`] if it does not exist yet, if there are several, or if its sim has a different
/// version.
pub fn choose_game(bus: &Bus, named: Option<&GameName>) -> Result<(GameName, GameInfo), Missing> {
    let game = named.map_or_else(|| only_game(bus), |game| Ok(game.clone()))?;
    let info = game_info(bus, &game)?;
    Ok((game, info))
}

/// The only game on the network.
fn only_game(bus: &Bus) -> Result<GameName, Missing> {
    let games = games(bus)?;
    match games.as_slice() {
        // Usually there is only one game, and requiring its name would be a nuisance. With several
        // games, a guess could join boats to someone else's game.
        [game] => Ok(game.clone()),
        [] => Err(Missing::Yet("no sim found on the network".to_owned())),
        several => {
            let message = format!(
                "several games are running; select one with --game: {}",
                listed(several)
            );
            Err(Missing::Forever(Refusal::Refused(message)))
        }
    }
}

/// The games on the network.
fn games(bus: &Bus) -> Result<Vec<GameName>, BusError> {
    let keys = bus.who_is_alive(&topic::everyone_alive(), ANSWER)?;
    Ok(keys
        .iter()
        .filter_map(|key| topic::parse_alive(key))
        .map(|(game, _)| game)
        .collect())
}

fn listed(games: &[GameName]) -> String {
    games
        .iter()
        .map(GameName::as_str)
        .collect::<Vec<_>>()
        .join(", ")
}

fn game_info(bus: &Bus, game: &GameName) -> Result<GameInfo, Missing> {
    let answer = bus.ask(&topic::scenario(game), Vec::new(), ANSWER)?;
    let Some(bytes) = answer else {
        let others = games(bus)?;
        let others = if others.is_empty() {
            String::new()
        } else {
            format!("; running games: {}", listed(&others))
        };
        return Err(Missing::Yet(format!(
            "no sim is serving game {:?}{others}",
            game.as_str()
        )));
    };
    Ok(understood(&bytes)?)
}

/// The sim's description of its game, once validated.
fn understood(answer: &[u8]) -> Result<GameInfo, Refusal> {
    // Check the version first: if it differs, the rest may be unreadable.
    let value: serde_json::Value = serde_json::from_slice(answer).unwrap_or_default();
    let version = value
        .get("version")
        .and_then(serde_json::Value::as_str)
        .unwrap_or("unknown");
    if version != primitives::VERSION {
        return Err(Refusal::Version(format!("the sim is {version}")));
    }
    let unparseable = |e: String| Refusal::Version(format!("cannot parse the sim's scenario: {e}"));
    let info: GameInfo = serde_json::from_slice(answer).map_err(|e| unparseable(e.to_string()))?;
    // Later code indexes teams and boats by the scenario's references, and this scenario comes from
    // the network.
    info.scenario.check_received().map_err(unparseable)?;
    Ok(info)
}

/// The result of joining.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Joined {
    /// The ticket that every message must carry.
    pub ticket: u64,
    /// The vehicles, in the requested order.
    pub vehicles: Vec<VehicleId>,
    /// Game time of the answer.
    pub now: SimTime,
    /// When the request was sent.
    pub asked: Instant,
}

/// Joins the game in this role for these vehicles, with the token from `place`.
///
/// # Errors
/// [`Missing`] if the sim does not reply or refuses, or if another node has one of the vehicles.
pub fn join(
    bus: &Bus,
    place: &Place,
    (game, scenario): (&GameName, &Scenario),
    role: Role,
    vehicles: &[String],
) -> Result<Joined, Missing> {
    // The hub silently drops requests that these keys do not allow, and the node would wait for an
    // answer that never comes.
    check_keys(bus, scenario, role, vehicles)?;
    let bus = bus.clone().with_token(place.net(Some(game))?.token);
    // Tell the sim the identifier of the node's session, so that it can act as soon as the node's
    // link ends. A killed process closes its socket, and its boats hold in the same decision.
    let version = primitives::VERSION.to_owned();
    let node = bus.id();
    let asked = clock::now();
    let request = JoinRequest {
        version,
        role,
        node,
        vehicles: vehicles.to_vec(),
    };
    match bus.request(
        &topic::join(game, scenario, role, vehicles),
        &request,
        ANSWER,
    )? {
        None => Err(Missing::Yet(
            "the sim does not reply to the join request".to_owned(),
        )),
        Some(JoinReply::Granted {
            ticket,
            vehicles,
            now_ns,
        }) => Ok(Joined {
            ticket,
            vehicles,
            now: now_ns,
            asked,
        }),
        Some(JoinReply::Busy { vehicle }) => {
            Err(Missing::Yet(format!("another {role} controls {vehicle}")))
        }
        Some(JoinReply::Refused { reason }) => Err(Missing::Forever(Refusal::Refused(reason))),
    }
}

/// Checks that the keys, if any, allow joining in this role: the hub drops queries that the keys do
/// not allow.
fn check_keys(
    bus: &Bus,
    scenario: &Scenario,
    role: Role,
    vehicles: &[String],
) -> Result<(), Refusal> {
    let Some(keys) = &bus.keys else { return Ok(()) };
    let is_own = |name: &String| match (&keys.identity, role) {
        (Identity::Team(team), Role::Agent) => {
            // The sim itself refuses unknown names.
            scenario
                .vehicle_by_name(name)
                .is_none_or(|v| scenario.teams[scenario.team_of(v).index()].name == *team)
        }
        (Identity::Gateway(boat), Role::Gateway) => boat.as_ref().is_none_or(|boat| boat == name),
        _ => false,
    };
    match vehicles.iter().find(|name| !is_own(name)) {
        None => Ok(()),
        Some(name) => {
            let folder = keys.folder.display();
            let identity = &keys.identity;
            Err(Refusal::Refused(format!(
                "{folder}: the keys of {identity} are not for the {role} of {name}"
            )))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_game_is_believed_if_it_is_of_this_version_and_everything_that_it_names_is_in_it() {
        let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../scenarios/games/pav01_vs_pav01.toml");
        let scenario = scenario::load(&file).unwrap_or_else(|e| panic!("{e}"));
        let info = GameInfo {
            version: primitives::VERSION.to_owned(),
            pace: "lockstep".to_owned(),
            scenario,
        };
        let told = |change: &dyn Fn(&mut GameInfo)| {
            let mut info = info.clone();
            change(&mut info);
            understood(&serde_json::to_vec(&info).expect("JSON")).map_err(|e| e.to_string())
        };
        assert_eq!(told(&|_| ()), Ok(info.clone()));
        let refused = |change: &dyn Fn(&mut GameInfo)| told(change).expect_err("it is refused");
        assert!(refused(&|info| info.version = "0.0.1".to_owned()).contains("the sim is 0.0.1"));
        let other_team = refused(&|info| info.scenario.vehicles[0].team = primitives::TeamId(9));
        assert!(
            other_team.contains("the team of blue_one is 9, expected less than 2"),
            "{other_team}"
        );
        let other_strategy = refused(&|info| info.scenario.vehicles[1].strategy = 77);
        assert!(
            other_strategy.contains("the strategy of blue_two is 77"),
            "{other_strategy}"
        );
        assert!(understood(b"{").is_err());
    }
}
