//! `squall list`: which games there are, and who is in them.

use crate::net_args::LeafArgs;
use crate::screen;
use anyhow::Result;
use bus::{Bus, Net};
use game::message::GameInfo;
use game::topic::{self, GameName, Part};
use std::collections::BTreeMap;
use std::process::ExitCode;

/// Where to look.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    leaf: LeafArgs,
    /// Looks only where --connect or --lan says, not at the games of this machine
    #[arg(long)]
    elsewhere: bool,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let mut places: Vec<Net> = Vec::new();
    if !args.elsewhere {
        places.extend(
            bus::local_registry().into_iter().map(|entry| Net { connect: vec![entry.endpoint], ..Net::default() }),
        );
    }
    // Several games on this machine are no error here: all are listed.
    places.extend(args.leaf.net().ok().filter(|net| net.lan || !places.iter().any(|p| p.connect == net.connect)));
    let mut games: BTreeMap<GameName, String> = BTreeMap::new();
    for place in &places {
        // Where nobody answers there is no game.
        if let Ok(bus) = Bus::leaf(place) {
            games.extend(games_at(&bus, place)?);
            bus.close();
        }
    }
    if games.is_empty() {
        screen::print("no games\n");
    }
    games.values().for_each(|text| screen::print(text));
    Ok(ExitCode::SUCCESS)
}

fn games_at(bus: &Bus, place: &Net) -> Result<BTreeMap<GameName, String>> {
    let keys = bus.who_is_alive(&topic::everyone_alive(), bus::ANSWER)?;
    let nodes: Vec<(GameName, Part, String)> = keys.iter().filter_map(|key| topic::parse_alive(key)).collect();
    let mut games = BTreeMap::new();
    for (game, _, sim) in nodes.iter().filter(|(_, part, _)| *part == Part::Sim) {
        let agents = nodes.iter().filter(|(other, part, _)| other == game && *part == Part::Agent);
        let mut text = format!("{}  {}\n  sim {sim}\n", game.as_str(), place.connect.join(" "));
        agents.for_each(|(_, _, agent)| text.push_str(&format!("  agent {agent}\n")));
        let answer = bus.ask(&topic::scenario(game), Vec::new(), bus::ANSWER)?;
        if let Some(info) = answer.and_then(|bytes| serde_json::from_slice::<GameInfo>(&bytes).ok()) {
            let scenario = &info.scenario;
            text.push_str(&format!(
                "  {} seed {}, {}, {} boats, Squall {}\n",
                scenario.name,
                scenario.seed,
                info.pace,
                scenario.vehicles.len(),
                info.version
            ));
        }
        games.insert(game.clone(), text);
    }
    Ok(games)
}
