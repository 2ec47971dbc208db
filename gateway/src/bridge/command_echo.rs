//! What a boat shows of the commands that it follows, against what it was sent.
//!
//! A boat that shows an older command than it should does not listen any more. One that shows a command that it was never sent, after it
//! has shown ours, gets orders from somebody else at the same port.

use crate::config::ControlWatch;
use crate::nmea::Mode;
use crate::protocol::Shown;
use primitives::SimTime;
use primitives::angle::wrap_pi;
use std::collections::VecDeque;

/// In mode G speeds and headings are the same if they are as near as this, kn and degrees: ArduPilot leaves out all after the comma.
const SAME_SPEED_KN: f64 = 0.1;
const SAME_HEADING_DEG: f64 = 1.1;
/// A boat that leaves our commands for standby so often within this time, s, and comes back in between, is sent standby by another.
const DEPARTURES: usize = 2;
const DEPARTURES_S: f64 = 5.0;
/// Orders of others count for this long after they were seen, s.
const FOREIGN_MEMORY_S: f64 = 5.0;
/// The most commands that are remembered: 20 a second for as long as a boat may take to show one.
const SENT_MAX: usize = 640;

impl Shown {
    /// Whether a boat that was sent this would show that. What a boat does not show cannot differ.
    fn agrees(&self, shown: &Shown, thrust_pct: f64) -> bool {
        // What is not shown cannot disagree: stand-ins and ArduPilot show fewer fields than a
        // Surveyor.
        let within = |sent: Option<f64>, shown: Option<f64>, apart: f64| {
            sent.zip(shown).is_none_or(|(sent, shown)| (sent - shown).abs() <= apart)
        };
        let turned = self.heading_deg.zip(shown.heading_deg);
        let turned_deg = turned.map_or(0.0, |(sent, shown)| wrap_pi((sent - shown).to_radians()).to_degrees());
        self.mode == shown.mode
            && match self.mode {
                Mode::Thruster => {
                    // The heading does not count in mode T: a boat that steers no heading
                    // reports the one it has.
                    within(self.thrust, shown.thrust, thrust_pct)
                        && within(self.difference, shown.difference, thrust_pct)
                }
                Mode::Speed => within(self.thrust, shown.thrust, SAME_SPEED_KN) && turned_deg.abs() <= SAME_HEADING_DEG,
                // What the boat's own controller asks of its thrusters is its own affair.
                _ => true,
            }
    }
}

/// What was sent lately, and how the boat showed it.
#[derive(Clone, Debug)]
pub(super) struct CommandEcho {
    watch: ControlWatch,
    /// Commands that the boat may still show, and when each was first sent; the newest last.
    sent: VecDeque<(SimTime, Shown)>,
    last: Option<Shown>,
    /// Whether the boat's last report showed a command of ours; whether any has, and any with a set-point.
    is_ours: bool,
    has_shown: bool,
    has_shown_set_point: bool,
    /// Since when it has shown a set-point that is none of those.
    unlike_since: Option<SimTime>,
    departures: VecDeque<SimTime>,
    foreign_at: Option<SimTime>,
}

impl CommandEcho {
    pub(super) fn new(watch: ControlWatch) -> CommandEcho {
        CommandEcho {
            watch,
            sent: VecDeque::new(),
            last: None,
            is_ours: false,
            has_shown: false,
            has_shown_set_point: false,
            unlike_since: None,
            departures: VecDeque::new(),
            foreign_at: None,
        }
    }

    /// The boat was sent what it should show as this.
    pub(super) fn note_sent(&mut self, now: SimTime, shown: Shown) {
        // Repeats of the same command are one: sent at 10 Hz for a minute they would displace
        // the change that the boat may still be showing.
        if self.sent.back().is_none_or(|(_, last)| *last != shown) {
            self.sent.push_back((now, shown));
        }
        // A command counts until the next one has been out for as long as the boat may take to show it.
        let is_over = |(next, _): &(SimTime, Shown)| (now - *next).as_s() > self.watch.echo_s;
        while self.sent.get(1).is_some_and(is_over) || self.sent.len() > SENT_MAX {
            self.sent.pop_front();
        }
    }

    /// Somebody else was heard to order the boat about.
    pub(super) fn note_foreign(&mut self, now: SimTime) {
        self.foreign_at = Some(now);
    }

    /// The boat's report, while we command it.
    pub(super) fn observe(&mut self, now: SimTime, mut shown: Shown) {
        // A boat that has never shown another heading of ours may show 0 for all of them.
        shown.heading_deg = shown.heading_deg.filter(|deg| *deg != 0.0 || self.has_shown_set_point);
        let is_new = self.last.replace(shown).is_none_or(|last| !last.agrees(&shown, self.watch.echo_thrust_pct));
        let was_ours = std::mem::take(&mut self.is_ours);
        if self.sent.iter().any(|(_, sent)| sent.agrees(&shown, self.watch.echo_thrust_pct)) {
            (self.is_ours, self.has_shown, self.unlike_since) = (true, true, None);
            let tells = shown.heading_deg.is_some() || shown.thrust.is_some();
            self.has_shown_set_point |= shown.mode.is_set_point() && tells;
            return;
        }
        let is_same_mode = self.sent.iter().any(|(_, sent)| sent.mode == shown.mode);
        if is_same_mode {
            self.unlike_since.get_or_insert(now);
        }
        // How a boat shows set-points must have been seen before one of them can be called foreign.
        let knows = if is_same_mode { self.has_shown_set_point } else { self.has_shown };
        // A set-point of others moves the boat, so one is enough. Standby that we did not send
        // may be the boat's own doing (a button, a failsafe), so it takes a repetition: a boat
        // that falls back to standby once is found by the mode that it does not show.
        if shown.mode.is_set_point() {
            if is_new && knows {
                self.foreign_at = Some(now);
            }
        } else if was_ours {
            self.departures.push_back(now);
            self.departures.retain(|at| (now - *at).as_s() <= DEPARTURES_S);
            if self.departures.len() >= DEPARTURES {
                self.foreign_at = Some(now);
            }
        }
    }

    /// Whether the boat has shown a command lately that we have not sent.
    pub(super) fn is_foreign(&self, now: SimTime) -> bool {
        self.foreign_at.is_some_and(|at| (now - at).as_s() <= FOREIGN_MEMORY_S)
    }

    /// Whether the boat shows thrust that it should not show any more.
    pub(super) fn is_deaf(&self, now: SimTime) -> bool {
        // One that has shown ours has had its time already.
        let patience_s = if self.has_shown_set_point { 0.0 } else { self.watch.echo_s };
        self.unlike_since.is_some_and(|since| (now - since).as_s() >= patience_s)
    }
}
