//! Alarms from the boat's own reports: its error code, its tilt, a leak, and abnormal thruster
//! currents.
//!
//! None of these stops the boat: operators should see the alarm and decide.

use super::Event;
use crate::config::CurrentWatch;
use crate::protocol::{Command, Power};
use crate::set_point::SetPoint;
use primitives::SimTime;
use primitives::angle::wrap_pi;

/// Minimum thrust order at which a thruster must draw a current, per cent.
const ORDERED_MIN_PCT: f64 = 20.0;
/// Order of the sides in all arrays: port first.
const SIDES: [&str; 2] = ["port", "starboard"];

/// Minimum roll or pitch (degrees) at which a boat may have capsized.
const TILT_MAX_DEG: f64 = 60.0;
/// How long the tilt must last, s: waves do not hold a boat at this angle for so long.
const TILT_S: f64 = 3.0;

/// A fault that counts only after a minimum duration.
#[derive(Clone, Copy, Debug, Default)]
struct Alarm {
    /// When the fault in progress began, and its latest value.
    since: Option<(SimTime, f64)>,
    /// Whether the fault has outlasted the debounce time and has been reported.
    is_told: bool,
}

impl Alarm {
    /// Records the value of the fault in progress, if any. Returns `text` as a warning once the
    /// fault has lasted for `debounce_s`, and a remark with its name when it ends.
    fn note(
        &mut self,
        now: SimTime,
        size: Option<f64>,
        debounce_s: f64,
        (text, name): (impl Fn(f64) -> String, &str),
    ) -> Option<Event> {
        // Keep the time of the first report and the latest value, so that the warning states the
        // value after the debounce time.
        self.since = size.map(|size| (self.since.map_or(now, |(since, _)| since), size));
        let lasts = self
            .since
            .is_some_and(|(since, _)| (now - since).as_s() >= debounce_s);
        match (std::mem::replace(&mut self.is_told, lasts), self.since) {
            (false, Some((_, size))) if lasts => Some(Event::Warning(text(size))),
            // The end is only a remark: it requires no action.
            (true, None) => Some(Event::Remark(format!("over: {name}"))),
            _ => None,
        }
    }

    /// The value of a fault that has been reported.
    fn told(&self) -> Option<f64> {
        self.since.filter(|_| self.is_told).map(|(_, size)| size)
    }
}

/// A fault that an electrical current shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wrong {
    Bilge,
    TooMuch,
    TooLittle,
}

const WRONGS: [Wrong; 3] = [Wrong::Bilge, Wrong::TooMuch, Wrong::TooLittle];

impl Wrong {
    /// Description for operators: the fault on a side, and its meaning.
    fn words(self) -> [&'static str; 2] {
        match self {
            Wrong::Bilge => ["bilge pump is running", "the boat is taking on water"],
            Wrong::TooMuch => ["thruster draws too much", "the propeller may be fouled"],
            Wrong::TooLittle => ["thruster draws no current", "it may be off or broken"],
        }
    }
}

/// The active alarms of a boat.
#[derive(Clone, Debug)]
pub(super) struct Alarms {
    watch: CurrentWatch,
    /// The error that the boat currently reports.
    error: Option<String>,
    /// The last notice from the boat.
    notice: Option<String>,
    /// The current tilt, degrees.
    tilt: Alarm,
    /// Abnormal currents, A, by fault (order of `WRONGS`), then side (port first).
    currents: [[Alarm; 2]; 3],
}

impl Alarms {
    /// The state before any report: no alarms.
    pub(super) fn new(watch: CurrentWatch) -> Alarms {
        Alarms {
            watch,
            error: None,
            notice: None,
            tilt: Alarm::default(),
            currents: Default::default(),
        }
    }

    /// Records the boat's error code; `None` means no error.
    pub(super) fn take_error(&mut self, error: Option<String>, events: &mut Vec<Event>) {
        if error != self.error {
            events.extend(error.as_deref().map(error_text).map(Event::Warning));
            self.error = error;
        }
    }

    /// Records a one-off notice from the boat. A repeated notice is not reported again.
    pub(super) fn take_notice(&mut self, text: String, events: &mut Vec<Event>) {
        if self.notice.as_ref() != Some(&text) {
            events.push(Event::Warning(format!("the boat reports {text:?}")));
            self.notice = Some(text);
        }
    }

    /// Checks roll and pitch (degrees).
    pub(super) fn take_tilt(&mut self, now: SimTime, tilt_deg: [f64; 2], events: &mut Vec<Event>) {
        let tilt_deg = tilt_deg.map(|deg| wrap_pi(deg.to_radians()).to_degrees().abs());
        let tilt_deg = tilt_deg[0].max(tilt_deg[1]);
        let tilt_deg = Some(tilt_deg).filter(|tilt_deg| *tilt_deg >= TILT_MAX_DEG);
        events.extend(self.tilt.note(
            now,
            tilt_deg,
            TILT_S,
            (tilt_text, "the boat was lying on its side"),
        ));
    }

    /// Checks the measured currents against the command that the boat follows.
    pub(super) fn take_power(
        &mut self,
        now: SimTime,
        power: &Power,
        command: Option<Command>,
        events: &mut Vec<Event>,
    ) {
        let ordered = command.and_then(ordered_pct);
        // An alarm, not a failsafe: the accuracy of these currents is not published, and a boat
        // that is stopped because of a faulty sensor drifts. Such currents can cause failsafes once
        // their normal range is known.
        for wrong in WRONGS {
            for side in [0, 1] {
                let amps = self.found(wrong, side, power, ordered);
                let told = |amps| text(wrong, side, amps);
                let name = name(wrong, side);
                let alarm = &mut self.currents[wrong as usize][side];
                events.extend(alarm.note(now, amps, self.watch.debounce_s, (told, &name)));
            }
        }
    }

    /// The current, A, if it shows the given fault.
    fn found(
        &self,
        wrong: Wrong,
        side: usize,
        power: &Power,
        ordered: Option<[f64; 2]>,
    ) -> Option<f64> {
        let watch = &self.watch;
        let [here, there] = [power.thruster_a[side], power.thruster_a[1 - side]];
        match wrong {
            Wrong::Bilge => {
                power.bilge_a[side].filter(|amps| watch.bilge_a > 0.0 && *amps >= watch.bilge_a)
            }
            Wrong::TooMuch => {
                here.filter(|amps| watch.thruster_max_a > 0.0 && amps.abs() > watch.thruster_max_a)
            }
            Wrong::TooLittle => {
                // Boats without current sensors report zeros; a current on the other side shows
                // that the boat has sensors.
                let is_measured = there.is_some_and(|amps| amps.abs() > watch.thruster_min_a);
                // In a turn, one side may have zero thrust and draw nothing, so a side without
                // current is a fault only if both sides are ordered to run.
                let is_ordered = ordered
                    .is_some_and(|sides| sides.iter().all(|pct| pct.abs() >= ORDERED_MIN_PCT));
                here.filter(|amps| amps.abs() < watch.thruster_min_a && is_measured && is_ordered)
            }
        }
    }

    /// Descriptions of the active alarms.
    pub(super) fn texts(&self) -> Vec<String> {
        let error = self.error.as_deref().map(error_text).into_iter();
        let currents = WRONGS
            .into_iter()
            .flat_map(|wrong| [0, 1].map(|side| (wrong, side)));
        let currents = currents.filter_map(|(wrong, side)| {
            self.currents[wrong as usize][side]
                .told()
                .map(|amps| text(wrong, side, amps))
        });
        error
            .chain(self.tilt.told().map(tilt_text))
            .chain(currents)
            .collect()
    }
}

/// Ordered thrust of both sides, port first, per cent; `None` if the boat steers itself.
fn ordered_pct(command: Command) -> Option<[f64; 2]> {
    match command {
        Command::SetPoint(SetPoint::Thrust {
            thrust_pct,
            difference_pct,
        }) => Some([thrust_pct + difference_pct, thrust_pct - difference_pct]),
        _ => None,
    }
}

fn tilt_text(tilt_deg: f64) -> String {
    format!("the boat is tilted by {tilt_deg:.0} degrees: it may have capsized")
}

fn error_text(code: &str) -> String {
    format!("the boat reports error {code:?}")
}

fn name(wrong: Wrong, side: usize) -> String {
    let [what, _] = wrong.words();
    format!("the {} {what}", SIDES[side])
}

fn text(wrong: Wrong, side: usize, amps: f64) -> String {
    let [_, why] = wrong.words();
    format!("{}, {amps:.1} A: {why}", name(wrong, side))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WATCH: CurrentWatch = CurrentWatch {
        thruster_max_a: 45.0,
        thruster_min_a: 0.5,
        bilge_a: 0.1,
        debounce_s: 3.0,
    };

    #[test]
    fn an_error_is_told_when_it_changes_and_stays_until_the_boat_takes_it_back() {
        let mut alarms = Alarms::new(WATCH);
        let mut events = vec![];
        for (error, told) in [
            (Some("L"), 1),
            (Some("L"), 1),
            (None, 1),
            (Some("L"), 2),
            (Some("B"), 3),
        ] {
            alarms.take_error(error.map(str::to_owned), &mut events);
            assert_eq!(events.len(), told);
            let shown: Vec<String> = error
                .iter()
                .map(|code| format!("the boat reports error {code:?}"))
                .collect();
            assert_eq!(alarms.texts(), shown);
        }
        alarms = Alarms::new(WATCH);
        alarms.take_notice("PreArm: no fix".to_owned(), &mut events);
        alarms.take_notice("PreArm: no fix".to_owned(), &mut events);
        assert_eq!(
            (events.len(), alarms.texts()),
            (4, vec![]),
            "a notice is not a state"
        );
    }
}
