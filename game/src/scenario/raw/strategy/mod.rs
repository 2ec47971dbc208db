//! A strategy file as typed.

mod behaviour;
mod goal;
mod guard;
mod value;

pub(in crate::scenario) use behaviour::{COMMON_KEYS, RawBehaviour, RawBehaviours, RawCommon, RawTask, keys_of, kinds};
pub(in crate::scenario) use goal::{
    RawAttractor, RawCutRange, RawEllipse, RawIntercept, RawLoiter, RawShield, RawStationKeep, RawTrail, RawWaypoint,
};
pub(in crate::scenario) use guard::{
    RawAvoidCollision, RawAvoidObstacle, RawConstantHeading, RawConstantSpeed, RawFullStop, RawMaxSpeed,
    RawMemoryTurnLimit, RawOpRegion, RawPolicy, RawTimer,
};
pub(in crate::scenario) use value::{Amount, Given, RawVariable, Stated};

use super::At;
use crate::strategy::Assignment;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Values given to variables, by their names.
pub(in crate::scenario) type RawSet = BTreeMap<String, At<Given>>;

/// How the boats of a team play: either roles and how they are dealt, or the program that everybody follows.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Squall strategy")]
pub(in crate::scenario) struct RawStrategy {
    /// Another strategy file that this one is laid over, relative to this file.
    #[expect(dead_code, reason = "followed before the files are merged; named here for the schema")]
    pub(in crate::scenario) base: Option<At<String>>,
    /// What the strategy is, in a line. Default "".
    pub(in crate::scenario) about: Option<At<String>>,
    /// The files of the programs, relative to this file, dealt to the team's boats in turn, again from the start:
    /// 1 to 1000 of them. Without it this file is itself a program.
    pub(in crate::scenario) roles: Option<At<Vec<At<String>>>>,
    /// How roles are dealt. Default "fixed".
    pub(in crate::scenario) assignment: Option<At<Assignment>>,
    /// How decisions are made.
    pub(in crate::scenario) helm: Option<At<RawHelm>>,
    /// Lets modes go without op_region or avoid_collision. Default false.
    pub(in crate::scenario) unsafe_i_know: Option<At<bool>>,
    /// Why they may. Required with unsafe_i_know.
    pub(in crate::scenario) unsafe_because: Option<At<String>>,
    /// Variables, by name: a number, true or false, or a table.
    pub(in crate::scenario) variables: Option<At<BTreeMap<String, At<RawVariable>>>>,
    /// Modes, parents before their parts: of the parts of a mode the first whose condition holds is the one. Default a
    /// single mode, "active".
    pub(in crate::scenario) mode: Option<At<Vec<At<RawMode>>>>,
    /// What the helm weighs against each other, by name.
    #[serde(default)]
    pub(in crate::scenario) behaviour: RawBehaviours,
    /// What gives values to variables at every decision, in order.
    pub(in crate::scenario) rule: Option<At<Vec<At<RawRule>>>>,
}

/// How decisions are made.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Helm")]
pub(in crate::scenario) struct RawHelm {
    /// How many courses are weighed against each other: 8 to 3600. Default 360.
    pub(in crate::scenario) courses: Option<At<i64>>,
    /// How many speeds, from 0 to the highest: 2 to 1000. Default 36.
    pub(in crate::scenario) speeds: Option<At<i64>>,
    /// The highest speed, m/s: 0.1 to 60, but never more than the boat's own. Default the boat's own.
    pub(in crate::scenario) speed_max_m_s: Option<At<f64>>,
    /// The last decision stands while it is worth this share less than the best at most: 0 to 0.1. Default 0.
    pub(in crate::scenario) hysteresis: Option<At<f64>>,
}

/// A mode: what the boat is at.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Mode")]
pub(in crate::scenario) struct RawMode {
    /// Its name, unique in the program. Required.
    pub(in crate::scenario) name: Option<At<String>>,
    /// The mode that it is a part of; that one stands before it. Default none.
    pub(in crate::scenario) r#in: Option<At<String>>,
    /// The condition for it, an expression. Required, but for the last part of a mode, which has none.
    pub(in crate::scenario) when: Option<At<String>>,
    /// Values given to variables when it begins.
    pub(in crate::scenario) set: Option<RawSet>,
}

/// Gives values to variables.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Rule")]
pub(in crate::scenario) struct RawRule {
    /// Only at this event: who and what, as in "enemy grabs". Required, or when.
    pub(in crate::scenario) on: Option<At<String>>,
    /// Only where this expression is true. Required, or on.
    pub(in crate::scenario) when: Option<At<String>>,
    /// The values, by the names of the variables. Required.
    pub(in crate::scenario) set: Option<RawSet>,
}
