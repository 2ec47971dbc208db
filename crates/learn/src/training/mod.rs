//! Training files: a policy's games, networks and learning algorithm.
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

/// The training of a policy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Training {
    /// The training file's stem.
    #[schemars(skip)]
    pub name: String,
    /// Purpose, in one line.
    #[schemars(extend("default" = ""))]
    pub about: String,
    /// The policy's observations.
    pub observation: ObservationSpace,
    /// The policy's actions.
    #[schemars(extend("default" = "pyquaticus"))]
    pub action: ActionSpace,
    /// Time between two decisions of the policy, s: a multiple of the games' `decision_s`.
    #[schemars(range(min = 0.01, max = 10), extend("default" = 0.5))]
    pub period_s: f64,
    /// Number of games played in parallel.
    #[schemars(range(min = 1, max = 65536), extend("default" = 64))]
    pub games: u32,
    /// Random seed. With the file and the version it determines the weights to the bit.
    #[schemars(range(min = 0, max = i64::MAX), extend("default" = 1))]
    pub seed: u64,
    /// The networks.
    pub network: Layers,
    /// Proximal policy optimisation, used if the file has no table of another algorithm.
    pub ppo: Ppo,
    /// TD3 instead, for continuous actions.
    pub td3: Option<Td3>,
    /// Double DQN instead, for discrete actions.
    pub dqn: Option<Dqn>,
    /// Past policies as opponents, for stages that use them.
    pub league: League,
    /// How the policy is evaluated; the best one is kept.
    pub evaluation: Evaluation,
    /// The stages, in order.
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

/// The critic's input. A critic estimates the value of the rest of a game, in training only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CriticInput {
    /// The policy's observation.
    #[default]
    Observation,
    /// The observation and the truth about all boats, the flags and the sea, which no policy receives (a central critic: Lowe and others,
    /// NeurIPS 2017).
    Truth,
}

/// The networks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Layers {
    /// Width of each hidden layer.
    #[schemars(length(min = 1, max = 8), inner(range(min = 1, max = 1024)), extend("default" = [128, 128]))]
    pub hidden: Vec<usize>,
    /// The critic's input.
    #[schemars(extend("default" = "observation"))]
    pub critic: CriticInput,
}

/// Settings of proximal policy optimisation (Schulman and others, arXiv 1707.06347).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Ppo {
    /// Steps of every game per update.
    #[schemars(range(min = 1, max = 65536), extend("default" = 64))]
    pub steps: usize,
    /// Initial learning rate of the optimiser.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.0003))]
    pub learning_rate: f32,
    /// Share of the learning rate left at the end of the last stage; it falls linearly.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.1))]
    pub learning_rate_end: f32,
    /// Relative change of an action's probability beyond which there is nothing to gain.
    #[schemars(range(min = 0.001, max = 1), extend("default" = 0.2))]
    pub clip: f32,
    /// Passes over the samples.
    #[schemars(range(min = 1, max = 100), extend("default" = 4))]
    pub epochs: u32,
    /// Samples per optimiser step.
    #[schemars(range(min = 1, max = 1_000_000), extend("default" = 2048))]
    pub minibatch: usize,
    /// Value of one nat of the policy's entropy.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.01))]
    pub entropy: f32,
    /// An update ends early once the policy has diverged by this much, nats. Default 0.03.
    #[schemars(range(min = 0, max = 100), extend("default" = 0.03))]
    pub divergence_max: f32,
    /// Value of a reward one step later.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.995))]
    pub discount: f32,
    /// The λ of generalised advantage estimation: how far advantages look ahead.
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
    /// Samples between two policies that are kept.
    #[schemars(range(min = 1000, max = 1_000_000_000), extend("default" = 500_000))]
    pub every_samples: u64,
    /// Maximum number of policies kept; the oldest are discarded.
    #[schemars(range(min = 1, max = 1000), extend("default" = 20))]
    pub most: usize,
    /// Opponents are drawn by their share of wins to this power; 0 draws all equally (prioritised fictitious self-play, Vinyals and others,
    /// Nature 2019). Every opponent keeps a small probability.
    #[schemars(range(min = 0, max = 10), extend("default" = 1))]
    pub priority: f64,
}

/// How policies are evaluated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Evaluation {
    /// Samples between two evaluations.
    #[schemars(range(min = 1000, max = 1_000_000_000), extend("default" = 200_000))]
    pub every_samples: u64,
    /// Games against each opponent, half on each side, with the same seeds every time.
    #[schemars(range(min = 2, max = 100_000), extend("default" = 20))]
    pub games: u32,
    /// The opponents' strategy files, in the game of the last stage. The best policy wins the largest share of all these games; draws
    /// count half.
    #[schemars(with = "Vec<FilePath>", length(min = 1, max = 100))]
    pub opponents: Vec<PathBuf>,
}

/// A stage of a training.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Stage {
    /// Its name.
    #[schemars(with = "Name")]
    pub name: String,
    /// The game file, with two teams of equal size. Its teams' strategies are ignored.
    #[schemars(with = "FilePath")]
    pub game: PathBuf,
    /// The sea file. Default: the game's.
    #[schemars(with = "Option<FilePath>")]
    pub sea: Option<PathBuf>,
    /// The rewards file.
    #[schemars(with = "FilePath")]
    pub rewards: PathBuf,
    /// The strategy file whose helms carry out actions, with a behaviour of kind `policy` in every role. Default none: actions are orders.
    #[schemars(with = "Option<FilePath>")]
    pub helm: Option<PathBuf>,
    /// A strategy that plays the policy's boats in this stage. The policy learns to imitate it (behaviour cloning), and the critic learns
    /// the results. Default none: the policy plays.
    pub teacher: Option<Teacher>,
    /// The mates' strategy file. The policy controls one boat of its team, each in turn, and this strategy the others. Default none: the
    /// policy controls all boats.
    #[schemars(with = "Option<FilePath>")]
    pub mates: Option<PathBuf>,
    /// Relative frequency of games against the current policy.
    #[schemars(range(min = 0, max = 1_000_000), extend("default" = 0))]
    pub self_play: f64,
    /// Relative frequency of games against past policies, all together.
    #[schemars(range(min = 0, max = 1_000_000), extend("default" = 0))]
    pub past_selves: f64,
    /// Relative frequency of games against the `opponent`s, all together.
    #[schemars(range(min = 0, max = 1_000_000), extend("default" = 1))]
    pub strategies: f64,
    /// Strategies as opponents.
    #[schemars(length(max = 100))]
    pub opponent: Vec<Opponent>,
    /// Number of different starts, which repeat; each one's sea and boats are created once. Default: a new start for every game.
    #[schemars(range(min = 1, max = 1_000_000))]
    pub starts: Option<u32>,
    /// Time after which an episode is cut off, s. Default: whole games.
    #[schemars(range(min = 1, max = 86400))]
    pub episode_max_s: Option<f64>,
    /// Samples after which the stage ends.
    #[schemars(range(min = 1, max = 1_000_000_000_000_u64))]
    pub samples: u64,
    /// Share of games won in an evaluation that ends the stage early; draws count half. Default: never.
    #[schemars(range(min = 0, max = 1))]
    pub until_won: Option<f64>,
}

/// A strategy to imitate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Teacher {
    /// The strategy file.
    #[schemars(with = "FilePath")]
    pub strategy: PathBuf,
    /// With `action = "options"`: the option of each mode. Other modes take the option with their own name, if any; without one, they are
    /// not imitated.
    #[schemars(extend("default" = {}))]
    pub options: BTreeMap<String, String>,
}

/// A strategy as an opponent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Opponent {
    /// The strategy file.
    #[schemars(with = "FilePath")]
    pub strategy: PathBuf,
}
