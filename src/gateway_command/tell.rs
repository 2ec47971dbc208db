//! `squall gateway tell`: an operator command to a boat's gateway.
//!
//! It goes straight to the gateway's control port where that is known, and over the network of the game otherwise; to all boats
//! it goes both ways at once.

use super::log_line::full;
use super::mission_file;
use crate::net_args::LeafArgs;
use crate::observer::Observer;
use crate::screen;
use crate::water_args::within;
use anyhow::{Context, Error, Result, anyhow, bail};
use bus::{Bus, BusError, Token, ask_gateway};
use clap::ValueEnum;
use game::external::{BoatMode, FleetCommand, GatewayCommand, OperatorCommand, OperatorReply};
use game::message::Control;
use game::topic::{self, GameName};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::Duration;

/// All boats at once.
const ALL: &str = "all";
/// How long a gateway's control port may take to answer.
const PORT_ANSWER: Duration = Duration::from_secs(3);
/// How long to wait for the next answer of all.
const NEXT_ANSWER: Duration = Duration::from_secs(10);

/// Whom, and what.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The vehicle, by name; all of them with "all", for estop, release and status
    vehicle: String,
    /// The command
    command: CommandArg,
    /// For mission: a .sea file, its lines as the boat receives them (PSEAR, then OIWPL; index 0 is the recovery point)
    file: Option<PathBuf>,
    /// For hold-heading: the true heading, degrees
    #[arg(long, value_name = "DEG", value_parser = within(0.0, 360.0, "degrees"))]
    heading_deg: Option<f64>,
    /// For hold-heading: thrust ahead, % of all
    #[arg(long, value_name = "PCT", value_parser = within(0.0, 100.0, "per cent"))]
    thrust_pct: Option<f64>,
    /// The gateway's control port, as it shows it [default: those of this machine's gateways, or by way of the game]
    #[arg(long, value_name = "HOST:PORT")]
    gateway: Option<SocketAddr>,
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
    /// Hold a heading at a thrust by the boat's own controller (mode C)
    HoldHeading,
    /// The boat's own river navigation (mode N)
    RiverNav,
    /// The boat's own autopilot (mode I)
    Autopilot,
    /// Calibration of the boat's compass (mode 3)
    CalibrateCompass,
    /// The boat's mode for depth (D)
    Depth,
    /// The boat's mode for the direction of gravity (S)
    GravityVector,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let command = command_of(args)?;
    if args.vehicle == ALL {
        return tell_all(args);
    }
    let reply = tell(args, &command)?;
    screen::show(&full(&reply.status));
    match reply.refused {
        None => Ok(ExitCode::SUCCESS),
        Some(reason) => Err(anyhow!("{} refuses: {reason}", args.vehicle)),
    }
}

fn command_of(args: &Args) -> Result<OperatorCommand> {
    Ok(match (args.command, &args.file) {
        (CommandArg::Mission, None) => bail!("mission needs a .sea file"),
        (CommandArg::Mission, Some(path)) => OperatorCommand::Mission(mission_file::read(path)?),
        (_, Some(path)) => bail!("{} is given, and only mission takes a file", path.display()),
        (CommandArg::HoldHeading, None) => match (args.heading_deg, args.thrust_pct) {
            (Some(heading_deg), Some(thrust_pct)) => {
                OperatorCommand::Mode(BoatMode::Heading { heading_deg, thrust_pct })
            }
            _ => bail!("hold-heading needs --heading-deg and --thrust-pct"),
        },
        _ if args.heading_deg.is_some() || args.thrust_pct.is_some() => {
            bail!("--heading-deg and --thrust-pct are for hold-heading")
        }
        (CommandArg::RiverNav, None) => OperatorCommand::Mode(BoatMode::RiverNav),
        (CommandArg::Autopilot, None) => OperatorCommand::Mode(BoatMode::Autopilot),
        (CommandArg::CalibrateCompass, None) => OperatorCommand::Mode(BoatMode::CompassCalibration),
        (CommandArg::Depth, None) => OperatorCommand::Mode(BoatMode::Depth),
        (CommandArg::GravityVector, None) => OperatorCommand::Mode(BoatMode::GravityVector),
        (CommandArg::Status, None) => OperatorCommand::Status,
        (CommandArg::Arm, None) => OperatorCommand::Arm,
        (CommandArg::Disarm, None) => OperatorCommand::Disarm,
        (CommandArg::Estop, None) => OperatorCommand::EStop,
        (CommandArg::Release, None) => OperatorCommand::Release,
        (CommandArg::StationKeep, None) => OperatorCommand::StationKeep,
        (CommandArg::GoToErp, None) => OperatorCommand::GoToErp,
    })
}

/// A control port, and the token of the game of its gateway.
struct Port {
    /// The boat, where it is known.
    vehicle: Option<String>,
    at: SocketAddr,
    token: Option<Token>,
}

impl Port {
    fn ask(&self, command: &GatewayCommand) -> Result<OperatorReply, BusError> {
        ask_gateway(self.at, self.token.as_ref(), command, PORT_ANSWER)
    }
}

/// The control ports that are known.
fn ports(args: &Args) -> Result<Vec<Port>> {
    let given = args.leaf.token()?;
    let mut ports: Vec<Port> = Vec::new();
    let stops_all = args.vehicle == ALL && args.command == CommandArg::Estop;
    for entry in args.leaf.local_gateways(stops_all) {
        let token = given.clone().or_else(|| entry.token?.parse().ok());
        ports.push(Port { vehicle: Some(entry.vehicle), at: entry.control, token });
    }
    if let Some(at) = args.gateway
        && !ports.iter().any(|port| port.at == at)
    {
        // The game on this machine, if there is one.
        let token = given.or_else(|| args.leaf.net().ok()?.token);
        ports.push(Port { vehicle: None, at, token });
    }
    Ok(ports)
}

fn tell(args: &Args, command: &OperatorCommand) -> Result<OperatorReply> {
    let is_meant = |port: &Port| match args.gateway {
        Some(at) => port.at == at,
        None => port.vehicle.as_ref() == Some(&args.vehicle),
    };
    let mut ports = ports(args)?;
    ports.retain(is_meant);
    match ports.as_slice() {
        [] => {}
        [port] => {
            let command = GatewayCommand::Boat { name: args.vehicle.clone(), command: command.clone() };
            match port.ask(&command) {
                // It may be ending; the one that comes after it is found by way of the game.
                Err(error @ BusError::Use { .. }) if args.gateway.is_none() => screen::remark(&error.to_string()),
                reply => return Ok(reply?),
            }
        }
        several => {
            let at: Vec<String> = several.iter().map(|port| port.at.to_string()).collect();
            bail!(
                "several gateways on this machine are for {}: choose with --gateway among {}",
                args.vehicle,
                at.join(", ")
            );
        }
    }
    let observer = Observer::connect(&args.leaf)?;
    observer.vehicle(&args.vehicle)?;
    let reply = ask(&observer.bus, &observer.game, &args.vehicle, command);
    observer.bus.close();
    reply
}

fn ask(bus: &Bus, game: &GameName, vehicle: &str, command: &OperatorCommand) -> Result<OperatorReply> {
    let answer = bus.request_node(&topic::operate(game, vehicle), command, bus::ANSWER)?;
    answer.with_context(|| format!("no gateway of {vehicle} answers"))
}

/// What came of a part of a command to all.
enum Outcome {
    /// The game was told, and with it all boats in it.
    Told,
    /// There is no game to tell.
    NoGame(Error),
    Reply(Box<OperatorReply>),
    Failed(Error),
}

/// Sends a command to all boats: over the game's network and straight to every gateway that is known, at once. None waits for
/// another, and the status of every real boat is printed as it comes.
fn tell_all(args: &Args) -> Result<ExitCode> {
    let (control, fleet) = match args.command {
        CommandArg::Status => (None, None),
        CommandArg::Estop => (Some(Control::EStop), Some(FleetCommand::EStop)),
        CommandArg::Release => (Some(Control::Release), Some(FleetCommand::Release)),
        _ => bail!("only estop, release and status go to all; tell each boat by its name"),
    };
    let ports = ports(args)?;
    let known: Vec<String> = ports.iter().filter_map(|port| port.vehicle.clone()).collect();
    let (sender, outcomes) = channel();
    for port in ports {
        let sender = sender.clone();
        std::thread::spawn(move || {
            let name = port.vehicle.clone().unwrap_or_default();
            let status = GatewayCommand::Boat { name, command: OperatorCommand::Status };
            let reply = port.ask(&fleet.map_or(status, GatewayCommand::Fleet));
            drop(
                sender.send(reply.map_or_else(|e| Outcome::Failed(e.into()), |reply| Outcome::Reply(Box::new(reply)))),
            );
        });
    }
    let leaf = args.leaf.clone();
    std::thread::spawn(move || tell_game(&leaf, control, &known, &sender));
    let (mut is_done, mut no_game, mut failed) = (false, None, Vec::new());
    loop {
        match outcomes.recv_timeout(NEXT_ANSWER) {
            Ok(Outcome::Told) => is_done = true,
            Ok(Outcome::NoGame(error)) => no_game = Some(error),
            Ok(Outcome::Failed(error)) => failed.push(format!("{error:#}")),
            Ok(Outcome::Reply(reply)) => {
                is_done = true;
                screen::show(&full(&reply.status));
                failed.extend(reply.refused.map(|reason| format!("{} refuses: {reason}", reply.status.vehicle)));
            }
            Err(RecvTimeoutError::Disconnected) => break,
            Err(RecvTimeoutError::Timeout) => {
                failed.push("not everybody answers".to_owned());
                break;
            }
        }
    }
    match no_game {
        Some(error) if is_done => screen::remark(&format!("only gateways were told, and no game: {error:#}")),
        Some(error) => failed.push(format!("{error:#}")),
        None => {}
    }
    if failed.is_empty() { Ok(ExitCode::SUCCESS) } else { Err(anyhow!(failed.join("; "))) }
}

/// Tells the game, then asks for the status of the real boats in it but for `known` ones.
fn tell_game(leaf: &LeafArgs, control: Option<Control>, known: &[String], outcomes: &Sender<Outcome>) {
    // Nobody listens any more when the time is up.
    let say = |outcome| drop(outcomes.send(outcome));
    let observer = match Observer::connect(leaf) {
        Ok(observer) => observer,
        Err(error) => return say(Outcome::NoGame(error)),
    };
    if let Some(control) = control {
        match bus::control(&observer.bus, &observer.game, control) {
            Ok(()) => say(Outcome::Told),
            Err(error) => say(Outcome::Failed(error.into())),
        }
    }
    let scenario = &observer.info.scenario;
    for vehicle in scenario.externals().map(|vehicle| &scenario.vehicles[vehicle.index()].name) {
        if !known.contains(vehicle) {
            let reply = ask(&observer.bus, &observer.game, vehicle, &OperatorCommand::Status);
            say(reply.map_or_else(Outcome::Failed, |reply| Outcome::Reply(Box::new(reply))));
        }
    }
    observer.bus.close();
}
