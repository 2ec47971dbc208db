//! Strategies: how the boats of a team play, as data.
//!
//! A [`Strategy`] deals [`Program`]s to the boats of a team. A program is what one boat's helm goes by: variables, a
//! tree of modes, behaviours, and rules that give values to variables.

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
pub use policy::{Policy, Proposer};
pub use task::{
    Attractor, AvoidCollision, AvoidObstacle, BeyondHalt, ConstantHeading, ConstantSpeed, Contacts, CutRange, Ellipse,
    FullStop, Grade, Intercept, Loiter, MaxSpeed, MemoryTurnLimit, OpRegion, Shape, Shield, StationKeep, Task, Timer,
    Trail, Turn, Waypoint,
};

use crate::policy::PolicyModel;
use serde::{Deserialize, Serialize};
use strum::{EnumMessage, IntoStaticStr, VariantArray};

/// The most contacts or obstacles that one behaviour responds to at a time: the nearest.
pub const NEAREST_MAX: usize = 16;
/// The most functions that the behaviours of a mode may ask for together, each contact or obstacle counted.
pub const FUNCTIONS_MAX: usize = 256;
/// The most shared variables of a program.
pub const SHARED_MAX: usize = 256;

/// How the boats of a team play.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Strategy {
    /// The strategy file's stem.
    pub name: String,
    /// What the strategy is, in the file's words.
    pub about: String,
    /// The programs, dealt to the team's boats of this strategy in order, again from the start when they run out.
    pub roles: Vec<Program>,
    /// How they are dealt.
    pub assignment: Assignment,
}

/// How roles are dealt to a team's boats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Assignment {
    /// In the order of the scenario's vehicles.
    Fixed,
    /// In an order drawn from the team's own stream.
    Seeded,
}

/// What one boat's helm goes by.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Program {
    /// The stem of the file it is from.
    pub name: String,
    /// What the program is, in the file's words.
    pub about: String,
    /// How decisions are made.
    pub helm: Helm,
    /// Its variables.
    pub variables: Vec<Variable>,
    /// Its modes, parents before children, siblings in order; at least one.
    pub modes: Vec<Mode>,
    /// Its behaviours, by name.
    pub behaviours: Vec<Behaviour>,
    /// What gives values to variables, in order.
    pub rules: Vec<Rule>,
    /// Why a mode may do without `op_region` or `avoid_collision`, if one does.
    pub unsafe_because: Option<String>,
}

/// How decisions are made.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Helm {
    /// How many courses are weighed against each other.
    #[schemars(range(min = 8, max = 3600), extend("default" = 360))]
    pub courses: usize,
    /// How many speeds, from 0 to the highest.
    #[schemars(range(min = 2, max = 1000), extend("default" = 36))]
    pub speeds: usize,
    /// The highest speed, m/s, but never more than the boat's own. Default the boat's own.
    #[schemars(range(min = 0.1, max = 60))]
    pub speed_max_m_s: Option<f64>,
    /// What is near the last decision (30 degrees, 0.75 m/s) is worth this share of all weights more: more would outweigh safety.
    #[schemars(range(min = 0, max = 0.1), extend("default" = 0))]
    pub hysteresis: f64,
    /// Whether it makes up for the drift and for the lasting error of the heading, as it sees them. Without, course and
    /// speed over the ground differ from those that behaviours ask for.
    #[schemars(rename = "compensate_drift", extend("x-field" = "compensates_drift", "default" = true))]
    pub compensates_drift: bool,
}

/// A variable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// What it can be.
    pub kind: Kind,
    /// What it is at first: see [`Expression`] for how truths and texts are numbers.
    pub initial: f64,
    /// Whether the team is told of it.
    pub shared: bool,
}

/// A mode: what the boat is at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mode {
    /// Its name, unique in the program.
    pub name: String,
    /// The mode it is a part of, by index; parents stand before their children.
    pub parent: Option<usize>,
    /// Of the parts of a mode the first whose condition holds is the one; the last of them has none.
    pub when: Option<Expression>,
    /// Given to variables when the mode begins.
    pub enter: Vec<(u16, Expression)>,
}

/// Gives values to variables.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rule {
    /// Only at this event.
    pub on: Option<Trigger>,
    /// Only where this holds.
    pub when: Option<Expression>,
    /// The variables, by index, and their new values.
    pub set: Vec<(u16, Expression)>,
}

/// An event that a rule waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Trigger {
    /// To whom it happens.
    pub who: Who,
    /// What happens.
    pub what: What,
}

/// To whom something happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantArray, IntoStaticStr, EnumMessage)]
#[strum(serialize_all = "snake_case")]
pub enum Who {
    /// The own boat.
    I,
    /// Another boat of the own team.
    Mate,
    /// An enemy.
    Enemy,
}

/// What happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantArray, IntoStaticStr, EnumMessage)]
#[strum(serialize_all = "snake_case")]
#[expect(missing_docs, reason = "each says it itself")]
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
    /// The models that its programs ask.
    pub fn models(&self) -> impl Iterator<Item = &PolicyModel> {
        self.roles.iter().flat_map(Program::models)
    }

    /// Whether a person may steer boats that play it.
    #[must_use]
    pub fn is_steered(&self) -> bool {
        self.roles.iter().any(|role| role.proposer() == Some(Proposer::Person))
    }
}

impl Program {
    /// The models that it asks.
    pub fn models(&self) -> impl Iterator<Item = &PolicyModel> {
        self.behaviours.iter().filter_map(|behaviour| match &behaviour.task {
            Task::Policy(policy) => policy.model.as_ref(),
            _ => None,
        })
    }

    /// Who proposes courses and speeds from outside, if the program lets anybody.
    #[must_use]
    pub fn proposer(&self) -> Option<Proposer> {
        self.behaviours.iter().find_map(|behaviour| match &behaviour.task {
            Task::Policy(policy) if policy.model.is_none() && policy.sets.is_none() => Some(policy.by),
            _ => None,
        })
    }

    /// The variable that whoever is outside gives one of its texts to, by index, if the program has options.
    #[must_use]
    pub fn options(&self) -> Option<u16> {
        self.behaviours.iter().find_map(|behaviour| match &behaviour.task {
            Task::Policy(policy) if policy.model.is_none() => policy.sets,
            _ => None,
        })
    }

    /// The texts of a variable; none if it has other values.
    #[must_use]
    pub fn texts(&self, variable: u16) -> &[String] {
        match &self.variables[usize::from(variable)].kind {
            Kind::Text(texts) => texts,
            _ => &[],
        }
    }

    /// Whether a mode has no parts.
    #[must_use]
    pub fn is_leaf(&self, mode: usize) -> bool {
        self.modes.iter().all(|other| other.parent != Some(mode))
    }

    /// The modes without parts, by index, in order.
    pub fn leaves(&self) -> impl Iterator<Item = usize> {
        (0..self.modes.len()).filter(|mode| self.is_leaf(*mode))
    }

    /// The mode's name with those of the modes it is a part of, outermost first: `defending:intercepting`.
    #[must_use]
    pub fn path(&self, mode: usize) -> String {
        let name = &self.modes[mode].name;
        self.modes[mode].parent.map_or_else(|| name.clone(), |parent| format!("{}:{name}", self.path(parent)))
    }

    /// The leaf that the conditions choose.
    ///
    /// # Panics
    /// If the last part of a mode has a condition, which no checked program has.
    #[must_use]
    pub fn leaf(&self, values: &impl Values) -> usize {
        let mut within = None;
        loop {
            let holds = |mode: &Mode| mode.when.as_ref().is_none_or(|when| when.is_true(values));
            let part = self.modes.iter().position(|mode| mode.parent == within && holds(mode));
            match part {
                Some(part) if self.is_leaf(part) => return part,
                Some(part) => within = Some(part),
                None => unreachable!("the last part of a mode has no condition"),
            }
        }
    }
}

/// What strategy files call by a name: the variant's, in snake case. Its doc comment is what people read about it.
pub trait Named: Copy + Into<&'static str> + VariantArray + EnumMessage {
    /// All of them, in the order in which they are explained.
    fn all() -> &'static [Self] {
        Self::VARIANTS
    }

    /// Its name in files.
    fn name(self) -> &'static str {
        self.into()
    }

    /// What it is.
    fn meaning(self) -> &'static str {
        self.get_documentation().unwrap_or_default()
    }

    /// The one called so.
    fn by_name(name: &str) -> Option<Self> {
        Self::all().iter().copied().find(|variant| variant.name() == name)
    }

    /// All names, in the same order.
    fn names() -> Vec<&'static str> {
        Self::all().iter().map(|variant| variant.name()).collect()
    }
}

impl<T: Copy + Into<&'static str> + VariantArray + EnumMessage> Named for T {}
