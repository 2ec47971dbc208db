//! The network shell: connects a real boat to a game, and emulates a boat for real back seats.
//!
//! [`serve`] is for a real boat, `emulate` for a simulated one. All decisions are made in
//! [`crate::bridge`] and `crate::emulator`; this module contains the sockets, clocks and threads.

mod clock;
mod control_port;
#[cfg(feature = "emulator")]
mod emulator;
mod error;
mod game_finder;
mod game_terms;
mod gateway_loop;
mod guard;
mod join;
mod latency;
mod loop_input;
mod machine_check;
mod node_event;
mod report;
mod settings;
#[cfg(feature = "emulator")]
mod sitl_port;
mod subscriptions;
mod tcp_port;
mod terminal_key;

#[cfg(feature = "emulator")]
pub use emulator::{EmulatorSettings, FrontSeatSettings, emulate};
pub use error::NodeError;
pub use guard::guard;
pub use machine_check::machine_checks;
pub use node_event::NodeEvent;
pub use settings::Settings;
pub use terminal_key::on_enter;

use crate::bridge::{Bridge, Event};
use crate::game_clock::GameClock;
use crate::link::{BoatLink, Link, LinkAddress, LinkError, LinkEvent, LinkSettings, OnPort};
use crate::protocol::Protocol;
use crate::record::{self, StepEncoder};
use bus::token::Guard;
use bus::{LinkLock, LinkLockError, Token};
use clock::Clock;
use control_port::ControlPort;
use gateway_loop::{Counters, GatewayLoop, InGame};
use guard::Guarded;
use loop_input::{Call, LoopInput, LoopOutput, loop_input};
use primitives::SimTime;
use recording::{Facts, NewFile, Recorder, utc};
use std::net::SocketAddr;
use std::process::Command;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Interval at which a waiting thread checks whether it must end.
const POLL: Duration = Duration::from_millis(100);

/// A gateway's connections other than the game's network: the boat, and a port for operators.
pub struct Outside {
    /// The address of the boat.
    pub link: LinkAddress,
    /// Time without a byte after which the boat is treated as lost.
    pub silence: Duration,
    /// The address of the control port; port 0 means any free port.
    pub control: SocketAddr,
    /// Starts the process that calls [`guard()`] and stops the boat when this process cannot;
    /// `None` means no guard.
    pub guard: Option<Command>,
}

/// The callback for a link's events.
pub type OnLinkEvent = Box<dyn Fn(LinkEvent) + Send + Sync>;

/// Connects a real boat to a game until it is stopped. It first opens the link and sends the boat
/// standby, then searches for the game while serving operators. However the gateway ends, it sends
/// the boat standby.
///
/// # Errors
/// [`NodeError`] if another gateway on this machine holds the link, if the game refuses the boat,
/// or if the network, the link or the recording fails. A lost boat or sim is not an error: the
/// gateway waits for it.
pub fn serve(
    settings: &Settings,
    file: Option<NewFile>,
    outside: Outside,
    notify: &mut dyn FnMut(NodeEvent<'_>),
) -> Result<(), NodeError> {
    file.iter()
        .for_each(|file| notify(NodeEvent::Recording(file.path())));
    let _lock = match LinkLock::take(&outside.link.to_string()) {
        Ok(lock) => Some(lock),
        Err(held @ LinkLockError::Held { .. }) => return Err(held.into()),
        // Failure to write a file is no reason to abandon the boat.
        Err(LinkLockError::File { link, source }) => {
            warn(
                notify,
                format!("the link {link} is not locked against a second gateway: {source}"),
            );
            None
        }
    };
    let input = loop_input();
    // Fetch the token known so far. Nothing waits for it, and having no game yet is not an error.
    drop(settings.place.net(settings.game.as_ref()));
    // Until a game provides a token, the port uses its own, which it keeps in a game with keys.
    let token = settings.place.token.get().unwrap_or_else(Token::random);
    // Open the port before the link: if it is in use, report this before sending the boat anything.
    let port = ControlPort::open(
        outside.control,
        &settings.plan.vehicle,
        Some(token).into(),
        input.0.clone(),
    )?;
    // A boat that receives only standby needs no guard.
    let guard = outside.guard.filter(|_| !settings.plan.dry_run);
    let guarded = guard.and_then(|guard| start_guard(settings, guard, notify));
    let on_port = guarded
        .clone()
        .map(|guarded| -> OnPort { Box::new(move |descriptor| guarded.link(descriptor)) });
    let open = |on_event: OnLinkEvent| -> Result<Box<dyn BoatLink>, LinkError> {
        let link_settings = LinkSettings {
            silence: Some(outside.silence),
            ..LinkSettings::default()
        };
        Ok(Box::new(Link::open_watched(
            &outside.link,
            link_settings,
            on_port,
            on_event,
        )?))
    };
    connect(settings, input, file, (Some(port), guarded), open, notify)
}

/// Reports a warning before the gateway's clock has started.
fn warn(notify: &mut dyn FnMut(NodeEvent<'_>), text: String) {
    notify(NodeEvent::Event {
        at_s: 0.0,
        event: &Event::Warning(text),
    });
}

/// Starts the guard. If the guard cannot start, the boat is still served.
fn start_guard(
    settings: &Settings,
    mut command: Command,
    notify: &mut dyn FnMut(NodeEvent<'_>),
) -> Option<Guarded> {
    // The environment may contain the token and addresses; the guard needs neither.
    command.env_clear();
    let started = Guarded::start(
        command,
        &Protocol::new(&settings.plan.gateway).guard_message(),
    );
    let text = "no guard is running: if the gateway is killed, nothing stops the boat";
    started
        .inspect_err(|e| warn(notify, format!("{text}: {e}")))
        .ok()
}

/// Like [`serve`], without a control port, and over a link from `open`: for simulated networks.
///
/// # Errors
/// As for [`serve`].
pub fn serve_over(
    settings: &Settings,
    open: impl FnOnce(OnLinkEvent) -> Result<Box<dyn BoatLink>, LinkError>,
    notify: &mut dyn FnMut(NodeEvent<'_>),
) -> Result<(), NodeError> {
    connect(settings, loop_input(), None, (None, None), open, notify)
}

/// Opens the link, runs the loop, and finds the game in the meantime.
fn connect(
    settings: &Settings,
    (input, output): (LoopInput, LoopOutput),
    file: Option<NewFile>,
    (port, guarded): (Option<ControlPort>, Option<Guarded>),
    open: impl FnOnce(OnLinkEvent) -> Result<Box<dyn BoatLink>, LinkError>,
    notify: &mut dyn FnMut(NodeEvent<'_>),
) -> Result<(), NodeError> {
    if let Some(port) = &port {
        notify(NodeEvent::ControlPort {
            address: port.address,
            token: port.token().get(),
        });
    }
    let plan = &settings.plan;
    let recorder = file.and_then(|file| recorder(file, settings, notify));
    let calls = input.calls.clone();
    let link = open(Box::new(move |event| calls.put(Call::Link(event))))?;
    // The core's time starts here, at zero, so that a recording and its replay have the same times.
    let clock = Clock::start();
    let mut gateway_loop = GatewayLoop {
        game_clock: GameClock::new(SimTime::from_s(plan.gateway.order_ttl_s)),
        bridge: Bridge::new(plan.clone()),
        link,
        clock,
        input: output,
        in_game: None,
        settings,
        guarded,
        recorder,
        encoder: StepEncoder::new(&plan.vehicle),
        counters: Counters::new(),
        notify: &mut *notify,
        guard: Guard::new(settings.place.token.clone()),
        port: port.as_ref(),
    };
    // Search on a separate thread: a gateway that searched first would leave a moving boat
    // unattended.
    let finder = game_finder::begin(settings, input);
    port.iter().for_each(ControlPort::begin);
    let result = match &finder {
        Ok(_) => gateway_loop.run(&settings.stop),
        Err(e) => Err(NodeError::Refused(format!(
            "cannot start a thread to look for the game: {e}"
        ))),
    };
    if result.is_err() {
        gateway_loop.await_boat();
    }
    let status = gateway_loop.full_status();
    // Stop the boat before closing the network.
    let in_game = gateway_loop.in_game.take();
    let recorder = gateway_loop.recorder.take();
    drop(gateway_loop);
    let recorded = recorder.map(|recorder| recorder.end(Facts::new()));
    // Set the flag in every case; this also ends the search for a game.
    settings.stop.store(true, Ordering::Relaxed);
    drop((port, finder));
    notify(NodeEvent::Ended(&status));
    in_game.into_iter().for_each(InGame::leave);
    // Errors of the boat or the game take precedence.
    result.and(match recorded.as_ref().and_then(report::recording_fault) {
        Some(fault) => Err(NodeError::Recording(fault)),
        None => Ok(()),
    })
}

/// Starts the recording. If it cannot start, the boat is still served.
fn recorder(
    file: NewFile,
    settings: &Settings,
    notify: &mut dyn FnMut(NodeEvent<'_>),
) -> Option<Recorder> {
    let begun = Recorder::begin(
        file,
        &record::opening(&settings.plan, utc::now_ns(), settings.commit),
    );
    begun
        .inspect_err(|e| warn(notify, format!("nothing is recorded: {e}")))
        .ok()
}
