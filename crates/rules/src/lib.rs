//! The rules of the game, and the referee that applies them.
//!
//! [`Rules`] are data from `scenarios/rules/*.toml`. Their types declare the keys, as for other
//! scenario files. The [`Referee`] sees positions and time, never physics: the same referee judges
//! a simulation, a replay and a game on real water.

mod ability;
mod ask;
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
mod place;
mod power_play;
mod referee;
mod sharing;
mod standing;
mod tag;

pub use ability::{Ability, tag_wait_s};
pub use ask::Asks;
pub use directive::Directive;
pub use event::Event;
pub use field::Field;
pub use referee::{Look, Notes, Referee};
pub use sharing::Sharing;
pub use standing::{FlagStanding, Standing, VehicleStanding};

use crate::count::Counts;
use primitives::time::SimTime;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The rules of the game. The defaults are those of `aquaticus_2023`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Rules {
    /// The rules file's stem.
    #[schemars(skip)]
    pub name: String,
    /// What is worth what.
    pub points: Points,
    /// A flag is grabbed closer than this, m.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 10))]
    pub grab_radius_m: f64,
    /// An intruder is tagged closer than this, m.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 10))]
    pub tag_radius_m: f64,
    /// A tagged boat plays again closer than this to its home, m.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 10))]
    pub untag_radius_m: f64,
    /// A flag is captured closer than this to the place of capture, m. Means nothing where the own side is the place.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 10))]
    pub capture_radius_m: f64,
    /// Two boats closer than this, centre to centre, have collided, m.
    #[schemars(range(min = 0, max = 100), extend("default" = 3))]
    pub collision_distance_m: f64,
    /// What boats are to each other. Walls and obstacles are solid to all.
    #[serde(default)]
    #[schemars(extend("default" = "solid"))]
    pub contact: Contact,
    /// Where a flag must be brought.
    #[schemars(extend("default" = "own_flag"))]
    pub capture_at: CaptureAt,
    /// Whether a capture needs the own flag at its home.
    #[schemars(extend("default" = false))]
    pub capture_needs_own_flag: bool,
    /// Where a tagged boat is freed.
    #[schemars(extend("default" = "own_flag"))]
    pub untag_at: UntagAt,
    /// What frees it there.
    #[schemars(extend("default" = "entering"))]
    pub untag_on: UntagOn,
    /// How long a boat waits after a successful tag before it can tag again, s.
    #[schemars(rename = "tag_cooldown_s", with = "f64", range(min = 0, max = 86400))]
    #[schemars(extend("x-field" = "tag_cooldown", "default" = 10))]
    pub tag_cooldown: SimTime,
    /// Which of several intruders in reach is tagged.
    #[schemars(extend("default" = "nearest"))]
    pub tag_choice: TagChoice,
    /// How what happens at one moment is resolved.
    #[serde(default)]
    #[schemars(extend("default" = "at_once"))]
    pub resolution: Resolution,
    /// Where a boat is judged to be when its side counts: for tags, and for captures on the own side.
    #[serde(default)]
    #[schemars(extend("default" = "after_move"))]
    pub side_judged: SideJudged,
    /// Whether boats tag and grab by being in reach, or must ask for it.
    #[serde(default)]
    #[schemars(extend("default" = "automatic"))]
    pub tags_and_grabs: Acting,
    /// Time between the referee's looks at boundary, tags and collisions, s, a multiple of the physics tick; 0 is every
    /// tick.
    #[serde(default)]
    #[schemars(rename = "tag_look_period_s", with = "f64", !default, range(min = 0, max = 60))]
    #[schemars(extend("x-field" = "tag_look_period", "default" = 0))]
    pub tag_look_period: SimTime,
    /// Time between the referee's looks at grabs, captures and boats that come home, s, a multiple of the physics tick; 0 is
    /// every tick.
    #[serde(default)]
    #[schemars(rename = "flag_look_period_s", with = "f64", !default, range(min = 0, max = 60))]
    #[schemars(extend("x-field" = "flag_look_period", "default" = 0))]
    pub flag_look_period: SimTime,
    /// Whether leaving the field tags a boat.
    #[schemars(extend("default" = true))]
    pub boundary_tags: bool,
    /// What a tagged boat does.
    #[schemars(extend("default" = "drives_itself"))]
    pub tagged_boat: TaggedBoat,
    /// Share of its top speed that a tagged boat may use.
    #[schemars(range(min = 0.05, max = 1), extend("default" = 1))]
    pub tagged_speed_factor: f64,
    /// Share of its top speed that a boat outside of the field may use.
    #[schemars(range(min = 0.05, max = 1), extend("default" = 1))]
    pub outside_speed_factor: f64,
    /// What a team is shown of other boats. Without it, all of it and at once.
    #[serde(default)]
    #[schemars(with = "Option<Sharing>", !default, extend("x-drawn" = true))]
    pub sharing: Sharing,
    /// Boats keep this far from their own flag while it is home, m; 0 is no such rule.
    #[schemars(range(min = 0, max = 1000), extend("default" = 0))]
    pub flag_keepout_m: f64,
    /// The game ends when a team has this score; 0 is no such rule.
    #[schemars(with = "u32", range(min = 0, max = 1000000), extend("default" = 0))]
    pub win_score: Option<u32>,
    /// The game ends at this time, s.
    #[schemars(rename = "time_limit_s", with = "f64", range(min = 1, max = 86400))]
    #[schemars(extend("x-field" = "time_limit", "default" = 600))]
    pub time_limit: SimTime,
    /// For how long one boat of each team is out of action, s; 0 is no such rule.
    #[schemars(rename = "power_play_s", with = "f64", range(min = 0, max = 86400))]
    #[schemars(extend("x-field" = "power_play", "default" = 0))]
    pub power_play: SimTime,
}

impl Rules {
    /// Distance at which two boats become relevant to each other by the rules, m: the reach of
    /// `near` in [`Referee::advance`].
    #[must_use]
    pub fn reach_m(&self) -> f64 {
        self.tag_radius_m.max(self.collision_distance_m)
    }
}

/// What is worth what.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Points {
    /// For a grab.
    #[schemars(range(min = 0, max = 1000), extend("default" = 1))]
    pub grab: u32,
    /// For a capture.
    #[schemars(range(min = 0, max = 1000), extend("default" = 2))]
    pub capture: u32,
    /// For tagging an opponent, not for the boundary's tags.
    #[schemars(range(min = 0, max = 1000), extend("default" = 0))]
    pub tag: u32,
}

impl Points {
    /// The points for these counts.
    #[must_use]
    pub fn of(&self, counts: &Counts) -> u32 {
        self.grab * counts.grabs + self.capture * counts.captures + self.tag * counts.tags
    }
}

/// Where a carrier must come to capture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CaptureAt {
    /// Its own flag's home.
    #[serde(alias = "OwnFlag")]
    OwnFlag,
    /// Its own side: the scrimmage line is enough.
    #[serde(alias = "OwnSide")]
    OwnSide,
    /// Either corner of its own end.
    #[serde(alias = "OwnCorners")]
    OwnCorners,
}

/// Where a tagged boat must come to play again.
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

/// What frees a tagged boat at its home.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum UntagOn {
    /// Coming in: a boat that was tagged inside must leave and come back.
    #[serde(alias = "Entering")]
    Entering,
    /// Being there.
    #[serde(alias = "Inside")]
    Inside,
}

/// Which of several intruders in reach is tagged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TagChoice {
    /// The nearest.
    #[serde(alias = "Nearest")]
    Nearest,
    /// The first in the game's list.
    #[serde(alias = "First")]
    First,
}

/// How what happens at one moment is resolved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Resolution {
    /// Tags, grabs, captures, each judged from how things stood before it. Of several boats that reach the same intruder or
    /// flag the nearest has it, and a boat that comes second has nothing at that moment: the order of the list counts
    /// between equals only.
    #[default]
    AtOnce,
    /// As in Pyquaticus: grabs, tags, captures, and in each the boats in the game's order, each with what those before
    /// it have left.
    InTurn,
}

/// Where a boat is judged to be when its side counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SideJudged {
    /// Where it is.
    #[default]
    AfterMove,
    /// Where it was before it moved, a physics tick ago: as in Pyquaticus.
    BeforeMove,
}

/// How boats come to tag and grab.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Acting {
    /// Whoever is in reach does.
    #[default]
    Automatic,
    /// Only who asks. A boat asks as long as it is in reach by what its team's picture shows of it and of others: where
    /// that is wrong or late, so is the request.
    OnRequest,
}

/// What boats are to each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Contact {
    /// They bump into each other.
    #[default]
    Solid,
    /// They pass through each other, as in Pyquaticus. That they were too close is noted all the same.
    Ghost,
}

/// What a tagged boat does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TaggedBoat {
    /// Its mind must drive it home.
    #[serde(alias = "DrivesItself")]
    DrivesItself,
    /// It is driven straight home, whatever its mind says.
    #[serde(alias = "IsDriven")]
    IsDriven,
}
