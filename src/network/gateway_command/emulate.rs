//! `squall gateway emulate`: a simulated boat for a real back seat or ground station.

use crate::stop;
use anyhow::{Context, Result, anyhow, bail};
use clap::ValueEnum;
use command_line::leaf_args::LeafArgs;
use command_line::number::{seconds, within};
use gateway::emulator::Extra;
use gateway::link::LinkAddress;
use gateway::node::{EmulatorSettings, NodeEvent};
use gateway_cli::log_line::Log;
use gateway_cli::protocol_arg::ProtocolArg;
use std::process::ExitCode;
use std::time::Duration;

/// Which boat, and where.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The vehicle in the game, by name: the back seat becomes its agent
    #[arg(long, value_name = "NAME")]
    vehicle: String,
    /// What the boat speaks
    #[arg(long, value_name = "PROTOCOL", value_enum, default_value_t = ProtocolArg::Surveyor)]
    protocol: ProtocolArg,
    /// Where the back seat connects: tcp://HOST:PORT, udp://HOST:PORT, pty, pty:///LINK, serial:///dev/ttyUSB0?baud=38400
    #[arg(long, value_name = "URL")]
    listen: String,
    /// Where the primary operator connects, who takes control by any command and gives it back with OP2_ON in the text field
    #[arg(long, value_name = "URL")]
    primary: Option<String>,
    /// A ground station that waits for the boat, as QGroundControl does at udp://127.0.0.1:14550 (MAVLink only)
    #[arg(long, value_name = "URL", conflicts_with = "primary")]
    ground_station: Option<String>,
    /// Magnetic north, degrees east of true [default: by the World Magnetic Model, for the field and today]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    declination_deg: Option<f64>,
    /// After this long without a command the boat goes to standby, s, or none: the real one's is not known
    #[arg(long, value_name = "S", default_value = "none", value_parser = watchdog)]
    watchdog_s: OrNone,
    /// A set-point that is not a whole number leaves the one before in force, as in one known stand-in
    #[arg(long)]
    integers: bool,
    /// Sentences beyond a Surveyor's: gpsd has time, speed and course only from rmc
    #[arg(long, value_name = "KIND", value_delimiter = ',')]
    extra: Vec<ExtraArg>,
    /// What is left in its battery at the beginning, %, or none: it is full and does not drain
    #[arg(long, value_name = "PCT", default_value = "100", value_parser = charge)]
    charge_pct: OrNone,
    /// How long to look for the game, s
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = seconds)]
    wait_s: f64,
    /// After this long without a picture the sim counts as lost, s
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = seconds)]
    silence_s: f64,
    #[command(flatten)]
    leaf: LeafArgs,
    /// Prints errors only, and stops when standard input ends
    #[arg(long, hide = true)]
    for_parent: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ExtraArg {
    /// Fix with date, course and speed
    Rmc,
    /// True heading
    Hdt,
    /// Magnetic heading and variation
    Hdg,
    /// Time and date
    Zda,
}

/// A number, displayed as "none" if missing.
#[derive(Clone, Copy, Debug)]
struct OrNone(Option<f64>);

fn or_none(text: &str, number: impl Fn(&str) -> Result<f64, String>) -> Result<OrNone, String> {
    match text {
        "none" => Ok(OrNone(None)),
        text => number(text).map(Some).map(OrNone).map_err(|e| format!("{e}, nor none")),
    }
}

fn watchdog(text: &str) -> Result<OrNone, String> {
    or_none(text, seconds)
}

fn charge(text: &str) -> Result<OrNone, String> {
    or_none(text, within(0.0, 100.0, "per cent"))
}

fn address(option: &str, text: &str) -> Result<LinkAddress> {
    LinkAddress::to_listen(text).map_err(|e| anyhow!("{option}: {e}"))
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let listen = address("--listen", &args.listen)?;
    let primary = match (&args.primary, &args.ground_station, args.protocol) {
        (None, None, _) => None,
        (Some(text), _, ProtocolArg::Surveyor) => Some(address("--primary", text)?),
        (_, Some(text), ProtocolArg::Mavlink) => {
            Some(LinkAddress::to_connect(text).map_err(|e| anyhow!("--ground-station: {e}"))?)
        }
        (Some(_), ..) => bail!("--primary is for a Surveyor: MAVLink has --ground-station"),
        (_, Some(_), _) => bail!("--ground-station is for --protocol mavlink"),
    };
    let stop = stop::on_ctrl_c_or_parent(args.for_parent)?;
    let extra = |kind: &ExtraArg| match kind {
        ExtraArg::Rmc => Extra::Rmc,
        ExtraArg::Hdt => Extra::Hdt,
        ExtraArg::Hdg => Extra::Hdg,
        ExtraArg::Zda => Extra::Zda,
    };
    let leaf = args.leaf.clone().in_water();
    let settings = EmulatorSettings {
        place: leaf.place()?,
        game: leaf.game,
        vehicle: args.vehicle.clone(),
        protocol: args.protocol.protocol(),
        listen,
        primary,
        declination_rad: args.declination_deg.map(f64::to_radians),
        watchdog_s: args.watchdog_s.0,
        integers: args.integers,
        extra: args.extra.iter().map(extra).collect(),
        charge: args.charge_pct.0.map(|pct| 0.01 * pct),
        wait: Duration::from_secs_f64(args.wait_s),
        silence: Duration::from_secs_f64(args.silence_s),
        stop,
    };
    let log = Log::new(args.for_parent);
    let mut notify = |event: NodeEvent<'_>| match event {
        NodeEvent::Looking { reason } => log.remark(format!("{}: looking for the game: {reason}", args.vehicle)),
        // The parent process may have requested any free port.
        NodeEvent::Listening { what, reach } => log.print(format!("{what} at {reach}\n")),
        NodeEvent::Event { at_s, event } => log.event(at_s, event),
        NodeEvent::Recording(_) | NodeEvent::ControlPort { .. } | NodeEvent::Status(_) | NodeEvent::Ended(_) => {}
    };
    let emulated = gateway::node::emulate(&settings, &mut notify);
    log.end(String::new());
    emulated.with_context(|| format!("the emulator of {}", args.vehicle))?;
    Ok(ExitCode::SUCCESS)
}
