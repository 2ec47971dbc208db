//! Behaviours that keep the boat out of trouble or hold something, as typed.

use super::Amount;
use crate::scenario::raw::At;
use crate::strategy::{Contacts, Grade, Proposer};
use schemars::JsonSchema;
use serde::Deserialize;

/// Keeps clear of other boats, by closest point of approach: one wish for each contact.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawAvoidCollision {
    /// Which boats. Default "all".
    pub(in crate::scenario) contacts: Option<At<Contacts>>,
    /// Nearer than this it has its full weight, m: 0 to 10000. Default 9.
    pub(in crate::scenario) inner_m: Option<At<Amount>>,
    /// Farther than this it has none, m: 0 to 10000. Default 15.
    pub(in crate::scenario) outer_m: Option<At<Amount>>,
    /// A closest point of approach of this is worth half, a nearer one less, m: 0 to 10000. Default 3.
    pub(in crate::scenario) cpa_min_m: Option<At<Amount>>,
    /// One of this or more is worth everything, m: 0 to 10000. Default 6.
    pub(in crate::scenario) cpa_max_m: Option<At<Amount>>,
    /// How long a course is thought to be held, s: 0.1 to 600. Default 20.
    pub(in crate::scenario) time_on_leg_s: Option<At<Amount>>,
    /// How the weight falls from the inner to the outer distance. Default "linear".
    pub(in crate::scenario) grade: Option<At<Grade>>,
}

/// Keeps clear of the field's obstacles.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawAvoidObstacle {
    /// Nearer than this to the edge it has its full weight, m: 0 to 10000. Default 4.
    pub(in crate::scenario) inner_m: Option<At<Amount>>,
    /// Farther than this it has none, m: 0 to 10000. Default 15.
    pub(in crate::scenario) outer_m: Option<At<Amount>>,
    /// A pass of this is worth half, a nearer one less, m: 0 to 10000. Default 1.
    pub(in crate::scenario) cpa_min_m: Option<At<Amount>>,
    /// One of this or more is worth everything, m: 0 to 10000. Default 4.
    pub(in crate::scenario) cpa_max_m: Option<At<Amount>>,
    /// How long a course is thought to be held, s: 0.1 to 600. Default 20.
    pub(in crate::scenario) time_on_leg_s: Option<At<Amount>>,
}

/// Keeps the boat on the field, and brings it back slowly if it got out.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawOpRegion {
    /// The region is the field shrunk by this, m: -1000 to 1000. Default 0; less is wider.
    pub(in crate::scenario) margin_m: Option<At<Amount>>,
    /// Nearer than this to the edge, inside, it turns away from courses that lead out, m: 0 to 1000. Default 6.
    pub(in crate::scenario) save_m: Option<At<Amount>>,
    /// Farther out than this the boat stops, m: 0 to 100000. Default 30.
    pub(in crate::scenario) halt_m: Option<At<Amount>>,
    /// How long a boat is out before it counts as out, s: 0 to 600. Default 1.
    pub(in crate::scenario) exit_s: Option<At<Amount>>,
    /// How long it is in again before it counts as in, s: 0 to 600. Default 1.
    pub(in crate::scenario) entry_s: Option<At<Amount>>,
    /// How fast it comes back, m/s: 0 to 60. Default 0.5.
    pub(in crate::scenario) recovery_speed_m_s: Option<At<Amount>>,
    /// It turns away when a course leads out sooner than this, s: 0 to 600. Default 6.
    pub(in crate::scenario) lookahead_s: Option<At<Amount>>,
}

/// Slows down near other boats.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawMaxSpeed {
    /// The speed allowed, m/s: 0 to 60. Required.
    pub(in crate::scenario) speed_m_s: Option<At<Amount>>,
    /// How much above it is worth nothing, m/s: 0 to 60. Default 0.5.
    pub(in crate::scenario) tolerance_m_s: Option<At<Amount>>,
    /// Only while a boat is nearer than this, m: 0 to 10000. Default 20; 0 is always.
    pub(in crate::scenario) range_m: Option<At<Amount>>,
    /// Only for boats within this angle of the bow on either side, degrees: 0 to 180. Default 55.
    pub(in crate::scenario) angle_deg: Option<At<Amount>>,
    /// Which boats. Default "all".
    pub(in crate::scenario) contacts: Option<At<Contacts>>,
}

/// Holds a heading.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawConstantHeading {
    /// The heading, compass degrees: -360 to 360. Required.
    pub(in crate::scenario) heading_deg: Option<At<Amount>>,
    /// Half width of the peak, degrees: 0 to 180. Default 10.
    pub(in crate::scenario) peak_width_deg: Option<At<Amount>>,
    /// From the peak down to nothing, degrees: 0 to 180. Default 170.
    pub(in crate::scenario) base_width_deg: Option<At<Amount>>,
}

/// Holds a speed.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawConstantSpeed {
    /// The speed, m/s: 0 to 60. Required.
    pub(in crate::scenario) speed_m_s: Option<At<Amount>>,
    /// Half width of the peak, m/s: 0 to 60. Default 0.
    pub(in crate::scenario) peak_width_m_s: Option<At<Amount>>,
    /// From the peak down to nothing, m/s: 0 to 60. Default 0.2.
    pub(in crate::scenario) base_width_m_s: Option<At<Amount>>,
}

/// Discourages turns away from the mean heading of the last while.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawMemoryTurnLimit {
    /// How long it remembers, s: 0.1 to 600. Default 20.
    pub(in crate::scenario) memory_s: Option<At<Amount>>,
    /// How far a turn costs nothing, degrees to either side: 0 to 180. Default 45.
    pub(in crate::scenario) turn_range_deg: Option<At<Amount>>,
}

/// Does nothing but wait: complete when its duration_s is over, which is required.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawTimer {}

/// Would like the boat to lie still; safety may move it all the same.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawFullStop {}

/// Lets a policy outside of the helm propose course and speed, weighed with everything else.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawPolicy {
    /// Who proposes: `program` is waited for in lockstep, `person` (somebody at the page) is not. Default `program`.
    pub(in crate::scenario) by: Option<At<Proposer>>,
    /// A proposal older than this is not heard any more, s: 0.01 to 600. Default 1.
    pub(in crate::scenario) ttl_s: Option<At<Amount>>,
    /// Half width of the peak at the proposed course, degrees: 0 to 180. Default 10.
    pub(in crate::scenario) peak_width_deg: Option<At<Amount>>,
    /// From there down to nothing, degrees: 0 to 180. Default 60.
    pub(in crate::scenario) base_width_deg: Option<At<Amount>>,
    /// How much course counts against speed: 0 to 1. Default 0.5.
    pub(in crate::scenario) course_share: Option<At<Amount>>,
}
