//! Strategies: how a team's boats play, as data.
//!
//! A [`Strategy`] assigns [`Program`]s to the boats of a team. A boat's helm follows one program:
//! variables, a tree of modes, behaviours, and rules that assign values to variables.

mod behaviour;
mod expression;
mod fact;
mod parameter;
mod place;
mod policy;
mod print;
mod task;

pub use behaviour::{Behaviour, Moment, Post};
pub use expression::{Expression, Join, Values};
pub use fact::{Fact, Kind, Measure};
pub use parameter::Parameter;
pub use place::{Boat, Mark, Place};
pub use policy::{Host, Policy, Proposer};
pub use task::{
    Attractor, AvoidCollision, AvoidObstacle, BeyondHalt, ConstantHeading, ConstantSpeed, Contacts,
    CutRange, Ellipse, FullStop, Grade, Intercept, Loiter, MaxSpeed, MemoryTurnLimit, OpRegion,
    Shape, Shield, StationKeep, Task, Timer, Trail, Turn, Waypoint,
};

use crate::policy::PolicyModel;
use crate::size::{COURSES_MAX, COURSES_MIN, SPEEDS_MAX, SPEEDS_MIN};
use serde::{Deserialize, Serialize};
use strum::{EnumMessage, IntoStaticStr, VariantArray};

/// Maximum number of contacts or obstacles to which one behaviour responds at a time: the nearest.
pub const NEAREST_MAX: usize = 16;
/// Maximum number of objective functions in a mode, one per contact or obstacle.
pub const FUNCTIONS_MAX: usize = 256;
/// Maximum number of shared variables of a program.
pub const SHARED_MAX: usize = 256;

/// The strategy of a team's boats.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Strategy {
    /// The strategy file's stem.
    pub name: String,
    /// The file's description of the strategy.
    pub about: String,
    /// The programs, assigned to the team's boats in order, starting over when they run out.
    pub roles: Vec<Program>,
    /// How the roles are assigned.
    pub assignment: Assignment,
}

/// How roles are assigned to a team's boats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Assignment {
    /// In the order of the game's vehicles.
    Fixed,
    /// In an order drawn from the team's random stream.
    Seeded,
}

/// The program of one boat's helm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Program {
    /// Its file's stem.
    pub name: String,
    /// The file's description of the program.
    pub about: String,
    /// Settings of the helm's decisions.
    pub helm: Helm,
    /// Its variables.
    pub variables: Vec<Variable>,
    /// Its modes, parents before children, siblings in order; at least one.
    pub modes: Vec<Mode>,
    /// Its behaviours, sorted by name.
    pub behaviours: Vec<Behaviour>,
    /// The rules that assign values to variables, in order.
    pub rules: Vec<Rule>,
    /// The reason why modes may lack `op_region` or `avoid_collision`.
    pub unsafe_because: Option<String>,
}

/// How the helm decides.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Helm {
    /// Number of courses compared.
    #[schemars(range(min = COURSES_MIN, max = COURSES_MAX), extend("default" = 360))]
    pub courses: usize,
    /// Number of speeds compared, from 0 to the maximum.
    #[schemars(range(min = SPEEDS_MIN, max = SPEEDS_MAX), extend("default" = 36))]
    pub speeds: usize,
    /// Maximum speed, m/s, at most the boat's. Default: the boat's.
    #[schemars(range(min = 0.1, max = 60))]
    pub speed_max_m_s: Option<f64>,
    /// Bonus for decisions near the last one (30 degrees, 0.75 m/s), as a fraction of all weights
    /// except those of `op_region`. More than 0.1 would outweigh safety.
    #[schemars(range(min = 0, max = 0.1), extend("default" = 0))]
    pub hysteresis: f64,
    /// Whether to correct for estimated drift and heading error, so that course and speed over the
    /// ground match those requested.
    #[schemars(rename = "compensate_drift", extend("x-field" = "compensates_drift", "default" = true))]
    pub compensates_drift: bool,
}

/// A variable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// The kind of its values.
    pub kind: Kind,
    /// Its initial value; see [`Expression`] for how Booleans and strings become numbers.
    pub initial: f64,
    /// Whether it is shared with the team.
    pub shared: bool,
}

/// A mode: the boat's current activity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mode {
    /// Its name, unique in the program.
    pub name: String,
    /// Index of the parent mode; parents precede their children.
    pub parent: Option<usize>,
    /// The first sibling whose condition holds is active; the last sibling has no condition.
    pub when: Option<Expression>,
    /// Assignments when the mode begins.
    pub enter: Vec<(u16, Expression)>,
}

/// A rule that assigns values to variables.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rule {
    /// Applies only at this event.
    pub on: Option<Trigger>,
    /// Applies only if this condition holds.
    pub when: Option<Expression>,
    /// The variables, by index, and their new values.
    pub set: Vec<(u16, Expression)>,
}

/// The event that triggers a rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Trigger {
    /// The boat that the event concerns.
    pub who: Who,
    /// The kind of event.
    pub what: What,
}

/// The boat that an event concerns.
#[derive(VariantArray, IntoStaticStr, EnumMessage)]
#[strum(serialize_all = "snake_case")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Who {
    /// The boat itself.
    I,
    /// A teammate.
    Mate,
    /// An enemy.
    Enemy,
}

/// The kind of event.
#[derive(VariantArray, IntoStaticStr, EnumMessage)]
#[strum(serialize_all = "snake_case")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names are self-explanatory")]
pub enum What {
    Grabs,
    Captures,
    LosesFlag,
    IsTagged,
    IsUntagged,
    Tags,
    LeavesField,
    ReturnsToField,
    Collides,
}

impl Strategy {
    /// The models that its programs use.
    pub fn models(&self) -> impl Iterator<Item = &PolicyModel> {
        self.roles.iter().flat_map(Program::models)
    }

    /// The competition entries of its programs.
    pub fn hosts(&self) -> impl Iterator<Item = &Host> {
        self.roles.iter().filter_map(Program::host)
    }

    /// The competition entries of its programs, to permit running them.
    pub fn hosts_mut(&mut self) -> impl Iterator<Item = &mut Host> {
        let behaviours = self.roles.iter_mut().flat_map(|role| &mut role.behaviours);
        behaviours.filter_map(|behaviour| match &mut behaviour.task {
            Task::Policy(policy) => policy.host.as_mut(),
            _ => None,
        })
    }

    /// Whether a person may steer boats with this strategy.
    pub fn is_steered(&self) -> bool {
        self.roles
            .iter()
            .any(|role| role.proposer() == Some(Proposer::Person))
    }
}

impl Program {
    /// The models that it uses.
    pub fn models(&self) -> impl Iterator<Item = &PolicyModel> {
        self.behaviours
            .iter()
            .filter_map(|behaviour| match &behaviour.task {
                Task::Policy(policy) => policy.model.as_ref(),
                _ => None,
            })
    }

    /// The competition entry that decides for its boats, if any.
    pub fn host(&self) -> Option<&Host> {
        self.behaviours
            .iter()
            .find_map(|behaviour| match &behaviour.task {
                Task::Policy(policy) => policy.host.as_ref(),
                _ => None,
            })
    }

    /// The accepted external source of courses and speeds, if any.
    pub fn proposer(&self) -> Option<Proposer> {
        self.behaviours
            .iter()
            .find_map(|behaviour| match &behaviour.task {
                Task::Policy(policy)
                    if policy.model.is_none() && policy.host.is_none() && policy.sets.is_none() =>
                {
                    Some(policy.by)
                }
                _ => None,
            })
    }

    /// Index of the variable whose string an external source sets, if the program has options.
    pub fn options(&self) -> Option<u16> {
        self.behaviours
            .iter()
            .find_map(|behaviour| match &behaviour.task {
                Task::Policy(policy) if policy.model.is_none() => policy.sets,
                _ => None,
            })
    }

    /// The strings of a variable; empty for other kinds.
    pub fn texts(&self, variable: u16) -> &[String] {
        match &self.variables[usize::from(variable)].kind {
            Kind::Text(texts) => texts,
            _ => &[],
        }
    }

    /// Whether a mode has no children.
    pub fn is_leaf(&self, mode: usize) -> bool {
        self.modes.iter().all(|other| other.parent != Some(mode))
    }

    /// The modes without children, by index, in order.
    pub fn leaves(&self) -> impl Iterator<Item = usize> {
        (0..self.modes.len()).filter(|mode| self.is_leaf(*mode))
    }

    /// The mode's name after those of its parents, outermost first: `defending:intercepting`.
    pub fn path(&self, mode: usize) -> String {
        let name = &self.modes[mode].name;
        self.modes[mode].parent.map_or_else(
            || name.clone(),
            |parent| format!("{}:{name}", self.path(parent)),
        )
    }

    /// The active leaf according to the conditions.
    ///
    /// # Panics
    /// If the last sibling has a condition, which is impossible in a checked program.
    pub fn leaf(&self, values: &impl Values) -> usize {
        let mut within = None;
        loop {
            let holds = |mode: &Mode| mode.when.as_ref().is_none_or(|when| when.is_true(values));
            let mut modes = self.modes.iter();
            match modes.position(|mode| mode.parent == within && holds(mode)) {
                Some(part) if self.is_leaf(part) => return part,
                Some(part) => within = Some(part),
                None => unreachable!("the last part of a mode has no condition"),
            }
        }
    }
}

/// Enums whose variants have names in strategy files, in snake case. Users see their doc comments.
pub trait Named: Copy + Into<&'static str> + VariantArray + EnumMessage {
    /// All variants, in the order of the documentation.
    fn all() -> &'static [Self] {
        Self::VARIANTS
    }

    /// Its name in files.
    fn name(self) -> &'static str {
        self.into()
    }

    /// Its doc comment.
    fn meaning(self) -> &'static str {
        self.get_documentation().unwrap_or_default()
    }

    /// The variant with this name.
    fn by_name(name: &str) -> Option<Self> {
        let mut all = Self::all().iter().copied();
        all.find(|variant| variant.name() == name)
    }

    /// All names, in the order of [`Named::all`].
    fn names() -> Vec<&'static str> {
        Self::all().iter().map(|variant| variant.name()).collect()
    }
}

impl<T: Copy + Into<&'static str> + VariantArray + EnumMessage> Named for T {}
