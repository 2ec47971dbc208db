//! How sensibly boats play: order chatter, idle time, time near the edges, contacts, circling, and
//! whether any boat attacks.
//!
//! [`GameQuality`] processes a game step by step, recorded or running, and produces a [`Quality`];
//! results of several games can be added. They are split by strategy, role and mode, because those
//! are what can be improved.

mod encounter;
mod orbit;
mod text;

pub use encounter::Encounters;
pub use orbit::ORBIT_MIN_S;

use crate::step::{Sample, Step, ordered_m_s};
use encounter::EncounterCounter;
use messages::Order;
use messages::helm::HelmReport;
use orbit::OrbitDetector;
use primitives::angle::wrap_pi;
use primitives::{TeamId, VehicleId};
use scenario::Scenario;
use serde::Serialize;
use std::collections::BTreeMap;

/// Smallest course change between consecutive orders that counts as a jump, rad.
const COURSE_JUMP_RAD: f64 = std::f64::consts::FRAC_PI_4;
/// Smallest speed change between consecutive orders that counts as a jump, m/s.
const SPEED_JUMP_M_S: f64 = 1.0;
/// Speed over the ground below which a boat is idle, m/s.
const STANDING_M_S: f64 = 0.2;
/// Distance from an edge within which a boat counts as at the edge, m.
const EDGE_M: f64 = 3.0;

/// How sensibly boats played, in one game or in many.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Quality {
    /// Number of games.
    pub games: u64,
    /// Their total duration, s.
    pub time_s: f64,
    /// Number of encounters, each counted once.
    pub encounters: Encounters,
    /// Results by strategy.
    pub strategies: BTreeMap<String, StrategyQuality>,
}

/// How sensibly the boats of a strategy played.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct StrategyQuality {
    /// Number of teams in the sums: a game of a strategy against itself has two.
    pub teams: u64,
    /// Total duration of their games, s.
    pub time_s: f64,
    /// Time in which no boat of the team attacked, s: none carried a flag, and none was free beyond
    /// its own side.
    pub nobody_attacks_s: f64,
    /// Number of encounters of its boats; one between two teammates counts once.
    pub encounters: Encounters,
    /// Results by role.
    pub roles: BTreeMap<String, RoleQuality>,
}

/// How sensibly the boats of a role played.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RoleQuality {
    /// Number of orbits: the boat circled the same point at the same radius for longer than
    /// [`ORBIT_MIN_S`].
    pub orbits: u64,
    /// Their total duration, s.
    pub orbit_s: f64,
    /// Results by mode.
    pub modes: BTreeMap<String, ModeQuality>,
}

/// How sensibly boats played in a mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ModeQuality {
    /// Time in the mode, s.
    pub time_s: f64,
    /// Number of times a boat entered it.
    pub begun: u64,
    /// Number of ordered courses more than 45 degrees from the previous one, within the mode.
    pub course_jumps: u64,
    /// Number of ordered speeds more than 1 m/s from the previous one, within the mode.
    pub speed_jumps: u64,
    /// Time at rest (below 0.2 m/s over the ground), s.
    pub standing_s: f64,
    /// Time within 3 m of an edge or beyond it, s.
    pub edge_s: f64,
}

/// Processes a game step by step into its [`Quality`].
pub struct GameQuality {
    scenario: Scenario,
    /// Time of the previous step, s.
    before_s: Option<f64>,
    boats: Vec<BoatTrack>,
    encounters: EncounterCounter,
    quality: Quality,
}

/// The role and mode of a boat's mind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MindState {
    /// Its role: the name of its strategy program.
    pub role: String,
    /// Its mode.
    pub mode: String,
}

impl From<HelmReport> for MindState {
    fn from(report: HelmReport) -> MindState {
        MindState {
            role: report.program,
            mode: report.mode,
        }
    }
}

impl MindState {
    /// The state of a mind that does not report it.
    fn unknown() -> MindState {
        MindState {
            role: "unknown".to_owned(),
            mode: "unknown".to_owned(),
        }
    }
}

/// The history of a boat.
#[derive(Default)]
struct BoatTrack {
    /// State and order of its mind in the previous step.
    before: Option<(MindState, Order)>,
    orbit: OrbitDetector,
}

impl GameQuality {
    /// Starts before the first step of a game.
    pub fn new(scenario: &Scenario) -> GameQuality {
        let mut quality = Quality {
            games: 1,
            ..Quality::default()
        };
        for team in (0..scenario.teams.len()).map(|team| TeamId(team as u8)) {
            for strategy in strategies_of(scenario, team) {
                quality
                    .strategies
                    .entry(strategy.to_owned())
                    .or_default()
                    .teams += 1;
            }
        }
        GameQuality {
            boats: scenario
                .vehicles
                .iter()
                .map(|_| BoatTrack::default())
                .collect(),
            encounters: EncounterCounter::new(scenario),
            before_s: None,
            scenario: scenario.clone(),
            quality,
        }
    }

    /// Adds the next step. `minds` are the states of the vehicles' minds when they gave the orders
    /// for this step, if known.
    pub fn add(&mut self, step: &Step, minds: &[Option<MindState>]) {
        self.encounters.add(step, &mut self.quality);
        // A step covers the time since the previous one. The first covers none, because no order
        // preceded it.
        let Some(before_s) = self.before_s.replace(step.time_s) else {
            return;
        };
        let step_s = step.time_s - before_s;
        self.quality.time_s += step_s;
        self.add_attacks(step, step_s);
        let GameQuality {
            scenario,
            boats,
            quality,
            ..
        } = self;
        for (i, (sample, boat)) in step.samples.iter().zip(boats).enumerate() {
            let strategy = quality
                .strategies
                .entry(strategy_name(scenario, i).to_owned())
                .or_default();
            let mind = minds
                .get(i)
                .cloned()
                .flatten()
                .unwrap_or_else(MindState::unknown);
            let role = strategy.roles.entry(mind.role.clone()).or_default();
            let sums = role.modes.entry(mind.mode.clone()).or_default();
            sums.add(scenario, sample, step_s);
            sums.compare(boat.before.as_ref(), &mind, sample.order);
            let orbit = boat.orbit.add(step.time_s, sample.truth.at());
            role.orbits += u64::from(orbit.begun);
            role.orbit_s += orbit.lasted_s;
            boat.before = Some((mind, sample.order));
        }
    }

    /// Adds the time in which no boat of a team attacks.
    fn add_attacks(&mut self, step: &Step, step_s: f64) {
        let GameQuality {
            scenario, quality, ..
        } = self;
        for team in (0..scenario.teams.len()).map(|team| TeamId(team as u8)) {
            let mut mates = step
                .samples
                .iter()
                .enumerate()
                .filter(|(i, _)| scenario.team_of(VehicleId::at(*i)) == team);
            let is_attacked = mates.any(|(_, sample)| attacks(scenario, team, sample));
            for name in strategies_of(scenario, team) {
                let strategy = quality.strategies.entry(name.to_owned()).or_default();
                strategy.time_s += step_s;
                strategy.nobody_attacks_s += if is_attacked { 0.0 } else { step_s };
            }
        }
    }

    /// The quality of the whole game.
    pub fn end(mut self) -> Quality {
        self.encounters.end(&mut self.quality);
        self.quality
    }
}

impl ModeQuality {
    /// Adds one step of a boat.
    fn add(&mut self, scenario: &Scenario, sample: &Sample, step_s: f64) {
        let is_at_edge = scenario.field.inside_by_m(sample.truth.at()) < EDGE_M;
        self.time_s += step_s;
        self.standing_s += if sample.truth.speed_m_s() < STANDING_M_S {
            step_s
        } else {
            0.0
        };
        self.edge_s += if is_at_edge { step_s } else { 0.0 };
    }

    /// Compares a mind's order with the previous one, within a mode, because modes have different
    /// aims.
    fn compare(&mut self, before: Option<&(MindState, Order)>, mind: &MindState, order: Order) {
        let same_mode = before.filter(|(before, _)| before == mind);
        let Some((_, before)) = same_mode else {
            self.begun += 1;
            return;
        };
        if let (
            Order::Steer {
                heading_rad: old_rad,
                ..
            },
            Order::Steer { heading_rad, .. },
        ) = (*before, order)
        {
            self.course_jumps += u64::from(wrap_pi(heading_rad - old_rad).abs() > COURSE_JUMP_RAD);
        }
        let change_m_s = ordered_m_s(order)
            .zip(ordered_m_s(*before))
            .map_or(0.0, |(new, old)| (new - old).abs());
        self.speed_jumps += u64::from(change_m_s > SPEED_JUMP_M_S);
    }

    fn merge(&mut self, other: &ModeQuality) {
        self.time_s += other.time_s;
        self.begun += other.begun;
        self.course_jumps += other.course_jumps;
        self.speed_jumps += other.speed_jumps;
        self.standing_s += other.standing_s;
        self.edge_s += other.edge_s;
    }
}

impl Quality {
    /// Adds the results of other games. Sums of the same games in the same order are bit-for-bit
    /// equal.
    pub fn merge(&mut self, other: &Quality) {
        self.games += other.games;
        self.time_s += other.time_s;
        self.encounters.merge(&other.encounters);
        for (name, other) in &other.strategies {
            self.strategies
                .entry(name.clone())
                .or_default()
                .merge(other);
        }
    }
}

impl StrategyQuality {
    fn merge(&mut self, other: &StrategyQuality) {
        self.teams += other.teams;
        self.time_s += other.time_s;
        self.nobody_attacks_s += other.nobody_attacks_s;
        self.encounters.merge(&other.encounters);
        for (name, other) in &other.roles {
            let role = self.roles.entry(name.clone()).or_default();
            role.orbits += other.orbits;
            role.orbit_s += other.orbit_s;
            for (name, other) in &other.modes {
                role.modes.entry(name.clone()).or_default().merge(other);
            }
        }
    }
}

/// The name of a vehicle's strategy.
fn strategy_name(scenario: &Scenario, vehicle: usize) -> &str {
    &scenario.strategy_of(VehicleId::at(vehicle)).name
}

/// The distinct names of a team's strategies.
fn strategies_of(scenario: &Scenario, team: TeamId) -> Vec<&str> {
    let vehicles =
        (0..scenario.vehicles.len()).filter(|i| scenario.team_of(VehicleId::at(*i)) == team);
    let mut names: Vec<&str> = vehicles.map(|i| strategy_name(scenario, i)).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// Whether a boat attacks: it carries a flag home, or is beyond its own side and free to act.
fn attacks(scenario: &Scenario, team: TeamId, sample: &Sample) -> bool {
    sample.carrying || (sample.is_free && !scenario.field.is_own_side(team, sample.truth.at()))
}

#[cfg(test)]
mod tests;
