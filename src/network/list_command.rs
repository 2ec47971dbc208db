//! `squall list`: lists the running games.

use crate::screen;
use anyhow::Result;
use bus::{Bus, BusError, Net, Watched};
use command_line::leaf_args::LeafArgs;
use messages::GameInfo;
use messages::run_state::{Phase, RunState};
use messages::topic::{self, GameName};
use std::collections::BTreeMap;
use std::process::ExitCode;
use std::sync::Arc;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    leaf: LeafArgs,
    /// Searches only as --connect and --lan specify, and ignores the games on this machine
    #[arg(long)]
    elsewhere: bool,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let mut places: Vec<Net> = Vec::new();
    if !args.elsewhere {
        let keys = args.leaf.access.keys()?;
        let place = |entry: bus::Entry| Net {
            connect: vec![entry.endpoint],
            keys: keys.clone(),
            ..Net::default()
        };
        places.extend(bus::local_registry().into_iter().map(place));
    }
    // Several games on this machine are not an error: list them all.
    places.extend(
        args.leaf
            .net()
            .ok()
            .filter(|net| net.lan || !places.iter().any(|p| p.connect == net.connect)),
    );
    let mut games: BTreeMap<GameName, String> = BTreeMap::new();
    for place in &places {
        match Bus::leaf(place) {
            Ok(bus) => {
                games.extend(games_at(&bus, place)?);
                bus.close();
            }
            Err(error @ (BusError::Keys(_) | BusError::NeedsKeys(_))) => {
                screen::remark(&error.to_string())
            }
            Err(error) if args.leaf.connects_to(place) => return Err(error.into()),
            // No answer means no game.
            Err(_) => {}
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
    let mut games = BTreeMap::new();
    for (game, sim) in keys.iter().filter_map(|key| topic::parse_alive(key)) {
        let mut text = format!(
            "{}  {}\n  sim {sim}\n",
            game.as_str(),
            place.connect.join(" ")
        );
        let answer = bus.ask(&topic::scenario(&game), Vec::new(), bus::ANSWER)?;
        if let Some(info) = answer.and_then(|bytes| serde_json::from_slice::<GameInfo>(&bytes).ok())
        {
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
        text.extend(run_state(bus, &game)?.map(|state| format!("  {}\n", in_words(&state))));
        games.insert(game, text);
    }
    Ok(games)
}

/// The state of a game, which its sim publishes many times a second.
fn run_state(bus: &Bus, game: &GameName) -> Result<Option<RunState>> {
    let newest = Arc::new(Watched::new(None));
    let told = Arc::clone(&newest);
    let take =
        move |bytes: &[u8]| told.visit(|newest| *newest = serde_json::from_slice(bytes).ok());
    let _subscription = bus.subscribe(topic::run(game), take)?;
    newest.wait(bus::ANSWER, Option::is_some);
    Ok(newest.visit(Option::take))
}

fn in_words(state: &RunState) -> String {
    let phase = match state.phase {
        Phase::Waiting => "waiting",
        Phase::Playing => "playing",
        Phase::Paused => "paused",
        Phase::Over => "over",
    };
    let missing = [("agents", &state.minds), ("gateways", &state.gateways)];
    let missing = missing.into_iter().filter(|(_, names)| !names.is_empty());
    let missing: String = missing
        .map(|(what, names)| format!(", for the {what} of {}", names.join(", ")))
        .collect();
    format!("{phase} at {:.0} s{missing}", state.now_s)
}
