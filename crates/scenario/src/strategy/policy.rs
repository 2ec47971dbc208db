//! The behaviour of the kind `policy` and its keys; [`super::task`] has the other kinds.

use super::Parameter;
use crate::action::ActionSpace;
use crate::observation::ObservationSpace;
use crate::policy::PolicyModel;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Lets a trained model, or somebody outside of the helm, propose course and speed, weighed with everything else.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Policy {
    /// What proposes; none: somebody outside.
    #[serde(default)]
    #[schemars(flatten, with = "ModelKeys")]
    pub model: Option<PolicyModel>,
    /// The variable that gets the option chosen, by index: the policy then proposes no course and no speed.
    #[serde(default)]
    #[schemars(with = "Option<String>", extend("x-expected" = "the name of a variable with texts"))]
    pub sets: Option<u16>,
    /// Without a model, who proposes: `program` is waited for in lockstep, `person` (somebody at the page) is not.
    #[schemars(extend("default" = "program"))]
    pub by: Proposer,
    /// A proposal from outside that is older than this is ignored, s.
    #[schemars(range(min = 0.01, max = 600), extend("default" = 1))]
    pub ttl_s: Parameter,
    /// Half width of the peak at the proposed course, degrees.
    #[schemars(range(min = 0, max = 180), extend("default" = 10))]
    pub peak_width_deg: Parameter,
    /// From there down to nothing, degrees.
    #[schemars(range(min = 0, max = 180), extend("default" = 60))]
    pub base_width_deg: Parameter,
    /// How much course counts against speed.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.5))]
    pub course_share: Parameter,
}

/// The keys for a model.
#[derive(JsonSchema)]
struct ModelKeys {
    /// The model that proposes: an ONNX file, relative to this file. Default none: somebody outside does.
    #[schemars(extend("minLength" = 1, "x-expected" = "the path of a file"))]
    #[expect(dead_code, reason = "only the schema is used")]
    model: Option<String>,
    /// What the model is given. Default what its metadata says.
    #[expect(dead_code, reason = "only the schema is used")]
    observation: Option<ObservationSpace>,
    /// What the model chooses. Default what its metadata says.
    #[expect(dead_code, reason = "only the schema is used")]
    action: Option<ActionSpace>,
    /// The time from one decision of the model to the next, s. Default what its metadata says.
    #[schemars(range(min = 0.01, max = 10))]
    #[expect(dead_code, reason = "only the schema is used")]
    period_s: Option<f64>,
}

/// Who proposes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Proposer {
    /// A program: in lockstep it is waited for.
    #[default]
    Program,
    /// A person ashore: nothing waits.
    Person,
}
