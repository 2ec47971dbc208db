//! A setup as users write it: file paths, seconds and names.

use super::setup::{Control, Player, Setup, SetupError, wrong};
use crate::rewards::Rewards;
use crate::training::CriticInput;
use agent::{ActionSpace, ObservationSpace, Spaces};
use primitives::TeamId;
use scenario::strategy::Strategy;
use scenario::{Overrides, Scenario};
use std::path::{Path, PathBuf};

/// The observation space before the team sizes are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RawObservation {
    /// An observation space that does not depend on the team sizes.
    Space(ObservationSpace),
    /// [`ObservationSpace::Squall`] with one slot for each boat of the game.
    Squall {
        /// Number of consecutive decisions in one observation.
        frames: u8,
    },
}

/// A setup as users write it.
#[derive(Clone, Debug)]
pub struct RawSetup {
    /// The game file.
    pub game: PathBuf,
    /// The sea file. `None` means the game's.
    pub sea: Option<PathBuf>,
    /// The numbers of boats of the teams; see [`Setup::team_sizes`].
    pub team_sizes: Option<[[u32; 2]; 2]>,
    /// The policies' observations.
    pub observation: RawObservation,
    /// The policies' actions.
    pub action: ActionSpace,
    /// The strategy file whose helms apply the actions. `None`: actions are orders.
    pub helm: Option<PathBuf>,
    /// How long an action holds, s; a multiple of the game's `decision_s`. `None` means the
    /// smallest multiple not below `decision_min_s`.
    pub decision_s: Option<f64>,
    /// Minimum time for which an action holds if `decision_s` is `None`, s.
    pub decision_min_s: f64,
    /// The maximum length of an episode, s.
    pub episode_max_s: Option<f64>,
    /// The number of repeating starts; see [`Setup::starts`].
    pub starts: Option<u32>,
    /// The learning team's name. `None`: teams alternate.
    pub team: Option<String>,
    /// The strategy file for all but one boat of a policy's team. `None`: policies control all
    /// boats.
    pub mates: Option<PathBuf>,
    /// The opponents' weights and strategy files. Without a file, the policy plays against itself.
    pub opponents: Vec<(f64, Option<PathBuf>)>,
    /// The rewards file. `None`: all rewards are 0.
    pub rewards: Option<PathBuf>,
    /// Discount factor per step, 0 to 1.
    pub discount: f64,
    /// A critic's input.
    pub critic: CriticInput,
}

impl RawSetup {
    /// Reads the files and checks the values.
    ///
    /// # Errors
    /// [`SetupError`]: the first invalid field, or all faults in a file.
    pub fn check(&self) -> Result<Setup, SetupError> {
        let overrides = Overrides {
            sea: self.sea.clone(),
            ..Overrides::default()
        };
        let scenario = scenario::load_with(&self.game, &overrides)?;
        let helm = self.helm.as_deref().map(strategy).transpose()?;
        let opponent = |(weight, file): &(f64, Option<PathBuf>)| {
            if !(weight.is_finite() && *weight >= 0.0) {
                return Err(wrong("an opponent's weight", weight, "0 or more"));
            }
            Ok((
                *weight,
                file.as_deref()
                    .map(strategy)
                    .transpose()?
                    .map_or(Player::Policy, Player::Strategy),
            ))
        };
        if !(0.0..=1.0).contains(&self.discount) {
            return Err(wrong("discount", self.discount, "0 to 1"));
        }
        if self.starts == Some(0) {
            return Err(wrong("starts", 0, "1 or more"));
        }
        let least = (self.decision_min_s / scenario.decision().as_s() - 1e-6).ceil();
        let decisions_per_step = self
            .decision_s
            .map_or(Ok((least as u32).max(1)), |decision_s| {
                decisions_per_step(decision_s, &scenario)
            })?;
        let setup = Setup {
            team_sizes: self.team_sizes,
            spaces: Spaces {
                observation: self.observation.check(&scenario)?,
                action: self.action,
            },
            control: helm.map_or(Control::Direct, Control::Helm),
            teacher: None,
            critic: self.critic,
            decisions_per_step,
            steps_max: self
                .episode_max_s
                .map(|s| steps_max(s, &scenario, decisions_per_step))
                .transpose()?,
            starts: self.starts,
            learner: self
                .team
                .as_deref()
                .map(|name| team(&scenario, name))
                .transpose()?,
            mates: self.mates.as_deref().map(strategy).transpose()?,
            opponents: self
                .opponents
                .iter()
                .map(opponent)
                .collect::<Result<_, SetupError>>()?,
            rewards: match &self.rewards {
                Some(file) => scenario::load_file::<crate::rewards::Rewards>(file)?,
                None => Rewards::default(),
            },
            discount: self.discount,
            scenario,
        };
        setup.check()?;
        Ok(setup)
    }
}

impl RawObservation {
    fn check(self, scenario: &Scenario) -> Result<ObservationSpace, SetupError> {
        let frames = match self {
            RawObservation::Space(space) => return Ok(space),
            RawObservation::Squall { frames } => frames,
        };
        if frames == 0 {
            return Err(wrong("frames", 0, "1 to 255"));
        }
        let boats = |team: usize| {
            scenario
                .vehicles
                .iter()
                .filter(|vehicle| vehicle.team.index() == team)
                .count()
        };
        let room = |boats: usize| u8::try_from(boats).unwrap_or(u8::MAX);
        Ok(ObservationSpace::Squall {
            mates: room(boats(0).saturating_sub(1)),
            enemies: room(boats(1)),
            frames,
        })
    }
}

fn strategy(file: &Path) -> Result<Box<Strategy>, SetupError> {
    Ok(Box::new(
        scenario::load_file::<scenario::strategy::Strategy>(file)?,
    ))
}

fn team(scenario: &Scenario, name: &str) -> Result<TeamId, SetupError> {
    let found = scenario.teams.iter().position(|team| team.name == name);
    let names = || {
        scenario
            .teams
            .iter()
            .map(|team| format!("{:?}", team.name))
            .collect::<Vec<_>>()
            .join(" or ")
    };
    found
        .map(|team| TeamId(team as u8))
        .ok_or_else(|| wrong("team", format!("{name:?}"), &names()))
}

/// The number of game decisions per policy decision.
fn decisions_per_step(decision_s: f64, scenario: &Scenario) -> Result<u32, SetupError> {
    let least_s = scenario.decision().as_s();
    let times = (decision_s / least_s).round();
    if (1.0..=1e6).contains(&times) && (times * least_s - decision_s).abs() < 1e-6 {
        return Ok(times as u32);
    }
    let allowed =
        format!("a multiple of the game's decision_s ({least_s} s), at most 1,000,000 times that");
    Err(wrong("decision_s", decision_s, &allowed))
}

fn steps_max(
    episode_max_s: f64,
    scenario: &Scenario,
    decisions_per_step: u32,
) -> Result<u32, SetupError> {
    let step_s = scenario.decision().as_s() * f64::from(decisions_per_step);
    let steps = (episode_max_s / step_s - 1e-6).ceil();
    if (1.0..=1e9).contains(&steps) {
        return Ok(steps as u32);
    }
    Err(wrong(
        "episode_max_s",
        episode_max_s,
        "more than 0, up to 1,000,000,000 steps",
    ))
}
