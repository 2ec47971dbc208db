//! The rules of the game, and the referee that applies them.
//!
//! [`Rules`] are data from `scenarios/rules/*.toml`. Their types declare the keys, as for other
//! scenario files. The [`Referee`] sees positions and time, never physics: the same referee judges
//! a simulation, a replay and a game on real water.

mod ability;
mod boundary;
mod claim;
mod collision;
pub mod count;
mod directive;
mod end;
pub mod event;
pub mod field;
mod flag;
mod home;
mod keepout;
mod obstacle;
mod place;
mod power_play;
mod radii;
mod referee;
mod sharing;
mod standing;
mod tag;

pub use ability::{Ability, tag_wait_s};
pub use directive::Directive;
pub use event::Event;
pub use field::Field;
pub use radii::Radii;
pub use referee::{Asks, Look, Notes, Referee};
pub use sharing::Sharing;
pub use standing::{FlagStanding, Standing, VehicleStanding};

use crate::count::Counts;
use primitives::time::SimTime;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The rules. The defaults are those of `aquaticus_2023`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Rules {
    /// The rules file's stem.
    #[schemars(skip)]
    pub name: String,
    /// Points for a team.
    pub points: Points,
    /// Maximum distance for a grab, m.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 10))]
    pub grab_radius_m: f64,
    /// Maximum distance for a tag, m.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 10))]
    pub tag_radius_m: f64,
    /// Maximum distance from the untag place, m.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 10))]
    pub untag_radius_m: f64,
    /// Maximum distance from the capture place, m; no effect with "own_side".
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 10))]
    pub capture_radius_m: f64,
    /// Distance between centres below which boats collide, m.
    #[schemars(range(min = 0, max = 100), extend("default" = 3))]
    pub collision_distance_m: f64,
    /// Contact between boats; walls and obstacles are always solid.
    #[serde(default)]
    #[schemars(extend("default" = "solid"))]
    pub contact: Contact,
    /// Place to which a flag must be brought.
    #[schemars(extend("default" = "own_flag"))]
    pub capture_at: CaptureAt,
    /// Whether a capture requires the team's own flag to be home.
    #[schemars(extend("default" = false))]
    pub capture_needs_own_flag: bool,
    /// Where a tagged boat is untagged.
    #[schemars(extend("default" = "own_flag"))]
    pub untag_at: UntagAt,
    /// What untags a boat at that place.
    #[schemars(extend("default" = "entering"))]
    pub untag_on: UntagOn,
    /// Minimum time between a boat's tags, s.
    #[schemars(rename = "tag_cooldown_s", with = "f64", range(min = 0, max = 86400))]
    #[schemars(extend("x-field" = "tag_cooldown", "default" = 10))]
    pub tag_cooldown: SimTime,
    /// Which of several intruders within reach is tagged.
    #[schemars(extend("default" = "nearest"))]
    pub tag_choice: TagChoice,
    /// Probability that a tag succeeds. A failed attempt also starts the cooldown.
    #[serde(default = "certain")]
    #[schemars(!default, range(min = 0, max = 1), extend("default" = 1))]
    pub tag_probability: f64,
    /// Order in which simultaneous actions are resolved.
    #[serde(default)]
    #[schemars(extend("default" = "at_once"))]
    pub resolution: Resolution,
    /// Position that determines a boat's side.
    #[serde(default)]
    #[schemars(extend("default" = "after_move"))]
    pub side_judged: SideJudged,
    /// Whether boats within reach tag and grab automatically.
    #[serde(default)]
    #[schemars(extend("default" = "automatic"))]
    pub tags_and_grabs: Acting,
    /// Interval between checks for boundary crossings, tags and collisions, s, a multiple of the
    /// tick; 0: every tick.
    #[serde(default)]
    #[schemars(rename = "tag_look_period_s", with = "f64", !default, range(min = 0, max = 60))]
    #[schemars(extend("x-field" = "tag_look_period", "default" = 0))]
    pub tag_look_period: SimTime,
    /// Interval between checks for grabs, captures and untagging, s, a multiple of the tick; 0:
    /// every tick.
    #[serde(default)]
    #[schemars(rename = "flag_look_period_s", with = "f64", !default, range(min = 0, max = 60))]
    #[schemars(extend("x-field" = "flag_look_period", "default" = 0))]
    pub flag_look_period: SimTime,
    /// Whether a boat that leaves the field is tagged.
    #[schemars(extend("default" = true))]
    pub boundary_tags: bool,
    /// Distance from obstacles and walls below which a boat is tagged and loses its flag, m; 0:
    /// never.
    #[serde(default)]
    #[schemars(!default, range(min = 0, max = 100), extend("default" = 0))]
    pub obstacle_tag_m: f64,
    /// Who drives a tagged boat.
    #[schemars(extend("default" = "drives_itself"))]
    pub tagged_boat: TaggedBoat,
    /// Maximum speed of a tagged boat, as a fraction of its top speed.
    #[schemars(range(min = 0.05, max = 1), extend("default" = 1))]
    pub tagged_speed_factor: f64,
    /// Maximum speed outside the field, as a fraction of top speed.
    #[schemars(range(min = 0.05, max = 1), extend("default" = 1))]
    pub outside_speed_factor: f64,
    /// Limits on a team's information about other boats. Default: no limits.
    #[serde(default)]
    #[schemars(with = "Option<Sharing>", !default, extend("x-drawn" = true))]
    pub sharing: Sharing,
    /// Minimum distance of boats from their own flag while it is home, m; 0: no limit.
    #[schemars(range(min = 0, max = 1000), extend("default" = 0))]
    pub flag_keepout_m: f64,
    /// Score that ends the game; 0: none.
    #[schemars(with = "u32", range(min = 0, max = 1000000), extend("default" = 0))]
    pub win_score: Option<u32>,
    /// Time limit of the game, s.
    #[schemars(rename = "time_limit_s", with = "f64", range(min = 1, max = 86400))]
    #[schemars(extend("x-field" = "time_limit", "default" = 600))]
    pub time_limit: SimTime,
    /// Time for which each team is one boat short, s; 0: none.
    #[schemars(rename = "power_play_s", with = "f64", range(min = 0, max = 86400))]
    #[schemars(extend("x-field" = "power_play", "default" = 0))]
    pub power_play: SimTime,
}

impl Rules {
    /// Distance within which two boats matter to each other under the rules, m: [`Look::near`] must
    /// contain all such pairs.
    pub fn reach_m(&self) -> f64 {
        self.tag_radius_m.max(self.collision_distance_m)
    }
}

fn certain() -> f64 {
    1.0
}

/// Points for a team.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Points {
    /// Per grab.
    #[schemars(range(min = 0, max = 1000), extend("default" = 1))]
    pub grab: u32,
    /// Per capture.
    #[schemars(range(min = 0, max = 1000), extend("default" = 2))]
    pub capture: u32,
    /// Per tag of an opponent; boundary tags do not count.
    #[schemars(range(min = 0, max = 1000), extend("default" = 0))]
    pub tag: u32,
}

impl Points {
    /// The points for these counts.
    pub fn of(&self, counts: &Counts) -> u32 {
        self.grab * counts.grabs + self.capture * counts.captures + self.tag * counts.tags
    }
}

/// The place where a carrier captures a flag.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CaptureAt {
    /// Its own flag's home.
    #[serde(alias = "OwnFlag")]
    OwnFlag,
    /// Its own side: crossing the scrimmage line is enough.
    #[serde(alias = "OwnSide")]
    OwnSide,
    /// Either corner of its own end.
    #[serde(alias = "OwnCorners")]
    OwnCorners,
}

/// Where a tagged boat is untagged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum UntagAt {
    /// Its own flag's home.
    #[serde(alias = "OwnFlag")]
    OwnFlag,
    /// Either corner of its own end.
    #[serde(alias = "OwnCorners")]
    OwnCorners,
}

/// What untags a tagged boat at that place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum UntagOn {
    /// Entering: a boat that was tagged inside must leave and come back.
    #[serde(alias = "Entering")]
    Entering,
    /// Being inside.
    #[serde(alias = "Inside")]
    Inside,
    /// Nothing: the boat stays tagged for the rest of the game.
    Never,
}

/// Which of several intruders within reach is tagged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TagChoice {
    /// The nearest.
    #[serde(alias = "Nearest")]
    Nearest,
    /// The first in the scenario's order.
    #[serde(alias = "First")]
    First,
    /// The nearest with a flag, or else the nearest.
    CarrierFirst,
}

/// Order in which simultaneous actions are resolved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Resolution {
    /// Tags, then grabs, then captures, each judged by the state before it. An intruder or flag
    /// within reach of several boats goes to the nearest boat. Processing order decides only ties.
    #[default]
    AtOnce,
    /// As in Pyquaticus: grabs, then tags, then captures, each in processing order and judged by
    /// the state after earlier boats.
    InTurn,
}

/// The position that determines a boat's side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SideJudged {
    /// The current position.
    #[default]
    AfterMove,
    /// The position before the boat's last move, one physics tick ago, as in Pyquaticus.
    BeforeMove,
}

/// Whether boats tag and grab automatically.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Acting {
    /// Every boat within reach acts.
    #[default]
    Automatic,
    /// Only boats that request it act. A boat sends requests while its team's picture shows a
    /// target within reach; a wrong or late picture causes wrong or late requests.
    OnRequest,
}

/// Contact between boats.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Contact {
    /// Boats collide physically.
    #[default]
    Solid,
    /// Boats pass through each other, as in Pyquaticus. Collisions still count.
    Ghost,
}

/// Who drives a tagged boat.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TaggedBoat {
    /// Its mind.
    #[serde(alias = "DrivesItself")]
    DrivesItself,
    /// The referee: straight home, whatever its mind orders.
    #[serde(alias = "IsDriven")]
    IsDriven,
}
