//! An agent on the network: finds a game, joins it, and decides for its vehicles until the game is over.
//!
//! Everything but the vehicles' names comes from the sim: field, rules, strategies, seed.

mod agent_loop;
mod helm_queries;
mod policy_inbox;
mod talk;
mod team_inbox;

use agent_loop::AgentLoop;
use bus::game_search::{self, GameSearch, NotFound, Refusal};
use bus::{BusError, Net};
use game::message::Role;
use game::refusal::Refusals;
use game::strategy::Strategy;
use game::topic::{self, GameName, Part};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
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
        /// Messages of others that were not used, and what never came.
        refused: Refusals,
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
    /// Another sim serves a game of the same name, and knows nothing of us.
    #[error("the sim is gone, and another one serves the game: join again")]
    SimReplaced,
}

/// How often an agent that hears nothing looks whether the sim is still there.
const LOOK_AGAIN: Duration = Duration::from_millis(100);

/// Joins a game and plays until it is over.
///
/// # Errors
/// [`NodeError`] says what went wrong; a sim that dies is an error.
pub fn serve(settings: &Settings, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
    let mut look = GameSearch::new(settings.wait, &settings.stop);
    let mut say = |reason: &str| tell(News::Looking { reason });
    let (bus, game) = look.game(&mut say, &settings.net, settings.game.as_ref())?;
    let _alive = bus.show_alive(topic::alive(&game, Part::Agent, &bus.id()))?;
    let notice = look.until(&mut say, || game_search::game_info(&bus, &game))?;
    let mut table = AgentLoop::lay(&bus, &game, &notice, settings)?;
    let seat = look.until(&mut say, || game_search::join(&bus, &game, Role::Agent, &settings.vehicles))?;
    table.seat(&bus, &game, &notice.scenario, seat)?;
    tell(News::Joined { game: game.as_str() });
    let played = table.play(settings);
    tell(News::Left { refused: table.refusals() });
    bus.close();
    played
}

impl From<NotFound> for NodeError {
    fn from(not_found: NotFound) -> NodeError {
        match not_found {
            NotFound::InTime(after, missing) => NodeError::NoGame(after, missing),
            NotFound::Refused(Refusal::Refused(reason)) => NodeError::Refused(reason),
            NotFound::Refused(Refusal::Version(theirs)) => NodeError::Version { theirs },
        }
    }
}
