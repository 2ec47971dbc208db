//! The network shell: connects a real boat with a game, and emulates a boat for real back seats.
//!
//! [`serve`] is for a real boat, `emulate` for a simulated one. All decisions are made in [`crate::bridge`] and
//! `crate::emulator`; here are the sockets, the clocks and the threads.

mod clock;
mod control_port;
#[cfg(feature = "emulator")]
mod emulator;
mod game_finder;
mod gateway_loop;
mod guard;
mod join;
mod latency;
mod loop_input;
mod machine_check;
mod payload;
mod report;
mod tcp_port;
mod terminal_key;

#[cfg(feature = "emulator")]
pub use emulator::{EmulatorSettings, emulate};
pub use guard::guard;
pub use machine_check::machine_checks;
pub use terminal_key::on_enter;

use crate::bridge::{Bridge, Event, Plan, Preflight};
use crate::declination::{DeclinationError, declination_deg};
use crate::game_clock::GameClock;
use crate::geofence::GeofenceError;
use crate::link::{BoatLink, Link, LinkAddress, LinkError, LinkEvent, LinkSettings, OnPort};
use crate::nmea::date_and_time;
use crate::payload::PayloadPort;
use crate::protocol::Protocol;
use crate::record::{self, StepEncoder};
use crate::supervisor::Scope;
use bus::game_search::NotFound;
use bus::token::{Checked, Guard};
use bus::{Bus, BusError, Declaration, LinkLock, LinkLockError, Place, Token};
use clock::Clock;
use control_port::ControlPort;
use game::external::{FleetCommand, GatewayCommand, GatewayStatus, OperatorCommand};
use game::frame::LatLon;
use game::gateway::Gateway;
use game::message::{Control, GameInfo};
use game::scenario::{Source, UnknownVehicle};
use game::topic::{self, GameName};
use game::{SimTime, VehicleId, codec};
use gateway_loop::{Counters, GatewayLoop, InGame};
use guard::Guarded;
use loop_input::{Call, LoopInput, LoopOutput, Stop, loop_input};
use machine_check::SPACE_MIN_MIB;
use payload::Payloads;
use recording::{NewFile, RecordError, Recorder, utc};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use thiserror::Error;

/// The settings of a gateway to a real boat.
pub struct Settings {
    /// The game; without a name, the only one there is.
    pub game: Option<GameName>,
    /// Where the sim is.
    pub place: Place,
    /// The boat's name in the game.
    pub vehicle: String,
    /// How it is driven and stopped.
    pub gateway: Gateway,
    /// Whether it arms by itself, once.
    pub arms_itself: bool,
    /// Whether the boat is sent nothing but standby.
    pub dry_run: bool,
    /// Whether its pre-flight check lets it be armed.
    pub preflight: Preflight,
    /// Whether its clock runs as fast as the game's: for emulated boats.
    pub at_game_pace: bool,
    /// The file of the recording, if any.
    pub record: Option<PathBuf>,
    /// The commit that the program was built from.
    pub commit: &'static str,
    /// How long to look for the game.
    pub wait: Duration,
    /// Set from outside to end.
    pub stop: Arc<AtomicBool>,
}

/// What a gateway has beside the network of the game: the way to its boat, a port for operators, and the boat's payloads.
pub struct Outside {
    /// The address of the boat.
    pub link: LinkAddress,
    /// After this long without a byte the boat counts as gone.
    pub silence: Duration,
    /// Where the control port listens; port 0 is any that is free.
    pub control: SocketAddr,
    /// Starts the process that calls [`guard()`] and stops the boat when this one cannot; `None` is without.
    pub guard: Option<GuardCommand>,
    /// The payloads of the boat that are passed through.
    pub payloads: Vec<PayloadPort>,
}

/// A command whose process calls [`guard()`].
pub struct GuardCommand {
    /// The file of the program.
    pub program: PathBuf,
    /// Its arguments.
    pub args: Vec<String>,
}

/// What a link tells its gateway.
pub type OnLinkEvent = Box<dyn Fn(LinkEvent) + Send + Sync>;

/// What a node reports to the program that runs it.
pub enum NodeEvent<'a> {
    /// It cannot begin yet.
    Looking {
        /// Why.
        reason: &'a str,
    },
    /// Something happened.
    Event {
        /// Time since it began, s.
        at_s: f64,
        /// What.
        event: &'a Event,
    },
    /// The status, twice a second.
    Status(&'a GatewayStatus),
    /// It has ended, with this status.
    Ended(&'a GatewayStatus),
    /// It records into this file.
    Recording(&'a Path),
    /// The control port is open, or asks for another token from now on.
    ControlPort {
        /// Where it listens.
        address: SocketAddr,
        /// The token that it asks for, if that is known.
        token: Option<Token>,
    },
    /// Others can connect here.
    Listening {
        /// Which port this is.
        what: &'a str,
        /// Its address.
        reach: &'a str,
    },
}

/// Why a gateway cannot work.
#[derive(Debug, Error)]
pub enum NodeError {
    /// The network failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// There is no game, or it refuses.
    #[error(transparent)]
    NotFound(#[from] NotFound),
    /// The link cannot be opened.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The control port cannot be opened.
    #[error("the control port {listen}: {source}")]
    ControlPort {
        /// Where it was to listen.
        listen: SocketAddr,
        /// Why.
        source: std::io::Error,
    },
    /// Another gateway has the link.
    #[error(transparent)]
    Locked(#[from] LinkLockError),
    /// The recording cannot be written.
    #[error("cannot record into {path}")]
    Record {
        /// The file.
        path: PathBuf,
        /// Why.
        source: RecordError,
    },
    /// The declination is not known.
    #[error("{0}; set declination_deg in the gateway's file")]
    Declination(#[from] DeclinationError),
    /// The game has no such boat.
    #[error(transparent)]
    UnknownVehicle(#[from] UnknownVehicle),
    /// The geofence does not go with the game.
    #[error("the gateway file {file}: geofence: {source}")]
    Geofence {
        /// The file's stem.
        file: String,
        /// Why.
        source: GeofenceError,
    },
    /// The game and the gateway do not go together.
    #[error("{0}")]
    Refused(String),
    /// The sim has died or fallen silent, and with it the emulated boat.
    #[error("the sim is gone: no picture for {0:.1?}")]
    SimGone(Duration),
    /// Another sim serves a game of the same name, and knows nothing of us.
    #[error("the sim is gone, and another one serves the game: join again")]
    SimReplaced,
}

/// Connects a real boat with a game until it is told to stop. The link comes first, and standby is the first thing that the boat
/// is sent; the game is looked for while operators are served. However it ends, the boat is sent standby.
///
/// # Errors
/// [`NodeError`] if another gateway on this machine has the link, if the game refuses, or if the network, the link or the
/// recording cannot work. A boat or a sim that goes away is none: the gateway waits for it.
pub fn serve(settings: &Settings, outside: &Outside, notify: &mut dyn FnMut(NodeEvent<'_>)) -> Result<(), NodeError> {
    // Before anything that others notice.
    let file = recording_file(settings, notify)?;
    let _lock = match LinkLock::take(&outside.link.to_string()) {
        Ok(lock) => Some(lock),
        Err(held @ LinkLockError::Held { .. }) => return Err(held.into()),
        // A boat is not left alone since a file cannot be written.
        Err(LinkLockError::File { link, source }) => {
            let text = format!("the link {link} is not locked against a second gateway: {source}");
            notify(NodeEvent::Event { at_s: 0.0, event: &Event::Warning(text) });
            None
        }
    };
    let input = loop_input();
    // What is known of the token by now; nothing is waited for.
    drop(settings.place.net(settings.game.as_ref()));
    // Until a game says which, the port has a token of its own; in a game with keys that stays so.
    let token = settings.place.token().get().unwrap_or_else(Token::random);
    let port = ControlPort::open(outside.control, &settings.vehicle, Some(token).into(), input.0.clone())?;
    // What is sent nothing but standby needs nobody to stop it.
    let guarded = if settings.dry_run { None } else { start_guard(settings, outside, notify) };
    let on_port = guarded.clone().map(|guarded| -> OnPort { Box::new(move |descriptor| guarded.link(descriptor)) });
    let open = |on_event: OnLinkEvent| -> Result<Box<dyn BoatLink>, LinkError> {
        let link_settings = LinkSettings { silence: Some(outside.silence), ..LinkSettings::default() };
        Ok(Box::new(Link::open_watched(&outside.link, link_settings, on_port, on_event)?))
    };
    connect(settings, input, file, (Some(port), guarded, &outside.payloads), open, notify)
}

/// The guard, where there is to be one. A boat is not left alone since it cannot be started.
fn start_guard(settings: &Settings, outside: &Outside, notify: &mut dyn FnMut(NodeEvent<'_>)) -> Option<Guarded> {
    let GuardCommand { program, args } = outside.guard.as_ref()?;
    let mut command = Command::new(program);
    command.args(args).env_clear();
    let started = Guarded::start(command, &Protocol::new(&settings.gateway).guard_message());
    if let Err(e) = &started {
        let text = format!("there is no guard, so if the gateway is killed, nobody stops the boat: {e}");
        notify(NodeEvent::Event { at_s: 0.0, event: &Event::Warning(text) });
    }
    started.ok()
}

/// As [`serve`], without a control port and over a link that `open` gives: for networks that are simulated.
///
/// # Errors
/// [`NodeError`], as there.
pub fn serve_over(
    settings: &Settings,
    open: impl FnOnce(OnLinkEvent) -> Result<Box<dyn BoatLink>, LinkError>,
    notify: &mut dyn FnMut(NodeEvent<'_>),
) -> Result<(), NodeError> {
    let file = recording_file(settings, notify)?;
    connect(settings, loop_input(), file, (None, None, &[]), open, notify)
}

/// Opens the link, runs the loop, and finds the game meanwhile.
fn connect(
    settings: &Settings,
    (input, output): (LoopInput, LoopOutput),
    file: Option<NewFile>,
    (port, guarded, payloads): (Option<ControlPort>, Option<Guarded>, &[PayloadPort]),
    open: impl FnOnce(OnLinkEvent) -> Result<Box<dyn BoatLink>, LinkError>,
    notify: &mut dyn FnMut(NodeEvent<'_>),
) -> Result<(), NodeError> {
    if let Some(port) = &port {
        notify(NodeEvent::ControlPort { address: port.address, token: port.token.get() });
    }
    let plan = Plan {
        vehicle: settings.vehicle.clone(),
        gateway: settings.gateway.clone(),
        site: None,
        arms_itself: settings.arms_itself,
        dry_run: settings.dry_run,
        preflight: settings.preflight.clone(),
    };
    let recorder = file.and_then(|file| recorder(file, settings, &plan, notify));
    let calls = input.calls.clone();
    let link = open(Box::new(move |event| calls.put(Call::Link(event))))?;
    let clock = Clock::start();
    let record = recorder.as_ref().map(Recorder::bulk).zip(settings.record.clone());
    let shell = payload::Shell { record, space_min_mib: SPACE_MIN_MIB, clock, calls: input.calls.clone() };
    let payloads = Payloads::open(payloads, &shell, notify);
    let mut gateway_loop = GatewayLoop {
        game_clock: GameClock::new(SimTime::from_s(plan.gateway.order_ttl_s)),
        bridge: Bridge::new(plan),
        link,
        clock,
        input: output,
        in_game: None,
        settings,
        guarded,
        back: input.clone(),
        recorder,
        encoder: StepEncoder::new(&settings.vehicle),
        counters: Counters::new(),
        notify: &mut *notify,
        guard: Guard::new(settings.place.token().clone()),
        port: port.as_ref().map(|port| (port.address, port.token.clone())),
    };
    let finder = game_finder::begin(settings, input);
    port.iter().for_each(ControlPort::begin);
    let result = match &finder {
        Ok(_) => gateway_loop.run(&settings.stop),
        Err(e) => Err(NodeError::Refused(format!("no thread to look for the game: {e}"))),
    };
    if result.is_err() {
        gateway_loop.await_boat();
    }
    let status = gateway_loop.full_status();
    // The boat is stopped before the network closes.
    let in_game = gateway_loop.in_game.take();
    drop(gateway_loop);
    // It ends however it came to that; who looks for a game does so too.
    settings.stop.store(true, Ordering::Relaxed);
    drop((port, finder, payloads));
    notify(NodeEvent::Ended(&status));
    in_game.into_iter().for_each(InGame::leave);
    result
}

/// The file of the recording, if there is to be one.
fn recording_file(settings: &Settings, notify: &mut dyn FnMut(NodeEvent<'_>)) -> Result<Option<NewFile>, NodeError> {
    let Some(path) = &settings.record else { return Ok(None) };
    let file = NewFile::create(path).map_err(|source| NodeError::Record { path: path.clone(), source })?;
    notify(NodeEvent::Recording(path));
    Ok(Some(file))
}

/// The recording. A boat is not left alone since it cannot begin.
fn recorder(
    file: NewFile,
    settings: &Settings,
    plan: &Plan,
    notify: &mut dyn FnMut(NodeEvent<'_>),
) -> Option<Recorder> {
    let begun = Recorder::begin(file, &record::opening(plan, utc::now_ns(), settings.commit));
    if let Err(e) = &begun {
        notify(NodeEvent::Event { at_s: 0.0, event: &Event::Warning(format!("nothing is recorded: {e}")) });
    }
    begun.ok()
}

/// Subscribes to what comes from the sim and from operators.
fn subscribe(
    bus: &Bus,
    game: &GameName,
    info: &GameInfo,
    vehicle: VehicleId,
    input: &LoopInput,
) -> Result<Vec<Declaration>, BusError> {
    let scenario = &info.scenario;
    let [orders, queries, stops, controls, releases, frames] = std::array::from_fn(|_| input.clone());
    let take_order = move |bytes: &[u8]| {
        let Ok(order) = codec::decode(bytes) else { return };
        let mut latest_order = orders.latest_order.lock();
        // A call that still waits will find the newest.
        if latest_order.replace((order, bus::clock::now())).is_none() {
            orders.calls.put(Call::Order);
        }
    };
    let name = &scenario.vehicles[vehicle.index()].name;
    let mut subscriptions = vec![
        bus.subscribe(topic::external_order(game, scenario, vehicle), take_order)?,
        bus.answer(topic::operate(game, name), move |query| {
            // It is read again, to be answered, behind others.
            let command = Guard::default().check(query.key(), query.payload(), OperatorCommand::needs_token);
            if let Checked::Granted(command) = command
                && let Some(stop) = Stop::of(&command)
            {
                queries.stop(stop);
            }
            queries.query(query);
        })?,
        bus.subscribe(topic::stop(game, name), move |bytes| {
            if let Some(stop) = stop_in(bytes) {
                stops.stop(stop);
            }
        })?,
        bus.subscribe(topic::control(game), move |bytes| {
            // Everything else reaches the boat as an order, if at all.
            if let Ok(Control::EStop) = serde_json::from_slice(bytes) {
                controls.stop(Stop::EStop(Scope::Fleet));
            }
        })?,
        bus.subscribe(topic::released(game), move |_| releases.calls.put(Call::Release))?,
    ];
    // Frames are published only where somebody subscribes.
    if scenario.externals().nth(1).is_some() {
        let take_frame = move |bytes: &[u8]| frames.calls.put(Call::Frame(bytes.to_vec()));
        subscriptions.push(bus.subscribe(topic::frame(game), take_frame)?);
    }
    Ok(subscriptions)
}

/// What is published to stop the boat: an operator's command, or one for all boats.
fn stop_in(bytes: &[u8]) -> Option<Stop> {
    match serde_json::from_slice(bytes) {
        Ok(GatewayCommand::Fleet(FleetCommand::EStop)) => Some(Stop::EStop(Scope::Fleet)),
        _ => Stop::of(&serde_json::from_slice(bytes).ok()?),
    }
}

fn external_vehicle(info: &GameInfo, name: &str) -> Result<VehicleId, NodeError> {
    let vehicle = info.scenario.vehicle_named(name)?;
    if info.scenario.vehicles[vehicle.index()].source == Source::External {
        return Ok(vehicle);
    }
    Err(NodeError::Refused(format!("{name} is simulated in this game: a real boat needs source = \"external\"")))
}

/// How many seconds of the game pass in a second of real time.
fn pace_factor(pace: &str, at_game_pace: bool) -> Result<f64, NodeError> {
    match (pace, at_game_pace) {
        ("realtime", _) => Ok(1.0),
        (pace, true) => pace
            .strip_suffix('x')
            .and_then(|factor| factor.parse().ok())
            .ok_or_else(|| NodeError::Refused(format!("the game's pace is {pace}, expected realtime or a factor"))),
        (pace, false) => Err(NodeError::Refused(format!(
            "the game's pace is {pace}, expected realtime: a real boat sails in real time (--at-game-pace is for emulated ones)"
        ))),
    }
}

/// The declination as it is set, or else that of here and today; east positive, rad.
fn declination_rad(set_rad: Option<f64>, at: LatLon) -> Result<f64, NodeError> {
    let today_rad = || Ok(declination_deg(at, date_and_time(utc::now_ns()).0)?.to_radians());
    set_rad.map_or_else(today_rad, Ok)
}
