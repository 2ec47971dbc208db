//! An observer: a session that watches a game and queries it.

use crate::leaf_args::LeafArgs;
use anyhow::{Context, Result};
use bus::Bus;
use bus::game_search;
use messages::GameInfo;
use messages::topic::{self, GameName};
use primitives::VehicleId;

/// A session in a running game.
pub struct Observer {
    /// The session on the network.
    pub bus: Bus,
    /// The name of the game.
    pub game: GameName,
    /// The sim's description of the game.
    pub info: GameInfo,
}

impl Observer {
    /// Connects to a running game.
    pub fn connect(leaf: &LeafArgs) -> Result<Observer> {
        let bus = Bus::leaf(&leaf.net()?).context("cannot watch a game")?;
        let (game, info) = game_search::choose_game(&bus, leaf.game.as_ref())?;
        Ok(Observer { bus, game, info })
    }

    /// The index of the vehicle with this name.
    pub fn vehicle(&self, name: &str) -> Result<VehicleId> {
        Ok(self.info.scenario.vehicle_named(name)?)
    }

    /// Whether the game's sim is still present.
    pub fn is_on(&self) -> Result<bool> {
        Ok(!self
            .bus
            .who_is_alive(&topic::all_alive(&self.game), bus::ANSWER)?
            .is_empty())
    }
}
