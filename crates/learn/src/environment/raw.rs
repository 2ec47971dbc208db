//! A setup as a person gives it: paths of files, seconds and names.

use super::setup::{Control, Player, Setup, SetupError};
use crate::rewards::Rewards;
use crate::training::CriticInput;
use agent::{ActionSpace, ObservationSpace, Spaces};
use primitives::TeamId;
use scenario::Scenario;
use scenario::strategy::Strategy;
use std::path::{Path, PathBuf};

/// What policies see, before it is known how large the teams are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RawObservation {
    /// [`ObservationSpace::Pyquaticus`].
    Pyquaticus,
    /// [`ObservationSpace::Squall`], with room for the boats of the game where nothing else is said.
    Squall {
        /// How many mates there is room for.
        mates: Option<u8>,
        /// How many enemies.
        enemies: Option<u8>,
        /// How many decisions of the policy are given together.
        frames: u8,
    },
}

/// A setup as it is given.
#[derive(Clone, Debug)]
pub struct RawSetup {
    /// The game file.
    pub game: PathBuf,
    /// What policies see.
    pub observation: RawObservation,
    /// What they choose from.
    pub action: ActionSpace,
    /// The strategy file through whose helms actions reach the boats; none: as orders.
    pub helm: Option<PathBuf>,
    /// How long an action holds, s: a multiple of the game's `decision_s`, which it is by default.
    pub decision_s: Option<f64>,
    /// An episode is cut off after this time at the latest, s.
    pub episode_max_s: Option<f64>,
    /// How many starts come round: see [`Setup::starts`].
    pub starts: Option<u32>,
    /// The name of the team that learns; none: by turns.
    pub team: Option<String>,
    /// The strategy file that sails all but one boat of a policy's team; none: policies sail all.
    pub mates: Option<PathBuf>,
    /// The opponents' strategy files, each with its weight; none of a file: the policy itself.
    pub opponents: Vec<(f64, Option<PathBuf>)>,
    /// The rewards file; none: all are 0.
    pub rewards: Option<PathBuf>,
    /// What a reward a step later is worth, 0 to 1.
    pub discount: f64,
    /// What a critic is given.
    pub critic: CriticInput,
}

impl RawSetup {
    /// Reads the files and checks the rest.
    ///
    /// # Errors
    /// [`SetupError`]: the first field that is wrong, or everything that is wrong with a file.
    pub fn check(&self) -> Result<Setup, SetupError> {
        let scenario = scenario::load(&self.game)?;
        let helm = self.helm.as_deref().map(strategy).transpose()?;
        let opponent = |(weight, file): &(f64, Option<PathBuf>)| {
            if !(weight.is_finite() && *weight >= 0.0) {
                return Err(wrong("an opponent's weight", weight, "0 or more"));
            }
            Ok((*weight, file.as_deref().map(strategy).transpose()?.map_or(Player::Policy, Player::Strategy)))
        };
        if !(0.0..=1.0).contains(&self.discount) {
            return Err(wrong("discount", self.discount, "0 to 1"));
        }
        if self.starts == Some(0) {
            return Err(wrong("starts", 0, "1 or more"));
        }
        let decisions_per_step =
            self.decision_s.map_or(Ok(1), |decision_s| decisions_per_step(decision_s, &scenario))?;
        let setup = Setup {
            spaces: Spaces { observation: self.observation.check(&scenario)?, action: self.action },
            control: helm.map_or(Control::Direct, Control::Helm),
            teacher: None,
            critic: self.critic,
            decisions_per_step,
            steps_max: self.episode_max_s.map(|s| steps_max(s, &scenario, decisions_per_step)).transpose()?,
            starts: self.starts,
            learner: self.team.as_deref().map(|name| team(&scenario, name)).transpose()?,
            mates: self.mates.as_deref().map(strategy).transpose()?,
            opponents: self.opponents.iter().map(opponent).collect::<Result<_, SetupError>>()?,
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
        let RawObservation::Squall { mates, enemies, frames } = self else { return Ok(ObservationSpace::Pyquaticus) };
        if frames == 0 {
            return Err(wrong("frames", 0, "1 to 255"));
        }
        let boats = |team: usize| scenario.vehicles.iter().filter(|vehicle| vehicle.team.index() == team).count();
        let room = |boats: usize| u8::try_from(boats).unwrap_or(u8::MAX);
        Ok(ObservationSpace::Squall {
            mates: mates.unwrap_or_else(|| room(boats(0).saturating_sub(1))),
            enemies: enemies.unwrap_or_else(|| room(boats(1))),
            frames,
        })
    }
}

fn strategy(file: &Path) -> Result<Box<Strategy>, SetupError> {
    Ok(Box::new(scenario::load_strategy(file)?))
}

fn team(scenario: &Scenario, name: &str) -> Result<TeamId, SetupError> {
    let found = scenario.teams.iter().position(|team| team.name == name);
    let names = || scenario.teams.iter().map(|team| format!("{:?}", team.name)).collect::<Vec<_>>().join(" or ");
    found.map(|team| TeamId(team as u8)).ok_or_else(|| wrong("team", format!("{name:?}"), &names()))
}

fn wrong(field: &'static str, found: impl ToString, allowed: &str) -> SetupError {
    SetupError::Field { field, found: found.to_string(), allowed: allowed.to_owned() }
}

/// How many decisions of the game there are to one of a policy that decides as often as this, s.
pub(super) fn decisions_per_step(decision_s: f64, scenario: &Scenario) -> Result<u32, SetupError> {
    let least_s = scenario.decision().as_s();
    let times = (decision_s / least_s).round();
    if (1.0..=1e6).contains(&times) && (times * least_s - decision_s).abs() < 1e-6 {
        return Ok(times as u32);
    }
    let allowed = format!("a multiple of the {least_s} s between two decisions of the game, to a million of them");
    Err(wrong("decision_s", decision_s, &allowed))
}

/// How many steps of the policy an episode of this length has, s.
pub(super) fn steps_max(episode_max_s: f64, scenario: &Scenario, decisions_per_step: u32) -> Result<u32, SetupError> {
    let step_s = scenario.decision().as_s() * f64::from(decisions_per_step);
    let steps = (episode_max_s / step_s - 1e-6).ceil();
    if (1.0..=1e9).contains(&steps) {
        return Ok(steps as u32);
    }
    Err(wrong("episode_max_s", episode_max_s, "more than 0, to a milliard steps"))
}
