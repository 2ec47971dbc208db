//! An observer: a session that watches a game and asks about it.

use super::net_args::LeafArgs;
use anyhow::{Context, Result, bail};
use bus::game_search;
use bus::{Bus, clock};
use messages::GameInfo;
use messages::helm::{HelmQuestion, HelmReport};
use messages::topic::{self, GameName};
use primitives::VehicleId;
use shore::page::is_sound;
use std::time::Duration;

/// A boat of which nothing is heard for this long has no agent.
pub(crate) const SILENCE: Duration = Duration::from_secs(10);

/// A session in a game that runs.
pub(crate) struct Observer {
    pub(crate) bus: Bus,
    pub(crate) game: GameName,
    pub(crate) info: GameInfo,
}

impl Observer {
    /// Connects to a game that runs.
    pub(crate) fn connect(leaf: &LeafArgs) -> Result<Observer> {
        let bus = Bus::leaf(&leaf.net()?).context("no game to watch")?;
        let (game, info) = game_search::choose_game(&bus, leaf.game.as_ref())?;
        Ok(Observer { bus, game, info })
    }

    /// The vehicle of this name.
    pub(crate) fn vehicle(&self, name: &str) -> Result<VehicleId> {
        Ok(self.info.scenario.vehicle_named(name)?)
    }

    /// The helm report of a vehicle; nothing if it has no agent now.
    pub(crate) fn helm(&self, vehicle: VehicleId, question: HelmQuestion) -> Result<Option<HelmReport>> {
        let question = serde_json::to_vec(&question).context("a question is JSON")?;
        let key = topic::helm(&self.game, &self.info.scenario, vehicle);
        let Some(answer) = self.bus.ask_node(&key, question, bus::ANSWER)? else { return Ok(None) };
        let report: Option<HelmReport> =
            serde_json::from_slice(&answer).context("the agent is of another version of Squall")?;
        let name = &self.info.scenario.vehicles[vehicle.index()].name;
        let report = report.with_context(|| format!("the agent of {name} has no helm"))?;
        if !is_sound(&report, vehicle, self.info.scenario.vehicles.len()) {
            bail!("the answer about the helm of {name} makes no sense");
        }
        Ok(Some(report))
    }

    /// The helm report of a vehicle that has an agent. An answer that a busy link dropped is asked for again.
    pub(crate) fn helm_of_agent(&self, vehicle: VehicleId, question: HelmQuestion) -> Result<HelmReport> {
        let start = clock::now();
        loop {
            let asked = clock::now();
            if let Some(report) = self.helm(vehicle, question)? {
                return Ok(report);
            }
            // Where nobody answers for this boat at all, that is told before the time for an answer is over.
            let is_answered_for = clock::since(asked) >= bus::ANSWER;
            if !is_answered_for || clock::since(start) >= SILENCE {
                bail!("{} has no agent", self.info.scenario.vehicles[vehicle.index()].name);
            }
        }
    }

    /// Whether the game's sim is still there.
    pub(crate) fn is_on(&self) -> Result<bool> {
        Ok(!self.bus.who_is_alive(&topic::all_alive(&self.game), bus::ANSWER)?.is_empty())
    }
}
