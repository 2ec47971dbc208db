//! Faults that the boat itself reports: its error code, a leak, and abnormal thruster currents.
//!
//! None of these stops the boat: operators should see the alarm and decide.

use super::Event;
use crate::config::CurrentWatch;
use crate::protocol::{Command, Power};
use crate::set_point::SetPoint;
use primitives::SimTime;
use primitives::angle::wrap_pi;

/// A thruster ordered to at least this thrust must draw a current, per cent.
const ORDERED_MIN_PCT: f64 = 20.0;
/// Index order of sides: port comes first everywhere.
const SIDES: [&str; 2] = ["port", "starboard"];

/// From this roll or pitch on a boat may have capsized, degrees: waves do not hold it there ...
const TILT_MAX_DEG: f64 = 60.0;
/// ... for this long, s.
const TILT_S: f64 = 3.0;

/// A fault that counts once it has lasted for some time.
#[derive(Clone, Copy, Debug, Default)]
struct Alarm {
    /// Start of the unbroken fault, and its newest size.
    since: Option<(SimTime, f64)>,
    /// Whether the fault has outlasted the debounce and has been reported.
    is_told: bool,
}

impl Alarm {
    /// Notes the size of the fault, if there is one now. Returns a warning with this text when it has
    /// lasted for `debounce_s`, and a remark with its name at its end.
    fn note(
        &mut self,
        now: SimTime,
        size: Option<f64>,
        debounce_s: f64,
        (text, name): (impl Fn(f64) -> String, &str),
    ) -> Option<Event> {
        // Keep the time of the first report and the size of the newest, so that the text
        // follows the pump during the debounce.
        self.since = size.map(|size| (self.since.map_or(now, |(since, _)| since), size));
        let lasts = self.since.is_some_and(|(since, _)| (now - since).as_s() >= debounce_s);
        match (std::mem::replace(&mut self.is_told, lasts), self.since) {
            (false, Some((_, size))) if lasts => Some(Event::Warning(text(size))),
            // The end is a remark: nobody has to act on it.
            (true, None) => Some(Event::Remark(format!("over: {name}"))),
            _ => None,
        }
    }

    /// The size of a fault that has been reported.
    fn told(&self) -> Option<f64> {
        self.since.filter(|_| self.is_told).map(|(_, size)| size)
    }
}

/// What is wrong with a current.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wrong {
    Bilge,
    TooMuch,
    TooLittle,
}

const WRONGS: [Wrong; 3] = [Wrong::Bilge, Wrong::TooMuch, Wrong::TooLittle];

impl Wrong {
    /// Text for operators: the fault on a side, and its meaning.
    fn words(self) -> [&'static str; 2] {
        match self {
            Wrong::Bilge => ["bilge pump runs", "the boat is taking on water"],
            Wrong::TooMuch => ["thruster draws too much", "the propeller may be fouled"],
            Wrong::TooLittle => ["thruster draws no current", "it may be off or broken"],
        }
    }
}

/// The active alarms of a boat.
#[derive(Clone, Debug)]
pub(super) struct Alarms {
    watch: CurrentWatch,
    /// The error that the boat reports now.
    error: Option<String>,
    /// The last notice from the boat.
    notice: Option<String>,
    /// The present tilt, degrees.
    tilt: Alarm,
    /// Abnormal thruster currents, A, by fault (order of `WRONGS`), then side (port first).
    currents: [[Alarm; 2]; 3],
}

impl Alarms {
    /// No alarms: nothing has been received yet.
    pub(super) fn new(watch: CurrentWatch) -> Alarms {
        Alarms { watch, error: None, notice: None, tilt: Alarm::default(), currents: Default::default() }
    }

    /// Records the boat's error code; `None` means no error.
    pub(super) fn take_error(&mut self, error: Option<String>, events: &mut Vec<Event>) {
        if error != self.error {
            events.extend(error.as_deref().map(error_text).map(Event::Warning));
            self.error = error;
        }
    }

    /// Records a one-off notice from the boat. A repeated text is not reported again.
    pub(super) fn take_notice(&mut self, text: String, events: &mut Vec<Event>) {
        if self.notice.as_ref() != Some(&text) {
            events.push(Event::Warning(format!("the boat reports {text:?}")));
            self.notice = Some(text);
        }
    }

    /// Checks roll and pitch, degrees.
    pub(super) fn take_tilt(&mut self, now: SimTime, tilt_deg: [f64; 2], events: &mut Vec<Event>) {
        let tilt_deg = tilt_deg.map(|deg| wrap_pi(deg.to_radians()).to_degrees().abs());
        let tilt_deg = tilt_deg[0].max(tilt_deg[1]);
        let tilt_deg = Some(tilt_deg).filter(|tilt_deg| *tilt_deg >= TILT_MAX_DEG);
        events.extend(self.tilt.note(now, tilt_deg, TILT_S, (tilt_text, "the boat lay on its side")));
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
        // stopped for a faulty sensor drifts. They can become failsafes when boats have shown what
        // is normal.
        for wrong in WRONGS {
            for side in [0, 1] {
                let amps = self.found(wrong, side, power, ordered);
                let (told, name) = (|amps| text(wrong, side, amps), name(wrong, side));
                let alarm = &mut self.currents[wrong as usize][side];
                events.extend(alarm.note(now, amps, self.watch.debounce_s, (told, &name)));
            }
        }
    }

    /// The current, A, if it shows this fault.
    fn found(&self, wrong: Wrong, side: usize, power: &Power, ordered: Option<[f64; 2]>) -> Option<f64> {
        let (watch, [here, there]) = (&self.watch, [power.thruster_a[side], power.thruster_a[1 - side]]);
        match wrong {
            Wrong::Bilge => power.bilge_a[side].filter(|amps| watch.bilge_a > 0.0 && *amps >= watch.bilge_a),
            Wrong::TooMuch => here.filter(|amps| watch.thruster_max_a > 0.0 && amps.abs() > watch.thruster_max_a),
            Wrong::TooLittle => {
                // Boats without current sensors report zeros; a current on the other side proves
                // that this boat measures.
                let is_measured = there.is_some_and(|amps| amps.abs() > watch.thruster_min_a);
                // In a turn one side may have zero thrust and draw nothing, so a silent side means
                // something only if both are ordered.
                let is_ordered = ordered.is_some_and(|sides| sides.iter().all(|pct| pct.abs() >= ORDERED_MIN_PCT));
                here.filter(|amps| amps.abs() < watch.thruster_min_a && is_measured && is_ordered)
            }
        }
    }

    /// The active alarms as texts.
    pub(super) fn texts(&self) -> Vec<String> {
        let error = self.error.as_deref().map(error_text).into_iter();
        let currents = WRONGS.into_iter().flat_map(|wrong| [0, 1].map(|side| (wrong, side)));
        let currents = currents
            .filter_map(|(wrong, side)| self.currents[wrong as usize][side].told().map(|amps| text(wrong, side, amps)));
        error.chain(self.tilt.told().map(tilt_text)).chain(currents).collect()
    }
}

/// Ordered thrust of both sides, port first, per cent; `None` if the boat steers itself.
fn ordered_pct(command: Command) -> Option<[f64; 2]> {
    match command {
        Command::SetPoint(SetPoint::Thrust { thrust_pct, difference_pct }) => {
            Some([thrust_pct + difference_pct, thrust_pct - difference_pct])
        }
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

    const WATCH: CurrentWatch =
        CurrentWatch { thruster_max_a: 45.0, thruster_min_a: 0.5, bilge_a: 0.1, debounce_s: 3.0 };

    fn power(thruster_a: [f64; 2], bilge_a: [f64; 2]) -> Power {
        Power { thruster_a: thruster_a.map(Some), bilge_a: bilge_a.map(Some), ..Power::default() }
    }

    fn ahead(thrust_pct: f64, difference_pct: f64) -> Option<Command> {
        Some(Command::SetPoint(SetPoint::Thrust { thrust_pct, difference_pct }))
    }

    /// Alarm texts after this many seconds of the same input, and the events until then.
    fn after(watch: CurrentWatch, seconds: u32, power: &Power, command: Option<Command>) -> (Vec<String>, usize) {
        let (mut alarms, mut events) = (Alarms::new(watch), vec![]);
        (0..=seconds).for_each(|s| alarms.take_power(SimTime::from_s(f64::from(s)), power, command, &mut events));
        (alarms.texts(), events.len())
    }

    #[test]
    fn each_current_that_lasts_is_told_once_with_its_side() {
        let none = [0.0; 2];
        for (power, command, told) in [
            (power([10.0, 10.0], none), ahead(40.0, 0.0), ""),
            (
                power([10.0, 10.0], [0.0, 0.8]),
                None,
                "the starboard bilge pump runs, 0.8 A: the boat is taking on water",
            ),
            (power([10.0, 10.0], [0.05, 0.0]), None, ""),
            (power([52.0, 10.0], none), None, "the port thruster draws too much, 52.0 A"),
            (power([10.0, -52.0], none), None, "the starboard thruster draws too much, -52.0 A"),
            (power([0.0, 10.0], none), ahead(40.0, 0.0), "the port thruster draws no current, 0.0 A"),
            // No alarm: one thruster is stopped in a turn, the boat steers itself, or it has no
            // current sensor.
            (power([0.0, 10.0], none), ahead(15.0, -15.0), ""),
            (power([0.0, 10.0], none), None, ""),
            (power([0.0, 0.0], none), ahead(40.0, 0.0), ""),
        ] {
            let (texts, events) = after(WATCH, 60, &power, command);
            assert_eq!((texts.len(), events), (usize::from(!told.is_empty()), texts.len()), "{texts:?}");
            assert!(texts.iter().all(|text| text.starts_with(told)), "{texts:?}, expected {told:?}");
            assert_eq!(after(WATCH, 2, &power, command).0, Vec::<String>::new(), "after two seconds");
        }
        let off = CurrentWatch { thruster_max_a: 0.0, thruster_min_a: 0.0, bilge_a: 0.0, ..WATCH };
        let all = power([0.0, 100.0], [9.0, 9.0]);
        assert_eq!(after(off, 60, &all, ahead(40.0, 0.0)), (vec![], 0));
    }

    #[test]
    fn an_alarm_ends_with_the_report_that_all_is_well_and_one_bad_report_is_none() {
        let (mut alarms, mut events) = (Alarms::new(WATCH), vec![]);
        let mut take = |s: f64, bilge_a: f64| {
            alarms.take_power(SimTime::from_s(s), &power([0.0; 2], [bilge_a, 0.0]), None, &mut events);
            (alarms.texts().len(), events.len())
        };
        assert_eq!(take(0.0, 0.8), (0, 0));
        assert_eq!(take(2.9, 0.8), (0, 0));
        assert_eq!(take(3.0, 0.0), (0, 0), "nothing was told, so nothing is over");
        assert_eq!(take(4.0, 0.8), (0, 0), "it begins anew");
        assert_eq!(take(7.0, 0.8), (1, 1));
        assert_eq!(take(8.0, 0.9), (1, 1));
        assert_eq!(take(9.0, 0.0), (0, 2));
    }

    #[test]
    fn a_boat_on_its_side_is_an_alarm_and_a_wave_is_none() {
        for (tilt_deg, told) in [
            ([170.0, 0.0], "the boat is tilted by 170 degrees: it may have capsized"),
            ([-95.0, 3.0], "the boat is tilted by 95 degrees"),
            ([190.0, 3.0], "the boat is tilted by 170 degrees"),
            ([0.0, 80.0], "the boat is tilted by 80 degrees"),
            ([40.0, -30.0], ""),
            ([359.0, 0.0], ""),
        ] {
            let (mut alarms, mut events) = (Alarms::new(WATCH), vec![]);
            let mut take = |s: f64, tilt_deg| {
                alarms.take_tilt(SimTime::from_s(s), tilt_deg, &mut events);
                (alarms.texts(), events.len())
            };
            assert_eq!(take(0.0, tilt_deg), (vec![], 0));
            assert_eq!(take(2.9, tilt_deg), (vec![], 0));
            let (texts, events) = take(3.0, tilt_deg);
            assert_eq!((texts.len(), events), (usize::from(!told.is_empty()), texts.len()), "{texts:?}");
            assert!(texts.iter().all(|text| text.starts_with(told)), "{texts:?}");
            assert_eq!(take(4.0, [0.0; 2]).0, Vec::<String>::new());
        }
    }

    #[test]
    fn an_error_is_told_when_it_changes_and_stays_until_the_boat_takes_it_back() {
        let (mut alarms, mut events) = (Alarms::new(WATCH), vec![]);
        for (error, told) in [(Some("L"), 1), (Some("L"), 1), (None, 1), (Some("L"), 2), (Some("B"), 3)] {
            alarms.take_error(error.map(str::to_owned), &mut events);
            assert_eq!(events.len(), told);
            let shown: Vec<String> = error.iter().map(|code| format!("the boat reports error {code:?}")).collect();
            assert_eq!(alarms.texts(), shown);
        }
        alarms = Alarms::new(WATCH);
        alarms.take_notice("PreArm: no fix".to_owned(), &mut events);
        alarms.take_notice("PreArm: no fix".to_owned(), &mut events);
        assert_eq!((events.len(), alarms.texts()), (4, vec![]), "a notice is no state");
    }
}
