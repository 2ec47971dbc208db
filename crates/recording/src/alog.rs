//! Reads `.alog` files of MOOS, from one or more communities of a game, as a recording of that
//! game.
//!
//! The communities' clocks are aligned by `LOGSTART`. The game begins when `AQUATICUS_GAME` or
//! `AQUATICUS_GAME_ALL` becomes `play`, or with the first position. A boat's motion is taken from
//! `NAV_GT_…`, else from `NAV_…` in its own log, else from node reports. Tags without a result from
//! a tag manager count as boundary tags.

use crate::{Bag, Decision, Ending, Entry, Header, RecordingError, Writer};
use messages::picture::{FlagView, Nav};
use messages::{EventRecord, Frame, GameInfo, Message, Stamp, VehicleTruth, water::Water};
use primitives::angle::{rad_from_compass_deg, wrap_pi};
use primitives::{FlagId, Ned, TeamId, VehicleId, input_file};
use rules::event::{Event, Logged, TagCause};
use rules::field::{Field, Plan};
use scenario::{Outcome, Scenario, Source, Vehicle};
use std::collections::BTreeMap;
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};

/// The pace of games read from logs: their inputs are not known.
pub const PACE: &str = "moos_logs";
/// The first bytes of every log.
const MAGIC: &[u8] = b"%%%%%%%%";
/// Time without a position after which a boat's navigation counts as lost, s.
const SILENCE_S: f64 = 5.0;
/// Maximum length of a game, s: longer logs contain several games, or their clocks differ.
const LENGTH_MAX_S: f64 = 86_400.0;
/// Width of the water around the tracks if the field is unknown, m.
const MARGIN_M: f64 = 10.0;
/// Variables of the log's own boat.
const OWN: &str = "NAV_GT_X NAV_GT_Y NAV_GT_HEADING NAV_GT_SPEED NAV_X NAV_Y NAV_HEADING NAV_SPEED \
                   TAGGED HAS_FLAG";

/// Times (s) and values.
type Series = Vec<(f64, f64)>;

/// The contents of a game's logs.
#[derive(Default)]
struct Game {
    /// By boat, team or neither, and by variable; `true` and `play` are stored as 1.
    values: BTreeMap<String, BTreeMap<String, Series>>,
    /// The teams of boats.
    teams: BTreeMap<String, String>,
    /// Tags: time (s), tagged boat, tagger.
    tags: Vec<(f64, String, String)>,
}

/// Whether a file is a log, by its content.
pub fn is_log(path: &Path) -> bool {
    // Opening a named pipe would block until it has a writer.
    if !path.is_file() {
        return false;
    }
    let mut start = [0; MAGIC.len()];
    std::fs::File::open(path)
        .and_then(|mut file| file.read_exact(&mut start))
        .is_ok_and(|()| start == MAGIC)
}

/// The game in these logs. If `is_known`, it is the game of this scenario; otherwise the scenario's
/// boats and field are replaced with the logged boats and a field around their tracks.
///
/// # Errors
/// [`RecordingError::Log`] with file and line.
pub fn read(files: &[PathBuf], game: Scenario, is_known: bool) -> Result<Bag, RecordingError> {
    let mut logs = Game::default();
    files.iter().try_for_each(|file| logs.add(file))?;
    let all = files.iter().map(|file| file.display().to_string());
    let all = all.collect::<Vec<_>>().join(", ");
    logs.recording(game, is_known)
        .map_err(|reason| RecordingError::Log(format!("{all}: {reason}")))
}

impl Game {
    fn add(&mut self, path: &Path) -> Result<(), RecordingError> {
        let bytes = input_file::read(path, input_file::TABLE_BYTES_MAX).map_err(|reason| {
            let path = path.to_owned();
            RecordingError::File { path, reason }
        })?;
        let mut name = name_of(&path.file_stem().unwrap_or_default().to_string_lossy());
        let (mut own, mut start_s) = (BTreeMap::<String, Series>::new(), None);
        for (i, line) in bytes.split(|byte| *byte == b'\n').enumerate() {
            let line = String::from_utf8_lossy(line);
            let wrong =
                |reason| RecordingError::Log(format!("{}:{}: {reason}", path.display(), i + 1));
            if let Some((_, start)) = line.split_once("% LOGSTART") {
                start_s = Some(number(start).map_err(wrong)?);
            }
            let (time, rest) = next_word(&line);
            let (key, rest) = next_word(rest);
            // The source comes before the value.
            let (_, value) = next_word(rest);
            let value = value.trim();
            // Values can span several lines, and the last line can be incomplete.
            let (Ok(time_s), false) = (time.parse::<f64>(), value.is_empty()) else {
                continue;
            };
            let start_s = start_s.ok_or_else(|| wrong("no LOGSTART above it".to_owned()))?;
            let row = (start_s + time_s, key, value);
            if OWN.split(' ').any(|own| own == key) {
                let series = own.entry(key.to_owned()).or_default();
                series.push((row.0, number(value).map_err(wrong)?));
            } else if let Some(boat) = self.take(row).map_err(wrong)? {
                name = boat;
            }
        }
        let known = self.values.entry(name).or_default();
        for (key, series) in own {
            known.entry(key).or_default().extend(series);
        }
        Ok(())
    }

    /// Processes a row. Returns the name of the log's own boat, if the row contains it.
    fn take(&mut self, (at_s, key, value): (f64, &str, &str)) -> Result<Option<String>, String> {
        let field = |name: &str| {
            let mut parts = value.split(',');
            parts.find_map(|part| part.trim().strip_prefix(name)?.strip_prefix('='))
        };
        if key.starts_with("NODE_REPORT") {
            let name = name_of(field("NAME").ok_or("NAME is missing")?);
            if let Some(team) = field("GROUP") {
                self.teams.insert(name.clone(), name_of(team));
            }
            let sent = field("TIME").and_then(|time| time.parse().ok());
            let sent_s = sent.filter(|sent_s| f64::abs(sent_s - at_s) < 10.0);
            let known = self.values.entry(name.clone()).or_default();
            for (name, axis) in [("X", "X"), ("Y", "Y"), ("HDG", "HEADING"), ("SPD", "SPEED")] {
                if let Some(text) = field(name) {
                    let series = known.entry(format!("REPORT_{axis}")).or_default();
                    series.push((sent_s.unwrap_or(at_s), number(text)?));
                }
            }
            return Ok((key == "NODE_REPORT_LOCAL").then_some(name));
        }
        if let Some((tagged, by)) = field("tagged").zip(field("source")) {
            self.tags.push((at_s, name_of(tagged), name_of(by)));
        }
        let (whose, what) = match key {
            "AQUATICUS_GAME" | "AQUATICUS_GAME_ALL" => ("", "PLAY"),
            "TAGGED_VEHICLES" => return Ok(None),
            _ if key.ends_with("SCORES") => (&key[..key.len() - 7], "SCORES"),
            _ if key.starts_with("TAGGED_") => (&key[7..], "TAGGED"),
            _ if key.starts_with("HAS_FLAG_") => (&key[9..], "HAS_FLAG"),
            _ => return Ok(None),
        };
        // Other values of these variables, such as `pause`, are ignored.
        if let Ok(value) = number(value) {
            let known = self.values.entry(name_of(whose)).or_default();
            let series = known.entry(what.to_owned()).or_default();
            series.push((at_s, value));
        }
        Ok(None)
    }

    fn recording(&mut self, game: Scenario, is_known: bool) -> Result<Bag, String> {
        for series in self.values.values_mut().flat_map(BTreeMap::values_mut) {
            series.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        let has_track = |boat: &&String| self.track(boat, "X").is_some();
        let boats: Vec<String> = self.values.keys().filter(has_track).cloned().collect();
        let tracks = || boats.iter().filter_map(|boat| self.track(boat, "X"));
        let firsts = tracks().map(|track| track[0].0);
        let first_s = firsts
            .reduce(f64::min)
            .ok_or("no boat has NAV_X or NODE_REPORT")?;
        let lasts = tracks().filter_map(|track| track.last());
        let last_s = lasts.fold(first_s, |last_s, (time_s, _)| last_s.max(*time_s));
        let scenario = if is_known {
            game
        } else {
            self.scenario(game, &boats)
        };
        for boat in &boats {
            scenario.vehicle_named(boat).map_err(|e| e.to_string())?;
        }
        let plays = self.values.get("").and_then(|values| values.get("PLAY"));
        let when = |state| Some(plays?.iter().find(|(_, value)| *value == state)?.0);
        let start_s = when(1.0).unwrap_or(first_s);
        let stop_s = when(0.0).filter(|end| *end > start_s);
        let length_s = stop_s.unwrap_or(last_s) - start_s;
        if !(0.0..LENGTH_MAX_S).contains(&length_s) {
            return Err("they span more than a day: are they all from one game?".to_owned());
        }
        let header = Header {
            commit: String::new(),
            game: scenario.name.clone(),
            // With a time warp, MOOS time can exceed the range of dates.
            began_utc_ns: if start_s < 8e9 {
                (start_s * 1e9) as u64
            } else {
                0
            },
            info: GameInfo {
                version: primitives::VERSION.to_owned(),
                pace: PACE.to_owned(),
                scenario,
            },
            water: Water::default(),
        };
        self.write(&header, (start_s, length_s, stop_s.is_some()))
            .map_err(|e| e.to_string())
    }

    fn write(
        &self,
        header: &Header,
        (start_s, length_s, has_ended): (f64, f64, bool),
    ) -> Result<Bag, Box<dyn std::error::Error>> {
        let scenario = &header.info.scenario;
        let count = (length_s / scenario.decision().as_s()) as u64;
        let mut writer = Writer::begin(Cursor::new(Vec::new()), &header.opening())?;
        let mut events: Vec<Logged> = Vec::new();
        let mut frame = self.frame(scenario, start_s);
        for seq in 0..=count {
            let at = scenario.decision() * seq as i64;
            let at_s = start_s + at.as_s();
            let stamp = Stamp {
                version: Frame::VERSION,
                valid_ns: at,
                seq,
            };
            let told = events.len();
            let before = std::mem::replace(&mut frame, self.frame(scenario, at_s));
            let tick = seq * u64::from(scenario.ticks_per_decision);
            let mut tell = |event| events.push(Logged { tick, at, event });
            for i in 0..scenario.vehicles.len() {
                let vehicle = VehicleId::at(i);
                self.tell_changes((&before, &frame), (vehicle, at_s), scenario, &mut tell);
            }
            let over = has_ended && seq == count;
            if over {
                let most = frame.score.iter().max();
                let mut best = (0..frame.score.len()).filter(|i| frame.score.get(*i) == most);
                let winner = best.next().filter(|_| best.next().is_none());
                let winner = winner.map(|team| TeamId(team as u8));
                tell(Event::Ended { winner });
            }
            let events = events[told..]
                .iter()
                .map(|logged| EventRecord::from(*logged));
            let shown = Frame {
                stamp,
                events: events.collect(),
                over,
                ..frame.clone()
            };
            let decision = Decision {
                frame: shown.into(),
                ..Decision::default()
            };
            let utc_ns = header.began_utc_ns + at.0.unsigned_abs();
            writer.write(&Entry::Decision(Box::new(decision)), utc_ns)?;
        }
        let ticks = count * u64::from(scenario.ticks_per_decision);
        let outcome = Outcome::new(scenario, 0, ticks, &frame.score, &events);
        let ending = Ending {
            outcome,
            ..Ending::default()
        };
        Ok(Bag::of(writer.end(ending.facts())?.into_inner())?)
    }

    fn frame(&self, scenario: &Scenario, at_s: f64) -> Frame {
        let vehicles: Vec<VehicleTruth> = scenario
            .vehicles
            .iter()
            .map(|vehicle| self.truth(scenario, vehicle, at_s))
            .collect();
        let carrier = |flag| {
            vehicles
                .iter()
                .position(|boat| usize::try_from(boat.carrying) == Ok(flag))
        };
        let flags = (0..scenario.field.flags.len()).map(|flag| FlagView {
            carrier: carrier(flag).map_or(-1, |boat| boat as i32),
        });
        let points =
            |team: &scenario::Team| self.newest(&team.name, "SCORES", at_s).unwrap_or(0.0) as u32;
        Frame {
            flags: flags.collect(),
            score: scenario.teams.iter().map(points).collect(),
            vehicles,
            ..Frame::default()
        }
    }

    fn truth(
        &self,
        scenario: &Scenario,
        Vehicle { name, team, .. }: &Vehicle,
        at_s: f64,
    ) -> VehicleTruth {
        let axis = |axis| between(self.track(name, axis).map_or(&[], Vec::as_slice), at_s);
        let newest_of = |axis| newest(self.track(name, axis)?, at_s);
        let heading_deg = newest_of("HEADING").map_or(0.0, |(_, deg)| deg);
        let is = |key| self.newest(name, key, at_s);
        let flag = scenario
            .field
            .flags
            .iter()
            .position(|flag| flag.team != *team);
        VehicleTruth {
            nav: Nav {
                north_m: axis("Y"),
                east_m: axis("X"),
                psi_rad: wrap_pi(rad_from_compass_deg(heading_deg)),
                surge_m_s: axis("SPEED"),
                ..Nav::default()
            },
            tagged: is("TAGGED") == Some(1.0),
            carrying: flag
                .filter(|_| is("HAS_FLAG") == Some(1.0))
                .map_or(-1, |flag| flag as i16),
            nav_lost: newest_of("X").is_none_or(|(seen_s, _)| at_s - seen_s > SILENCE_S),
            ..VehicleTruth::default()
        }
    }

    /// Reports a boat's changes since the previous frame.
    fn tell_changes(
        &self,
        (before, now): (&Frame, &Frame),
        (vehicle, at_s): (VehicleId, f64),
        scenario: &Scenario,
        tell: &mut dyn FnMut(Event),
    ) {
        let Vehicle { name, team, .. } = &scenario.vehicles[vehicle.index()];
        let [was, is] = [before, now].map(|frame| frame.vehicles[vehicle.index()]);
        if was.tagged != is.tagged {
            let mut tags = self.tags.iter();
            let by = tags.find(|(tag_s, who, _)| who == name && (tag_s - at_s).abs() < 2.0);
            let by = by.and_then(|(.., by)| scenario.vehicle_by_name(by));
            let cause = by.map_or(TagCause::Boundary, TagCause::Opponent);
            let tagged = Event::Tagged { vehicle, cause };
            tell(if is.tagged {
                tagged
            } else {
                Event::Untagged(vehicle)
            });
        }
        if was.carrying != is.carrying {
            let flag = FlagId(was.carrying.max(is.carrying) as u8);
            let has_scored = now.score[team.index()] > before.score[team.index()];
            tell(match (is.carrying >= 0, has_scored) {
                (true, _) => Event::Grabbed { vehicle, flag },
                (_, true) => Event::Captured { vehicle, flag },
                _ => Event::FlagReturned { vehicle, flag },
            });
        }
    }

    /// The best source of a boat's motion along an axis.
    fn track(&self, boat: &str, axis: &str) -> Option<&Series> {
        let values = self.values.get(boat)?;
        let mut sources = ["NAV_GT_", "NAV_", "REPORT_"].into_iter();
        sources.find_map(|source| values.get(&format!("{source}{axis}")))
    }

    fn newest(&self, whose: &str, key: &str, at_s: f64) -> Option<f64> {
        Some(newest(self.values.get(whose)?.get(key)?, at_s)?.1)
    }

    /// The scenario with the boats of the logs, and a field around their tracks.
    fn scenario(&self, game: Scenario, boats: &[String]) -> Scenario {
        let vehicle = |name: &String| {
            let said = self.teams.get(name).unwrap_or(name);
            let is_of = |team: &scenario::Team| said.starts_with(&team.name);
            Vehicle {
                name: name.clone(),
                team: TeamId(game.teams.iter().position(is_of).unwrap_or(0) as u8),
                source: Source::External,
                ..game.vehicles[0].clone()
            }
        };
        let bounds = |axis| {
            let tracks = || boats.iter().filter_map(|boat| self.track(boat, axis));
            let values = || tracks().flatten().map(|(_, value)| *value);
            let low = values().fold(f64::INFINITY, f64::min) - MARGIN_M;
            (low, values().fold(low, f64::max) + MARGIN_M - low)
        };
        let ((east, width_m), (north, depth_m)) = (bounds("X"), bounds("Y"));
        let field = Field::new(Plan {
            name: PACE.to_owned(),
            corner: Ned { north, east },
            along_deg: 90.0,
            width_m,
            depth_m,
            flag_inset_m: width_m / 8.0,
            ..game.field.plan.clone()
        });
        Scenario {
            name: PACE.to_owned(),
            vehicles: boats.iter().map(vehicle).collect(),
            field,
            recipe: None,
            ..game
        }
    }
}

/// The last value at or before a time.
fn newest(series: &Series, at_s: f64) -> Option<(f64, f64)> {
    let next = series.partition_point(|(time_s, _)| *time_s <= at_s);
    Some(series[next.checked_sub(1)?])
}

/// The value at a time, by linear interpolation.
fn between(series: &[(f64, f64)], at_s: f64) -> f64 {
    let next = series.partition_point(|(time_s, _)| *time_s <= at_s);
    let (before, after) = series.split_at(next);
    let (Some(a), Some(b)) = (
        before.last().or(series.first()),
        after.first().or(series.last()),
    ) else {
        return 0.0;
    };
    let span_s = b.0 - a.0;
    let share = if span_s > 0.0 {
        (at_s - a.0) / span_s
    } else {
        0.0
    };
    a.1 + (b.1 - a.1) * share
}

fn next_word(text: &str) -> (&str, &str) {
    let text = text.trim();
    text.split_once(char::is_whitespace).unwrap_or((text, ""))
}

fn number(text: &str) -> Result<f64, String> {
    match text.trim().to_ascii_lowercase().as_str() {
        "true" | "play" => Ok(1.0),
        "false" | "stop" => Ok(0.0),
        text => {
            let number = text.parse().ok().filter(|number| f64::is_finite(*number));
            number.ok_or_else(|| format!("{text:?} is not a number"))
        }
    }
}

/// A boat or a team, as named in scenarios.
fn name_of(text: &str) -> String {
    let fit = |c: char| {
        if c.is_ascii_alphanumeric() {
            c.to_ascii_lowercase()
        } else {
            '_'
        }
    };
    text.trim().chars().map(fit).take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Recording;

    const BLUE: &str = "%% LOGSTART 1000.0\n1.0 NODE_REPORT_LOCAL p NAME=Blue_1,GROUP=blue\n\
        1.0 NAV_X p 10\n1.0 NAV_Y p -20\n3.0 NAV_X p 14\n3.0 NAV_Y p -20\n2.0 NAV_HEADING p 90\n\
        2.0 TAGGED p false\n3.0 HAS_FLAG p true\n3.1 APPCAST p two\nlines\n3.2 NAV_X";
    const SHORE: &str = "%% LOGSTART 1001.0\n0.5 NODE_REPORT p NAME=red_1,X=50,Y=5,SPD=1,HDG=0\n\
        1.0 TAG_RESULT_RED_1 p event=1,source=red_1,tagged=blue_1\n1.0 TAGGED_BLUE_1 p true\n\
        1.5 RED_SCORES p 2\n2.0 AQUATICUS_GAME_ALL p stop\n";

    fn read_text(texts: &[&str]) -> Result<Recording, RecordingError> {
        let folder = tempfile::tempdir().expect("a folder");
        let file = |(i, text)| {
            let path = folder.path().join(format!("{i}.txt"));
            std::fs::write(&path, format!("%%%%%%%%%%\n{text}")).expect("it is written");
            assert!(is_log(&path));
            path
        };
        let files: Vec<PathBuf> = texts.iter().enumerate().map(file).collect();
        let game = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../scenarios/games/pav01_vs_pav01.toml"
        );
        let game = scenario::load(Path::new(game)).unwrap_or_else(|e| panic!("{e}"));
        read(&files, game, false).and_then(Recording::of_bag)
    }

    #[test]
    fn logs_of_several_clocks_become_one_recording() {
        let recording = read_text(&[BLUE, SHORE]).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(recording.header().began_utc_ns, 1_001_000_000_000);
        let frames: Vec<Frame> = recording
            .frames()
            .map(|frame| frame.expect("sound"))
            .collect();
        let (middle, last) = (&frames[10], frames.last().expect("frames"));
        let blue = middle.vehicles[0];
        assert_eq!(
            (blue.nav.east_m, blue.nav.north_m, blue.tagged),
            (12.0, -20.0, true)
        );
        assert_eq!(
            (last.vehicles[0].carrying, last.score.clone(), last.over),
            (1, vec![0, 2], true)
        );
        assert_eq!(last.vehicles[1].nav.east_m, 50.0);
        let ending = recording.ending().expect("an ending");
        let told = ending.outcome.events.iter().map(|event| event.sentence());
        assert_eq!(
            told.collect::<Vec<_>>(),
            [
                "blue_1 is tagged by red_1",
                "blue_1 grabs the red flag",
                "red wins"
            ]
        );
    }

    #[test]
    fn errors_name_file_and_line() {
        for (text, want) in [
            ("1.0 NAV_X p 1\n", "0.txt:2: no LOGSTART above it"),
            (
                "%% LOGSTART 1\n1 NAV_X p east\n",
                "0.txt:3: \"east\" is not a number",
            ),
            (
                "%% LOGSTART 1\n1 NODE_REPORT p X=1\n",
                "0.txt:3: NAME is missing",
            ),
            ("%% LOGSTART 1\n", "0.txt: no boat has NAV_X or NODE_REPORT"),
        ] {
            let error = read_text(&[text]).expect_err("it is wrong").to_string();
            assert!(error.ends_with(want), "{error}");
        }
        let far = SHORE.replace("1001.0", "900000.0");
        let error = read_text(&[BLUE, &far]).expect_err("two games").to_string();
        assert!(error.ends_with("are they all from one game?"), "{error}");
    }

    #[test]
    fn a_log_that_is_too_long_is_not_read() {
        let long = tempfile::NamedTempFile::new().expect("a file");
        let sized = long.as_file().set_len(input_file::TABLE_BYTES_MAX + 1);
        sized.expect("it takes no space");
        let error = Game::default().add(long.path()).expect_err("refused");
        assert!(error.to_string().contains("it is longer than"), "{error}");
    }
}
