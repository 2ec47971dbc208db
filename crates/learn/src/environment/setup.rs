//! What is played in an environment: the game, who learns, what a policy sees and may do, and against whom.

use super::truth;
use crate::rewards::Rewards;
use crate::training::CriticInput;
use agent::{ActionSpace, Spaces};
use primitives::{TeamId, VehicleId};
use scenario::policy::PolicyModel;
use scenario::strategy::{Program, Strategy, Task};
use scenario::{Problems, Scenario};
use std::collections::BTreeMap;
use thiserror::Error;

/// How actions reach a boat.
#[derive(Clone, Debug)]
pub enum Control {
    /// As orders.
    Direct,
    /// As proposals to the helms of this strategy, every role of which has a behaviour of the kind `policy`.
    Helm(Box<Strategy>),
}

/// A strategy that plays instead of the policy, which learns to do as it does.
#[derive(Clone, Debug)]
pub struct Teacher {
    /// The strategy.
    pub strategy: Box<Strategy>,
    /// With [`ActionSpace::Options`]: which option a mode is, by the mode's path. What is in none of these modes is not taught.
    pub options: BTreeMap<String, usize>,
}

/// Who plays a team in a game.
#[derive(Clone, Debug)]
pub enum Player {
    /// Whoever gives the actions: the policy that learns, or one that it once was.
    Policy,
    /// The helms of a strategy.
    Strategy(Box<Strategy>),
    /// A policy as it was, through the same control as the one that learns.
    Model(PolicyModel),
}

/// What is played.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The game; seeds choose what is random in it.
    pub scenario: Scenario,
    /// What policies see and do.
    pub spaces: Spaces,
    /// How it reaches the boats.
    pub control: Control,
    /// Who plays the policy's boats instead of it; none: it plays itself.
    pub teacher: Option<Teacher>,
    /// What a critic is given.
    pub critic: CriticInput,
    /// Decisions of the game to one of the policy.
    pub decisions_per_step: u32,
    /// An episode ends after so many steps at the latest, though the game would go on; none plays whole games.
    pub steps_max: Option<u32>,
    /// There are so many different starts, which come round again: what takes longest of a new game, its sea and its boats, is made once
    /// for each. None: every game has a start of its own.
    pub starts: Option<u32>,
    /// The team that learns; none: the one and the other by turns, seed by seed.
    pub learner: Option<TeamId>,
    /// Policies sail one boat of their team, each by turns, and this strategy the others; none: policies sail all.
    pub mates: Option<Box<Strategy>>,
    /// The enemies, each with how often it is drawn.
    pub opponents: Vec<(f64, Player)>,
    /// What is worth how much.
    pub rewards: Rewards,
    /// What a reward a step later is worth, for potentials.
    pub discount: f64,
}

/// Why nothing can be played.
#[derive(Debug, Error)]
pub enum SetupError {
    /// Games are between two teams.
    #[error("the game has {0} teams; an environment is a game between two")]
    Teams(usize),
    /// A policy with numbers for equal teams.
    #[error("the teams have {0} and {1} boats; policies play either side, so they must have as many")]
    Uneven(usize, usize),
    /// Nobody to play against.
    #[error("no opponent is given, or none with a weight above 0")]
    NoOpponent,
    /// A strategy that asks no policy for what it is to choose.
    #[error("the role {role:?} has no behaviour of the kind \"policy\" {expected}: nothing would come of actions")]
    NoPolicy {
        /// The role.
        role: String,
        /// What the behaviour would need.
        expected: &'static str,
    },
    /// Steps without a decision.
    #[error("a policy decides every 0 decisions of the game; expected 1 or more")]
    NoDecisions,
    /// Nothing to begin with.
    #[error("there are 0 starts; expected 1 or more, or none for a new one every time")]
    NoStarts,
    /// A seed that is not among the starts that come round.
    #[error("seed is {seed}, expected {first} to {last}: only so many starts come round (`starts`)")]
    SeedOfStarts {
        /// What was asked for.
        seed: u64,
        /// The first of them.
        first: u64,
        /// The last one.
        last: u64,
    },
    /// Something that a person gave is not what it may be.
    #[error("{field} is {found}, expected {allowed}")]
    Field {
        /// What it is called.
        field: &'static str,
        /// What it is.
        found: String,
        /// What it may be.
        allowed: String,
    },
    /// A file that cannot be used.
    #[error(transparent)]
    Files(#[from] Problems),
    /// A policy whose weights are no numbers any more.
    #[error("the policy has diverged: {0}")]
    Diverged(String),
    /// The game cannot begin.
    #[error(transparent)]
    NoStart(#[from] sim::NoStart),
}

impl Setup {
    /// What makes it impossible to play, if anything does.
    ///
    /// # Errors
    /// [`SetupError`], the first that was found.
    pub fn check(&self) -> Result<(), SetupError> {
        if self.scenario.teams.len() != 2 {
            return Err(SetupError::Teams(self.scenario.teams.len()));
        }
        let [one, other] = [0, 1].map(|team| self.boats_of(TeamId(team)).count());
        if one != other {
            return Err(SetupError::Uneven(one, other));
        }
        if let Some(team) = self.learner.filter(|team| team.index() > 1) {
            let (found, allowed) = (team.index().to_string(), "0 or 1".to_owned());
            return Err(SetupError::Field { field: "learner", found, allowed });
        }
        if self.decisions_per_step == 0 {
            return Err(SetupError::NoDecisions);
        }
        if self.starts == Some(0) {
            return Err(SetupError::NoStarts);
        }
        if !self.opponents.iter().any(|(weight, _)| *weight > 0.0) {
            return Err(SetupError::NoOpponent);
        }
        if let Control::Helm(strategy) = &self.control {
            self.check_helm(strategy)?;
        } else if self.spaces.action == ActionSpace::Options {
            let allowed = "another action, or a helm whose strategy has the options".to_owned();
            return Err(SetupError::Field { field: "action", found: "options".to_owned(), allowed });
        }
        Ok(())
    }

    /// Whether the programs of a strategy do what policies choose.
    fn check_helm(&self, strategy: &Strategy) -> Result<(), SetupError> {
        let has_options = self.spaces.action == ActionSpace::Options;
        let asks = |task: &Task| matches!(task, Task::Policy(policy) if policy.model.is_none() && policy.sets.is_some() == has_options);
        let deaf = strategy.roles.iter().find(|role| !role.behaviours.iter().any(|behaviour| asks(&behaviour.task)));
        if let Some(role) = deaf {
            let expected = if has_options { "with `sets`" } else { "for course and speed" };
            return Err(SetupError::NoPolicy { role: role.name.clone(), expected });
        }
        let texts = |role: &Program| role.options().map(|variable| role.texts(variable).to_vec());
        if let Some(other) = strategy.roles.iter().find(|role| has_options && texts(role) != texts(&strategy.roles[0]))
        {
            let found = texts(other).unwrap_or_default().join(", ");
            let allowed = format!("the options of the first: {}", self.options().unwrap_or_default().join(", "));
            return Err(SetupError::Field { field: "sets of the second role", found, allowed });
        }
        Ok(())
    }

    /// The options that a policy chooses among; none if it chooses something else.
    #[must_use]
    pub fn options(&self) -> Option<&[String]> {
        match &self.control {
            Control::Helm(strategy) if self.spaces.action == ActionSpace::Options => {
                let role = strategy.roles.first()?;
                Some(role.texts(role.options()?))
            }
            _ => None,
        }
    }

    /// How many discrete actions there are; none if they are continuous.
    #[must_use]
    pub fn actions(&self) -> Option<usize> {
        self.options().map(<[String]>::len).or(self.spaces.action.count())
    }

    /// Whether any opponent is a policy.
    #[must_use]
    pub fn is_self_play(&self) -> bool {
        self.opponents.iter().any(|(_, player)| matches!(player, Player::Policy))
    }

    /// How many rows there are to a game: one for each boat that may be given actions.
    #[must_use]
    pub fn rows_per_game(&self) -> usize {
        let of_team = if self.mates.is_some() { 1 } else { self.team_size() };
        of_team * if self.is_self_play() { 2 } else { 1 }
    }

    /// The boats of a team that a policy sails in the game of a seed.
    pub fn pilots_of(&self, team: TeamId, seed: u64) -> impl Iterator<Item = VehicleId> {
        // Sides alternate with the seed, and boats with every second one.
        let one = self.mates.is_some().then(|| (seed / 2) as usize % self.team_size().max(1));
        self.boats_of(team)
            .enumerate()
            .filter(move |(i, _)| one.is_none_or(|one| one == *i))
            .map(|(_, vehicle)| vehicle)
    }

    /// The boats of a team, in the scenario's order.
    pub fn boats_of(&self, team: TeamId) -> impl Iterator<Item = VehicleId> {
        let boats = (0..self.scenario.vehicles.len()).map(VehicleId::at);
        boats.filter(move |vehicle| self.scenario.team_of(*vehicle) == team)
    }

    /// How many boats a team has.
    #[must_use]
    pub fn team_size(&self) -> usize {
        self.boats_of(TeamId(0)).count()
    }

    /// What the numbers of an observation are called.
    #[must_use]
    pub fn observation_names(&self) -> Vec<String> {
        let boats = self.team_size();
        self.spaces.observation.names(boats.saturating_sub(1), boats)
    }

    /// How many numbers a critic is given.
    #[must_use]
    pub fn state_size(&self) -> usize {
        self.observation_size() + self.truth_size()
    }

    /// What those of them are called that no policy is given.
    #[must_use]
    pub fn truth_names(&self) -> Vec<String> {
        let boats = self.team_size();
        match self.critic {
            CriticInput::Observation => vec![],
            CriticInput::Truth => truth::names(boats.saturating_sub(1), boats),
        }
    }

    /// How many of them no policy is given.
    #[must_use]
    pub fn truth_size(&self) -> usize {
        match self.critic {
            CriticInput::Observation => 0,
            CriticInput::Truth => truth::size(self.scenario.vehicles.len()),
        }
    }

    /// How many numbers an observation has.
    #[must_use]
    pub fn observation_size(&self) -> usize {
        let boats = self.team_size();
        self.spaces.observation.size(boats.saturating_sub(1), boats)
    }
}
