//! A rules file as typed.

use super::{At, RawSharing};
use crate::rules::{CaptureAt, TagChoice, TaggedBoat, UntagAt, UntagOn};
use schemars::JsonSchema;
use serde::Deserialize;

/// The rules of the game. The defaults are those of `aquaticus_2023`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Squall rules")]
pub(in crate::scenario) struct RawRules {
    /// Another rules file that this one is laid over, relative to this file.
    #[expect(dead_code, reason = "followed before the files are merged; named here for the schema")]
    pub(in crate::scenario) base: Option<At<String>>,
    /// What is worth what.
    pub(in crate::scenario) points: Option<RawPoints>,
    /// A flag is grabbed closer than this, m: 0.1 to 1000. Default 10.
    pub(in crate::scenario) grab_radius_m: Option<At<f64>>,
    /// An intruder is tagged closer than this, m: 0.1 to 1000. Default 10.
    pub(in crate::scenario) tag_radius_m: Option<At<f64>>,
    /// A tagged boat plays again closer than this to its home, m: 0.1 to 1000. Default 10.
    pub(in crate::scenario) untag_radius_m: Option<At<f64>>,
    /// A flag is captured closer than this to the place of capture, m: 0.1 to 1000. Default 10. Means
    /// nothing where the own side is the place.
    pub(in crate::scenario) capture_radius_m: Option<At<f64>>,
    /// Two boats closer than this, centre to centre, have collided, m: 0 to 100. Default 3.
    pub(in crate::scenario) collision_distance_m: Option<At<f64>>,
    /// What a team is shown of other boats. Default all of it, at once.
    pub(in crate::scenario) sharing: Option<At<RawSharing>>,
    /// Where a flag must be brought. Default "own_flag".
    pub(in crate::scenario) capture_at: Option<RawCaptureAt>,
    /// Whether a capture needs the own flag at its home. Default false.
    pub(in crate::scenario) capture_needs_own_flag: Option<At<bool>>,
    /// Where a tagged boat is freed. Default "own_flag".
    pub(in crate::scenario) untag_at: Option<RawUntagAt>,
    /// What frees it there. Default "entering".
    pub(in crate::scenario) untag_on: Option<RawUntagOn>,
    /// How long a boat waits after a successful tag before it can tag again, s: 0 to 86400. Default 10.
    pub(in crate::scenario) tag_cooldown_s: Option<At<f64>>,
    /// Which of several intruders in reach is tagged. Default "nearest".
    pub(in crate::scenario) tag_choice: Option<RawTagChoice>,
    /// Whether leaving the field tags a boat. Default true.
    pub(in crate::scenario) boundary_tags: Option<At<bool>>,
    /// What a tagged boat does. Default "drives_itself".
    pub(in crate::scenario) tagged_boat: Option<RawTaggedBoat>,
    /// Share of its top speed that a tagged boat may use: 0.05 to 1. Default 1.
    pub(in crate::scenario) tagged_speed_factor: Option<At<f64>>,
    /// Share of its top speed that a boat outside of the field may use: 0.05 to 1. Default 1.
    pub(in crate::scenario) outside_speed_factor: Option<At<f64>>,
    /// Boats keep this far from their own flag while it is home, m: 0 to 1000. Default 0, no such rule.
    pub(in crate::scenario) flag_keepout_m: Option<At<f64>>,
    /// The game ends when a team has this score: 0 to 1000000. Default 0, no such rule.
    pub(in crate::scenario) win_score: Option<At<i64>>,
    /// The game ends at this time, s: 1 to 86400. Default 600.
    pub(in crate::scenario) time_limit_s: Option<At<f64>>,
    /// For how long one boat of each team is out of action, s: 0 to 86400. Default 0, no such rule.
    pub(in crate::scenario) power_play_s: Option<At<f64>>,
}

/// What is worth what.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Points")]
pub(in crate::scenario) struct RawPoints {
    /// For a grab: 0 to 1000. Default 1.
    pub(in crate::scenario) grab: Option<At<i64>>,
    /// For a capture: 0 to 1000. Default 2.
    pub(in crate::scenario) capture: Option<At<i64>>,
    /// For tagging an opponent, not for the boundary's tags: 0 to 1000. Default 0.
    pub(in crate::scenario) tag: Option<At<i64>>,
}

/// Where a carrier must come to capture.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "CaptureAt")]
#[expect(clippy::enum_variant_names, reason = "they are the words of the file, and of the checked type")]
pub(in crate::scenario) enum RawCaptureAt {
    /// Its own flag's home.
    OwnFlag,
    /// Its own side: the scrimmage line is enough.
    OwnSide,
    /// Either corner of its own end.
    OwnCorners,
}

/// Where a tagged boat must come to play again.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "UntagAt")]
pub(in crate::scenario) enum RawUntagAt {
    /// Its own flag's home.
    OwnFlag,
    /// Either corner of its own end.
    OwnCorners,
}

/// What frees a tagged boat at its home.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "UntagOn")]
pub(in crate::scenario) enum RawUntagOn {
    /// Coming in: a boat that was tagged inside must leave and come back.
    Entering,
    /// Being there.
    Inside,
}

/// Which of several intruders in reach is tagged.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "TagChoice")]
pub(in crate::scenario) enum RawTagChoice {
    /// The nearest.
    Nearest,
    /// The first in the game's list.
    First,
}

/// What a tagged boat does.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "TaggedBoat")]
pub(in crate::scenario) enum RawTaggedBoat {
    /// Its mind must drive it home.
    DrivesItself,
    /// It is driven straight home, whatever its mind says.
    IsDriven,
}

impl From<RawCaptureAt> for CaptureAt {
    fn from(raw: RawCaptureAt) -> CaptureAt {
        match raw {
            RawCaptureAt::OwnFlag => CaptureAt::OwnFlag,
            RawCaptureAt::OwnSide => CaptureAt::OwnSide,
            RawCaptureAt::OwnCorners => CaptureAt::OwnCorners,
        }
    }
}

impl From<RawUntagAt> for UntagAt {
    fn from(raw: RawUntagAt) -> UntagAt {
        match raw {
            RawUntagAt::OwnFlag => UntagAt::OwnFlag,
            RawUntagAt::OwnCorners => UntagAt::OwnCorners,
        }
    }
}

impl From<RawUntagOn> for UntagOn {
    fn from(raw: RawUntagOn) -> UntagOn {
        match raw {
            RawUntagOn::Entering => UntagOn::Entering,
            RawUntagOn::Inside => UntagOn::Inside,
        }
    }
}

impl From<RawTagChoice> for TagChoice {
    fn from(raw: RawTagChoice) -> TagChoice {
        match raw {
            RawTagChoice::Nearest => TagChoice::Nearest,
            RawTagChoice::First => TagChoice::First,
        }
    }
}

impl From<RawTaggedBoat> for TaggedBoat {
    fn from(raw: RawTaggedBoat) -> TaggedBoat {
        match raw {
            RawTaggedBoat::DrivesItself => TaggedBoat::DrivesItself,
            RawTaggedBoat::IsDriven => TaggedBoat::IsDriven,
        }
    }
}
