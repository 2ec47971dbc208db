//! A strategy file as typed.

use super::At;
use crate::scenario::{Assignment, Role};
use schemars::JsonSchema;
use serde::Deserialize;

/// How the boats of a team play: the roles they take, and how each role is played.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Squall strategy")]
pub(in crate::scenario) struct RawStrategy {
    /// Another strategy file that this one is laid over, relative to this file.
    #[expect(dead_code, reason = "followed before the files are merged; named here for the schema")]
    pub(in crate::scenario) base: Option<At<String>>,
    /// Roles, dealt to the team's boats of this strategy in order, again from the start when they run out.
    /// Required: 1 to 1000 of them.
    pub(in crate::scenario) roles: Option<At<Vec<Role>>>,
    /// How they are dealt. Default "fixed".
    pub(in crate::scenario) assignment: Option<Assignment>,
    /// How an easy attacker plays.
    pub(in crate::scenario) easy_attacker: Option<RawEasyAttacker>,
    /// How an easy defender plays.
    pub(in crate::scenario) easy_defender: Option<RawEasyDefender>,
}

/// How an easy attacker plays.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "EasyAttacker")]
pub(in crate::scenario) struct RawEasyAttacker {
    /// Speed, m/s: 0.1 to 60; more than the boat can do is its top speed. Default 5.
    pub(in crate::scenario) speed_m_s: Option<At<f64>>,
}

/// How an easy defender plays: round and round an ellipse.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "EasyDefender")]
pub(in crate::scenario) struct RawEasyDefender {
    /// Speed, m/s: 0.1 to 60. Default 1.4.
    pub(in crate::scenario) speed_m_s: Option<At<f64>>,
    /// The named point of the own team at the centre of the ellipse. Default "CH".
    pub(in crate::scenario) centre: Option<At<String>>,
    /// Full extent of the ellipse along the field, m: 1 to 10000. Default 15.
    pub(in crate::scenario) along_m: Option<At<f64>>,
    /// Full extent of the ellipse across the field, m: 1 to 10000. Default 50.
    pub(in crate::scenario) across_m: Option<At<f64>>,
}
