//! The gateway's log on the terminal: events line by line, and the status as one line that is
//! overwritten.

use command_line::printer::Printer;
use command_line::{style, terminal};
use gateway::bridge::Event;
use messages::external::{GatewayStatus, GeofenceReport};
use std::io::IsTerminal;

/// Prints a gateway's log on its own thread, so that the gateway never waits for the terminal.
pub struct Log {
    is_live: bool,
    is_quiet: bool,
    printer: Printer<Line>,
}

enum Line {
    /// A permanent line.
    Lasting(String),
    /// A line that the next one overwrites.
    Status(String),
    /// A line for standard error.
    Remark(String),
}

impl Log {
    /// A new log; a quiet one prints errors only.
    pub fn new(is_quiet: bool) -> Log {
        let is_live = std::io::stdout().is_terminal();
        let mut status = String::new();
        let printer = Printer::start(move |line| match line {
            Line::Lasting(line) if is_live => terminal::overwrite(&format!("{line}{status}")),
            Line::Lasting(line) => terminal::show(line),
            Line::Status(line) => {
                status.clone_from(line);
                terminal::overwrite(line);
            }
            Line::Remark(text) => terminal::remark(text),
        });
        Log {
            is_live,
            is_quiet,
            printer,
        }
    }

    /// Prints a permanent line.
    pub fn event(&self, at_s: f64, event: &Event) {
        if !self.is_quiet {
            self.print(format!("{at_s:>8.1} s  {}\n", text_of(event)));
        }
    }

    /// On a terminal, prints a status line that the next one overwrites.
    pub fn status(&self, status: &GatewayStatus) {
        if self.is_live && !self.is_quiet {
            self.printer.print(Line::Status(brief(status)));
        }
    }

    /// Prints a message that is not part of the log.
    pub fn remark(&self, text: String) {
        if !self.is_quiet {
            self.printer.print(Line::Remark(text));
        }
    }

    /// Prints permanent lines, even in a quiet log.
    pub fn print(&self, lines: String) {
        self.printer.print(Line::Lasting(lines));
    }

    /// Prints the last lines after all queued ones, and ends the log.
    pub fn end(self, lines: String) {
        self.printer.end(Line::Lasting(lines));
    }
}

/// A state, in red if the boat was stopped.
pub fn state(text: &str) -> String {
    if ["failsafe", "e-stopped"]
        .iter()
        .any(|stopped| text.starts_with(stopped))
    {
        style::bad(text)
    } else {
        text.to_owned()
    }
}

/// An event as a line for display.
pub fn text_of(event: &Event) -> String {
    match event {
        Event::State { from, to } => format!("{} (was {from})", state(to)),
        Event::Blocked(true) => style::warning("another boat is in the way: zero thrust"),
        Event::Blocked(false) => "the way is clear again".to_owned(),
        Event::Warning(text) => style::warning(&format!("WARNING: {text}")),
        Event::Remark(text) => text.clone(),
    }
}

fn brief(status: &GatewayStatus) -> String {
    let nav = match (status.nav, status.nav_age_s) {
        (Some(nav), Some(age_s)) => format!(
            "x {:.1} y {:.1} m, {:03.0} deg, {:.1} m/s, {age_s:.1} s old",
            nav.east_m,
            nav.north_m,
            primitives::angle::compass_deg_from_rad(nav.psi_rad),
            nav.surge_m_s
        ),
        _ => "no navigation".to_owned(),
    };
    let mode = status.mode.map_or("-".to_owned(), |mode| {
        with_age(mode.to_string(), status.mode_age_s)
    });
    let battery = volts(status).map_or(String::new(), |volts| format!("{volts} | "));
    let alarms: String = status
        .alarms
        .iter()
        .map(|alarm| format!("ALARM: {alarm} | "))
        .collect();
    let text = format!(
        "{} | {alarms}link {} | mode {mode} | {nav} | {battery}{}",
        status.state,
        status.link,
        status
            .would_send
            .as_ref()
            .map_or(status.last_sent.clone(), |command| format!(
                "dry run, would send {command}"
            ))
    );
    text.chars().take(150).collect()
}

/// A value with its age, if known.
fn with_age(text: String, age_s: Option<f64>) -> String {
    match age_s {
        Some(age_s) => format!("{text}, {age_s:.1} s old"),
        None => text,
    }
}

fn volts(status: &GatewayStatus) -> Option<String> {
    let left = status
        .battery_pct
        .map_or(String::new(), |left_pct| format!(" ({left_pct:.0} %)"));
    status
        .battery_v
        .map(|volts| with_age(format!("{volts:.1} V{left}"), status.battery_age_s))
}

fn geofence(report: &GeofenceReport) -> Option<String> {
    let clearance_m = report.clearance_m?;
    let stopping_m = report.stopping_m?;
    let is_inside = if clearance_m > 0.0 {
        "inside".to_owned()
    } else {
        style::bad("OUTSIDE")
    };
    Some(format!(
        "{is_inside}, {:.1} m to the nearest edge, {stopping_m:.1} m to stop",
        clearance_m.abs()
    ))
}

/// The full status of a gateway for display.
pub fn full(status: &GatewayStatus) -> String {
    let or_none = |text: Option<String>| text.unwrap_or_else(|| "unknown".to_owned());
    let nav = status.nav.map(|nav| {
        format!(
            "x {:.2} m, y {:.2} m, heading {:.1} deg, {:.2} m/s ahead, {:.1} s old",
            nav.east_m,
            nav.north_m,
            primitives::angle::compass_deg_from_rad(nav.psi_rad),
            nav.surge_m_s,
            status.nav_age_s.unwrap_or(0.0)
        )
    });
    let mut lines = vec![
        format!("{}: {}", status.vehicle, state(&status.state)),
        format!("  link        {}", status.link),
        format!(
            "  mode        {}",
            or_none(
                status
                    .mode
                    .map(|mode| with_age(mode.to_string(), status.mode_age_s))
            )
        ),
        format!(
            "  operator    {}",
            or_none(
                status
                    .operator
                    .clone()
                    .map(|operator| with_age(operator, status.mode_age_s))
            )
        ),
        format!("  navigation  {}", or_none(nav)),
        format!(
            "  geofence    {}",
            or_none(status.geofence.as_ref().and_then(geofence))
        ),
        format!("  battery     {}", or_none(volts(status))),
        format!("  last sent   {}", status.last_sent),
    ];
    lines.extend(
        status
            .would_send
            .iter()
            .map(|command| format!("  dry run     would send {command}")),
    );
    lines.extend(
        status
            .alarms
            .iter()
            .map(|alarm| style::bad(&format!("  alarm       {alarm}"))),
    );
    if !status.missing.is_empty() {
        lines.push(style::warning(&format!(
            "  missing     {}",
            status.missing.join("; ")
        )));
    }
    lines.extend(status.failsafes.iter().map(|failsafe| {
        style::bad(&format!(
            "  failsafe    {:>8.1} s  {}",
            failsafe.at_s, failsafe.cause
        ))
    }));
    let named = ["sentence in, topic out", "order in, sentence out"];
    for (name, latency) in named.iter().zip(status.latency_us) {
        if let Some([median, p99]) = latency {
            lines.push(format!(
                "  latency     {name}: median {median:.0} us, p99 {p99:.0} us"
            ));
        }
    }
    let counts: Vec<String> = status
        .counts
        .iter()
        .filter(|(_, count)| *count > 0)
        .map(|(name, count)| format!("{count} {name}"))
        .collect();
    lines.push(format!("  counts      {}", counts.join(", ")));
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_boat_that_was_stopped_is_red_and_any_other_state_is_not() {
        let told = |to: &str| {
            text_of(&Event::State {
                from: "armed".to_owned(),
                to: to.to_owned(),
            })
        };
        assert_eq!(told("disarmed"), "disarmed (was armed)");
        for to in [
            "failsafe: the link is down",
            "e-stopped (by an E-stop of this boat)",
        ] {
            assert_eq!(told(to), format!("{} (was armed)", style::bad(to)));
        }
    }
}
