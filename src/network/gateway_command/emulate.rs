//! `squall gateway emulate`: a simulated boat for a real back seat or ground station.

use crate::stop;
use anyhow::{Context, Result, bail};
use clap::ValueEnum;
use command_line::explain::UsageError;
use command_line::leaf_args::LeafArgs;
use command_line::number::{seconds, within};
use gateway::emulator::Extra;
use gateway::link::LinkAddress;
use gateway::node::{EmulatorSettings, FrontSeatSettings, NodeEvent};
use gateway_cli::link_arg::{to_connect, to_listen};
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
    #[arg(long, value_name = "URL", value_parser = to_listen)]
    listen: LinkAddress,
    /// Address for the primary operator, who takes control with any command and returns it with
    /// OP2_ON in the text field
    #[arg(long, value_name = "URL", value_parser = to_listen)]
    primary: Option<LinkAddress>,
    /// Address of a ground station that waits for the boat, for example udp://127.0.0.1:14550 for
    /// QGroundControl (MAVLink only)
    #[arg(long, value_name = "URL", conflicts_with = "primary", value_parser = to_connect)]
    ground_station: Option<LinkAddress>,
    /// Magnetic declination, degrees east [default: from the World Magnetic Model, for the field
    /// and today]
    #[arg(long, value_name = "DEG", value_parser = within(-180.0, 180.0, "degrees"))]
    declination_deg: Option<f64>,
    /// Time without a command after which the boat goes to standby, s, or none; the real boat's
    /// value is unknown
    #[arg(long, value_name = "S", default_value = "none", value_parser = or_none(seconds))]
    watchdog_s: OrNone,
    /// Ignores fractional set-points and keeps the previous one, as one known simulator does
    #[arg(long)]
    integers: bool,
    /// Sentences to send in addition to a Surveyor's; gpsd needs rmc for time, speed and course
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
    /// How long the sim may go without sending a picture before it is treated as lost, s
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = seconds)]
    silence_s: f64,
    #[command(flatten)]
    leaf: LeafArgs,
    /// Prints only errors, and exits when standard input closes
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

fn or_none(
    number: impl Fn(&str) -> Result<f64, String> + Clone,
) -> impl Fn(&str) -> Result<OrNone, String> + Clone {
    move |text| match text {
        "none" => Ok(OrNone(None)),
        text => number(text)
            .map(Some)
            .map(OrNone)
            .map_err(|e| format!("{e}, or none")),
    }
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let front_seat = front_seat(args)?;
    emulate(&args.vehicle, front_seat, &args.common)
}

fn front_seat(args: &Args) -> Result<FrontSeatSettings> {
    let listen = args.listen.clone();
    let charge = args.charge_pct.0.map(|pct| 0.01 * pct);
    let wrong = match (args.protocol, &args.primary, &args.ground_station) {
        (ProtocolArg::Surveyor, primary, None) => {
            return Ok(FrontSeatSettings::Surveyor {
                listen,
                primary: primary.clone(),
                declination_rad: args.declination_deg.map(f64::to_radians),
                watchdog_s: args.watchdog_s.0,
                integers: args.integers,
                extra: args.extra.iter().map(ExtraArg::extra).collect(),
                charge,
            });
        }
        (ProtocolArg::Mavlink, None, ground_station) => {
            return Ok(FrontSeatSettings::ArduPilot {
                listen,
                ground_station: ground_station.clone(),
                charge,
            });
        }
        (ProtocolArg::Surveyor, _, Some(_)) => "--ground-station requires --protocol mavlink",
        (ProtocolArg::Mavlink, Some(_), _) => {
            "--primary requires --protocol surveyor; for MAVLink, use --ground-station"
        }
    };
    bail!(UsageError(wrong.to_owned()))
}

/// Runs a boat with this front seat until its game is over.
pub(super) fn emulate(
    vehicle: &str,
    front_seat: FrontSeatSettings,
    common: &CommonArgs,
) -> Result<ExitCode> {
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
        NodeEvent::Looking { reason } => {
            log.remark(format!("{vehicle}: looking for the game: {reason}"))
        }
        // The parent process may have requested any free port.
        NodeEvent::Listening { what, reach } => log.print(format!("{what} at {reach}\n")),
        NodeEvent::Event { at_s, event } => log.event(at_s, event),
        NodeEvent::Recording(_)
        | NodeEvent::ControlPort { .. }
        | NodeEvent::Status(_)
        | NodeEvent::Ended(_) => {}
    };
    let emulated = gateway::node::emulate(&settings, &mut notify);
    log.end(String::new());
    emulated.with_context(|| format!("the emulator of {vehicle}"))?;
    Ok(ExitCode::SUCCESS)
}
