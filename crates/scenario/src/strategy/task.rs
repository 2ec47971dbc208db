//! The tasks of behaviours: one type per kind, with its keys as in files.
//!
//! Each key is declared once, here. Its doc comment gives its meaning and unit; `range` and
//! `length` give the allowed values, `default` the value of an omitted key. The schema of these
//! types is used to check files, for completion in editors, and for the reference page.

use super::{Boat, Parameter, Place, Policy};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use strum::IntoStaticStr;

/// What a behaviour does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, IntoStaticStr, JsonSchema)]
#[strum(serialize_all = "snake_case")]
#[schemars(rename_all = "snake_case")]
#[expect(missing_docs, reason = "each says it itself")]
pub enum Task {
    Waypoint(Waypoint),
    Loiter(Loiter),
    StationKeep(StationKeep),
    CutRange(CutRange),
    Trail(Trail),
    Intercept(Intercept),
    Shield(Shield),
    Attractor(Attractor),
    AvoidCollision(AvoidCollision),
    AvoidObstacle(AvoidObstacle),
    OpRegion(OpRegion),
    MaxSpeed(MaxSpeed),
    ConstantHeading(ConstantHeading),
    ConstantSpeed(ConstantSpeed),
    MemoryTurnLimit(MemoryTurnLimit),
    Timer(Timer),
    FullStop(FullStop),
    Policy(Policy),
}

impl Task {
    /// The kind's name in files.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        self.into()
    }

    /// Whether it is a safety behaviour, which has a greater default weight.
    #[must_use]
    pub fn is_safety(&self) -> bool {
        matches!(self, Task::OpRegion(_) | Task::AvoidCollision(_) | Task::AvoidObstacle(_))
    }
}

/// Drives along a list of points, and is complete at the last.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Waypoint {
    /// The points, in order, each a place.
    #[schemars(length(min = 1, max = 1000), extend("x-expected" = "1 to 1000 places"))]
    pub points: Vec<Place>,
    /// Drives the list backwards.
    #[schemars(extend("default" = false))]
    pub reverse: bool,
    /// How often the list is driven again after the first time.
    #[schemars(range(min = 0, max = 1_000_000), extend("default" = 0))]
    pub repeat: Parameter,
    /// Desired speed, m/s. More than the boat can do is its top speed.
    #[schemars(range(min = 0, max = 60), extend("default" = 5))]
    pub speed_m_s: Parameter,
    /// A point nearer than this is reached, m.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 3))]
    pub capture_radius_m: Parameter,
    /// A point within this that draws away again is reached, m.
    #[schemars(range(min = 0, max = 1000), extend("default" = 15))]
    pub slip_radius_m: Parameter,
    /// Steers for the point of the line between two points that lies this far ahead, m; 0 for the next point.
    #[schemars(range(min = 0, max = 1000), extend("default" = 0))]
    pub lead_m: Parameter,
    /// How much course counts against speed.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.5))]
    pub course_share: Parameter,
}

/// Drives round and round a convex polygon.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Loiter {
    /// Its shape.
    #[schemars(flatten, with = "ShapeKeys")]
    pub shape: Shape,
    /// Which way round.
    #[schemars(extend("default" = "best"))]
    pub turn: Turn,
    /// Desired speed, m/s. More than the boat can do is its top speed.
    #[schemars(range(min = 0, max = 60), extend("default" = 5))]
    pub speed_m_s: Parameter,
    /// A corner nearer than this is passed, m.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 3))]
    pub capture_radius_m: Parameter,
    /// A corner within this that draws away again is passed, m.
    #[schemars(range(min = 0, max = 1000), extend("default" = 15))]
    pub slip_radius_m: Parameter,
    /// Farther than this from the polygon it goes there first, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 10))]
    pub acquire_m: Parameter,
}

/// A convex polygon.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Shape {
    /// By its corners, in order.
    Corners(Vec<Place>),
    /// An ellipse.
    Ellipse(Ellipse),
}

/// The keys for a shape: one of them is needed.
#[derive(JsonSchema)]
struct ShapeKeys {
    /// Its corners, in order, each a place. Either this is needed or `ellipse`.
    #[schemars(length(min = 3, max = 1000), extend("x-expected" = "3 to 1000 places"))]
    #[expect(dead_code, reason = "only the schema is used")]
    polygon: Option<Vec<Place>>,
    /// An ellipse instead.
    #[expect(dead_code, reason = "only the schema is used")]
    ellipse: Option<Ellipse>,
}

/// Which way round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Turn {
    /// With the hands of a clock, seen from above.
    Clockwise,
    /// Against them.
    Counterclockwise,
    /// As the boat heads when it comes.
    Best,
}

/// An ellipse with axes along and across the field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Ellipse {
    /// Its centre, a place.
    pub centre: Place,
    /// Full extent along the field, m.
    #[schemars(range(min = 1, max = 10_000))]
    pub along_m: f64,
    /// Full extent across it, m.
    #[schemars(range(min = 1, max = 10_000))]
    pub across_m: f64,
    /// By how many corners.
    #[schemars(range(min = 3, max = 1000), extend("default" = 24))]
    pub corners: usize,
}

/// Holds a place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StationKeep {
    /// The place; without it, where the boat is when it begins.
    pub at: Option<Place>,
    /// Within this it does nothing, m.
    #[schemars(range(min = 0, max = 1000), extend("default" = 4))]
    pub inner_radius_m: Parameter,
    /// From here outwards it goes at the transit speed, m.
    #[schemars(range(min = 0, max = 1000), extend("default" = 15))]
    pub outer_radius_m: Parameter,
    /// The speed that it reaches at the outer radius, rising from 0 at the inner one, m/s.
    #[schemars(range(min = 0, max = 60), extend("default" = 1.2))]
    pub outer_speed_m_s: Parameter,
    /// The speed outside of it, m/s.
    #[schemars(range(min = 0, max = 60), extend("default" = 2.5))]
    pub transit_speed_m_s: Parameter,
}

/// Closes in on a boat: a blend of the rate of closure and the closest point of approach.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CutRange {
    /// Which boat.
    pub contact: Boat,
    /// From only the rate of closure to only the closest point of approach.
    #[schemars(range(min = 0, max = 100), extend("default" = 50))]
    pub patience: Parameter,
    /// How long a course is thought to be held, s.
    #[schemars(range(min = 0.1, max = 600), extend("default" = 15))]
    pub time_on_leg_s: Parameter,
    /// Farther than this it gives up, m; 0 is never.
    #[schemars(range(min = 0, max = 100_000), extend("default" = 0))]
    pub giveup_m: Parameter,
}

/// Keeps a place relative to a boat that moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Trail {
    /// Which boat.
    pub contact: Boat,
    /// How far from it, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 50))]
    pub range_m: Parameter,
    /// In which direction from its bow, degrees clockwise; 180 is astern.
    #[schemars(range(min = -360, max = 360), extend("default" = 180))]
    pub angle_deg: Parameter,
    /// Nearer than this to the place it takes the contact's own course and speed, m.
    #[schemars(range(min = 0, max = 1000), extend("default" = 5))]
    pub radius_m: Parameter,
    /// The fastest it goes, m/s. More than the boat can do is its top speed.
    #[schemars(range(min = 0, max = 60), extend("default" = 5))]
    pub speed_m_s: Parameter,
}

/// Steers for the point where it can meet a boat soonest (lead pursuit).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Intercept {
    /// Which boat.
    pub contact: Boat,
    /// Speed, m/s. More than the boat can do is its top speed.
    #[schemars(range(min = 0, max = 60), extend("default" = 5))]
    pub speed_m_s: Parameter,
    /// Farther than this it gives up, m; 0 is never.
    #[schemars(range(min = 0, max = 100_000), extend("default" = 0))]
    pub giveup_m: Parameter,
}

/// Keeps between what it guards and an enemy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Shield {
    /// What it guards, a place.
    pub guarded: Place,
    /// From whom.
    #[schemars(extend("default" = "nearest_attacker"))]
    pub against: Boat,
    /// How far from what it guards it keeps, towards the enemy, m; never beyond the middle between the two.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 10))]
    pub distance_m: Parameter,
    /// Within this of its station it takes the speed of what it guards, m.
    #[schemars(range(min = 0, max = 1000), extend("default" = 3))]
    pub radius_m: Parameter,
    /// The fastest it goes, m/s. More than the boat can do is its top speed.
    #[schemars(range(min = 0, max = 60), extend("default" = 5))]
    pub speed_m_s: Parameter,
}

/// Draws the boat to a place, the more the nearer it is, and not at all beyond a distance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Attractor {
    /// The place.
    pub to: Place,
    /// Nearer than this it has its full weight, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 10))]
    pub inner_m: Parameter,
    /// Farther than this it has none, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 50))]
    pub outer_m: Parameter,
    /// Speed, m/s. More than the boat can do is its top speed.
    #[schemars(range(min = 0, max = 60), extend("default" = 5))]
    pub speed_m_s: Parameter,
}

/// Keeps clear of other boats, by closest point of approach: one objective function for each contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("x-weight" = 300))]
pub struct AvoidCollision {
    /// Which boats.
    #[schemars(extend("default" = "all"))]
    pub contacts: Contacts,
    /// Nearer than this it has its full weight, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 9))]
    pub inner_m: Parameter,
    /// Farther than this it has none, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 15))]
    pub outer_m: Parameter,
    /// A closest point of approach of this is worth half, a nearer one less, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 3))]
    pub cpa_min_m: Parameter,
    /// One of this or more is worth everything, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 6))]
    pub cpa_max_m: Parameter,
    /// How long a course is thought to be held, s.
    #[schemars(range(min = 0.1, max = 600), extend("default" = 20))]
    pub time_on_leg_s: Parameter,
    /// How the weight falls from the inner to the outer distance.
    #[schemars(extend("default" = "linear"))]
    pub grade: Grade,
    /// When any boat is nearer than this, the own boat stops, whatever others want, until it is released, m. Default
    /// never.
    #[schemars(range(min = 0.1, max = 1000))]
    pub halt_m: Option<Parameter>,
    /// It is released when all boats are farther than this, m. Default three times `halt_m`.
    #[schemars(range(min = 0, max = 1000))]
    pub release_m: Option<Parameter>,
    /// It is also released after so long, to sort itself out, and stops again only after it has been clear, s. Default
    /// never.
    #[schemars(range(min = 0.1, max = 86_400))]
    pub release_s: Option<Parameter>,
}

/// Whose boats are meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Contacts {
    /// All others.
    All,
    /// The enemy's.
    Enemies,
    /// The enemy's that could tag this boat now: not tagged, and this boat is on their side or near it.
    Taggers,
    /// Of those the one that is assigned to this boat.
    Opponent,
    /// The own team's.
    Mates,
    /// All with whom there can be no tag now: mates, and everybody while this boat is tagged, else enemies that are.
    NoTag,
}

/// How a weight falls with distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Grade {
    /// In proportion.
    Linear,
    /// With the power 1.5.
    Quasi,
    /// With the square.
    Quadratic,
}

/// Keeps clear of the field's obstacles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("x-weight" = 300))]
pub struct AvoidObstacle {
    /// Nearer than this to the edge it has its full weight, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 4))]
    pub inner_m: Parameter,
    /// Farther than this it has none, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 15))]
    pub outer_m: Parameter,
    /// A pass of this is worth half, a nearer one less, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 1))]
    pub cpa_min_m: Parameter,
    /// One of this or more is worth everything, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 4))]
    pub cpa_max_m: Parameter,
    /// How long a course is thought to be held, s.
    #[schemars(range(min = 0.1, max = 600), extend("default" = 20))]
    pub time_on_leg_s: Parameter,
}

/// Keeps the boat on the field, and brings it back slowly if it got out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("x-weight" = 300))]
pub struct OpRegion {
    /// The region is the field shrunk by this, m; less than 0 is wider.
    #[schemars(range(min = -1000, max = 1000), extend("default" = 0))]
    pub margin_m: Parameter,
    /// Nearer than this to the edge, inside, it turns away from courses that lead out, m.
    #[schemars(range(min = 0, max = 1000), extend("default" = 6))]
    pub save_m: Parameter,
    /// Farther out than this it does what `beyond_halt` says, m.
    #[schemars(range(min = 0, max = 100_000), extend("default" = 30))]
    pub halt_m: Parameter,
    /// What a boat does that is so far out.
    #[schemars(extend("default" = "comes_back"))]
    pub beyond_halt: BeyondHalt,
    /// How long a boat is out before it counts as out, s.
    #[schemars(range(min = 0, max = 600), extend("default" = 1))]
    pub exit_s: Parameter,
    /// How long it is in again before it counts as in, s.
    #[schemars(range(min = 0, max = 600), extend("default" = 1))]
    pub entry_s: Parameter,
    /// How fast it comes back, m/s.
    #[schemars(range(min = 0, max = 60), extend("default" = 0.5))]
    pub recovery_speed_m_s: Parameter,
    /// It turns away when a course leads out sooner than this, s.
    #[schemars(range(min = 0, max = 600), extend("default" = 6))]
    pub lookahead_s: Parameter,
}

/// What a boat does that is farther out than it may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BeyondHalt {
    /// It comes back as from anywhere else.
    ComesBack,
    /// It stops its thrusters, and drifts where wind and current take it, as MOOS-IvP has it: somebody fetches it.
    Stops,
}

/// Slows down near other boats.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MaxSpeed {
    /// The speed allowed, m/s.
    #[schemars(range(min = 0, max = 60))]
    pub speed_m_s: Parameter,
    /// How much above it is worth nothing, m/s.
    #[schemars(range(min = 0, max = 60), extend("default" = 0.5))]
    pub tolerance_m_s: Parameter,
    /// Only while a boat is nearer than this, m; 0 is always.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 20))]
    pub range_m: Parameter,
    /// Only for boats within this angle of the bow on either side, degrees.
    #[schemars(range(min = 0, max = 180), extend("default" = 55))]
    pub angle_deg: Parameter,
    /// Which boats.
    #[schemars(extend("default" = "all"))]
    pub contacts: Contacts,
}

/// Holds a heading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ConstantHeading {
    /// The heading, compass degrees.
    #[schemars(range(min = -360, max = 360))]
    pub heading_deg: Parameter,
    /// Half width of the peak, degrees.
    #[schemars(range(min = 0, max = 180), extend("default" = 10))]
    pub peak_width_deg: Parameter,
    /// From the peak down to nothing, degrees.
    #[schemars(range(min = 0, max = 180), extend("default" = 170))]
    pub base_width_deg: Parameter,
}

/// Holds a speed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ConstantSpeed {
    /// The speed, m/s.
    #[schemars(range(min = 0, max = 60))]
    pub speed_m_s: Parameter,
    /// Half width of the peak, m/s.
    #[schemars(range(min = 0, max = 60), extend("default" = 0))]
    pub peak_width_m_s: Parameter,
    /// From the peak down to nothing, m/s.
    #[schemars(range(min = 0, max = 60), extend("default" = 0.2))]
    pub base_width_m_s: Parameter,
}

/// Discourages turns away from the mean heading of the last while.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MemoryTurnLimit {
    /// How long it remembers, s.
    #[schemars(range(min = 0.1, max = 600), extend("default" = 20))]
    pub memory_s: Parameter,
    /// How far a turn costs nothing, degrees to either side.
    #[schemars(range(min = 0, max = 180), extend("default" = 45))]
    pub turn_range_deg: Parameter,
}

/// Does nothing but wait: complete when its duration_s is over, which is required.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Timer {}

/// Would like the boat to lie still; safety may move it all the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FullStop {}
