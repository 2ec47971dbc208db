//! The guided parts of a pre-flight check: compass swing and propeller test, driven by remote
//! control.

use super::check::Listener;
use command_line::terminal;
use gateway::config::{BoatProtocol, CompassFrame, Gateway};
use gateway::declination::declination_deg;
use gateway::nmea::{Operator, date_and_time};
use gateway::preflight::{Check, CompassSwing};
use recording::utc;
use std::io::BufRead;
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};

/// Timeout of a guided part, s.
const LONGEST_S: f64 = 600.0;
/// Deviation above which the compass should be corrected first, degrees.
const DEVIATION_MAX_DEG: f64 = 14.0;
/// Minimum reported thrust that counts as ahead or astern, per cent.
const THRUST_MIN_PCT: f64 = 10.0;

/// Asks questions at the terminal.
pub(super) struct Guide {
    /// Typed lines; `None` if no guide is wanted.
    lines: Option<Receiver<String>>,
}

impl Guide {
    /// A guide; it asks only if `is_wanted`.
    pub(super) fn new(is_wanted: bool) -> Guide {
        let begin = || {
            let (sender, lines) = sync_channel(16);
            std::thread::spawn(move || {
                let mut typed = std::io::stdin().lock().lines().map_while(Result::ok);
                while typed.next().is_some_and(|line| sender.send(line).is_ok()) {}
            });
            lines
        };
        Guide {
            lines: is_wanted.then(begin),
        }
    }

    /// The next typed line, if any; an empty line after the end of input.
    fn typed(&self) -> Option<String> {
        match self.lines.as_ref()?.try_recv() {
            Ok(line) => Some(line),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(String::new()),
        }
    }

    /// Asks a question and keeps listening to the boat until the user answers or [`LONGEST_S`] has
    /// passed.
    fn is_agreed(&self, question: &str, listener: &mut Listener) -> bool {
        terminal::remark(&format!("{question} [y/N]"));
        let start = listener.now();
        let mut answer = None;
        listener.listen(&mut |listener| {
            answer = self.typed();
            answer.is_some() || (listener.now() - start).as_s() >= LONGEST_S
        });
        answer.is_some_and(|answer| matches!(answer.trim(), "y" | "Y" | "yes"))
    }

    /// Prints an instruction and listens until Enter is pressed or [`LONGEST_S`] has passed.
    fn until_enter(&self, what: &str, listener: &mut Listener, take: &mut dyn FnMut(&Listener)) {
        terminal::remark(&format!("{what} Press Enter when done."));
        let start = listener.now();
        listener.listen(&mut |listener| {
            take(listener);
            self.typed().is_some() || (listener.now() - start).as_s() >= LONGEST_S
        });
    }
}

pub(super) fn guided_checks(
    guide: &mut Guide,
    listener: &mut Listener,
    gateway: &Gateway,
) -> Vec<Check> {
    if guide.lines.is_none() {
        return ["compass swing", "propellers"]
            .map(|name| Check::not_done(name, "use --guided"))
            .to_vec();
    }
    vec![swing(guide, listener, gateway), propellers(guide, listener)]
}

fn swing(guide: &Guide, listener: &mut Listener, gateway: &Gateway) -> Check {
    let name = "compass swing";
    if gateway.protocol == BoatProtocol::Mavlink {
        return Check::not_done(
            name,
            "a MAVLink boat reports true headings; use its own calibration",
        );
    }
    if !guide.is_agreed(
        "Compass swing: can you turn the boat by remote control in open water?",
        listener,
    ) {
        return Check::not_done(name, "skipped");
    }
    let declination_rad = match declination_rad(listener, gateway) {
        Ok(declination_rad) => declination_rad,
        Err(why) => return Check::not_done(name, why),
    };
    let mut swing = CompassSwing::default();
    let what = "Turn the boat slowly through two full circles; if it reports no true heading, drive them at 1 m/s or more.";
    guide.until_enter(what, listener, &mut |listener| {
        if let (Some(compass_deg), Some(true_deg)) =
            (listener.check.compass_deg, listener.check.true_deg())
        {
            swing.add_reading(
                compass_deg.to_radians() + declination_rad,
                true_deg.to_radians(),
            );
        }
    });
    match swing.fit() {
        Err(why) => Check::not_done(name, why),
        Ok(deviation) => {
            terminal::print(&format!("\nfor the boat's file:\n\n{}", deviation.toml()));
            let found = format!(
                "deviation up to {:.1} degrees, residual {:.1} degrees; expected at most {DEVIATION_MAX_DEG}",
                deviation.largest_deg, deviation.residual_deg
            );
            Check::of(name, deviation.largest_deg <= DEVIATION_MAX_DEG, found)
        }
    }
}

/// The declination to add to the compass heading, rad.
fn declination_rad(listener: &Listener, gateway: &Gateway) -> Result<f64, String> {
    match (
        gateway.compass,
        gateway.declination_rad,
        listener.check.fixes.last(),
    ) {
        (CompassFrame::True, ..) => Ok(0.0),
        (_, Some(declination_rad), _) => Ok(declination_rad),
        (_, None, None) => {
            Err("the declination is unknown without a position; set declination_deg".to_owned())
        }
        (_, None, Some((_, at))) => declination_deg(*at, date_and_time(utc::now_ns()).0)
            .map(f64::to_radians)
            .map_err(|e| e.to_string()),
    }
}

fn propellers(guide: &Guide, listener: &mut Listener) -> Check {
    let name = "propellers";
    if !guide.is_agreed(
        "Propeller test: is everyone clear of the propellers, and is the remote control in your hand?",
        listener,
    ) {
        return Check::not_done(name, "skipped");
    }
    // Whether the boat has reported its operator, whether that was the remote control, and whether
    // thrust ahead and astern was seen.
    let mut tells = false;
    let mut by_remote = false;
    let mut seen = [false; 2];
    let what = "Run both propellers ahead and astern by remote control, at 20 per cent for two seconds each.";
    guide.until_enter(what, listener, &mut |listener| {
        let Some(control) = listener.check.control else {
            return;
        };
        tells |= control.operator.is_some();
        by_remote |= control.operator == Some(Operator::Rc);
        let thrust_pct = control.shown.thrust.unwrap_or(0.0);
        seen = [
            seen[0] || thrust_pct >= THRUST_MIN_PCT,
            seen[1] || thrust_pct <= -THRUST_MIN_PCT,
        ];
    });
    let turned = guide.is_agreed(
        "Did both propellers turn both ways, without unusual noise?",
        listener,
    );
    let word = |is: bool| if is { "seen" } else { "not seen" };
    let found = format!(
        "both turned: {}; in the boat's reports, remote control {}, thrust ahead {}, astern {}",
        if turned { "yes" } else { "no" },
        word(by_remote),
        word(seen[0]),
        word(seen[1])
    );
    Check::of(name, turned && (by_remote || !tells), found)
}
