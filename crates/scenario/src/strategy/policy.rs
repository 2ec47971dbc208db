//! The behaviour of the kind `policy` and its keys; [`super::task`] has the other kinds.

use super::Parameter;
use crate::action::ActionKey;
use crate::observation::ObservationSpace;
use crate::policy::PolicyModel;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Follows a course and speed proposed by a trained model, an external program or a person.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Policy {
    /// The proposing model; `None` means an external source.
    #[serde(default)]
    #[schemars(flatten, with = "ModelKeys")]
    pub model: Option<PolicyModel>,
    /// The competition entry that decides in place of a model.
    #[serde(default)]
    #[schemars(skip)]
    pub host: Option<Host>,
    /// Variable that the chosen option sets; the policy then proposes no course or speed.
    #[serde(default)]
    #[schemars(with = "Option<String>", extend("x-expected" = "the name of a string variable"))]
    pub sets: Option<u16>,
    /// Whether to sample actions from the model's probabilities, using the game's seed, instead of
    /// taking the most likely action. Only for models with logits.
    #[serde(default)]
    pub sampled: bool,
    /// Whether the model's actions are the boat's orders, as in Pyquaticus. Modes, rules and other
    /// behaviours then have no effect, and nothing keeps the boat safe; a tagged boat drives home.
    #[serde(default)]
    pub direct: bool,
    /// Source of external proposals.
    #[schemars(extend("default" = "program"))]
    pub by: Proposer,
    /// Maximum age of an external proposal, s.
    #[schemars(range(min = 0.01, max = 600), extend("default" = 1))]
    pub ttl_s: Parameter,
    /// Half width of the peak at the proposed course, degrees.
    #[schemars(range(min = 0, max = 180), extend("default" = 10))]
    pub peak_width_deg: Parameter,
    /// Width from the peak to zero, degrees.
    #[schemars(range(min = 0, max = 180), extend("default" = 60))]
    pub base_width_deg: Parameter,
    /// Weight of course against speed.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.5))]
    pub course_share: Parameter,
}

/// The keys for a model or a competition entry.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "only the schema is used")]
struct ModelKeys {
    /// ONNX file. Default: an external source of proposals.
    #[schemars(extend("minLength" = 1, "x-expected" = "the path of a file"))]
    model: Option<String>,
    /// Competition entry in place of a model: its folder or `solution.py`.
    #[schemars(extend("minLength" = 1, "x-expected" = "the path of a folder"))]
    host: Option<String>,
    /// Python interpreter for the entry. Default: python3.
    #[schemars(length(min = 1))]
    python: Option<String>,
    /// Wall-clock limit for an entry's decision, s. Default: 1.
    #[schemars(range(min = 0.01, max = 60))]
    limit_s: Option<f64>,
    /// The model's inputs. Default: as in its metadata; for an entry, the game's.
    observation: Option<ObservationSpace>,
    /// The model's actions: a name, or a table of [fraction of the top speed,
    /// turn in degrees clockwise].
    /// Default: as in its metadata.
    action: Option<ActionKey>,
    /// Time between decisions, s. Default: as in the metadata; for an entry, the game's.
    #[schemars(range(min = 0.01, max = 10))]
    period_s: Option<f64>,
}

/// A competition entry: a Python program that decides for boats.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Host {
    /// Its folder, or its `solution.py`.
    pub path: String,
    /// The Python interpreter that runs it.
    pub python: String,
    /// Wall-clock time for each decision, s.
    pub limit_s: f64,
    /// Its observations, those of Pyquaticus in 2025 or 2026. `None` means those of the game's
    /// year.
    pub observation: Option<ObservationSpace>,
    /// Time between decisions, s. `None` means the game's.
    pub period_s: Option<f64>,
    /// Whether this process may run it. A path from another process or a recording never makes this
    /// process run a program.
    #[serde(skip)]
    pub is_allowed: bool,
}

/// Source of external proposals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Proposer {
    /// A program; lockstep waits for it.
    #[default]
    Program,
    /// A person at the page; lockstep does not wait.
    Person,
}
