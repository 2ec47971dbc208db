//! Compares the commands that a boat echoes with those sent to it.
//!
//! A boat that keeps echoing an outdated command no longer listens. If it has echoed our commands
//! and then echoes one that we never sent, someone else is commanding it through the same port.

use crate::config::ControlWatch;
use crate::nmea::Mode;
use crate::protocol::Shown;
use primitives::SimTime;
use primitives::angle::wrap_pi;
use std::collections::VecDeque;

/// Tolerances for equal speeds and headings in mode G, kn and degrees: ArduPilot truncates all
/// decimals.
const SAME_SPEED_KN: f64 = 0.1;
const SAME_HEADING_DEG: f64 = 1.1;
/// If the boat drops out of our mode to standby this many times within this period (s), and
/// recovers in between, someone else is sending it standby.
const DEPARTURES: usize = 2;
const DEPARTURES_S: f64 = 5.0;
/// Time (s) for which foreign orders count after they were seen.
const FOREIGN_MEMORY_S: f64 = 5.0;
/// Capacity for sent commands: 20 a second for the longest echo delay of a boat.
const SENT_MAX: usize = 640;

impl Shown {
    /// Whether the boat's report is consistent with this sent command.
    fn agrees(&self, shown: &Shown, thrust_pct: f64) -> bool {
        // A missing field cannot disagree: emulators and ArduPilot report fewer fields than a
        // Surveyor.
        let within = |sent: Option<f64>, shown: Option<f64>, apart: f64| {
            sent.zip(shown)
                .is_none_or(|(sent, shown)| (sent - shown).abs() <= apart)
        };
        let turned = self.heading_deg.zip(shown.heading_deg);
        let turned_deg = turned.map_or(0.0, |(sent, shown)| {
            wrap_pi((sent - shown).to_radians()).to_degrees()
        });
        self.mode == shown.mode
            && match self.mode {
                Mode::Thruster => {
                    // The heading is not compared in mode T: a boat that steers no heading reports
                    // its actual one.
                    within(self.thrust, shown.thrust, thrust_pct)
                        && within(self.difference, shown.difference, thrust_pct)
                }
                Mode::Speed => {
                    within(self.thrust, shown.thrust, SAME_SPEED_KN)
                        && turned_deg.abs() <= SAME_HEADING_DEG
                }
                // In other modes the boat's own controller chooses the thrust.
                _ => true,
            }
    }
}

/// Recently sent commands, and how the boat echoed them.
#[derive(Clone, Debug)]
pub(super) struct CommandEcho {
    watch: ControlWatch,
    /// Commands that the boat may still echo, and when each was first sent; newest last.
    sent: VecDeque<(SimTime, Shown)>,
    last: Option<Shown>,
    /// Whether the last report echoed one of our commands, whether any report has, and whether any
    /// has echoed a set-point of ours.
    is_ours: bool,
    has_shown: bool,
    has_shown_set_point: bool,
    /// Start of the period in which the boat has echoed a set-point that matches none of ours.
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

    /// Records a sent command in the form in which the boat should echo it.
    pub(super) fn note_sent(&mut self, now: SimTime, shown: Shown) {
        // Store repeats of the same command once: a minute of them at 10 Hz would displace the
        // change that the boat may still be echoing.
        if self.sent.back().is_none_or(|(_, last)| *last != shown) {
            self.sent.push_back((now, shown));
        }
        // A command may be echoed until its successor is older than the longest echo delay.
        let is_over = |(next, _): &(SimTime, Shown)| (now - *next).as_s() > self.watch.echo_s;
        while self.sent.get(1).is_some_and(is_over) || self.sent.len() > SENT_MAX {
            self.sent.pop_front();
        }
    }

    /// Records that another sender was heard commanding the boat.
    pub(super) fn note_foreign(&mut self, now: SimTime) {
        self.foreign_at = Some(now);
    }

    /// Checks a report from the boat; called only while we command it.
    pub(super) fn observe(&mut self, now: SimTime, mut shown: Shown) {
        // A boat that has never echoed a nonzero heading may report 0 for all headings.
        shown.heading_deg = shown
            .heading_deg
            .filter(|deg| *deg != 0.0 || self.has_shown_set_point);
        let is_on_its_way = self.is_on_its_way(&shown);
        let is_new = self
            .last
            .replace(shown)
            .is_none_or(|last| !last.agrees(&shown, self.watch.echo_thrust_pct));
        let was_ours = std::mem::take(&mut self.is_ours);
        if self
            .sent
            .iter()
            .any(|(_, sent)| sent.agrees(&shown, self.watch.echo_thrust_pct))
        {
            (self.is_ours, self.has_shown, self.unlike_since) = (true, true, None);
            let tells = shown.heading_deg.is_some() || shown.thrust.is_some();
            self.has_shown_set_point |= shown.mode.is_set_point() && tells;
            return;
        }
        let is_same_mode = self.sent.iter().any(|(_, sent)| sent.mode == shown.mode);
        if is_same_mode {
            self.unlike_since.get_or_insert(now);
        }
        // Only if the boat has echoed our set-points can an unknown echo be judged foreign.
        let knows = if is_same_mode {
            self.has_shown_set_point
        } else {
            self.has_shown
        };
        // A foreign set-point moves the boat, so one is enough. Standby that we did not send may be
        // the boat's own doing (a button, a failsafe), so it must repeat: a single fallback to
        // standby is caught by the mode mismatch.
        if shown.mode.is_set_point() {
            if is_new && knows && !is_on_its_way {
                self.foreign_at = Some(now);
            }
        } else if was_ours {
            self.departures.push_back(now);
            self.departures
                .retain(|at| (now - *at).as_s() <= DEPARTURES_S);
            if self.departures.len() >= DEPARTURES {
                self.foreign_at = Some(now);
            }
        }
    }

    /// Whether thrust and difference lie between the last reported and the last sent values, as on
    /// a boat that reports the applied thrust, which lags, instead of the commanded one. Another
    /// gateway's set-points would jump.
    fn is_on_its_way(&self, shown: &Shown) -> bool {
        let Some(last) = self
            .last
            .filter(|last| last.mode == Mode::Thruster && shown.mode == Mode::Thruster)
        else {
            return false;
        };
        let is_between = |of: fn(&Shown) -> Option<f64>| {
            let sent = self.sent.iter().filter_map(|(_, sent)| of(sent));
            let (low, high) = sent
                .chain(of(&last))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), pct| {
                    (low.min(pct), high.max(pct))
                });
            let apart = self.watch.echo_thrust_pct;
            of(shown).is_none_or(|pct| (low - apart..=high + apart).contains(&pct))
        };
        is_between(|shown| shown.thrust) && is_between(|shown| shown.difference)
    }

    /// Whether the boat has recently echoed a command that we have not sent.
    pub(super) fn is_foreign(&self, now: SimTime) -> bool {
        self.foreign_at
            .is_some_and(|at| (now - at).as_s() <= FOREIGN_MEMORY_S)
    }

    /// Whether the boat echoes thrust that it should no longer apply.
    pub(super) fn is_deaf(&self, now: SimTime) -> bool {
        // A boat that has already echoed our set-points gets no grace period.
        let patience_s = if self.has_shown_set_point {
            0.0
        } else {
            self.watch.echo_s
        };
        self.unlike_since
            .is_some_and(|since| (now - since).as_s() >= patience_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use primitives::math;

    fn thrust(thrust: f64) -> Shown {
        Shown {
            mode: Mode::Thruster,
            heading_deg: None,
            thrust: Some(thrust),
            difference: Some(0.0),
        }
    }

    /// The verdict when the boat reports these thrusts, ten a second, after commands of 20 % and
    /// then 60 %.
    fn found(shows: &[f64]) -> (bool, bool) {
        let mut echo = CommandEcho::new(crate::config::default_gateway().control);
        let at = |tenth: usize| SimTime::from_s(0.1 * tenth as f64);
        echo.note_sent(at(0), thrust(20.0));
        echo.observe(at(1), thrust(20.0));
        echo.note_sent(at(2), thrust(60.0));
        for (i, pct) in shows.iter().enumerate() {
            echo.note_sent(at(3 + i), thrust(60.0));
            echo.observe(at(3 + i), thrust(*pct));
        }
        let now = at(3 + shows.len());
        (echo.is_foreign(now), echo.is_deaf(now))
    }

    #[test]
    fn a_boat_that_shows_its_applied_thrust_has_no_second_gateway() {
        let lagging: Vec<f64> = (0..40)
            .map(|i| (60.0 - 40.0 * math::exp(-0.1 * f64::from(i))).round())
            .collect();
        assert_eq!(
            found(&lagging[..20]),
            (false, true),
            "it does not echo the command"
        );
        assert_eq!(
            found(&lagging),
            (false, false),
            "it finally echoes the command"
        );
        let mut later = vec![60.0; 20];
        later.push(30.0);
        for another in [&[90.0][..], &[60.0, -40.0, 60.0], &later] {
            assert!(found(another).0, "{another:?} is another gateway's thrust");
        }
    }
}
