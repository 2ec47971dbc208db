//! The setup of an environment: the game, the learner, its spaces and its opponents.

use super::truth;
use crate::rewards::Rewards;
use crate::training::CriticInput;
use agent::{ActionSpace, Spaces};
use primitives::stream::Stream;
use primitives::{TeamId, VehicleId};
use scenario::policy::PolicyModel;
use scenario::strategy::{Program, Strategy, Task};
use scenario::{Problems, Scenario};
use std::borrow::Cow;
use std::collections::BTreeMap;
use thiserror::Error;

/// How actions reach a boat.
#[derive(Clone, Debug)]
pub enum Control {
    /// As orders.
    Direct,
    /// As proposals to the helms of this strategy. Each of its roles needs a behaviour of kind
    /// `policy`.
    Helm(Box<Strategy>),
}

/// A strategy for the policy to imitate.
#[derive(Clone, Debug)]
pub struct Teacher {
    /// The strategy.
    pub strategy: Box<Strategy>,
    /// Whether the strategy plays in place of the policy. Otherwise, the policy plays, and the
    /// strategy says what it would do in the same situations.
    pub drives: bool,
    /// With [`ActionSpace::Options`]: the option for each mode, by the mode's path. Nothing is
    /// learned from other modes.
    pub options: BTreeMap<String, usize>,
}

/// The player of a team.
#[derive(Clone, Debug)]
pub enum Player {
    /// External actions, from the learning policy or an earlier version of it.
    Policy,
    /// The helms of a strategy.
    Strategy(Box<Strategy>),
    /// A fixed policy with the same control as the learning policy.
    Model(Box<PolicyModel>),
}

/// The setup of an environment.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The game; the seed chooses its random values.
    pub scenario: Scenario,
    /// By team, the minimum and maximum number of boats. A number is drawn for each team and game;
    /// surplus boats, the team's last, are left out. `None`: all boats play.
    pub team_sizes: Option<[[u32; 2]; 2]>,
    /// The policies' observation and action spaces.
    pub spaces: Spaces,
    /// How actions reach the boats.
    pub control: Control,
    /// Demonstrates actions to imitate. `None`: the policy learns from rewards.
    pub teacher: Option<Teacher>,
    /// A critic's input.
    pub critic: CriticInput,
    /// Game decisions per policy step, at least one.
    pub decisions_per_step: u32,
    /// Maximum number of steps of an episode. `None`: until the game is over.
    pub steps_max: Option<u32>,
    /// The number of different starts, used in rotation. The slowest part of a new game, creating
    /// sea and boats, is done once per start. `None`: every game has a new start.
    pub starts: Option<u32>,
    /// The learning team. `None`: alternates with the seed.
    pub learner: Option<TeamId>,
    /// The strategy of all but one boat of a policy's team; that boat alternates. `None`: policies
    /// control all boats.
    pub mates: Option<Box<Strategy>>,
    /// The enemies and their draw weights.
    pub opponents: Vec<(f64, Player)>,
    /// The reward definition.
    pub rewards: Rewards,
    /// Discount factor of potentials per step.
    pub discount: f64,
}

/// A reason why a setup cannot be played.
#[derive(Debug, Error)]
pub enum SetupError {
    /// The game does not have two teams.
    #[error("the game has {0} teams, expected 2")]
    Teams(usize),
    /// Teams of different sizes.
    #[error(
        "the teams have {0} and {1} boats, expected teams of equal size, because policies play both sides"
    )]
    Uneven(usize, usize),
    /// No opponent has a positive weight.
    #[error("no opponent can be drawn, expected at least one with a weight above 0")]
    NoOpponent,
    /// A role without a suitable policy behaviour.
    #[error(
        "the role {role:?} has no behaviour of kind \"policy\" {expected}: actions would have no effect"
    )]
    NoPolicy {
        /// The role.
        role: String,
        /// The required kind of policy behaviour.
        expected: &'static str,
    },
    /// A seed outside the repeating starts.
    #[error("seed is {seed}, expected {first} to {last}: `starts` limits the seeds")]
    SeedOfStarts {
        /// The seed found.
        seed: u64,
        /// The smallest valid seed.
        first: u64,
        /// The largest valid seed.
        last: u64,
    },
    /// An invalid value from the user.
    #[error("{field} is {found}, expected {allowed}")]
    Field {
        /// The field's name.
        field: &'static str,
        /// The value found.
        found: String,
        /// The allowed values.
        allowed: String,
    },
    /// An invalid file.
    #[error(transparent)]
    Files(#[from] Problems),
    /// A policy with non-finite weights.
    #[error("the policy has diverged: {0}")]
    Diverged(String),
    /// The game cannot begin.
    #[error(transparent)]
    NoStart(#[from] sim::NoStart),
}

/// The error for a field with an invalid value.
pub(crate) fn wrong(field: &'static str, found: impl ToString, allowed: &str) -> SetupError {
    SetupError::Field {
        field,
        found: found.to_string(),
        allowed: allowed.to_owned(),
    }
}

impl Setup {
    /// Checks that this setup can be played.
    ///
    /// # Errors
    /// [`SetupError`]: the first problem found.
    pub fn check(&self) -> Result<(), SetupError> {
        if self.scenario.teams.len() != 2 {
            return Err(SetupError::Teams(self.scenario.teams.len()));
        }
        if self.scenario.draws_fleets() {
            let allowed = "a number: `team_sizes` draws team sizes for learning";
            return Err(wrong("count of a [[fleet]]", "a distribution", allowed));
        }
        let [one, other] = [0, 1].map(|team| boats_of(&self.scenario, TeamId(team)).count());
        if one != other {
            return Err(SetupError::Uneven(one, other));
        }
        self.check_team_sizes(one)?;
        if !self.opponents.iter().any(|(weight, _)| *weight > 0.0) {
            return Err(SetupError::NoOpponent);
        }
        if let Control::Helm(strategy) = &self.control {
            self.check_helm(strategy)?;
        } else if self.spaces.action == ActionSpace::Options {
            let allowed = "a different action space, or a helm whose strategy declares options";
            return Err(wrong("action", "options", allowed));
        }
        Ok(())
    }

    fn check_team_sizes(&self, boats: usize) -> Result<(), SetupError> {
        for [least, most] in self.team_sizes.into_iter().flatten() {
            let found = format!("[{least}, {most}]");
            if !(1 <= least && least <= most && most as usize <= boats) {
                let allowed =
                    format!("two ascending numbers from 1 to {boats}, the game's team size");
                return Err(wrong("team_sizes", found, &allowed));
            }
            if self.spaces.observation.edition().is_some() {
                let allowed = "observation \"squall\", which fits teams of any size";
                return Err(wrong("team_sizes", found, allowed));
            }
        }
        Ok(())
    }

    /// The game with this seed, with the teams' sizes drawn.
    ///
    /// # Errors
    /// [`SetupError`] if the seed's random values are inconsistent.
    pub fn scenario_of(&self, seed: u64) -> Result<Cow<'_, Scenario>, SetupError> {
        let Some(ranges) = self.team_sizes else {
            return Ok(Cow::Borrowed(&self.scenario));
        };
        let mut scenario = self.scenario.of_seed(seed)?;
        // Nothing is left to draw, and drawing again would bring the other boats back.
        scenario.recipe = None;
        let mut stream = Stream::new(seed, "team_sizes");
        let kept = [0, 1].map(|team| {
            let [least, most] = ranges[usize::from(team)];
            let size = u64::from(least) + stream.below(u64::from(most - least) + 1);
            boats_of(&scenario, TeamId(team))
                .take(size as usize)
                .collect::<Vec<_>>()
        });
        let mut kept = kept.concat();
        kept.sort_unstable();
        let vehicles = kept
            .iter()
            .map(|vehicle| scenario.vehicles[vehicle.index()].clone());
        scenario.vehicles = vehicles.collect();
        for fault in &mut scenario.faults {
            let left = fault
                .vehicles
                .iter()
                .filter_map(|boat| kept.binary_search(boat).ok());
            fault.vehicles = left.map(VehicleId::at).collect();
        }
        Ok(Cow::Owned(scenario))
    }

    /// The boat of the whole game that corresponds to one of a game with this setup, from which
    /// some may have been left out.
    pub fn whole_game_boat(&self, played: &Scenario, boat: VehicleId) -> VehicleId {
        let named = |name: &str| self.scenario.vehicle_by_name(name);
        let whole = self
            .team_sizes
            .and_then(|_| named(&played.vehicles[boat.index()].name));
        whole.unwrap_or(boat)
    }

    /// Checks that every role of the strategy applies the policy's choices.
    fn check_helm(&self, strategy: &Strategy) -> Result<(), SetupError> {
        let has_options = self.spaces.action == ActionSpace::Options;
        let asks = |task: &Task| matches!(task, Task::Policy(policy) if policy.model.is_none() && policy.host.is_none() && policy.sets.is_some() == has_options);
        let deaf = strategy.roles.iter().find(|role| {
            !role
                .behaviours
                .iter()
                .any(|behaviour| asks(&behaviour.task))
        });
        if let Some(role) = deaf {
            let expected = if has_options {
                "with `sets`"
            } else {
                "for course and speed"
            };
            return Err(SetupError::NoPolicy {
                role: role.name.clone(),
                expected,
            });
        }
        let texts = |role: &Program| role.options().map(|variable| role.texts(variable).to_vec());
        if let Some(other) = strategy
            .roles
            .iter()
            .find(|role| has_options && texts(role) != texts(&strategy.roles[0]))
        {
            let found = texts(other).unwrap_or_default().join(", ");
            let allowed = format!(
                "those of the first role: {}",
                self.options().unwrap_or_default().join(", ")
            );
            return Err(wrong("the options of a role", found, &allowed));
        }
        Ok(())
    }

    /// The options from which a policy chooses. `None` in other action spaces.
    pub fn options(&self) -> Option<&[String]> {
        match &self.control {
            Control::Helm(strategy) if self.spaces.action == ActionSpace::Options => {
                let role = strategy.roles.first()?;
                Some(role.texts(role.options()?))
            }
            _ => None,
        }
    }

    /// The number of discrete actions. `None` if actions are continuous.
    pub fn actions(&self) -> Option<usize> {
        self.options()
            .map(<[String]>::len)
            .or(self.spaces.action.count())
    }

    /// Whether a teacher plays in place of the policy, so that actions have no effect.
    pub fn is_driven(&self) -> bool {
        self.teacher.as_ref().is_some_and(|teacher| teacher.drives)
    }

    /// The number of rows per game: for each policy's team, those of the largest team.
    pub fn rows_per_game(&self) -> usize {
        let is_self_play = self
            .opponents
            .iter()
            .any(|(_, player)| matches!(player, Player::Policy));
        self.rows_per_team() * if is_self_play { 2 } else { 1 }
    }

    /// The number of rows of a policy's team.
    pub fn rows_per_team(&self) -> usize {
        let largest = |ranges: [[u32; 2]; 2]| ranges.map(|[_, most]| most).into_iter().max();
        match self.team_sizes.and_then(largest) {
            _ if self.mates.is_some() => 1,
            Some(most) => most as usize,
            None => self.team_size(),
        }
    }

    /// The boats of a team that a policy controls in the game with this seed.
    pub fn pilots_of(
        &self,
        scenario: &Scenario,
        team: TeamId,
        seed: u64,
    ) -> impl Iterator<Item = VehicleId> {
        // Sides alternate with every seed, boats with every second seed.
        let size = boats_of(scenario, team).count().max(1);
        let one = self.mates.is_some().then(|| (seed / 2) as usize % size);
        boats_of(scenario, team)
            .enumerate()
            .filter(move |(i, _)| one.is_none_or(|one| one == *i))
            .map(|(_, vehicle)| vehicle)
    }

    /// The number of boats in a team of the game file.
    pub fn team_size(&self) -> usize {
        boats_of(&self.scenario, TeamId(0)).count()
    }

    /// The names of the values of an observation.
    pub fn observation_names(&self) -> Vec<String> {
        let boats = self.team_size();
        self.spaces
            .observation
            .names(boats.saturating_sub(1), boats)
    }

    /// The size of a critic's input.
    pub fn state_size(&self) -> usize {
        self.observation_size() + self.truth_size()
    }

    /// The names of the values that only the critic receives.
    pub fn truth_names(&self) -> Vec<String> {
        let boats = self.team_size();
        match self.critic {
            CriticInput::Observation => vec![],
            CriticInput::Truth => truth::names(boats.saturating_sub(1), boats),
        }
    }

    /// The number of values that only the critic receives.
    pub fn truth_size(&self) -> usize {
        match self.critic {
            CriticInput::Observation => 0,
            CriticInput::Truth => truth::size(2 * self.team_size()),
        }
    }

    /// The size of an observation.
    pub fn observation_size(&self) -> usize {
        let boats = self.team_size();
        self.spaces.observation.size(boats.saturating_sub(1), boats)
    }
}

/// The boats of a team, in the scenario's order.
fn boats_of(scenario: &Scenario, team: TeamId) -> impl Iterator<Item = VehicleId> {
    let boats = (0..scenario.vehicles.len()).map(VehicleId::at);
    boats.filter(move |vehicle| scenario.team_of(*vehicle) == team)
}
