//! `squall gateway tell`: an operator command to a boat's gateway.

use super::log_line::full;
use crate::net_args::LeafArgs;
use crate::observer::Observer;
use crate::screen;
use anyhow::{Context, Result, anyhow, bail};
use clap::ValueEnum;
use game::external::{Mission, OperatorCommand, OperatorReply};
use game::message::Control;
use game::scenario::Source;
use game::topic;
use gateway::nmea::{Framer, Sentence};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// All boats at once.
const ALL: &str = "all";

/// Whom, and what.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The vehicle, by name; all of them with "all", for estop, release and status
    vehicle: String,
    /// The command
    command: CommandArg,
    /// For mission: a .sea file, its lines as the boat receives them (PSEAR, then OIWPL; index 0 is the recovery point)
    file: Option<PathBuf>,
    #[command(flatten)]
    leaf: LeafArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum CommandArg {
    /// Print its status
    Status,
    /// Follow orders, if everything that this needs is there
    Arm,
    /// Do not follow orders any more: standby
    Disarm,
    /// Standby, and nothing else until it is released
    Estop,
    /// The E-stop is over; the boat stays safed
    Release,
    /// Keep the station by the boat's own controller
    StationKeep,
    /// Go to the emergency recovery point by the boat's own controller
    GoToErp,
    /// Upload a mission and sail it by the boat's own controller
    Mission,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let command = command_of(args)?;
    let observer = Observer::connect(&args.leaf)?;
    let result = if args.vehicle == ALL { tell_all(&observer, args.command) } else { tell(&observer, args, &command) };
    observer.bus.close();
    result
}

fn command_of(args: &Args) -> Result<OperatorCommand> {
    Ok(match (args.command, &args.file) {
        (CommandArg::Mission, None) => bail!("mission needs a .sea file"),
        (CommandArg::Mission, Some(path)) => OperatorCommand::Mission(mission(path)?),
        (_, Some(path)) => bail!("{} is given, and only mission takes a file", path.display()),
        (CommandArg::Status, None) => OperatorCommand::Status,
        (CommandArg::Arm, None) => OperatorCommand::Arm,
        (CommandArg::Disarm, None) => OperatorCommand::Disarm,
        (CommandArg::Estop, None) => OperatorCommand::EStop,
        (CommandArg::Release, None) => OperatorCommand::Release,
        (CommandArg::StationKeep, None) => OperatorCommand::StationKeep,
        (CommandArg::GoToErp, None) => OperatorCommand::GoToErp,
    })
}

fn tell(observer: &Observer, args: &Args, command: &OperatorCommand) -> Result<ExitCode> {
    observer.vehicle(&args.vehicle)?;
    let reply = ask(observer, &args.vehicle, command)?;
    screen::print(&full(&reply.status));
    match reply.refused {
        None => Ok(ExitCode::SUCCESS),
        Some(reason) => Err(anyhow!("{} refuses: {reason}", args.vehicle)),
    }
}

fn ask(observer: &Observer, vehicle: &str, command: &OperatorCommand) -> Result<OperatorReply> {
    let answer = observer.bus.request(&topic::operate(&observer.game, vehicle), command, bus::ANSWER)?;
    answer.with_context(|| format!("no gateway of {vehicle} answers"))
}

/// Sends a command to all boats and the sim at once; then prints the status of every real boat.
fn tell_all(observer: &Observer, command: CommandArg) -> Result<ExitCode> {
    let control = match command {
        CommandArg::Status => None,
        CommandArg::Estop => Some(Control::EStop),
        CommandArg::Release => Some(Control::Release),
        _ => bail!("only estop, release and status go to all; tell each boat by its name"),
    };
    if let Some(control) = control {
        bus::control(&observer.bus, &observer.game, control)?;
    }
    let scenario = &observer.info.scenario;
    let mut silent = Vec::new();
    for vehicle in scenario.vehicles.iter().filter(|vehicle| vehicle.source == Source::External) {
        match ask(observer, &vehicle.name, &OperatorCommand::Status) {
            Ok(reply) => screen::print(&full(&reply.status)),
            Err(_) => silent.push(vehicle.name.as_str()),
        }
    }
    if silent.is_empty() {
        return Ok(ExitCode::SUCCESS);
    }
    Err(anyhow!("no gateway answers of {}", silent.join(", ")))
}

/// The mission in a `.sea` file.
fn mission(path: &Path) -> Result<Mission> {
    let bytes = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let (mut throttle_pct, mut places, mut wrong) = (None, Vec::new(), None);
    let mut framer = Framer::new();
    framer.push(&[bytes.as_slice(), b"\r\n"].concat(), &mut |body| match Sentence::parse(body) {
        Ok(Sentence::MissionSettings(settings)) => throttle_pct = Some(settings.throttle_pct),
        Ok(Sentence::Waypoint(waypoint)) => places.push((waypoint.index, [waypoint.at.lat_deg, waypoint.at.lon_deg])),
        Ok(Sentence::Command(_)) => {}
        Ok(_) => wrong = Some(format!("{body:?} has no place in a mission")),
        Err(e) => wrong = Some(e.to_string()),
    });
    let counts = framer.counts();
    let unread = counts.bad_checksum + counts.broken + counts.overlong + counts.garbage;
    if unread > 0 {
        wrong = Some(format!(
            "{} wrong checksums, {} lines that are no sentences",
            counts.bad_checksum,
            unread - counts.bad_checksum
        ));
    }
    places.sort_by_key(|(index, _)| *index);
    let in_order = places.iter().enumerate().all(|(i, (index, _))| usize::from(*index) == i);
    if let Some(wrong) = wrong {
        bail!("{}: {wrong}", path.display());
    }
    if !in_order || places.len() < 2 {
        bail!(
            "{}: waypoints {:?}, expected 0 (the recovery point), 1 and so on",
            path.display(),
            places.iter().map(|(i, _)| i).collect::<Vec<_>>()
        );
    }
    let throttle_pct = throttle_pct.with_context(|| format!("{}: no PSEAR line with the throttle", path.display()))?;
    let mut places = places.into_iter().map(|(_, place)| place);
    let erp = places.next().context("a recovery point is there")?;
    Ok(Mission { throttle_pct, erp, waypoints: places.collect() })
}
