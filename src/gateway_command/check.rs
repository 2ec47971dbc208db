//! `squall gateway check`: what a boat says, before anybody arms anything.

use crate::screen;
use crate::sim_command::seconds;
use crate::stop;
use anyhow::{Result, anyhow, bail};
use game::SimTime;
use gateway::link::{Link, LinkAddress, LinkEvent, LinkSettings};
use gateway::survey::Survey;
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
    // Who looks on drops what it cannot take.
    let take = move |event| drop(sender.try_send(event));
    let _link = Link::open(&address, LinkSettings { silence: None, ..LinkSettings::default() }, take)?;
    let start = Instant::now();
    let at = |moment: Instant| SimTime::from_s(moment.saturating_duration_since(start).as_secs_f64());
    let (mut survey, mut reason) = (Survey::new(), String::from("nothing came"));
    while start.elapsed().as_secs_f64() < args.for_s && !stop.load(Ordering::Relaxed) {
        match events.recv_timeout(Duration::from_millis(100)) {
            Ok(LinkEvent::Bytes { at: moment, bytes, .. }) => survey.take(at(moment), &bytes),
            Ok(LinkEvent::Up { name, .. }) => {
                screen::remark(&format!("connected to {name}; listening for {} s, without a word", args.for_s));
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
    if survey.heard().is_empty() {
        let counts = survey.counts();
        bail!("no sentence from {address} in {} s: {reason} ({} bytes of garbage)", args.for_s, counts.garbage);
    }
    let host = (at(Instant::now()), gateway::utc::now().1);
    screen::print(&report(&survey, host));
    Ok(if survey.missing().is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn report(survey: &Survey, host: (SimTime, gateway::nmea::TimeOfDay)) -> String {
    let mut lines = vec![format!("{:<10} {:>7} {:>8}  last", "sentence", "count", "1/s")];
    for (name, heard) in survey.heard() {
        let rate = heard.rate_hz().map_or("-".to_owned(), |rate| format!("{rate:.2}"));
        let note = if heard.unreadable > 0 { "  (not read)" } else { "" };
        lines.push(format!("{name:<10} {:>7} {rate:>8}  {}{note}", heard.count, heard.last));
    }
    let counts = survey.counts();
    lines.push(format!(
        "\nbad checksums {}, overlong {}, broken {}, bytes of garbage {}",
        counts.bad_checksum, counts.overlong, counts.broken, counts.garbage
    ));
    lines.extend(survey.findings(host));
    let missing = survey.missing();
    if missing.is_empty() {
        lines.push("\nnothing is missing".to_owned());
    } else {
        lines.push("\nmissing:".to_owned());
        lines.extend(missing.iter().map(|what| format!("  {what}")));
    }
    lines.join("\n") + "\n"
}
