//! A rules file as typed.

use super::Sharing;
use crate::rules::{CaptureAt, Points, TagChoice, TaggedBoat, UntagAt, UntagOn};
use schemars::JsonSchema;
use serde::Deserialize;

/// The rules of the game. The defaults are those of `aquaticus_2023`.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Rules {
    /// What is worth what.
    pub(crate) points: Points,
    /// A flag is grabbed closer than this, m.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 10))]
    pub(crate) grab_radius_m: f64,
    /// An intruder is tagged closer than this, m.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 10))]
    pub(crate) tag_radius_m: f64,
    /// A tagged boat plays again closer than this to its home, m.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 10))]
    pub(crate) untag_radius_m: f64,
    /// A flag is captured closer than this to the place of capture, m. Means nothing where the own side is the place.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 10))]
    pub(crate) capture_radius_m: f64,
    /// Two boats closer than this, centre to centre, have collided, m.
    #[schemars(range(min = 0, max = 100), extend("default" = 3))]
    pub(crate) collision_distance_m: f64,
    /// What a team is shown of other boats. Without it, all of it and at once.
    #[schemars(extend("x-drawn" = true))]
    pub(crate) sharing: Option<Sharing>,
    /// Where a flag must be brought.
    #[schemars(extend("default" = "own_flag"))]
    pub(crate) capture_at: CaptureAt,
    /// Whether a capture needs the own flag at its home.
    #[schemars(extend("default" = false))]
    pub(crate) capture_needs_own_flag: bool,
    /// Where a tagged boat is freed.
    #[schemars(extend("default" = "own_flag"))]
    pub(crate) untag_at: UntagAt,
    /// What frees it there.
    #[schemars(extend("default" = "entering"))]
    pub(crate) untag_on: UntagOn,
    /// How long a boat waits after a successful tag before it can tag again, s.
    #[schemars(range(min = 0, max = 86400), extend("default" = 10))]
    pub(crate) tag_cooldown_s: f64,
    /// Which of several intruders in reach is tagged.
    #[schemars(extend("default" = "nearest"))]
    pub(crate) tag_choice: TagChoice,
    /// Whether leaving the field tags a boat.
    #[schemars(extend("default" = true))]
    pub(crate) boundary_tags: bool,
    /// What a tagged boat does.
    #[schemars(extend("default" = "drives_itself"))]
    pub(crate) tagged_boat: TaggedBoat,
    /// Share of its top speed that a tagged boat may use.
    #[schemars(range(min = 0.05, max = 1), extend("default" = 1))]
    pub(crate) tagged_speed_factor: f64,
    /// Share of its top speed that a boat outside of the field may use.
    #[schemars(range(min = 0.05, max = 1), extend("default" = 1))]
    pub(crate) outside_speed_factor: f64,
    /// Boats keep this far from their own flag while it is home, m; 0 is no such rule.
    #[schemars(range(min = 0, max = 1000), extend("default" = 0))]
    pub(crate) flag_keepout_m: f64,
    /// The game ends when a team has this score; 0 is no such rule.
    #[schemars(range(min = 0, max = 1000000), extend("default" = 0))]
    pub(crate) win_score: u32,
    /// The game ends at this time, s.
    #[schemars(range(min = 1, max = 86400), extend("default" = 600))]
    pub(crate) time_limit_s: f64,
    /// For how long one boat of each team is out of action, s; 0 is no such rule.
    #[schemars(range(min = 0, max = 86400), extend("default" = 0))]
    pub(crate) power_play_s: f64,
}
