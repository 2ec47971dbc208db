//! `gateway stop`: stops a boat directly over its link; nothing else needs to run.

use crate::link_arg::to_connect;
use crate::protocol_arg::ProtocolArg;
use anyhow::{Result, bail};
use bus::{LinkLock, ask_gateway, clock};
use command_line::number::seconds;
use command_line::terminal;
use gateway::config::Gateway;
use gateway::config::default_gateway;
use gateway::link::{BoatLink, Link, LinkAddress, LinkEvent, LinkSettings};
use gateway::nmea::{Mode, Operator};
use gateway::protocol::{ControlReport, Protocol, Report};
use messages::external::{GatewayCommand, OperatorCommand};
use primitives::SimTime;
use std::process::ExitCode;
use std::sync::mpsc::sync_channel;
use std::time::Duration;

/// Interval between stop commands.
const AGAIN: Duration = Duration::from_millis(100);
/// Minimum time to keep sending, because single sentences may be lost.
const SAY: Duration = Duration::from_millis(500);
/// Timeout for the answer of a gateway that holds the link.
const ANSWER: Duration = Duration::from_secs(1);
/// Capacity of the event queue.
const EVENTS_MAX: usize = 4096;

#[derive(clap::Args)]
pub struct Args {
    /// Link to the boat: tcp://HOST:PORT, udp://HOST:PORT, udp-listen://0.0.0.0:14550 or
    /// serial:///dev/ttyUSB0?baud=38400 (4800 to 921600 baud)
    #[arg(value_parser = to_connect)]
    link: LinkAddress,
    /// Protocol of the boat
    #[arg(long, value_name = "PROTOCOL", value_enum, default_value_t = ProtocolArg::Surveyor)]
    protocol: ProtocolArg,
    /// How long to try to stop the boat, s
    #[arg(long, value_name = "S", default_value_t = 10.0, value_parser = seconds)]
    wait_s: f64,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let address = args.link.clone();
    // Ask the gateway that holds the link first: otherwise it would keep driving its boat.
    if stopped_by_its_gateway(&address) {
        return Ok(ExitCode::SUCCESS);
    }
    let (sender, events) = sync_channel(EVENTS_MAX);
    // A full queue drops events, which is harmless: the boat will report again.
    let take = move |event| drop(sender.try_send(event));
    let settings = LinkSettings {
        silence: None,
        retry_max: AGAIN,
        ..LinkSettings::default()
    };
    let link = Link::open(&address, settings, take)?;
    let gateway = Gateway {
        protocol: args.protocol.protocol(),
        ..default_gateway()
    };
    let mut protocol = Protocol::new(&gateway);
    let mut boat = None;
    let start = clock::now();
    let limit = Duration::from_secs_f64(args.wait_s);
    let mut connected = None;
    let mut due = start;
    let mut reason = "no answer yet".to_owned();
    while clock::since(start) < limit {
        match events.recv_timeout(due.saturating_duration_since(clock::now()).min(AGAIN)) {
            Ok(LinkEvent::Up { name, .. }) => {
                terminal::remark(&format!(
                    "connected to {name}: sending zero thrust and standby"
                ));
                (connected, due) = (Some(clock::now()), clock::now());
            }
            Ok(LinkEvent::Bytes { bytes, .. }) => {
                protocol.read(SimTime::ZERO, &bytes, &mut |report| {
                    if let Report::Control(control) = report {
                        boat = Some(control);
                    }
                })
            }
            Ok(LinkEvent::Failed { reason: why, .. } | LinkEvent::Down { reason: why, .. }) => {
                (connected, reason) = (None, why);
            }
            Ok(LinkEvent::Written { .. }) | Err(_) => {}
        }
        let Some(since) = connected else { continue };
        if clock::now() >= due {
            due = clock::now() + AGAIN;
            link.send(protocol.forced_stop_message(), 0);
        }
        if clock::since(since) >= SAY && boat.is_some_and(|boat| boat.shown.mode == Mode::Standby) {
            terminal::print("the boat reports standby\n");
            return Ok(ExitCode::SUCCESS);
        }
    }
    match (connected, boat) {
        (None, _) => bail!(
            "the boat at {address} was not reached within {} s: {reason}",
            args.wait_s
        ),
        (_, None) => {
            bail!(
                "sent zero thrust and standby to {address} for {} s, but the boat does not report its mode",
                args.wait_s
            )
        }
        (_, Some(ControlReport { shown, operator })) => bail!(
            "the boat receives zero thrust and standby, but reports mode {}{}",
            shown.mode.letter(),
            match operator {
                Some(Operator::Secondary) | None => String::new(),
                Some(other) =>
                    format!("; operator {} has control and must stop it", other.number()),
            }
        ),
    }
}

/// Whether a gateway on this machine holds the link and has stopped its boat.
fn stopped_by_its_gateway(address: &LinkAddress) -> bool {
    let Some(pid) = LinkLock::holder(&address.to_string()) else {
        return false;
    };
    let Some(entry) = bus::local_gateways()
        .into_iter()
        .find(|entry| entry.pid == pid)
    else {
        return false;
    };
    let command = GatewayCommand::boat(&entry.vehicle, OperatorCommand::EStop);
    match ask_gateway(entry.control, None, &command, ANSWER) {
        Ok(reply) if reply.refused.is_none() && reply.status.link == "up" => {
            terminal::print(&format!(
                "the gateway of {} holds the link: {}\n",
                entry.vehicle, reply.status.state
            ));
            true
        }
        Ok(reply) => {
            terminal::remark(&format!(
                "the gateway of {} holds the link, but its link to the boat is not up: {}",
                entry.vehicle, reply.status.link
            ));
            false
        }
        Err(e) => {
            terminal::remark(&format!(
                "the gateway of {} holds the link but does not respond: {e}",
                entry.vehicle
            ));
            false
        }
    }
}
