//! A game as the `.alog` files of MOOS, so that its post-mission tools (`alogview`, `aloggrep` and the like) read it.
//!
//! As after a mission there is a file for the shoreside and one for every vehicle. Positions are local metres, x east and
//! y north of the datum; headings are compass degrees. A file is a header of five lines, then rows in the order of time:
//! seconds since `LOGSTART` in 15 columns with 5 places, the variable in 20, the source in 15, and the value. Values are
//! not escaped, and older readers drop the blanks in them: no value here has any.
//!
//! | file | variables |
//! |---|---|
//! | shoreside | `NODE_REPORT` of every boat (the truth), `AQUATICUS_GAME_ALL`, `<TEAM>_SCORES`, `<TEAM>_FLAG_GRABBED`, `HAS_FLAG_<BOAT>`, `TAGGED_<BOAT>`, `ONFIELD_<BOAT>`, `FLAG_RESET`, `SQUALL_EVENT` |
//! | a vehicle | `NAV_X`, `NAV_Y`, `NAV_HEADING`, `NAV_SPEED` (what it estimated), the same as `NAV_GT_…` (the truth), `DESIRED_HEADING`, `DESIRED_SPEED`, `DESIRED_THRUST_L` and `_R`, `HAS_FLAG`, `TAGGED`, `NODE_REPORT_LOCAL` |

use crate::series::{BoatSeries, GameSeries, Sample};
use game::angle::compass_deg_from_rad;
use game::math::decimal;
use game::outcome::EventOutcome;
use game::picture::Nav;
use game::{Order, Scenario};
use recording::Header;
use recording::utc;
use std::fmt::Write;

/// Node reports come this often, s: as the reporter of that test-bed has it by default.
const REPORT_S: f64 = 0.5;
/// The program that all rows are from.
const SOURCE: &str = "squall";

/// A log in the making.
struct Log {
    text: String,
    start_utc_s: f64,
}

/// The files of a game: the shoreside first, then the vehicles in their order.
#[must_use]
pub fn names(series: &GameSeries) -> Vec<String> {
    let shoreside = "shoreside".to_owned();
    std::iter::once(shoreside).chain(series.boats.iter().map(|boat| boat.name.clone())).collect()
}

/// The log of the shoreside.
#[must_use]
pub fn shoreside(header: &Header, series: &GameSeries) -> String {
    let scenario = &header.info.scenario;
    let mut log = Log::new(header, "shoreside");
    let mut events = series.named_events(scenario).into_iter().peekable();
    let mut points: Vec<Option<u32>> = vec![None; series.teams.len()];
    let mut reported = Every::new(REPORT_S);
    for (i, time_s) in series.times_s.iter().copied().enumerate() {
        if i == 0 {
            log.row(time_s, "AQUATICUS_GAME_ALL", "play");
        }
        // An event is told with the frame after it; its own time comes first.
        while let Some(event) = events.next_if(|event| event.at_s <= time_s) {
            happened(&mut log, scenario, &event);
        }
        for ((team, now), before) in series.teams.iter().zip(&series.score[i]).zip(&mut points) {
            if before.replace(*now) != Some(*now) {
                log.row(time_s, &format!("{}_SCORES", team.to_uppercase()), &now.to_string());
            }
        }
        if reported.is_due(time_s) {
            for (place, boat) in series.boats.iter().enumerate() {
                let sample = &boat.samples[i];
                let report = log.node_report(time_s, (series, scenario), (place, sample, &sample.truth));
                log.row(time_s, "NODE_REPORT", &report);
            }
        }
    }
    log.text
}

/// The log of the vehicle with this place among all; none if there are fewer.
#[must_use]
pub fn vehicle(header: &Header, series: &GameSeries, place: usize) -> Option<String> {
    let boat = series.boats.get(place)?;
    let mut log = Log::new(header, &boat.name);
    let mut reported = Every::new(REPORT_S);
    let mut before: Option<&Sample> = None;
    for (time_s, sample) in series.times_s.iter().copied().zip(&boat.samples) {
        let estimated = sample.estimated.unwrap_or(sample.truth);
        log.nav(time_s, "NAV_", &estimated);
        log.nav(time_s, "NAV_GT_", &sample.truth);
        log.desired(time_s, sample.order);
        for (name, is, was) in [
            ("HAS_FLAG", sample.carrying, before.map(|before| before.carrying)),
            ("TAGGED", sample.tagged, before.map(|before| before.tagged)),
        ] {
            if was != Some(is) {
                log.row(time_s, name, if is { "true" } else { "false" });
            }
        }
        if reported.is_due(time_s) {
            let report = log.node_report(time_s, (series, &header.info.scenario), (place, sample, &estimated));
            log.row(time_s, "NODE_REPORT_LOCAL", &report);
        }
        before = Some(sample);
    }
    Some(log.text)
}

impl Log {
    fn new(header: &Header, community: &str) -> Log {
        let line = "%".repeat(59);
        let start_utc_s = header.began_utc_ns as f64 * 1e-9;
        let opened = utc::ctime(header.began_utc_ns);
        let text = format!(
            "{line}\n%% LOG FILE:       {community}.alog\n%% FILE OPENED ON  {opened}\n%% LOGSTART        {start_utc_s:>20.2}\n{line}\n"
        );
        Log { text, start_utc_s }
    }

    fn row(&mut self, at_s: f64, variable: &str, value: &str) {
        let value: String = value.split_whitespace().collect::<Vec<_>>().join("_");
        writeln!(self.text, "{at_s:<15.5} {variable:<20} {SOURCE:<15} {value}").expect("a String takes all text");
    }

    fn number(&mut self, at_s: f64, variable: &str, value: f64) {
        self.row(at_s, variable, &decimal(value, 4));
    }

    fn nav(&mut self, at_s: f64, prefix: &str, nav: &Nav) {
        for (name, value) in [
            ("X", nav.east_m),
            ("Y", nav.north_m),
            ("HEADING", compass_deg_from_rad(nav.psi_rad)),
            ("SPEED", nav.speed_m_s()),
        ] {
            self.number(at_s, &format!("{prefix}{name}"), value);
        }
    }

    fn desired(&mut self, at_s: f64, order: Order) {
        match order {
            Order::Hold => self.number(at_s, "DESIRED_SPEED", 0.0),
            Order::Steer { heading_rad, speed_m_s } => {
                self.number(at_s, "DESIRED_HEADING", compass_deg_from_rad(heading_rad));
                self.number(at_s, "DESIRED_SPEED", speed_m_s);
            }
            Order::Thrust { port, starboard } => {
                self.number(at_s, "DESIRED_THRUST_L", 100.0 * port);
                self.number(at_s, "DESIRED_THRUST_R", 100.0 * starboard);
            }
        }
    }

    /// A node report: `key=value` with commas between, `TIME` in UTC seconds. `TYPE` is a shape for viewers to draw.
    fn node_report(
        &self,
        at_s: f64,
        (series, scenario): (&GameSeries, &Scenario),
        (place, sample, nav): (usize, &Sample, &Nav),
    ) -> String {
        let boat: &BoatSeries = &series.boats[place];
        let group = series.teams.get(boat.team).map_or("", String::as_str);
        let length_m = scenario.boat_of(game::VehicleId::at(place)).length_m;
        format!(
            "NAME={},TYPE=kayak,TIME={:.2},X={},Y={},SPD={},HDG={},DEPTH=0,LENGTH={length_m},MODE={},GROUP={group}",
            boat.name,
            self.start_utc_s + at_s,
            decimal(nav.east_m, 2),
            decimal(nav.north_m, 2),
            decimal(nav.speed_m_s(), 2),
            decimal(compass_deg_from_rad(nav.psi_rad), 2),
            mode(sample),
        )
    }
}

/// What happened, under the names that the referees of the Aquaticus test-bed have for it, and all of it once more as
/// `SQUALL_EVENT`.
fn happened(log: &mut Log, scenario: &Scenario, event: &EventOutcome) {
    let at_s = event.at_s;
    let boat = event.vehicle.as_deref().unwrap_or_default();
    let of_boat = |name: &str| format!("{name}_{}", boat.to_uppercase());
    let team = event.team.as_deref().unwrap_or_default();
    let grabbed = format!("{}_FLAG_GRABBED", team.to_uppercase());
    match event.event.as_str() {
        "grabbed" => {
            log.row(at_s, &of_boat("HAS_FLAG"), "true");
            log.row(at_s, &grabbed, "true");
        }
        "captured" | "flag_returned" => {
            log.row(at_s, &of_boat("HAS_FLAG"), "false");
            log.row(at_s, &grabbed, "false");
            log.row(at_s, "FLAG_RESET", &format!("label={team}"));
        }
        "tagged" | "tagged_by_boundary" => log.row(at_s, &of_boat("TAGGED"), "true"),
        "untagged" => log.row(at_s, &of_boat("TAGGED"), "false"),
        "left_field" => log.row(at_s, &of_boat("ONFIELD"), "false"),
        "returned_to_field" => log.row(at_s, &of_boat("ONFIELD"), "true"),
        "ended" => log.row(at_s, "AQUATICUS_GAME_ALL", "stop"),
        _ => {}
    }
    let named = [("vname", &event.vehicle), ("other", &event.other), ("team", &event.team)];
    let named = named.into_iter().filter_map(|(key, name)| Some(format!(",{key}={}", name.as_ref()?)));
    let text = format!("event={}{},game={}", event.event, named.collect::<String>(), scenario.name);
    log.row(at_s, "SQUALL_EVENT", &text);
}

/// What a boat is about; a viewer shows it beside the boat.
fn mode(sample: &Sample) -> &'static str {
    match sample {
        Sample { nav_lost: true, .. } => "LOST",
        Sample { agent_lost: true, .. } => "MINDLESS",
        Sample { tagged: true, .. } => "TAGGED",
        Sample { outside: true, .. } => "OUTSIDE",
        Sample { carrying: true, .. } => "CARRYING",
        Sample { is_free: false, .. } => "STOPPED",
        _ => "PLAYING",
    }
}

/// Says at which samples something comes that does not come at all.
struct Every {
    step_s: f64,
    next_s: f64,
}

impl Every {
    fn new(step_s: f64) -> Every {
        Every { step_s, next_s: f64::NEG_INFINITY }
    }

    fn is_due(&mut self, at_s: f64) -> bool {
        let is_due = at_s >= self.next_s - 1e-6;
        if is_due {
            self.next_s = at_s + self.step_s;
        }
        is_due
    }
}
