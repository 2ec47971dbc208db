//! `gateway surveyor`: connects a real boat to a game.

use super::log_line::{Log, full};
use super::{guard, preflight_report};
use crate::link_arg::to_connect;
use anyhow::{Context, Result};
use bus::{GatewayEntry, Registration, Token};
use command_line::leaf_args::LeafArgs;
use command_line::number::{address, seconds};
use command_line::{program, stop};
use gateway::bridge::{Plan, Preflight};
use gateway::config::Gateway;
use gateway::link::LinkAddress;
use gateway::node::{NodeEvent, Outside, Settings, on_enter};
use messages::external::{GatewayCommand, OperatorCommand};
use recording::{NewFile, utc};
use std::io::IsTerminal;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

/// Timeout for the gateway's answer to a key on its own terminal.
const KEY_ANSWER: Duration = Duration::from_secs(2);

#[derive(clap::Args)]
pub struct Args {
    /// Name of the vehicle; the game must define it with source = "external"
    #[arg(long, value_name = "NAME")]
    vehicle: String,
    /// Link to the boat: tcp://HOST:PORT, udp://HOST:PORT, udp-listen://0.0.0.0:14550 or
    /// serial:///dev/ttyUSB0?baud=38400 (4800 to 921600 baud)
    #[arg(long, value_name = "URL", value_parser = to_connect)]
    link: LinkAddress,
    /// Address and port on this machine for operator commands, with or without a game; port 0
    /// selects a free port
    #[arg(long, value_name = "HOST:PORT", default_value = "127.0.0.1:0", value_parser = control_address)]
    control_listen: SocketAddr,
    /// Gateway settings: a file or a name [default: a Surveyor with conservative limits]
    #[arg(long, value_name = "GATEWAY", value_parser = command_line::scenario_files::file_of(scenario::Kind::of::<Gateway>()))]
    config: Option<PathBuf>,
    /// Arms once, as soon as the boat is ready; after a failsafe, an operator must arm it
    #[arg(long)]
    arm: bool,
    /// Runs as it would on the water, but sends the boat only standby commands
    #[arg(long)]
    dry_run: bool,
    /// Report of a passed `gateway check --vehicle`, needed to arm if the gateway file requires it
    #[arg(long, value_name = "FILE")]
    preflight: Option<PathBuf>,
    /// Allows arming without a pre-flight report; takes the name of the person responsible
    #[arg(long, value_name = "PERSON", conflicts_with = "preflight")]
    without_preflight: Option<String>,
    /// Records to this file [default: runs/gateway-NAME-UTC.mcap]
    #[arg(long, value_name = "FILE", conflicts_with = "no_record")]
    record: Option<PathBuf>,
    /// Does not record
    #[arg(long)]
    no_record: bool,
    /// Runs at the pace of the game; only for an emulated boat
    #[arg(long)]
    at_game_pace: bool,
    /// How long the boat may be silent before it is treated as lost, s
    #[arg(long, value_name = "S", default_value_t = 3.0, value_parser = seconds)]
    silence_s: f64,
    /// How long to look for the game, s; operators can connect in the meantime [default: no limit]
    #[arg(long, value_name = "S", value_parser = seconds)]
    wait_s: Option<f64>,
    #[command(flatten)]
    leaf: LeafArgs,
    /// Prints only errors, and exits when standard input closes
    #[arg(long, hide = true)]
    for_parent: bool,
}

pub(crate) fn run(args: &Args, commit: &'static str) -> Result<ExitCode> {
    let link = args.link.clone();
    let gateway = super::gateway_file(args.config.as_deref())?;
    let preflight = preflight(args, &link, &gateway)?;
    let stop = stop::on_ctrl_c_or_parent(args.for_parent)?;
    let record = recording(args)?;
    let log = Log::new(args.for_parent);
    if args.dry_run {
        log.remark("dry run: the boat receives only standby".to_owned());
    }
    if let Some(operator) = &args.without_preflight {
        log.remark(format!(
            "WARNING: {operator} is responsible for arming without a pre-flight check"
        ));
    }
    let game = args.leaf.game.as_ref().map(|game| game.as_str().to_owned());
    let settings = Settings {
        plan: Plan {
            arms_itself: args.arm,
            dry_run: args.dry_run,
            preflight,
            ..Plan::new(&args.vehicle, gateway)
        },
        game: args.leaf.game.clone(),
        place: args.leaf.place()?,
        at_game_pace: args.at_game_pace,
        commit,
        wait: args.wait_s.map_or(Duration::MAX, Duration::from_secs_f64),
        stop: stop.clone(),
    };
    let silence = Duration::from_secs_f64(args.silence_s);
    // No guard for an emulated boat at game pace: on a busy machine, the gateway would seem to
    // hang.
    let guard = if args.at_game_pace {
        None
    } else {
        Some(guard::own_command()?)
    };
    let outside = Outside {
        link,
        silence,
        control: args.control_listen,
        guard,
    };
    let mut last = String::new();
    let mut registration = None::<Registration>;
    let mut notify = |event: NodeEvent<'_>| match event {
        NodeEvent::Looking { reason } => {
            log.remark(format!("{}: looking for the game: {reason}", args.vehicle))
        }
        NodeEvent::Recording(file) => log.remark(format!("recording to {}", file.display())),
        // Only emulated boats report this.
        NodeEvent::Listening { .. } => {}
        NodeEvent::ControlPort {
            address: control,
            token,
        } => {
            let entry = GatewayEntry {
                vehicle: args.vehicle.clone(),
                game: game.clone(),
                control,
                pid: std::process::id(),
                token: token.as_ref().map(Token::hex),
            };
            match &registration {
                Some(registration) => drop(registration.update(&entry)),
                None => registration = announce(&entry, args.for_parent, &log),
            }
        }
        NodeEvent::Event { at_s, event } => log.event(at_s, event),
        NodeEvent::Status(status) => log.status(status),
        NodeEvent::Ended(status) => last = format!("\n{}", full(status)),
    };
    let served = gateway::node::serve(&settings, record, outside, &mut notify);
    drop(registration);
    log.end(last);
    served.with_context(|| format!("the gateway of {}", args.vehicle))?;
    Ok(ExitCode::SUCCESS)
}

/// Registers a gateway for operators on this machine, and prints how to reach it.
fn announce(entry: &GatewayEntry, for_parent: bool, log: &Log) -> Option<Registration> {
    // If registration fails, operators must be given the address; nothing else is affected.
    let registered = bus::register_gateway(entry).inspect_err(|error| {
        log.remark(format!(
            "operators on this machine must enter the address themselves: {error}"
        ));
    });
    let control = entry.control;
    log.remark(format!(
        "operators reach this gateway at {control}, with or without a game"
    ));
    if !for_parent && std::io::stdin().is_terminal() {
        log.remark("press Enter in this terminal for an E-stop of this boat".to_owned());
        let stop = GatewayCommand::boat(&entry.vehicle, OperatorCommand::EStop);
        // The log shows whether the command was carried out.
        on_enter(move || drop(bus::ask_gateway(control, None, &stop, KEY_ANSWER)));
    }
    registered.ok()
}

/// Parses the address of the control port. It must be specific, because operators are told to use
/// it.
fn control_address(text: &str) -> Result<SocketAddr, String> {
    let address = address(text)?;
    if address.ip().is_unspecified() {
        return Err(
            "expected the address at which operators reach this machine, not 0.0.0.0 or [::]"
                .to_owned(),
        );
    }
    Ok(address)
}

/// Whether the boat's pre-flight check allows arming.
fn preflight(args: &Args, link: &LinkAddress, gateway: &Gateway) -> Result<Preflight> {
    if let Some(person) = &args.without_preflight {
        return Ok(Preflight::WaivedBy(person.clone()));
    }
    let how = program::text(
        "{gateway} check --vehicle, then --preflight FILE; or --without-preflight PERSON",
    );
    Ok(match &args.preflight {
        Some(path) => {
            let report = preflight_report::read(path)?;
            let now_s = utc::now_ns() / 1_000_000_000;
            match report.admits(
                &args.vehicle,
                &link.to_string(),
                now_s,
                gateway.preflight.age_max_h,
            ) {
                Ok(()) => Preflight::Passed,
                Err(why) => Preflight::Missing(format!(
                    "a passed pre-flight check ({}: {why})",
                    path.display()
                )),
            }
        }
        None if gateway.preflight.required => {
            Preflight::Missing(format!("a passed pre-flight check ({how})"))
        }
        None => Preflight::NotRequired,
    })
}

/// The new file of the recording, if requested.
fn recording(args: &Args) -> Result<Option<NewFile>> {
    if args.no_record {
        return Ok(None);
    }
    let folder = Path::new("runs");
    let file = match &args.record {
        Some(path) if args.for_parent => NewFile::of_child(path),
        Some(path) => NewFile::create(path),
        None => {
            std::fs::create_dir_all(folder)
                .with_context(|| format!("cannot create the folder {}", folder.display()))?;
            let stem = format!(
                "gateway-{}-{}",
                args.vehicle,
                utc::file_stamp(utc::now_ns())
            );
            NewFile::create_numbered(folder, &stem)
        }
    };
    let place = args.record.as_deref().unwrap_or(folder);
    Ok(Some(file.with_context(|| {
        format!("cannot record to {}", place.display())
    })?))
}
