//! `gateway check`: checks a boat's sensors and, for a named vehicle, whether it may be armed.

use super::preflight_report;
use super::swing_guide::{Guide, guided_checks};
use crate::link_arg::to_connect;
use anyhow::{Context, Result, bail};
use bus::game_search::GameSearch;
use command_line::leaf_args::LeafArgs;
use command_line::number::seconds;
use command_line::stop;
use command_line::terminal;
use gateway::config::{BoatProtocol, Gateway};
use gateway::geofence::GeofenceArea;
use gateway::link::{BoatLink, Link, LinkAddress, LinkEvent, LinkSettings};
use gateway::node::machine_checks;
use gateway::preflight::{Report, Water, boat_checks};
use gateway::sensor_check::{HostTime, SensorCheck};
use primitives::SimTime;
use recording::utc;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::{Duration, Instant};

/// Default time to listen, without and with a pre-flight check, s.
const LISTEN_S: [f64; 2] = [10.0, 30.0];
/// Maximum length of a displayed sentence or message, characters.
const LAST_MAX: usize = 90;
/// Timeout for finding the game.
const GAME_WAIT: Duration = Duration::from_secs(5);

#[derive(clap::Args)]
pub struct Args {
    /// Link to the boat: tcp://HOST:PORT, udp://HOST:PORT, udp-listen://0.0.0.0:14550 or
    /// serial:///dev/ttyUSB0?baud=38400 (4800 to 921600 baud)
    #[arg(long, value_name = "URL", value_parser = to_connect)]
    link: LinkAddress,
    /// How long to listen, s [default: 10, or 30 with --vehicle]
    #[arg(long, value_name = "S", value_parser = seconds)]
    for_s: Option<f64>,
    /// Runs the pre-flight check for this vehicle, using the field of its game
    #[arg(long, value_name = "NAME")]
    vehicle: Option<String>,
    /// Gateway settings: a file or a name [default: a Surveyor with conservative limits]
    #[arg(long, value_name = "GATEWAY", value_parser = command_line::scenario_files::file_of(scenario::Kind::of::<Gateway>()))]
    config: Option<PathBuf>,
    /// Guides you through a compass swing and a propeller test, for which you drive the boat by
    /// remote control; asks before each step
    #[arg(long, requires = "vehicle")]
    guided: bool,
    /// Writes the report to this JSON file, and a text copy to a .txt file beside it [default:
    /// runs/preflight-NAME.json]
    #[arg(long, value_name = "FILE", requires = "vehicle")]
    report: Option<PathBuf>,
    #[command(flatten)]
    leaf: LeafArgs,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let address = args.link.clone();
    let gateway = super::gateway_file(args.config.as_deref())?;
    let stop = stop::on_ctrl_c()?;
    let (sender, events) = sync_channel(4096);
    // A full queue drops events, which is harmless because this command only listens.
    let take = move |event| drop(sender.try_send(event));
    let link = Link::open(
        &address,
        LinkSettings {
            silence: None,
            ..LinkSettings::default()
        },
        take,
    )?;
    let for_s = args
        .for_s
        .unwrap_or(LISTEN_S[usize::from(args.vehicle.is_some())]);
    let sends = if gateway.protocol == BoatProtocol::Mavlink {
        "only requests for telemetry"
    } else {
        "nothing"
    };
    let hello = format!("listening for {for_s} s, sending {sends}");
    let check = SensorCheck::new(&gateway);
    let start = bus::clock::now();
    let mut listener = Listener {
        check,
        link,
        events,
        start,
        stop,
        reason: None,
        hello,
    };
    listener.listen(&mut |listener| listener.now().as_s() >= for_s);
    let check = &listener.check;
    if check.received.is_empty() {
        let reason = listener.reason.clone().unwrap_or_else(|| check.unread());
        bail!(
            "no valid sentences from {address} within {for_s} s: {reason} ({})",
            counted(check)
        );
    }
    // Read the clocks before the search for the game, which takes time.
    let host = HostTime {
        now: listener.now(),
        utc_ns: utc::now_ns(),
    };
    terminal::print(&report(check, host));
    let Some(vehicle) = &args.vehicle else {
        let is_well = check.missing().is_empty() && check.clock_fault(host).is_none();
        return Ok(if is_well {
            ExitCode::SUCCESS
        } else {
            ExitCode::FAILURE
        });
    };
    let water = water(args, vehicle, &gateway, &listener.stop)?;
    let mut checks = boat_checks(check, host, &gateway, water.as_ref());
    let path = args
        .report
        .clone()
        .unwrap_or_else(|| Path::new("runs").join(format!("preflight-{vehicle}.json")));
    let folder = path
        .parent()
        .filter(|folder| *folder != Path::new(""))
        .unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot create the folder {}", folder.display()))?;
    checks.extend(machine_checks(folder));
    checks.extend(guided_checks(
        &mut Guide::new(args.guided),
        &mut listener,
        &gateway,
    ));
    let now_ns = utc::now_ns();
    let at_unix_s = now_ns / 1_000_000_000;
    let at = utc::text(now_ns);
    let made = Report {
        vehicle: vehicle.clone(),
        link: address.to_string(),
        at_unix_s,
        at,
        checks,
    };
    terminal::print(&format!("\n{}", made.text()));
    preflight_report::write(&path, &made)?;
    terminal::remark(&format!("report: {}", path.display()));
    Ok(if made.faults().is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

/// The boat's site in the running game, if there is one.
fn water(
    args: &Args,
    vehicle: &str,
    gateway: &Gateway,
    stop: &AtomicBool,
) -> Result<Option<Water>> {
    let mut tell = |reason: &str| terminal::remark(&format!("looking for the game: {reason}"));
    let place = args.leaf.place()?;
    let found = GameSearch::new(GAME_WAIT, stop).game(&mut tell, &place, args.leaf.game.as_ref());
    let (bus, _, info) = match found {
        Ok(found) => found,
        Err(e) => {
            terminal::remark(&format!("no game: {e}"));
            return Ok(None);
        }
    };
    bus.close();
    let number = info.scenario.vehicle_named(vehicle)?;
    let area = GeofenceArea::new(&info.scenario.field, &gateway.geofence);
    area.check(&info.scenario, number)
        .with_context(|| format!("the gateway file {}: geofence", gateway.name))?;
    Ok(Some(Water {
        field: info.scenario.field,
        area,
    }))
}

/// Listens to a boat and counts its messages.
pub(super) struct Listener {
    pub(super) check: SensorCheck,
    link: Link,
    events: Receiver<LinkEvent>,
    start: Instant,
    stop: Arc<AtomicBool>,
    /// Why the boat cannot be reached, if it cannot.
    reason: Option<String>,
    /// Message printed when the boat connects.
    hello: String,
}

impl Listener {
    /// Sends queries for data that the boat sends only on request.
    fn ask(&mut self) {
        let now = self.now();
        let mut bytes = vec![];
        self.check.write_questions(now, &mut bytes);
        if !bytes.is_empty() {
            self.link.send(bytes, 0);
        }
    }

    fn at(&self, moment: Instant) -> SimTime {
        SimTime::from_s(moment.saturating_duration_since(self.start).as_secs_f64())
    }

    /// Time since the start.
    pub(super) fn now(&self) -> SimTime {
        self.at(bus::clock::now())
    }

    /// Listens until `is_enough` returns true; calls it after every event and ten times a second.
    pub(super) fn listen(&mut self, is_enough: &mut dyn FnMut(&Listener) -> bool) {
        while !self.stop.load(Ordering::Relaxed) {
            self.ask();
            match self.events.recv_timeout(Duration::from_millis(100)) {
                Ok(LinkEvent::Bytes { at, bytes, .. }) => self.check.receive(self.at(at), &bytes),
                Ok(LinkEvent::Up { name, .. }) => {
                    self.reason = None;
                    terminal::remark(&format!("connected to {name}; {}", self.hello));
                }
                Ok(LinkEvent::Failed { reason: why, .. } | LinkEvent::Down { reason: why, .. }) => {
                    if self.reason.as_ref() != Some(&why) {
                        terminal::remark(&why);
                    }
                    self.reason = Some(why);
                }
                Ok(LinkEvent::Written { .. }) | Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            if is_enough(self) {
                break;
            }
        }
    }
}

/// The message counts of the link, for display.
fn counted(check: &SensorCheck) -> String {
    check
        .counts()
        .iter()
        .map(|(name, count)| format!("{count} {name}"))
        .collect::<Vec<_>>()
        .join(", ")
}

fn report(check: &SensorCheck, host: HostTime) -> String {
    let width = check
        .received
        .keys()
        .map(String::len)
        .max()
        .unwrap_or(0)
        .max(10);
    let mut lines = vec![format!(
        "{:<width$} {:>7} {:>8}  last",
        "name", "count", "1/s"
    )];
    for (name, received) in &check.received {
        let rate = received
            .rate_hz()
            .map_or("-".to_owned(), |rate| format!("{rate:.2}"));
        let note = if received.unreadable > 0 {
            "  (not read)"
        } else {
            ""
        };
        let last: String = received.last.chars().take(LAST_MAX).collect();
        lines.push(format!(
            "{name:<width$} {:>7} {rate:>8}  {last}{note}",
            received.count
        ));
        let why = received.why_unreadable.as_ref();
        lines.extend(why.map(|why| {
            format!(
                "{:<width$} {:>7} unreadable: {why}",
                "", received.unreadable
            )
        }));
    }
    lines.push(format!("\n{}", counted(check)));
    lines.extend(check.findings(host));
    let mut missing = check.missing();
    missing.extend(
        check
            .clock_fault(host)
            .map(|fault| format!("a correct clock: {fault}")),
    );
    if missing.is_empty() {
        lines.push("\nnothing is missing".to_owned());
    } else {
        lines.push("\nmissing:".to_owned());
        lines.extend(missing.iter().map(|what| format!("  {what}")));
    }
    lines.join("\n") + "\n"
}
