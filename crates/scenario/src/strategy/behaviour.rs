//! Behaviours: the objectives that a boat's helm weighs, and when they run.

use super::{Expression, Parameter, Task};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use strum::{EnumMessage, IntoStaticStr, VariantArray};

/// A behaviour. In a file it also has a key for each [`Moment`] and the keys of its task.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Behaviour {
    /// Its name, unique in the program.
    #[schemars(skip)]
    pub name: String,
    /// Modes in which it may run, including their children. Default: all.
    #[schemars(rename = "in", with = "Option<Vec<String>>")]
    #[schemars(length(min = 1), extend("x-expected" = "at least one mode"))]
    pub modes: Vec<bool>,
    /// Runs only while this condition holds. Default: always.
    #[schemars(with = "Option<String>")]
    pub when: Option<Expression>,
    /// Weight, at most that of `op_region` and `avoid_collision` in the same modes. The default of
    /// safety behaviours is 300.
    #[schemars(range(min = 0, max = 1000), extend("default" = 100))]
    pub weight: Parameter,
    /// Running time after which it completes, s. Default: never.
    #[schemars(range(min = 0, max = 86400))]
    pub duration_s: Option<Parameter>,
    /// Whether it restarts after completion.
    #[schemars(extend("default" = false))]
    pub perpetual: bool,
    /// The values that it posts, and when.
    #[schemars(skip)]
    pub posts: Vec<Post>,
    /// Its task.
    #[schemars(skip)]
    pub task: Task,
}

/// An assignment to a variable at a moment in the life of a behaviour.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Post {
    /// The moment.
    pub at: Moment,
    /// Index of the variable.
    pub variable: u16,
    /// Its new value.
    pub value: Expression,
}

/// A moment in the life of a behaviour, named after the key for its assignments, such as `on_run`.
#[derive(VariantArray, IntoStaticStr, EnumMessage)]
#[strum(serialize_all = "snake_case", prefix = "on_")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Moment {
    /// It begins to run.
    Run,
    /// It stops running.
    Idle,
    /// It begins to influence the helm.
    Active,
    /// It stops influencing the helm.
    Inactive,
    /// It reaches a point, or its time ends.
    Reach,
    /// It completes.
    Complete,
}
