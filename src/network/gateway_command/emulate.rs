//! `squall gateway emulate`: a simulated boat for a real back seat or ground station.

use crate::stop;
use anyhow::{Context, Result, anyhow, bail};
use clap::ValueEnum;
use command_line::leaf_args::LeafArgs;
use command_line::number::{seconds, within};
use gateway::emulator::Extra;
use gateway::link::LinkAddress;
use gateway::node::{EmulatorSettings, FrontSeatSettings, NodeEvent};
use gateway_cli::log_line::Log;
use gateway_cli::protocol_arg::ProtocolArg;
use std::process::ExitCode;
use std::time::Duration;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Name of the vehicle in the game; the back seat becomes its agent
    #[arg(long, value_name = "NAME")]
    vehicle: String,
    /// Protocol of the boat
    #[arg(long, value_name = "PROTOCOL", value_enum, default_value_t = ProtocolArg::Surveyor)]
    protocol: ProtocolArg,
    /// Address for the back seat: tcp://HOST:PORT, udp://HOST:PORT, pty, pty:///LINK or
    /// serial:///dev/ttyUSB0?baud=38400
    #[arg(long, value_name = "URL")]
    listen: String,
    /// Address for the primary operator, who takes control with any command and returns it with OP2_ON in the text
    /// field
    #[arg(long, value_name = "URL")]
    primary: Option<String>,
    /// Address of a ground station that waits for the boat, for example udp://127.0.0.1:14550 for QGroundControl
    /// (MAVLink only)
    #[arg(long, value_name = "URL", conflicts_with = "primary")]
    ground_station: Option<String>,
    /// Magnetic declination, degrees east [default: from the World Magnetic Model, for the field and today]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    declination_deg: Option<f64>,
    /// Time without a command after which the boat goes to standby, s, or none; the real boat's value is unknown
    #[arg(long, value_name = "S", default_value = "none", value_parser = or_none(seconds))]
    watchdog_s: OrNone,
    /// Ignores a set-point that is not a whole number and keeps the previous one, as one known simulator does
    #[arg(long)]
    integers: bool,
    /// Additional sentences beyond a Surveyor's; gpsd needs rmc for time, speed and course
    #[arg(long, value_name = "KIND", value_delimiter = ',')]
    extra: Vec<ExtraArg>,
    /// Battery charge at the start, per cent, or none for a full battery that does not drain
    #[arg(long, value_name = "PCT", default_value = "100", value_parser = or_none(within(0.0, 100.0, "per cent")))]
    charge_pct: OrNone,
    #[command(flatten)]
    common: CommonArgs,
}

/// The options of every emulated boat.
#[derive(clap::Args)]
pub(super) struct CommonArgs {
    /// How long to look for the game, s
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = seconds)]
    wait_s: f64,
    /// How long the sim may go without sending a picture before it counts as lost, s
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = seconds)]
    silence_s: f64,
    #[command(flatten)]
    leaf: LeafArgs,
    /// Prints only errors, and stops when standard input ends
    #[arg(long, hide = true)]
    for_parent: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ExtraArg {
    /// Position, date, course and speed
    Rmc,
    /// True heading
    Hdt,
    /// Magnetic heading and variation
    Hdg,
    /// Time and date
    Zda,
}

impl ExtraArg {
    fn extra(&self) -> Extra {
        match self {
            ExtraArg::Rmc => Extra::Rmc,
            ExtraArg::Hdt => Extra::Hdt,
            ExtraArg::Hdg => Extra::Hdg,
            ExtraArg::Zda => Extra::Zda,
        }
    }
}

/// A number, displayed as "none" if missing.
#[derive(Clone, Copy, Debug)]
struct OrNone(Option<f64>);

fn or_none(number: impl Fn(&str) -> Result<f64, String> + Clone) -> impl Fn(&str) -> Result<OrNone, String> + Clone {
    move |text| match text {
        "none" => Ok(OrNone(None)),
        text => number(text).map(Some).map(OrNone).map_err(|e| format!("{e}, or none")),
    }
}

fn address(option: &str, text: &str) -> Result<LinkAddress> {
    LinkAddress::to_listen(text).map_err(|e| anyhow!("{option}: {e}"))
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let front_seat = front_seat(args)?;
    emulate(&args.vehicle, front_seat, &args.common)
}

fn front_seat(args: &Args) -> Result<FrontSeatSettings> {
    let listen = address("--listen", &args.listen)?;
    let charge = args.charge_pct.0.map(|pct| 0.01 * pct);
    match (args.protocol, &args.primary, &args.ground_station) {
        (ProtocolArg::Surveyor, _, Some(_)) => bail!("--ground-station requires --protocol mavlink"),
        (ProtocolArg::Mavlink, Some(_), _) => {
            bail!("--primary requires --protocol surveyor; for MAVLink, use --ground-station")
        }
        (ProtocolArg::Surveyor, primary, None) => Ok(FrontSeatSettings::Surveyor {
            listen,
            primary: primary.as_deref().map(|text| address("--primary", text)).transpose()?,
            declination_rad: args.declination_deg.map(f64::to_radians),
            watchdog_s: args.watchdog_s.0,
            integers: args.integers,
            extra: args.extra.iter().map(ExtraArg::extra).collect(),
            charge,
        }),
        (ProtocolArg::Mavlink, None, station) => {
            let connect = |text| LinkAddress::to_connect(text).map_err(|e| anyhow!("--ground-station: {e}"));
            let ground_station = station.as_deref().map(connect).transpose()?;
            Ok(FrontSeatSettings::ArduPilot { listen, ground_station, charge })
        }
    }
}

/// Runs a boat with this front seat until its game is over.
pub(super) fn emulate(vehicle: &str, front_seat: FrontSeatSettings, common: &CommonArgs) -> Result<ExitCode> {
    let stop = stop::on_ctrl_c_or_parent(common.for_parent)?;
    let leaf = common.leaf.clone().in_water();
    let settings = EmulatorSettings {
        place: leaf.place()?,
        game: leaf.game,
        vehicle: vehicle.to_owned(),
        front_seat,
        wait: Duration::from_secs_f64(common.wait_s),
        silence: Duration::from_secs_f64(common.silence_s),
        stop,
    };
    let log = Log::new(common.for_parent);
    let mut notify = |event: NodeEvent<'_>| match event {
        NodeEvent::Looking { reason } => log.remark(format!("{vehicle}: looking for the game: {reason}")),
        // The parent process may have requested any free port.
        NodeEvent::Listening { what, reach } => log.print(format!("{what} at {reach}\n")),
        NodeEvent::Event { at_s, event } => log.event(at_s, event),
        NodeEvent::Recording(_) | NodeEvent::ControlPort { .. } | NodeEvent::Status(_) | NodeEvent::Ended(_) => {}
    };
    let emulated = gateway::node::emulate(&settings, &mut notify);
    log.end(String::new());
    emulated.with_context(|| format!("the emulator of {vehicle}"))?;
    Ok(ExitCode::SUCCESS)
}
