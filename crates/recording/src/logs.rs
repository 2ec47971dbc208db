//! Logs of a game's boats as series of measurements, which become a recording of that game.
//!
//! Each format has its own reader: [`crate::alog`] for MOOS, and the crate `import` for the others.
//! Tags for which no tag manager logged a result count as boundary tags.

use crate::{Decision, Ending, Entry, Header, Writer};
use messages::input::Input;
use messages::order::Order;
use messages::picture::{FlagView, Nav};
use messages::{EventRecord, Frame, GameInfo, Message, Stamp, VehicleTruth, water::Water};
use primitives::angle::{rad_from_compass_deg, wrap_pi};
use primitives::{FlagId, LatLon, Ned, SimTime, TeamId, VehicleId};
use rules::event::{Event, Logged, TagCause};
use rules::field::{Field, Plan};
use scenario::{Outcome, Scenario, Source, Vehicle};
use std::collections::BTreeMap;
use std::io::Cursor;

/// The pace of games read from logs, whose inputs are unknown.
pub const PACE: &str = "logs";
/// The name of an unknown game.
const UNKNOWN: &str = "imported";
/// Time without a position after which a boat's navigation counts as lost, s.
const SILENCE_S: f64 = 5.0;
/// Maximum length of a game, s: longer logs contain several games, or their clocks differ.
const LENGTH_MAX_S: f64 = 86_400.0;
/// Width of the water around the tracks if the field is unknown, m.
const MARGIN_M: f64 = 10.0;

/// Times (s, UTC since 1970 or since the start of the log) and values.
pub type Series = Vec<(f64, f64)>;

/// A measured quantity of a boat, or of a team or the game.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// East of the datum, m.
    X,
    /// North of the datum, m.
    Y,
    /// Height above the ellipsoid, the geoid or the boat's start, m: only its changes matter.
    Height,
    /// Compass heading, degrees.
    Heading,
    /// Speed over the ground, m/s.
    Speed,
    /// Velocity north over the ground, m/s.
    North,
    /// Velocity east over the ground, m/s.
    East,
    /// Velocity ahead over the ground, m/s.
    Surge,
    /// Velocity to starboard over the ground, m/s.
    Sway,
    /// Yaw rate, degrees per second clockwise.
    YawRate,
    /// Commanded thrust of the port thruster, per cent.
    Port,
    /// Commanded thrust of the starboard thruster, per cent.
    Starboard,
    /// 1 while the boat is tagged.
    Tagged,
    /// 1 while the boat carries a flag.
    HasFlag,
    /// The points of a team.
    Scores,
    /// Of the game (no name): 1 when it starts, 0 when it ends.
    Play,
}

/// The contents of a game's logs.
#[derive(Debug, Default)]
pub struct Logs {
    /// Series by boat, team or neither, then by quantity, then by source from best to worst.
    values: BTreeMap<String, BTreeMap<(Quantity, u8), Series>>,
    /// The teams of boats.
    teams: BTreeMap<String, String>,
    /// Tags: time (s), tagged boat, tagger.
    tags: Vec<(f64, String, String)>,
    /// Geographic position of x = y = 0; `None` if the logs do not contain it.
    pub datum: Option<LatLon>,
}

impl Logs {
    /// Adds a value of a boat, of a team, or of the game. If a quantity has several sources, the
    /// one with the lowest number is used.
    pub fn push(&mut self, whose: &str, quantity: Quantity, source: u8, (at_s, value): (f64, f64)) {
        let known = self.values.entry(whose.to_owned()).or_default();
        known
            .entry((quantity, source))
            .or_default()
            .push((at_s, value));
    }

    /// Sets the team of a boat.
    pub fn set_team(&mut self, boat: &str, team: &str) {
        self.teams.insert(boat.to_owned(), team.to_owned());
    }

    /// Adds a tag.
    pub fn push_tag(&mut self, at_s: f64, tagged: &str, by: &str) {
        self.tags.push((at_s, tagged.to_owned(), by.to_owned()));
    }

    /// Shifts all times by an interval, s.
    pub fn shift(&mut self, by_s: f64) {
        for (at_s, _) in self
            .values
            .values_mut()
            .flatten()
            .flat_map(|(_, series)| series)
        {
            *at_s += by_s;
        }
        self.tags.iter_mut().for_each(|(at_s, ..)| *at_s += by_s);
    }

    /// Adds other logs of the same game.
    pub fn merge(&mut self, other: Logs) {
        for (whose, quantities) in other.values {
            let known = self.values.entry(whose).or_default();
            for (key, series) in quantities {
                known.entry(key).or_default().extend(series);
            }
        }
        self.teams.extend(other.teams);
        self.tags.extend(other.tags);
        self.datum = self.datum.or(other.datum);
    }

    /// Sorts all series by time, and removes the jumps of headings at north.
    pub fn sort(&mut self) {
        for ((quantity, _), series) in self.values.values_mut().flatten() {
            series.sort_by(|a, b| a.0.total_cmp(&b.0));
            if *quantity == Quantity::Heading {
                let mut before = series.first().map_or(0.0, |(_, first)| *first);
                for (_, deg) in series {
                    *deg = before + (*deg - before + 180.0).rem_euclid(360.0) - 180.0;
                    before = *deg;
                }
            }
        }
    }

    /// The boats with a track, by name.
    pub fn boats(&self) -> Vec<String> {
        let has_track = |boat: &&String| self.series(boat, Quantity::X).is_some();
        self.values.keys().filter(has_track).cloned().collect()
    }

    /// The best series of a quantity.
    pub fn series(&self, whose: &str, quantity: Quantity) -> Option<&Series> {
        let known = self.values.get(whose)?;
        let mut sources = known.range((quantity, 0)..=(quantity, u8::MAX));
        sources.next().map(|(_, series)| series)
    }

    /// The game as an MCAP file. Call [`Logs::sort`] first. If `is_known`, `game` is the scenario
    /// of the logged game; otherwise its boats and field are replaced with the logged boats and a
    /// field around their tracks.
    ///
    /// # Errors
    /// If the logs do not belong to one game, or a boat is not in the scenario.
    pub fn recording(&self, game: Scenario, is_known: bool) -> Result<Vec<u8>, String> {
        let boats = self.boats();
        let tracks = || {
            boats
                .iter()
                .filter_map(|boat| self.series(boat, Quantity::X))
        };
        let firsts = tracks().map(|track| track[0].0);
        let first_s = firsts.reduce(f64::min).ok_or("no boat has a position")?;
        let lasts = tracks().filter_map(|track| track.last());
        let last_s = lasts.fold(first_s, |last_s, (time_s, _)| last_s.max(*time_s));
        let mut scenario = if is_known {
            game
        } else {
            self.scenario(game, &boats)
        };
        for boat in &boats {
            scenario.vehicle_named(boat).map_err(|e| e.to_string())?;
        }
        let plays = self.series("", Quantity::Play);
        let when = |state| Some(plays?.iter().find(|(_, value)| *value == state)?.0);
        let start_s = when(1.0).unwrap_or(first_s);
        let stop_s = when(0.0).filter(|end| *end > start_s);
        let length_s = stop_s.unwrap_or(last_s) - start_s;
        if !(0.0..LENGTH_MAX_S).contains(&length_s) {
            return Err("the logs span more than a day: are they all from one game?".to_owned());
        }
        if !is_known {
            scenario.rules.time_limit = SimTime::from_s(length_s);
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
    ) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
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
            let thrusts = (0..scenario.vehicles.len()).filter_map(|i| {
                let order = self.thrust(&scenario.vehicles[i].name, at_s)?;
                Some(Input::Ordered {
                    vehicle: VehicleId::at(i),
                    order,
                    given_at: SimTime::NEVER,
                })
            });
            let decision = Decision {
                inputs: thrusts.collect(),
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
        Ok(writer.end(ending.facts())?.into_inner())
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
        let points = |team: &scenario::Team| {
            self.newest(&team.name, Quantity::Scores, at_s)
                .unwrap_or(0.0) as u32
        };
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
        let at = |quantity| self.at(name, quantity, at_s);
        let is = |quantity| self.newest(name, quantity, at_s) == Some(1.0);
        let seen = self.series(name, Quantity::X);
        let seen_s = seen.and_then(|series| newest(series, at_s)).map(|(s, _)| s);
        let surge_m_s = at(Quantity::Surge).or_else(|| at(Quantity::Speed));
        let flag = scenario
            .field
            .flags
            .iter()
            .position(|flag| flag.team != *team);
        VehicleTruth {
            nav: Nav {
                north_m: at(Quantity::Y).unwrap_or(0.0),
                east_m: at(Quantity::X).unwrap_or(0.0),
                psi_rad: wrap_pi(rad_from_compass_deg(at(Quantity::Heading).unwrap_or(0.0))),
                surge_m_s: surge_m_s.unwrap_or(0.0),
                sway_m_s: at(Quantity::Sway).unwrap_or(0.0),
                yaw_rate_rad_s: at(Quantity::YawRate).unwrap_or(0.0).to_radians(),
            },
            tagged: is(Quantity::Tagged),
            carrying: flag
                .filter(|_| is(Quantity::HasFlag))
                .map_or(-1, |flag| flag as i16),
            nav_lost: seen_s.is_none_or(|seen_s| at_s - seen_s > SILENCE_S),
            ..VehicleTruth::default()
        }
    }

    /// Reports what changed since the previous frame: whether a boat is tagged, and which flag it
    /// carries.
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

    /// A boat's measurement at a time, by linear interpolation.
    pub fn at(&self, boat: &str, quantity: Quantity, at_s: f64) -> Option<f64> {
        Some(between(self.series(boat, quantity)?, at_s))
    }

    /// The commanded thrust; `None` if the logs do not contain it.
    fn thrust(&self, boat: &str, at_s: f64) -> Option<Order> {
        let [port, starboard] = [Quantity::Port, Quantity::Starboard]
            .map(|side| self.newest(boat, side, at_s).map(|pct| 0.01 * pct));
        Some(Order::Thrust {
            port: port?,
            starboard: starboard?,
        })
    }

    /// The last value of a boat, a team or the game at or before a time.
    pub fn newest(&self, whose: &str, quantity: Quantity, at_s: f64) -> Option<f64> {
        Some(self.newest_at(whose, quantity, at_s)?.1)
    }

    /// Like [`Logs::newest`], with the time of the value.
    pub fn newest_at(&self, whose: &str, quantity: Quantity, at_s: f64) -> Option<(f64, f64)> {
        newest(self.series(whose, quantity)?, at_s)
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
            let tracks = || boats.iter().filter_map(|boat| self.series(boat, axis));
            let values = || tracks().flatten().map(|(_, value)| *value);
            let low = values().fold(f64::INFINITY, f64::min) - MARGIN_M;
            (low, values().fold(low, f64::max) + MARGIN_M - low)
        };
        let ((east, width_m), (north, depth_m)) = (bounds(Quantity::X), bounds(Quantity::Y));
        let field = Field::new(Plan {
            name: UNKNOWN.to_owned(),
            datum: self.datum.unwrap_or(game.field.plan.datum),
            corner: Ned { north, east },
            along_deg: 90.0,
            width_m,
            depth_m,
            flag_inset_m: width_m / 8.0,
            ..game.field.plan.clone()
        });
        let mut strategies = game.strategies.clone();
        for strategy in &mut strategies {
            // Only the name changes: it is not known how these boats decided.
            strategy.name = "unknown".to_owned();
        }
        Scenario {
            name: UNKNOWN.to_owned(),
            vehicles: boats.iter().map(vehicle).collect(),
            field,
            strategies,
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

/// The name of a boat or a team in the form used in scenarios.
pub fn name_of(text: &str) -> String {
    let fit = |c: char| {
        if c.is_ascii_alphanumeric() {
            c.to_ascii_lowercase()
        } else {
            '_'
        }
    };
    text.trim().chars().map(fit).take(40).collect()
}
