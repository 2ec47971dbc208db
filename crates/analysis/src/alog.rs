//! Exports a game as `.alog` files of MOOS, for its post-mission tools (`alogview`, `aloggrep` and
//! the like).
//!
//! As after a mission, there is a file for the shoreside and one for every vehicle. Positions are
//! local metres, x east and y north of the datum; headings are compass degrees. A file has a header
//! of five lines, then rows in time order: seconds since `LOGSTART` in 15 columns with 5 decimal
//! places, the variable in 20, the source in 15, and the value. Values are not escaped, and older
//! readers drop blanks, so no value here contains blanks.
//!
//! | file | variables |
//! |---|---|
//! | shoreside | `NODE_REPORT` of every boat (the truth), `AQUATICUS_GAME_ALL`, `<TEAM>_SCORES`, `<TEAM>_FLAG_GRABBED`, `HAS_FLAG_<BOAT>`, `TAGGED_<BOAT>`, `ONFIELD_<BOAT>`, `TAG_RESULT_<BOAT>`, `FLAG_RESET`, `SQUALL_EVENT` |
//! | a vehicle | `NAV_X`, `NAV_Y`, `NAV_HEADING`, `NAV_SPEED` (estimated), the same as `NAV_GT_…` (true), `DESIRED_HEADING`, `DESIRED_TURN`, `DESIRED_SPEED`, `DESIRED_THRUST_L` and `_R`, `HAS_FLAG`, `TAGGED`, `NODE_REPORT_LOCAL` |

use crate::step::{Sample, Step, for_each_step};
use messages::Order;
use messages::picture::Nav;
use primitives::angle::compass_deg_from_rad;
use primitives::math::decimal;
use recording::{Damaged, Header, Recording, utc};
use scenario::Scenario;
use scenario::outcome::EventOutcome;
use std::io::{self, BufWriter, Write};

/// Period of node reports, s: the default of the test-bed's reporter.
const REPORT_S: f64 = 0.5;
/// The community name of the shoreside.
const SHORESIDE: &str = "shoreside";
/// The source of all rows.
const SOURCE: &str = "squall";

/// Maximum number of files open at a time. For more boats, the recording is read in several passes.
const FILES_MAX: usize = 100;

/// Opens the file of the shoreside or of a boat, by name.
pub type Open<'a> = dyn FnMut(&str) -> io::Result<Box<dyn Write>> + 'a;

/// A log being written.
struct Log {
    file: BufWriter<Box<dyn Write>>,
    start_utc_s: f64,
    /// When the next node report is due, s.
    report_s: f64,
}

/// The shoreside's log being written.
struct Shoreside {
    log: Log,
    points: Vec<Option<u32>>,
    has_begun: bool,
}

/// A vehicle's log being written.
struct Vehicle {
    log: Log,
    place: usize,
    before: Option<Sample>,
}

/// Writes the log of the shoreside and, if requested, those of the vehicles in order. Returns the
/// number of logs and the damaged messages.
///
/// # Errors
/// Errors of `open` and of the files that it returns.
pub fn write(
    recording: &Recording,
    wants_vehicles: bool,
    open: &mut Open<'_>,
) -> io::Result<(usize, Damaged)> {
    let header = recording.header();
    let boats = if wants_vehicles {
        recording.scenario().vehicles.len()
    } else {
        0
    };
    let mut shoreside = Some(Shoreside::begin(header, open)?);
    let mut next = 0;
    let mut damaged = Damaged::default();
    // The first pass is needed even without vehicles.
    while shoreside.is_some() || next < boats {
        let end = boats.min(next + FILES_MAX);
        let vehicles: io::Result<Vec<Vehicle>> = (next..end)
            .map(|place| Vehicle::begin(header, place, open))
            .collect();
        damaged = pass(recording, shoreside.take(), vehicles?)?;
        next = end;
    }
    Ok((1 + boats, damaged))
}

/// Writes these logs in one pass over the recording.
fn pass(
    recording: &Recording,
    mut shoreside: Option<Shoreside>,
    mut vehicles: Vec<Vehicle>,
) -> io::Result<Damaged> {
    let scenario = recording.scenario();
    let mut written = Ok(());
    let damaged = for_each_step(recording, |step| {
        if written.is_ok() {
            written = shoreside
                .iter_mut()
                .try_for_each(|log| log.add(scenario, &step));
        }
        if written.is_ok() {
            written = vehicles
                .iter_mut()
                .try_for_each(|log| log.add(scenario, &step));
        }
    });
    written?;
    let mut logs = shoreside
        .into_iter()
        .map(|log| log.log)
        .chain(vehicles.into_iter().map(|log| log.log));
    logs.try_for_each(|mut log| log.file.flush())?;
    Ok(damaged)
}

impl Shoreside {
    fn begin(header: &Header, open: &mut Open<'_>) -> io::Result<Shoreside> {
        let log = Log::begin(header, SHORESIDE, open)?;
        let points = vec![None; header.info.scenario.teams.len()];
        Ok(Shoreside {
            log,
            points,
            has_begun: false,
        })
    }

    fn add(&mut self, scenario: &Scenario, step: &Step) -> io::Result<()> {
        let log = &mut self.log;
        let time_s = step.time_s;
        // An event is recorded with the next frame. Its own time is earlier, except at the start of
        // the game.
        if !std::mem::replace(&mut self.has_begun, true) {
            log.row(time_s, "AQUATICUS_GAME_ALL", "play")?;
        }
        for logged in &step.events {
            happened(log, scenario, &EventOutcome::new(scenario, logged))?;
        }
        for ((team, now), before) in scenario.teams.iter().zip(&step.score).zip(&mut self.points) {
            if before.replace(*now) != Some(*now) {
                log.row(
                    time_s,
                    &format!("{}_SCORES", team.name.to_uppercase()),
                    &now.to_string(),
                )?;
            }
        }
        if log.reports(time_s) {
            for (place, sample) in step.samples.iter().enumerate() {
                let report = log.node_report(time_s, scenario, (place, sample, &sample.truth));
                log.row(time_s, "NODE_REPORT", &report)?;
            }
        }
        Ok(())
    }
}

impl Vehicle {
    fn begin(header: &Header, place: usize, open: &mut Open<'_>) -> io::Result<Vehicle> {
        let log = Log::begin(header, &header.info.scenario.vehicles[place].name, open)?;
        Ok(Vehicle {
            log,
            place,
            before: None,
        })
    }

    fn add(&mut self, scenario: &Scenario, step: &Step) -> io::Result<()> {
        let log = &mut self.log;
        let time_s = step.time_s;
        let Some(sample) = step.samples.get(self.place) else {
            return Ok(());
        };
        let estimated = sample.estimated.unwrap_or(sample.truth);
        log.nav(time_s, "NAV_", &estimated)?;
        log.nav(time_s, "NAV_GT_", &sample.truth)?;
        log.desired(time_s, sample.order)?;
        let before = self.before.replace(*sample);
        for (name, is, was) in [
            (
                "HAS_FLAG",
                sample.carrying,
                before.map(|before| before.carrying),
            ),
            ("TAGGED", sample.tagged, before.map(|before| before.tagged)),
        ] {
            if was != Some(is) {
                log.row(time_s, name, if is { "true" } else { "false" })?;
            }
        }
        if log.reports(time_s) {
            let report = log.node_report(time_s, scenario, (self.place, sample, &estimated));
            log.row(time_s, "NODE_REPORT_LOCAL", &report)?;
        }
        Ok(())
    }
}

impl Log {
    fn begin(header: &Header, community: &str, open: &mut Open<'_>) -> io::Result<Log> {
        let line = "%".repeat(59);
        let start_utc_s = header.began_utc_ns as f64 * 1e-9;
        let opened = utc::ctime(header.began_utc_ns);
        let mut file = BufWriter::new(open(community)?);
        writeln!(
            file,
            "{line}\n%% LOG FILE:       {community}.alog\n%% FILE OPENED ON  {opened}"
        )?;
        writeln!(file, "%% LOGSTART        {start_utc_s:>20.2}\n{line}")?;
        Ok(Log {
            file,
            start_utc_s,
            report_s: f64::NEG_INFINITY,
        })
    }

    /// Whether a node report is due at this time.
    fn reports(&mut self, at_s: f64) -> bool {
        let is_due = at_s >= self.report_s - 1e-6;
        if is_due {
            self.report_s = at_s + REPORT_S;
        }
        is_due
    }

    fn row(&mut self, at_s: f64, variable: &str, value: &str) -> io::Result<()> {
        let value: String = value.split_whitespace().collect::<Vec<_>>().join("_");
        writeln!(
            self.file,
            "{at_s:<15.5} {variable:<20} {SOURCE:<15} {value}"
        )
    }

    fn number(&mut self, at_s: f64, variable: &str, value: f64) -> io::Result<()> {
        self.row(at_s, variable, &decimal(value, 4))
    }

    fn nav(&mut self, at_s: f64, prefix: &str, nav: &Nav) -> io::Result<()> {
        let numbers = [
            ("X", nav.east_m),
            ("Y", nav.north_m),
            ("HEADING", compass_deg_from_rad(nav.psi_rad)),
            ("SPEED", nav.speed_m_s()),
        ];
        numbers
            .into_iter()
            .try_for_each(|(name, value)| self.number(at_s, &format!("{prefix}{name}"), value))
    }

    fn desired(&mut self, at_s: f64, order: Order) -> io::Result<()> {
        match order {
            Order::Hold => self.number(at_s, "DESIRED_SPEED", 0.0),
            Order::Steer {
                heading_rad,
                speed_m_s,
            } => {
                self.number(at_s, "DESIRED_HEADING", compass_deg_from_rad(heading_rad))?;
                self.number(at_s, "DESIRED_SPEED", speed_m_s)
            }
            Order::Turn { by_rad, speed_m_s } => {
                self.number(at_s, "DESIRED_TURN", by_rad.to_degrees())?;
                self.number(at_s, "DESIRED_SPEED", speed_m_s)
            }
            Order::Thrust { port, starboard } => {
                self.number(at_s, "DESIRED_THRUST_L", 100.0 * port)?;
                self.number(at_s, "DESIRED_THRUST_R", 100.0 * starboard)
            }
        }
    }

    fn node_report(
        &self,
        at_s: f64,
        scenario: &Scenario,
        (place, sample, nav): (usize, &Sample, &Nav),
    ) -> String {
        node_report(
            scenario,
            (place, nav),
            self.start_utc_s + at_s,
            mode(sample),
        )
    }
}

/// A node report of the boat at this index: comma-separated `key=value` pairs, with `TIME` in
/// seconds. `TYPE` is the shape that viewers draw.
pub fn node_report(
    scenario: &Scenario,
    (place, nav): (usize, &Nav),
    time_s: f64,
    mode: &str,
) -> String {
    let vehicle = &scenario.vehicles[place];
    let group = scenario
        .teams
        .get(vehicle.team.index())
        .map_or("", |team| team.name.as_str());
    let length_m = scenario.boat_of(primitives::VehicleId::at(place)).length_m;
    format!(
        "NAME={},TYPE=kayak,TIME={time_s:.2},X={},Y={},SPD={},HDG={},DEPTH=0,LENGTH={length_m},MODE={mode},GROUP={group}",
        vehicle.name,
        decimal(nav.east_m, 2),
        decimal(nav.north_m, 2),
        decimal(nav.speed_m_s(), 2),
        decimal(compass_deg_from_rad(nav.psi_rad), 2),
    )
}

/// Writes an event under the names used by the referees of the Aquaticus test-bed, and once more as
/// `SQUALL_EVENT`.
fn happened(log: &mut Log, scenario: &Scenario, event: &EventOutcome) -> io::Result<()> {
    let at_s = event.at_s;
    let boat = event.vehicle.as_deref().unwrap_or_default();
    let of_boat = |name: &str| format!("{name}_{}", boat.to_uppercase());
    let team = event.team.as_deref().unwrap_or_default();
    let grabbed = format!("{}_FLAG_GRABBED", team.to_uppercase());
    match event.event.as_str() {
        "grabbed" => {
            log.row(at_s, &of_boat("HAS_FLAG"), "true")?;
            log.row(at_s, &grabbed, "true")?;
        }
        "captured" | "flag_returned" => {
            log.row(at_s, &of_boat("HAS_FLAG"), "false")?;
            log.row(at_s, &grabbed, "false")?;
            log.row(at_s, "FLAG_RESET", &format!("label={team}"))?;
        }
        "tagged" | "tagged_by_boundary" | "tagged_by_obstacle" => {
            log.row(at_s, &of_boat("TAGGED"), "true")?;
            if let Some(by) = &event.other {
                let key = format!("TAG_RESULT_{}", by.to_uppercase());
                log.row(at_s, &key, &format!("source={by},tagged={boat}"))?;
            }
        }
        "untagged" => log.row(at_s, &of_boat("TAGGED"), "false")?,
        "left_field" => log.row(at_s, &of_boat("ONFIELD"), "false")?,
        "returned_to_field" => log.row(at_s, &of_boat("ONFIELD"), "true")?,
        "ended" => log.row(at_s, "AQUATICUS_GAME_ALL", "stop")?,
        _ => {}
    }
    let named = [
        ("vname", &event.vehicle),
        ("other", &event.other),
        ("team", &event.team),
    ];
    let named = named
        .into_iter()
        .filter_map(|(key, name)| Some(format!(",{key}={}", name.as_ref()?)));
    let text = format!(
        "event={}{},game={}",
        event.event,
        named.collect::<String>(),
        scenario.name
    );
    log.row(at_s, "SQUALL_EVENT", &text)
}

/// The current activity of a boat, which viewers show next to it.
fn mode(sample: &Sample) -> &'static str {
    match sample {
        Sample { nav_lost: true, .. } => "LOST",
        Sample {
            agent_lost: true, ..
        } => "MINDLESS",
        Sample { tagged: true, .. } => "TAGGED",
        Sample { outside: true, .. } => "OUTSIDE",
        Sample { carrying: true, .. } => "CARRYING",
        Sample { is_free: false, .. } => "STOPPED",
        _ => "PLAYING",
    }
}
