//! Behaviours: what a boat's helm weighs against each other, and when.

use super::{Expression, Parameter, Task};
use serde::{Deserialize, Serialize};

/// A behaviour of a strategy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Behaviour {
    /// Its name, unique in the program.
    pub name: String,
    /// Whether it may run in each mode, by mode; for parents as for leaves.
    pub modes: Vec<bool>,
    /// It runs only while this holds.
    pub when: Option<Expression>,
    /// Its priority weight, 0 to 1000.
    pub weight: Parameter,
    /// It is complete after running for this long, s.
    pub duration_s: Option<Parameter>,
    /// Whether it starts again after it was complete.
    pub perpetual: bool,
    /// What it posts, and when.
    pub posts: Vec<Post>,
    /// What it does.
    pub task: Task,
}

/// A value given to a variable at a moment of a behaviour's life.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Post {
    /// When.
    pub at: Moment,
    /// The variable, by index.
    pub variable: u16,
    /// Its new value.
    pub value: Expression,
}

/// A moment of a behaviour's life.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
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
