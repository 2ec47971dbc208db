//! A strategy file as typed.

use super::At;
use schemars::JsonSchema;
use serde::Deserialize;

/// How the boats of a team play.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Squall strategy")]
pub(in crate::scenario) struct RawStrategy {
    /// Another strategy file that this one is laid over, relative to this file.
    #[expect(dead_code, reason = "followed before the files are merged; named here for the schema")]
    pub(in crate::scenario) base: Option<At<String>>,
}
