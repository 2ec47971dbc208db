//! Behaviours: the objectives that a boat's helm weighs, and when they run.

use super::{Expression, Parameter, Task};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use strum::{EnumMessage, IntoStaticStr, VariantArray};

/// A behaviour of a strategy. In a file it has a key for each [`Moment`] and for each of its task's as well.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Behaviour {
    /// Its name, unique in the program.
    #[schemars(skip)]
    pub name: String,
    /// The modes in which it may run; a mode means it and all its parts. Default all modes.
    #[schemars(rename = "in", with = "Option<Vec<String>>")]
    #[schemars(length(min = 1), extend("x-expected" = "at least one mode"))]
    pub modes: Vec<bool>,
    /// It runs only while this expression is true. Default always.
    #[schemars(with = "Option<String>")]
    pub when: Option<Expression>,
    /// How much it counts against others; no more than the op_region and the avoid_collision on guard have. Those and
    /// avoid_obstacle have 300 by default.
    #[schemars(range(min = 0, max = 1000), extend("default" = 100))]
    pub weight: Parameter,
    /// It is complete after running for this long, s. Default never.
    #[schemars(range(min = 0, max = 86400))]
    pub duration_s: Option<Parameter>,
    /// Whether it starts again after it was complete.
    #[schemars(extend("default" = false))]
    pub perpetual: bool,
    /// What it posts, and when.
    #[schemars(skip)]
    pub posts: Vec<Post>,
    /// What it does.
    #[schemars(skip)]
    pub task: Task,
}

/// A value given to a variable at a moment of a behaviour's life.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Post {
    /// The moment.
    pub at: Moment,
    /// Index of the variable.
    pub variable: u16,
    /// Its new value.
    pub value: Expression,
}

/// A moment of a behaviour's life. It is called by the key for what is posted then, such as `on_run`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantArray, IntoStaticStr, EnumMessage)]
#[strum(serialize_all = "snake_case", prefix = "on_")]
pub enum Moment {
    /// It begins to run.
    Run,
    /// It stops running.
    Idle,
    /// It begins to influence the helm.
    Active,
    /// It stops doing so.
    Inactive,
    /// It reaches one of its points, or its time.
    Reach,
    /// It is complete.
    Complete,
}
