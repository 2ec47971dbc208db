//! An agent on the network: finds a game, joins it, and decides for its vehicles until the game is
//! over.
//!
//! Everything except the vehicles' names comes from the sim: field, rules, strategies and seed.

mod agent_loop;
mod error;
mod helm_queries;
mod policy_inbox;
mod settings;
mod talk;
pub mod team_inbox;

pub use error::NodeError;
pub use settings::{MindMaker, Settings};

use agent_loop::AgentLoop;
use bus::game_search::{self, GameSearch};
use messages::Role;
use messages::refusal::Refusals;
use primitives::VehicleId;

/// An event that an agent reports to the program that runs it.
pub enum News<'a> {
    /// No sim found yet.
    Looking {
        /// Why the agent is waiting.
        reason: &'a str,
    },
    /// The agent is in the game.
    Joined {
        /// The game's name.
        game: &'a str,
    },
    /// The game is over, or the agent has left it.
    Left {
        /// Counts of rejected messages, and of expected messages that never arrived.
        refused: Refusals,
        /// The boats whose programs had faults, each with the first fault and the number of faults.
        faults: Vec<(String, String, u64)>,
    },
}

/// Joins a game and plays until it is over.
///
/// # Errors
/// [`NodeError`], including the loss of the sim.
pub fn serve(settings: &Settings, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
    let mut search = GameSearch::new(settings.wait, &settings.stop);
    let place = &settings.place;
    let (bus, game, mut info) = search.game(&mut looking(tell), place, settings.game.as_ref())?;
    let played = loop {
        let mut agent = AgentLoop::open(&bus, &game, &info, settings)?;
        let joined = search.until(&mut looking(tell), || {
            let game = (&game, &info.scenario);
            game_search::join(&bus, place, game, Role::Agent, &settings.vehicles)
        })?;
        agent.join(&bus, &game, &info.scenario, joined)?;
        tell(News::Joined {
            game: game.as_str(),
        });
        let played = agent.play(&settings.stop);
        let name = |(vehicle, first, count): (VehicleId, String, u64)| {
            let name = info.scenario.vehicles[vehicle.index()].name.clone();
            (name, first, count)
        };
        tell(News::Left {
            refused: agent.refusals(),
            faults: agent.faults().map(name).collect(),
        });
        if !matches!(played, Ok(true)) {
            break played.map(drop);
        }
        // The new seed may have changed strategies and boats.
        search = GameSearch::new(settings.wait, &settings.stop);
        let described = || game_search::choose_game(&bus, Some(&game));
        (_, info) = search.until(&mut looking(tell), described)?;
    };
    // Closing the link tells the sim at once that the agent has left; then its boats hold from the
    // next decision on.
    bus.close();
    played
}

fn looking(tell: &mut dyn FnMut(News<'_>)) -> impl FnMut(&str) {
    move |reason| tell(News::Looking { reason })
}
