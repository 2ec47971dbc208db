//! `squall gateway check`: the sensor check of a boat before arming.

use crate::screen;
use crate::sim_command::seconds;
use crate::stop;
use anyhow::{Result, anyhow, bail};
use game::SimTime;
use gateway::link::{Link, LinkAddress, LinkEvent, LinkSettings};
use gateway::nmea::date_and_time;
use gateway::sensor_check::SensorCheck;
use recording::utc;
use std::process::ExitCode;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::{Duration, Instant};

/// Which boat.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Where the boat is: tcp://HOST:PORT, udp://HOST:PORT, serial:///dev/ttyUSB0?baud=38400
    #[arg(long, value_name = "URL")]
    link: String,
    /// How long to listen, s
    #[arg(long, value_name = "S", default_value_t = 10.0, value_parser = seconds)]
    for_s: f64,
}

#[expect(clippy::disallowed_methods, reason = "it listens for so long by the clock")]
pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let address = LinkAddress::to_connect(&args.link).map_err(|e| anyhow!("--link: {e}"))?;
    let stop = stop::on_ctrl_c()?;
    let (sender, events) = sync_channel(4096);
    // A full queue drops events: this only listens.
    let take = move |event| drop(sender.try_send(event));
    let _link = Link::open(&address, LinkSettings { silence: None, ..LinkSettings::default() }, take)?;
    let start = Instant::now();
    let at = |moment: Instant| SimTime::from_s(moment.saturating_duration_since(start).as_secs_f64());
    let (mut check, mut reason) = (SensorCheck::new(), String::from("nothing came"));
    while start.elapsed().as_secs_f64() < args.for_s && !stop.load(Ordering::Relaxed) {
        match events.recv_timeout(Duration::from_millis(100)) {
            Ok(LinkEvent::Bytes { at: moment, bytes, .. }) => check.take(at(moment), &bytes),
            Ok(LinkEvent::Up { name, .. }) => {
                screen::remark(&format!("connected to {name}; listening for {} s, sending nothing", args.for_s));
            }
            Ok(LinkEvent::Failed { reason: why, .. } | LinkEvent::Down { reason: why, .. }) => {
                if why != reason {
                    screen::remark(&why);
                }
                reason = why;
            }
            Ok(LinkEvent::Written { .. }) | Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    if check.received().is_empty() {
        let counts = check.counts();
        bail!("no sentence from {address} in {} s: {reason} ({} bytes of garbage)", args.for_s, counts.garbage);
    }
    screen::print(&report(&check, at(Instant::now()), date_and_time(utc::now_ns()).1));
    Ok(if check.missing().is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn report(check: &SensorCheck, now: SimTime, host: gateway::nmea::TimeOfDay) -> String {
    let mut lines = vec![format!("{:<10} {:>7} {:>8}  last", "sentence", "count", "1/s")];
    for (name, received) in check.received() {
        let rate = received.rate_hz().map_or("-".to_owned(), |rate| format!("{rate:.2}"));
        let note = if received.unreadable > 0 { "  (not read)" } else { "" };
        lines.push(format!("{name:<10} {:>7} {rate:>8}  {}{note}", received.count, received.last));
    }
    let counts = check.counts();
    lines.push(format!(
        "\nbad checksums {}, overlong {}, broken {}, bytes of garbage {}",
        counts.bad_checksum, counts.overlong, counts.broken, counts.garbage
    ));
    lines.extend(check.findings(now, host));
    let missing = check.missing();
    if missing.is_empty() {
        lines.push("\nnothing is missing".to_owned());
    } else {
        lines.push("\nmissing:".to_owned());
        lines.extend(missing.iter().map(|what| format!("  {what}")));
    }
    lines.join("\n") + "\n"
}
