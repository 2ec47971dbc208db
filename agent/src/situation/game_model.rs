//! The game as seen by one boat: everything that is constant during a game.

use primitives::{FlagId, Ned, SimTime, TeamId, VehicleId};
use rules::{Field, Rules};
use scenario::Scenario;
use scenario::strategy::Program;
use std::sync::Arc;

/// The score at which Pyquaticus ends a game by default.
const PYQUATICUS_SCORE_MAX: f64 = 20.0;
const HAS_ALL: &str = "a checked field has flags and corners for every team";

/// Knowledge that all boats of a team share before the game begins.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TeamModel {
    pub(crate) team: TeamId,
    pub(crate) field: Field,
    pub(crate) rules: Rules,
    /// The top speed of every boat of the game, m/s, by vehicle index.
    pub(crate) boat_speeds_m_s: Vec<f64>,
}

/// A helm's knowledge before the game begins.
#[derive(Clone, Debug)]
pub(crate) struct GameModel {
    pub(crate) me: VehicleId,
    pub(super) of_team: Arc<TeamModel>,
    /// The game's seed.
    pub(crate) seed: u64,
    /// The physics' time step, s.
    pub(crate) tick_s: f64,
    /// The boat's index in its team.
    pub(crate) rank: usize,
    /// The enemies, in the scenario's order.
    pub(crate) enemies: Vec<VehicleId>,
    /// The other boats of the team, in the scenario's order.
    pub(crate) mates: Vec<VehicleId>,
    /// The flags to attack.
    pub(crate) targets: Vec<FlagId>,
    /// The flags to defend.
    pub(crate) own_flags: Vec<FlagId>,
    /// The score that ends the game, or Pyquaticus's default.
    pub(crate) score_max: f64,
    /// The maximum speed of the helm's decisions, m/s.
    pub(crate) speed_max_m_s: f64,
    /// The team's named points, sorted by name.
    points: Vec<(String, Ned)>,
}

/// The score that ends a game, or Pyquaticus's default.
pub(crate) fn score_max(scenario: &Scenario) -> f64 {
    scenario
        .rules
        .win_score
        .map_or(PYQUATICUS_SCORE_MAX, f64::from)
}

impl GameModel {
    pub(crate) fn new(scenario: &Scenario, me: VehicleId, program: &Program) -> GameModel {
        let team = scenario.vehicles[me.index()].team;
        let field = &scenario.field;
        let of = |wanted: bool| {
            let vehicles = (0..scenario.vehicles.len()).map(VehicleId::at);
            vehicles.filter(move |vehicle| (scenario.team_of(*vehicle) == team) == wanted)
        };
        let flags = |wanted: bool| {
            let flags = field
                .flags
                .iter()
                .enumerate()
                .filter(move |(_, flag)| (flag.team == team) == wanted);
            flags.map(|(i, _)| FlagId(i as u8)).collect::<Vec<_>>()
        };
        let mut points: Vec<(String, Ned)> = Field::point_names()
            .into_iter()
            .filter_map(|name| field.point(team, &name).map(|at| (name, at)))
            .collect();
        // Sorted once for binary search: expressions look up points by name at every decision.
        points.sort_by(|a, b| a.0.cmp(&b.0));
        let speed_m_s = |i: usize| scenario.boat_of(VehicleId::at(i)).speed_max_m_s();
        let boat_speeds_m_s: Vec<f64> = (0..scenario.vehicles.len()).map(speed_m_s).collect();
        let own_m_s = boat_speeds_m_s[me.index()];
        GameModel {
            me,
            seed: scenario.seed,
            tick_s: scenario.tick.as_s(),
            rank: of(true).position(|vehicle| vehicle == me).unwrap_or(0),
            enemies: of(false).collect(),
            mates: of(true).filter(|vehicle| *vehicle != me).collect(),
            targets: flags(false),
            own_flags: flags(true),
            score_max: score_max(scenario),
            speed_max_m_s: program
                .helm
                .speed_max_m_s
                .map_or(own_m_s, |most_m_s| most_m_s.min(own_m_s)),
            points,
            of_team: Arc::new(TeamModel {
                team,
                field: field.clone(),
                rules: scenario.rules.clone(),
                boat_speeds_m_s,
            }),
        }
    }

    /// A named point of the team.
    pub(crate) fn point(&self, name: &str) -> Option<Ned> {
        let found = self
            .points
            .binary_search_by(|(known, _)| known.as_str().cmp(name));
        found.ok().map(|i| self.points[i].1)
    }

    /// The place to which a flag must be brought from `at`.
    pub(crate) fn capture_place(&self, at: Ned, now: SimTime) -> Ned {
        self.rules
            .capture_place(&self.field, self.team, at, now)
            .expect(HAS_ALL)
    }

    /// The place to which a tagged boat must be steered from `at`.
    pub(crate) fn untag_place(&self, at: Ned, now: SimTime) -> Ned {
        self.rules
            .untag_place(&self.field, self.team, at, now)
            .expect(HAS_ALL)
    }

    /// The untagging circle for a boat at `at`: centre and radius in m.
    pub(crate) fn untag_circle(&self, at: Ned, now: SimTime) -> (Ned, f64) {
        self.rules
            .untag_circle(&self.field, self.team, at, now)
            .expect(HAS_ALL)
    }
}

impl TeamModel {
    /// The home of the team's flag nearest to a place.
    pub(crate) fn own_flag_near(&self, at: Ned, now: SimTime) -> Ned {
        let flag = self.field.nearest_own_flag(self.team, at, now);
        flag.expect(HAS_ALL).1
    }

    /// Whether `at` is on the team's own side.
    pub(crate) fn is_own_side(&self, at: Ned) -> bool {
        self.field.is_own_side(self.team, at)
    }
}

impl std::ops::Deref for GameModel {
    type Target = TeamModel;

    fn deref(&self) -> &TeamModel {
        &self.of_team
    }
}
