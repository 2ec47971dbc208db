//! Training files: a policy's games, networks and learning algorithm.
//!
//! [`Training`] is data, read from `scenarios/training/*.toml`; the type declares the keys.

mod algorithm;
mod check;
mod check_algorithm;

pub use algorithm::{Algorithm, Dqn, Ppo, Td3};

use scenario::action::ActionSpace;
use scenario::keys::{FilePath, Name};
use scenario::observation::ObservationSpace;
use scenario::{Document, ScenarioFile};
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
    /// Description, in one line.
    #[schemars(extend("default" = ""))]
    pub about: String,
    /// The policy's inputs.
    pub observation: ObservationSpace,
    /// The policy's actions.
    #[schemars(extend("default" = "pyquaticus"))]
    pub action: ActionSpace,
    /// Time between decisions of the policy, s; a multiple of the games' `decision_s`.
    #[schemars(range(min = 0.01, max = 10), extend("default" = 0.5))]
    pub period_s: f64,
    /// Games played in parallel.
    #[schemars(range(min = 1, max = 65536), extend("default" = 64))]
    pub games: u32,
    /// Random seed.
    #[schemars(range(min = 0, max = i64::MAX), extend("default" = 1))]
    pub seed: u64,
    /// The networks.
    pub network: Layers,
    /// Proximal policy optimisation, the default algorithm.
    pub ppo: Ppo,
    /// Instead of `ppo`, for continuous actions.
    pub td3: Option<Td3>,
    /// Instead of `ppo`, for discrete actions.
    pub dqn: Option<Dqn>,
    /// Past policies kept as opponents.
    pub league: League,
    /// How policies are evaluated; the best is kept.
    pub evaluation: Evaluation,
    /// Stages, in order.
    #[schemars(length(min = 1, max = 100))]
    pub stage: Vec<Stage>,
}

impl ScenarioFile for Training {
    type Keys = Training;
    const NAME: &'static str = "training";
    const FOLDER: &'static str = "training";

    fn check(document: &Document<Training>) -> Option<Training> {
        check::training(document)
    }
}

/// Input of the critic, which estimates the value of the rest of a game. It is used only in
/// training.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CriticInput {
    /// The policy's inputs.
    #[default]
    Observation,
    /// The policy's inputs and the true state of all boats, the flags and the sea, which no policy
    /// receives (a central critic: Lowe and others, NeurIPS 2017).
    Truth,
}

/// The networks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Layers {
    /// Size of each hidden layer.
    #[schemars(length(min = 1, max = 8), inner(range(min = 1, max = 1024)), extend("default" = [128, 128]))]
    pub hidden: Vec<usize>,
    /// The critic's inputs.
    #[schemars(extend("default" = "observation"))]
    pub critic: CriticInput,
}

/// Past policies as opponents.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct League {
    /// Samples between kept policies.
    #[schemars(range(min = 1000, max = 1_000_000_000), extend("default" = 500_000))]
    pub every_samples: u64,
    /// Maximum number of policies kept; the newest remain.
    #[schemars(range(min = 1, max = 1000), extend("default" = 20))]
    pub most: usize,
    /// Opponents are drawn in proportion to this power of their fraction of wins; 0: uniformly
    /// (prioritised fictitious self-play, Vinyals and others, Nature 2019).
    #[schemars(range(min = 0, max = 10), extend("default" = 1))]
    pub priority: f64,
}

/// How policies are evaluated; the best is kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Evaluation {
    /// Samples between evaluations.
    #[schemars(range(min = 1000, max = 1_000_000_000), extend("default" = 200_000))]
    pub every_samples: u64,
    /// Games per opponent, half on each side, with fixed seeds.
    #[schemars(range(min = 2, max = 100_000), extend("default" = 20))]
    pub games: u32,
    /// Strategy files of the opponents, in the game of the last stage. The best policy wins the
    /// most games in total; draws count half.
    #[schemars(with = "Vec<FilePath>", length(min = 1, max = 100))]
    pub opponents: Vec<PathBuf>,
}

/// A stage of training.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Stage {
    /// Name of the stage.
    #[schemars(with = "Name")]
    pub name: String,
    /// Game file with two teams of equal size; its strategies are ignored.
    #[schemars(with = "FilePath")]
    pub game: PathBuf,
    /// Minimum and maximum team size; a size is drawn for each team and game. Only with observation
    /// "squall". Default: all boats.
    #[schemars(inner(range(min = 1, max = 10000)))]
    pub team_sizes: Option<[u32; 2]>,
    /// Sea file. Default: the game's.
    #[schemars(with = "Option<FilePath>")]
    pub sea: Option<PathBuf>,
    /// Rewards file.
    #[schemars(with = "FilePath")]
    pub rewards: PathBuf,
    /// Strategy file whose helms execute actions; every role needs a behaviour of kind `policy`.
    /// Default: none, actions are orders.
    #[schemars(with = "Option<FilePath>")]
    pub helm: Option<PathBuf>,
    /// Strategy that the policy imitates (behaviour cloning) and whose returns the critic learns.
    /// Default: none.
    pub teacher: Option<Teacher>,
    /// Strategy file of teammates: the policy drives one boat per game, a different one each time.
    /// Default: none, the policy drives all.
    #[schemars(with = "Option<FilePath>")]
    pub mates: Option<PathBuf>,
    /// Weight of the policy itself as an opponent.
    #[schemars(range(min = 0, max = 1_000_000), extend("default" = 0))]
    pub self_play: f64,
    /// Total weight of past policies as opponents.
    #[schemars(range(min = 0, max = 1_000_000), extend("default" = 0))]
    pub past_selves: f64,
    /// Total weight of the strategies in `opponent`.
    #[schemars(range(min = 0, max = 1_000_000), extend("default" = 1))]
    pub strategies: f64,
    /// Strategies as opponents.
    #[schemars(length(max = 100))]
    pub opponent: Vec<Opponent>,
    /// Number of different starts, used in rotation, so that seas and boats are created only once
    /// per start. Default: a new start every game.
    #[schemars(range(min = 1, max = 1_000_000))]
    pub starts: Option<u32>,
    /// Maximum duration of an episode, s. Default: whole games.
    #[schemars(range(min = 1, max = 86400))]
    pub episode_max_s: Option<f64>,
    /// Length, in samples.
    #[schemars(range(min = 1, max = 1_000_000_000_000_u64))]
    pub samples: u64,
    /// Fraction of evaluation games won that ends the stage early; draws count half. Default:
    /// never.
    #[schemars(range(min = 0, max = 1))]
    pub until_won: Option<f64>,
}

/// A strategy to imitate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Teacher {
    /// Strategy file.
    #[schemars(with = "FilePath")]
    pub strategy: PathBuf,
    /// Whether the strategy plays in place of the policy. If `false`, the policy plays, and learns
    /// what the strategy would do in the same situations (DAgger: Ross, Gordon and Bagnell, AISTATS
    /// 2011).
    #[schemars(extend("default" = true))]
    pub drives: bool,
    /// With `action = "options"`: the option for each mode. An omitted mode uses the option with
    /// the same name; if there is none, the policy does not learn from that mode.
    #[schemars(extend("default" = {}))]
    pub options: BTreeMap<String, String>,
}

/// An opponent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Opponent {
    /// Strategy file.
    #[schemars(with = "FilePath")]
    pub strategy: PathBuf,
}
