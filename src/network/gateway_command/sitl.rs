//! `squall gateway sitl`: a simulated boat with ArduPilot's own firmware.

use super::emulate::{CommonArgs, emulate};
use anyhow::Result;
use command_line::number::{address, whole};
use gateway::emulator::Servos;
use gateway::node::FrontSeatSettings;
use std::net::SocketAddr;
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Name of the vehicle in the game; the firmware becomes its agent
    #[arg(long, value_name = "NAME")]
    vehicle: String,
    /// Address to which the firmware sends its servo outputs, by UDP; instance N of SITL uses port
    /// 9002 + 10 N
    #[arg(long, value_name = "IP:PORT", default_value = "127.0.0.1:9002", value_parser = address)]
    listen: SocketAddr,
    /// Servo output of the port thruster (function 73, ThrottleLeft)
    #[arg(long, value_name = "CHANNEL", default_value_t = 1, value_parser = whole::<usize>(1, Servos::CHANNEL_MAX))]
    port_servo: usize,
    /// Servo output of the starboard thruster (function 74, ThrottleRight)
    #[arg(long, value_name = "CHANNEL", default_value_t = 3, value_parser = whole::<usize>(1, Servos::CHANNEL_MAX))]
    starboard_servo: usize,
    /// Pulse widths for full astern, zero and full ahead, µs: SERVOn_MIN, _TRIM and _MAX. A
    /// BlueBoat has 1100,1500,1900
    #[arg(long, value_name = "US,US,US", default_value = "1000,1500,2000", value_parser = pulses)]
    pulse_us: Pulses,
    #[command(flatten)]
    common: CommonArgs,
}

#[derive(Clone, Copy, Debug)]
struct Pulses([u16; 3]);

fn pulses(text: &str) -> Result<Pulses, String> {
    let numbers: Option<Vec<u16>> = text
        .split(',')
        .map(|number| number.trim().parse().ok())
        .collect();
    match numbers.as_deref() {
        Some(&[astern, zero, ahead]) if 0 < astern && astern < zero && zero < ahead => {
            Ok(Pulses([astern, zero, ahead]))
        }
        _ => Err("expected three ascending whole numbers, such as 1000,1500,2000".to_owned()),
    }
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let servos = Servos {
        port: args.port_servo,
        starboard: args.starboard_servo,
        pulse_us: args.pulse_us.0,
    };
    emulate(
        &args.vehicle,
        FrontSeatSettings::Sitl {
            listen: args.listen,
            servos,
        },
        &args.common,
    )
}
