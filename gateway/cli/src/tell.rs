//! `gateway tell`: sends an operator command to a boat's gateway.
//!
//! Stop commands use every path at once. Other commands go straight to the gateway's control port
//! if it is known, and otherwise over the game's network. Commands for all boats use both.

use super::log_line::full;
use super::mission_file;
use anyhow::{Context, Error, Result, anyhow, bail};
use bus::stop::{StopClient, StopCommand, StopNews, StopOrders};
use bus::{Bus, BusError, Token, ask_gateway, clock};
use clap::ValueEnum;
use command_line::leaf_args::LeafArgs;
use command_line::number::{address, within};
use command_line::observer::Observer;
use command_line::terminal;
use messages::Control;
use messages::external::{BoatMode, FleetCommand, GatewayCommand, OperatorCommand, OperatorReply};
use messages::topic::{self, GameName};
use scenario::Scenario;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::OnceLock;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::Duration;

/// The name that addresses all boats at once.
pub(super) const ALL: &str = "all";
/// Timeout for a gateway's control port.
const PORT_ANSWER: Duration = Duration::from_secs(3);
/// Timeout for the next answer to a command for all boats.
const NEXT_ANSWER: Duration = Duration::from_secs(10);
/// Timeout for boats to report that they have stopped.
const STOP_MAX: Duration = Duration::from_secs(10);

#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    words: Words,
    /// Address of the gateway's control port, as the gateway prints it [default: that of the
    /// boat's gateway on this machine; without one, the command goes through the game]
    #[arg(long, value_name = "HOST:PORT", value_parser = address)]
    gateway: Option<SocketAddr>,
    #[command(flatten)]
    leaf: LeafArgs,
}

#[derive(clap::Args)]
pub(super) struct Words {
    /// Name of the vehicle, or "all" for estop, disarm, release and status
    pub(super) vehicle: String,
    /// Command to send
    pub(super) command: CommandArg,
    /// For mission: .sea file with the sentences to send, PSEAR and then OIWPL; waypoint 0 is the
    /// recovery point
    file: Option<PathBuf>,
    /// For hold-heading: true heading, degrees
    #[arg(long, value_name = "DEG", value_parser = within(0.0, 360.0, "degrees"))]
    heading_deg: Option<f64>,
    /// For hold-heading: thrust ahead, per cent of the maximum
    #[arg(long, value_name = "PCT", value_parser = within(0.0, 100.0, "per cent"))]
    thrust_pct: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum CommandArg {
    /// Prints the boat's status
    Status,
    /// Lets agents drive the boat, if it is ready
    Arm,
    /// Puts the boat in standby; agents no longer drive it
    Disarm,
    /// Keeps the boat in standby until it is released
    Estop,
    /// Ends the E-stop; the boat stays disarmed
    Release,
    /// Keeps station, using the boat's own controller
    StationKeep,
    /// Goes to the emergency recovery point, using the boat's own controller
    GoToErp,
    /// Uploads a mission and follows it, using the boat's own controller
    Mission,
    /// Holds a heading and a thrust, using the boat's own controller (mode C)
    HoldHeading,
    /// Starts the boat's own river navigation (mode N)
    RiverNav,
    /// Starts the boat's own autopilot (mode I)
    Autopilot,
    /// Calibrates the boat's compass (mode 3)
    CalibrateCompass,
    /// Selects the boat's depth mode (mode D)
    Depth,
    /// Selects the boat's gravity vector mode (mode S)
    GravityVector,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let command = args.words.command()?;
    if let Some(stop) = StopCommand::of(&command) {
        return tell_stop(args, stop);
    }
    if args.words.vehicle == ALL {
        return tell_all(args);
    }
    let reply = tell(args, &command)?;
    terminal::show(&full(&reply.status));
    match reply.refused {
        None => Ok(ExitCode::SUCCESS),
        Some(reason) => Err(anyhow!("refused by {}: {reason}", args.words.vehicle)),
    }
}

impl Words {
    /// The command for a boat.
    pub(super) fn command(&self) -> Result<OperatorCommand> {
        Ok(match (self.command, &self.file) {
            (CommandArg::Mission, None) => bail!("mission requires a .sea file"),
            (CommandArg::Mission, Some(path)) => {
                OperatorCommand::Mission(mission_file::read(path)?)
            }
            (_, Some(path)) => bail!("unexpected file {}; only mission takes one", path.display()),
            (CommandArg::HoldHeading, None) => match (self.heading_deg, self.thrust_pct) {
                (Some(heading_deg), Some(thrust_pct)) => OperatorCommand::Mode(BoatMode::Heading {
                    heading_deg,
                    thrust_pct,
                }),
                _ => bail!("hold-heading requires --heading-deg and --thrust-pct"),
            },
            _ if self.heading_deg.is_some() || self.thrust_pct.is_some() => {
                bail!("only hold-heading takes --heading-deg and --thrust-pct")
            }
            (CommandArg::RiverNav, None) => OperatorCommand::Mode(BoatMode::RiverNav),
            (CommandArg::Autopilot, None) => OperatorCommand::Mode(BoatMode::Autopilot),
            (CommandArg::CalibrateCompass, None) => {
                OperatorCommand::Mode(BoatMode::CompassCalibration)
            }
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
}

/// A control port, with the token of its gateway's game.
pub(super) struct Port {
    /// The boat, if known.
    pub(super) vehicle: Option<String>,
    pub(super) at: SocketAddr,
    pub(super) token: Option<Token>,
}

impl Port {
    fn ask(&self, command: &GatewayCommand) -> Result<OperatorReply, BusError> {
        ask_gateway(self.at, self.token.as_ref(), command, PORT_ANSWER)
    }
}

/// The known control ports.
fn ports(args: &Args) -> Result<Vec<Port>> {
    let given = args.leaf.access.token()?;
    let mut ports: Vec<Port> = Vec::new();
    let stops = args.words.vehicle == ALL
        && matches!(args.words.command, CommandArg::Estop | CommandArg::Disarm);
    for entry in args.leaf.local_gateways(stops) {
        let token = given.clone().or_else(|| entry.token?.parse().ok());
        ports.push(Port {
            vehicle: Some(entry.vehicle),
            at: entry.control,
            token,
        });
    }
    if let Some(at) = args.gateway
        && !ports.iter().any(|port| port.at == at)
    {
        // The token of the game on this machine, if any.
        let token = given.or_else(|| args.leaf.net().ok()?.token);
        ports.push(Port {
            vehicle: None,
            at,
            token,
        });
    }
    Ok(ports)
}

/// The known control ports selected by the arguments.
fn ports_meant(args: &Args) -> Result<Vec<Port>> {
    let vehicle = &args.words.vehicle;
    let is_meant = |port: &Port| match args.gateway {
        _ if vehicle == ALL => true,
        Some(at) => port.at == at,
        None => port.vehicle.as_ref() == Some(vehicle),
    };
    let mut ports = ports(args)?;
    ports.retain(is_meant);
    if let ([_, _, ..], true) = (ports.as_slice(), vehicle != ALL) {
        let at: Vec<String> = ports.iter().map(|port| port.at.to_string()).collect();
        bail!(
            "several gateways on this machine drive {vehicle}; select one with --gateway: {}",
            at.join(", ")
        );
    }
    Ok(ports)
}

fn tell(args: &Args, command: &OperatorCommand) -> Result<OperatorReply> {
    let vehicle = &args.words.vehicle;
    if let Some(port) = ports_meant(args)?.first() {
        match port.ask(&GatewayCommand::boat(vehicle, command.clone())) {
            // That gateway may be shutting down; its successor is found through the game.
            Err(error @ BusError::Use { .. }) if args.gateway.is_none() => {
                terminal::remark(&error.to_string())
            }
            reply => return Ok(reply?),
        }
    }
    let observer = Observer::connect(&args.leaf)?;
    observer.vehicle(vehicle)?;
    let reply = ask(&observer.bus, &observer.game, vehicle, command);
    observer.bus.close();
    reply
}

fn ask(
    bus: &Bus,
    game: &GameName,
    vehicle: &str,
    command: &OperatorCommand,
) -> Result<OperatorReply> {
    let answer = bus.request_node(&topic::operate(game, vehicle), command, bus::ANSWER)?;
    answer.with_context(|| format!("no gateway of {vehicle} is responding"))
}

/// Sends a command to a boat: to its control port if that is among `ports`, otherwise over the
/// game's network.
pub(super) fn to_boat(
    ports: &[Port],
    game: Option<&(Bus, GameName)>,
    vehicle: &str,
    command: &OperatorCommand,
) -> Result<OperatorReply> {
    let port = ports
        .iter()
        .find(|port| port.vehicle.as_deref() == Some(vehicle));
    let asked = port.map(|port| port.ask(&GatewayCommand::boat(vehicle, command.clone())));
    match (asked, game) {
        (Some(Ok(reply)), _) => Ok(reply),
        (None | Some(Err(BusError::Use { .. })), Some((bus, game))) => {
            ask(bus, game, vehicle, command)
        }
        (Some(Err(error)), _) => Err(error.into()),
        (None, None) => bail!("no gateway of {vehicle} is known"),
    }
}

/// Ends an E-stop of all boats in the game and at these ports. Returns the failures.
pub(super) fn release_all(ports: &[Port], game: Option<&(Bus, GameName)>) -> Vec<String> {
    std::thread::scope(|scope| {
        let release = |port: &Port| match port.ask(&GatewayCommand::Fleet(FleetCommand::Release)) {
            Ok(OperatorReply {
                refused: Some(reason),
                status,
            }) => Some(format!("refused by {}: {reason}", status.vehicle)),
            Ok(_) => None,
            Err(e) => Some(e.to_string()),
        };
        let asked: Vec<_> = ports
            .iter()
            .map(|port| scope.spawn(move || release(port)))
            .collect();
        let of_game = game.map(|(bus, game)| {
            bus::control(bus, game, Control::Release).map_err(|e| e.to_string())
        });
        let of_ports = asked
            .into_iter()
            .filter_map(|asked| asked.join().ok().flatten());
        of_game
            .into_iter()
            .filter_map(Result::err)
            .chain(of_ports)
            .collect()
    })
}

/// Stops one boat or all boats over every known path, and prints the reports.
fn tell_stop(args: &Args, command: StopCommand) -> Result<ExitCode> {
    let target = (args.words.vehicle != ALL).then_some(args.words.vehicle.as_str());
    let ports = ports_meant(args)?;
    let client = Arc::new(StopClient::open(STOP_MAX)?);
    client.stop(target, command);
    for port in &ports {
        client.add_gateway(port.at, port.vehicle.as_deref(), port.token.clone())?;
    }
    let no_game = Arc::new(OnceLock::new());
    // A gateway specified by address needs no game.
    if target.is_none() || args.gateway.is_none() {
        if let Ok(net) = args.leaf.net()
            && net.keys.is_none()
        {
            client.add_hub(&net.connect, args.leaf.game.as_ref(), net.token.as_ref())?;
        }
        let leaf = args.leaf.clone();
        let target = target.map(str::to_owned);
        let joins = Arc::clone(&client);
        let reason = Arc::clone(&no_game);
        std::thread::spawn(move || {
            if let Err(e) = join(&leaf, target.as_deref(), &joins) {
                drop(reason.set(command_line::explain::line(&e)));
                joins.visit(StopOrders::complete);
            }
        });
    }
    // If the game is the only path and does not exist, do not wait.
    client.wait(STOP_MAX, |orders| {
        orders.is_done(clock::now()) || no_game.get().is_some()
    });
    let is_alone = ports.is_empty() && no_game.get().is_some();
    let left = client.finish(if is_alone { Duration::ZERO } else { STOP_MAX });
    for news in client.visit(StopOrders::take_news) {
        if let StopNews::Done {
            vehicle,
            state,
            after,
            ..
        } = news
        {
            terminal::show(&format!(
                "{vehicle}: {} after {} ms\n",
                super::log_line::state(&state),
                after.as_millis()
            ));
        }
    }
    match (left.is_empty(), no_game.get()) {
        (true, None) if client.visit(|orders| orders.is_done(clock::now())) => {}
        (true, None) => terminal::remark(
            "the game does not respond; only the known gateways received the command",
        ),
        (true, Some(reason)) => terminal::remark(&format!(
            "only gateways received the command, not the game: {reason}"
        )),
        (false, None) => return Err(anyhow!(left.join("; "))),
        (false, Some(reason)) => return Err(anyhow!("{}; {reason}", left.join("; "))),
    }
    Ok(ExitCode::SUCCESS)
}

/// The names of the real boats in a game.
pub(super) fn real_boats(scenario: &Scenario) -> Vec<String> {
    scenario
        .externals()
        .map(|boat| scenario.vehicles[boat.index()].name.clone())
        .collect()
}

/// Adds the game's topics to the paths if the game has this boat.
fn join(leaf: &LeafArgs, target: Option<&str>, client: &StopClient) -> Result<()> {
    let observer = Observer::connect(leaf)?;
    let boats = real_boats(&observer.info.scenario);
    if let Some(target) = target {
        observer.vehicle(target)?;
        if !boats.iter().any(|boat| boat == target) {
            bail!("{target} is simulated and has no gateway");
        }
    }
    Ok(client.join(&observer.bus, &observer.game, &boats)?)
}

/// The result of one part of a command to all boats.
enum Outcome {
    /// The game accepted the command for all its boats.
    Told,
    /// No game exists.
    NoGame(Error),
    Reply(Box<OperatorReply>),
    Failed(Error),
}

impl Outcome {
    fn of(reply: Result<OperatorReply, impl Into<Error>>) -> Outcome {
        reply.map_or_else(
            |e| Outcome::Failed(e.into()),
            |reply| Outcome::Reply(Box::new(reply)),
        )
    }
}

/// Sends a command to all boats at once: over the game's network and straight to every known
/// gateway, in parallel. Prints the status of every real boat as it arrives.
fn tell_all(args: &Args) -> Result<ExitCode> {
    let (control, fleet) = match args.words.command {
        CommandArg::Status => (None, None),
        CommandArg::Release => (Some(Control::Release), Some(FleetCommand::Release)),
        _ => {
            bail!("`all` accepts only estop, disarm, release and status; address each boat by name")
        }
    };
    if control.is_some() {
        args.leaf.check_one_game(&args.leaf.local_gateways(false))?;
    }
    let ports = ports(args)?;
    let known: Vec<String> = ports
        .iter()
        .filter_map(|port| port.vehicle.clone())
        .collect();
    let (sender, outcomes) = channel();
    for port in ports {
        let sender = sender.clone();
        std::thread::spawn(move || {
            let name = port.vehicle.as_deref().unwrap_or_default();
            let status = GatewayCommand::boat(name, OperatorCommand::Status);
            let reply = port.ask(&fleet.map_or(status, GatewayCommand::Fleet));
            drop(sender.send(Outcome::of(reply)));
        });
    }
    let leaf = args.leaf.clone();
    std::thread::spawn(move || tell_game(&leaf, control, &known, &sender));
    let mut is_done = false;
    let mut no_game = None;
    let mut failed = Vec::new();
    loop {
        match outcomes.recv_timeout(NEXT_ANSWER) {
            Ok(Outcome::Told) => is_done = true,
            Ok(Outcome::NoGame(error)) => no_game = Some(error),
            Ok(Outcome::Failed(error)) => failed.push(command_line::explain::line(&error)),
            Ok(Outcome::Reply(reply)) => {
                is_done = true;
                terminal::show(&full(&reply.status));
                failed.extend(
                    reply
                        .refused
                        .map(|reason| format!("refused by {}: {reason}", reply.status.vehicle)),
                );
            }
            Err(RecvTimeoutError::Disconnected) => break,
            Err(RecvTimeoutError::Timeout) => {
                failed.push("not all boats responded".to_owned());
                break;
            }
        }
    }
    match no_game {
        Some(error) if is_done => terminal::remark(&format!(
            "only gateways received the command, not the game: {}",
            command_line::explain::line(&error)
        )),
        Some(error) => failed.push(command_line::explain::line(&error)),
        None => {}
    }
    if failed.is_empty() {
        Ok(ExitCode::SUCCESS)
    } else {
        Err(anyhow!(failed.join("; ")))
    }
}

/// Sends the command to the game, then queries the real boats in it except the `known` ones.
fn tell_game(
    leaf: &LeafArgs,
    control: Option<Control>,
    known: &[String],
    outcomes: &Sender<Outcome>,
) {
    // Ignore the error: after the timeout, no one is listening.
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
    for vehicle in real_boats(&observer.info.scenario)
        .iter()
        .filter(|vehicle| !known.contains(vehicle))
    {
        say(Outcome::of(ask(
            &observer.bus,
            &observer.game,
            vehicle,
            &OperatorCommand::Status,
        )));
    }
    observer.bus.close();
}
