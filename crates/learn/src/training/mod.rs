//! Training files: a policy's games, its networks and its learning algorithm.
//!
//! [`Training`] is data, read from `scenarios/training/*.toml`; the type declares the keys.

mod algorithm;
mod check;
mod check_algorithm;
mod dqn;
mod td3;

pub use algorithm::Algorithm;
pub use dqn::Dqn;
pub use td3::Td3;

use scenario::action::ActionSpace;
use scenario::keys::{FilePath, Name};
use scenario::observation::ObservationSpace;
use scenario::{Diagnostics, Document, ScenarioFile};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// How a policy is trained.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Training {
    /// The training file's stem.
    #[schemars(skip)]
    pub name: String,
    /// What it is meant for, in a line.
    #[schemars(extend("default" = ""))]
    pub about: String,
    /// What the policy is given.
    pub observation: ObservationSpace,
    /// What it chooses.
    #[schemars(extend("default" = "pyquaticus"))]
    pub action: ActionSpace,
    /// The time from one decision of the policy to the next, s: a multiple of the games' `decision_s`.
    #[schemars(range(min = 0.01, max = 10), extend("default" = 0.5))]
    pub period_s: f64,
    /// Games that are played side by side.
    #[schemars(range(min = 1, max = 65536), extend("default" = 64))]
    pub games: u32,
    /// The seed: with the file and the version it names the weights that come of it, to the bit.
    #[schemars(range(min = 0, max = i64::MAX), extend("default" = 1))]
    pub seed: u64,
    /// The networks.
    pub network: Layers,
    /// How the policy learns: proximal policy optimisation, where the file has no table of another algorithm.
    pub ppo: Ppo,
    /// How it learns instead, with continuous actions.
    pub td3: Option<Td3>,
    /// How it learns instead, with discrete actions.
    pub dqn: Option<Dqn>,
    /// What past policies are kept as opponents, for stages that have them.
    pub league: League,
    /// How it is seen how good a policy is; the best one is kept.
    pub evaluation: Evaluation,
    /// What is played, one stage after the other.
    #[schemars(length(min = 1, max = 100))]
    pub stage: Vec<Stage>,
}

impl ScenarioFile for Training {
    type Keys = Training;
    const NAME: &'static str = "training";
    const FOLDER: &'static str = "training";

    fn check(diagnostics: &mut Diagnostics, document: &Document<Training>) -> Option<Training> {
        check::training(diagnostics, document)
    }
}

/// What a critic is given, who learns what the rest of a game is worth. It is of use in training alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CriticInput {
    /// What the policy is given.
    #[default]
    Observation,
    /// That and the truth about all boats, the flags and the sea, which no policy is given (a central critic: Lowe and others,
    /// NeurIPS 2017).
    Truth,
}

/// The networks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Layers {
    /// Numbers of each hidden layer.
    #[schemars(length(min = 1, max = 8), inner(range(min = 1, max = 1024)), extend("default" = [128, 128]))]
    pub hidden: Vec<usize>,
    /// What the critic is given.
    #[schemars(extend("default" = "observation"))]
    pub critic: CriticInput,
}

/// How updates are made: proximal policy optimisation (Schulman and others, arXiv 1707.06347).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Ppo {
    /// Steps of every game to an update.
    #[schemars(range(min = 1, max = 65536), extend("default" = 64))]
    pub steps: usize,
    /// How far one step of the optimiser goes, at first.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.0003))]
    pub learning_rate: f32,
    /// The share of it that is left at the end of the last stage; it falls evenly.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.1))]
    pub learning_rate_end: f32,
    /// Beyond this change of an action's probability, in parts of it, there is nothing to gain.
    #[schemars(range(min = 0.001, max = 1), extend("default" = 0.2))]
    pub clip: f32,
    /// How often the samples are gone through.
    #[schemars(range(min = 1, max = 100), extend("default" = 4))]
    pub epochs: u32,
    /// Samples to a step of the optimiser.
    #[schemars(range(min = 1, max = 1_000_000), extend("default" = 2048))]
    pub minibatch: usize,
    /// What a nat of the policy's entropy is worth.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.01))]
    pub entropy: f32,
    /// An update ends early when the policy has become as different as this, nats. Default 0.03.
    #[schemars(range(min = 0, max = 100), extend("default" = 0.03))]
    pub divergence_max: f32,
    /// What a reward one step later is worth.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.995))]
    pub discount: f32,
    /// How far advantages look beyond what is expected next: the λ of generalised advantage estimation.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.95))]
    pub lambda: f32,
}

impl Default for Ppo {
    fn default() -> Ppo {
        Ppo {
            steps: 64,
            learning_rate: 3e-4,
            learning_rate_end: 0.1,
            clip: 0.2,
            epochs: 4,
            minibatch: 2048,
            entropy: 0.01,
            divergence_max: 0.03,
            discount: 0.995,
            lambda: 0.95,
        }
    }
}

/// Past policies as opponents.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct League {
    /// One is kept each time that the policy has learnt from so many samples.
    #[schemars(range(min = 1000, max = 1_000_000_000), extend("default" = 500_000))]
    pub every_samples: u64,
    /// How many are kept, the newest ones.
    #[schemars(range(min = 1, max = 1000), extend("default" = 20))]
    pub most: usize,
    /// Opponents are drawn by how often they win, to this power: 0 draws all as often (prioritised fictitious self-play, Vinyals
    /// and others, Nature 2019). Every opponent is drawn a little.
    #[schemars(range(min = 0, max = 10), extend("default" = 1))]
    pub priority: f64,
}

/// How it is seen how good a policy is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Evaluation {
    /// It is looked at each time that the policy has learnt from so many samples.
    #[schemars(range(min = 1000, max = 1_000_000_000), extend("default" = 200_000))]
    pub every_samples: u64,
    /// Games against each opponent, half of them on each side, of the same seeds every time.
    #[schemars(range(min = 2, max = 100_000), extend("default" = 20))]
    pub games: u32,
    /// The strategy files of the opponents, in the game of the last stage. The best policy is the one that wins most of all
    /// these games, draws counting half.
    #[schemars(with = "Vec<FilePath>", length(min = 1, max = 100))]
    pub opponents: Vec<PathBuf>,
}

/// A stage: what is played until it is over.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Stage {
    /// Its name.
    #[schemars(with = "Name")]
    pub name: String,
    /// The game file: two teams of as many boats. The strategies of its teams play no part.
    #[schemars(with = "FilePath")]
    pub game: PathBuf,
    /// The sea file. Default the game's.
    #[schemars(with = "Option<FilePath>")]
    pub sea: Option<PathBuf>,
    /// The rewards file.
    #[schemars(with = "FilePath")]
    pub rewards: PathBuf,
    /// The strategy file through whose helms actions reach the boats, with a behaviour of the kind `policy` in every role.
    /// Default none: actions are orders.
    #[schemars(with = "Option<FilePath>")]
    pub helm: Option<PathBuf>,
    /// A strategy that plays the policy's boats in this stage, so that the policy learns to do as it does (behaviour cloning) and the
    /// critic what comes of it. Default none: the policy plays.
    pub teacher: Option<Teacher>,
    /// The strategy file of its mates: the policy sails one boat of its team, each by turns, and this strategy the others. Default none:
    /// the policy sails all.
    #[schemars(with = "Option<FilePath>")]
    pub mates: Option<PathBuf>,
    /// How often the policy plays against itself as it is, in comparison with the other opponents.
    #[schemars(range(min = 0, max = 1_000_000), extend("default" = 0))]
    pub self_play: f64,
    /// How often it plays against one that it was, all of them together.
    #[schemars(range(min = 0, max = 1_000_000), extend("default" = 0))]
    pub past_selves: f64,
    /// How often it plays against one of the `opponent`s, all of them together.
    #[schemars(range(min = 0, max = 1_000_000), extend("default" = 1))]
    pub strategies: f64,
    /// Strategies that it plays against.
    #[schemars(length(max = 100))]
    pub opponent: Vec<Opponent>,
    /// So many different starts come round again: their seas and boats are made once. Default a new one every game.
    #[schemars(range(min = 1, max = 1_000_000))]
    pub starts: Option<u32>,
    /// An episode is cut off after this time, s. Default whole games.
    #[schemars(range(min = 1, max = 86400))]
    pub episode_max_s: Option<f64>,
    /// It is over when the policy has learnt from so many samples in it.
    #[schemars(range(min = 1, max = 1_000_000_000_000_u64))]
    pub samples: u64,
    /// Or earlier, when an evaluation gives this share of games won, draws counting half. Default never.
    #[schemars(range(min = 0, max = 1))]
    pub until_won: Option<f64>,
}

/// A strategy to imitate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Teacher {
    /// Its file.
    #[schemars(with = "FilePath")]
    pub strategy: PathBuf,
    /// With `action = "options"`: which option each of its modes is. A mode that is not named here is the option of its own name, or
    /// nothing to learn from.
    #[schemars(extend("default" = {}))]
    pub options: BTreeMap<String, String>,
}

/// A strategy to play against.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Opponent {
    /// Its file.
    #[schemars(with = "FilePath")]
    pub strategy: PathBuf,
}
