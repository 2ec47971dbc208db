//! The tasks of behaviours: one type per kind, with its keys as in files.
//!
//! Each key is declared once, in this module. Its doc comment gives its meaning and unit; `range`
//! and `length` give the allowed values, `default` the value of an omitted key. The schema of these
//! types is used to check files, for completion in editors, and for the reference page.

use super::{Boat, Parameter, Place, Policy};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use strum::IntoStaticStr;

/// The task of a behaviour.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, IntoStaticStr, JsonSchema)]
#[strum(serialize_all = "snake_case")]
#[schemars(rename_all = "snake_case")]
#[expect(missing_docs, reason = "each task's type has the documentation")]
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
    Policy(Box<Policy>),
}

impl Task {
    /// The kind's name in files.
    pub fn kind(&self) -> &'static str {
        self.into()
    }

    /// Whether it is a safety behaviour, which has a greater default weight.
    pub fn is_safety(&self) -> bool {
        matches!(
            self,
            Task::OpRegion(_) | Task::AvoidCollision(_) | Task::AvoidObstacle(_)
        )
    }
}

/// Follows a list of points and completes at the last.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Waypoint {
    /// Places, in order.
    #[schemars(length(min = 1, max = 1000), extend("x-expected" = "1 to 1000 places"))]
    pub points: Vec<Place>,
    /// Follows the list backwards.
    #[schemars(extend("default" = false))]
    pub reverse: bool,
    /// Number of repetitions.
    #[schemars(range(min = 0, max = 1_000_000), extend("default" = 0))]
    pub repeat: Parameter,
    /// Speed, m/s.
    #[schemars(range(min = 0, max = 60), extend("default" = 5))]
    pub speed_m_s: Parameter,
    /// Distance within which a point counts as reached, m.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 3))]
    pub capture_radius_m: Parameter,
    /// Distance within which a point counts as reached once the boat passes it, m.
    #[schemars(range(min = 0, max = 1000), extend("default" = 15))]
    pub slip_radius_m: Parameter,
    /// How far ahead on the leg to steer, m; 0: steer for the next point.
    #[schemars(range(min = 0, max = 1000), extend("default" = 0))]
    pub lead_m: Parameter,
    /// Weight of course against speed.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.5))]
    pub course_share: Parameter,
}

/// Circles a convex polygon.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Loiter {
    /// Its shape.
    #[schemars(flatten, with = "ShapeKeys")]
    pub shape: Shape,
    /// Direction of travel.
    #[schemars(extend("default" = "best"))]
    pub turn: Turn,
    /// Speed, m/s.
    #[schemars(range(min = 0, max = 60), extend("default" = 5))]
    pub speed_m_s: Parameter,
    /// Distance within which a corner counts as reached, m.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 3))]
    pub capture_radius_m: Parameter,
    /// Distance within which a corner counts as reached once the boat passes it, m.
    #[schemars(range(min = 0, max = 1000), extend("default" = 15))]
    pub slip_radius_m: Parameter,
    /// Distance from the polygon beyond which the boat first approaches it, m.
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

/// The keys for a shape, one of which is required.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "only the schema is used")]
struct ShapeKeys {
    /// Corners, in order. Required without `ellipse`.
    #[schemars(length(min = 3, max = 1000), extend("x-expected" = "3 to 1000 places"))]
    polygon: Option<Vec<Place>>,
    /// An ellipse instead of `polygon`.
    ellipse: Option<Ellipse>,
}

/// Direction of travel around a polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Turn {
    /// Clockwise, seen from above.
    Clockwise,
    /// Counterclockwise.
    Counterclockwise,
    /// Whichever suits the heading on arrival.
    Best,
}

/// An ellipse with axes along and across the field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Ellipse {
    /// Centre.
    pub centre: Place,
    /// Full length along the field, m.
    #[schemars(range(min = 1, max = 10_000))]
    pub along_m: f64,
    /// Full length across the field, m.
    #[schemars(range(min = 1, max = 10_000))]
    pub across_m: f64,
    /// Number of corners.
    #[schemars(range(min = 3, max = 1000), extend("default" = 24))]
    pub corners: usize,
}

/// Keeps station.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StationKeep {
    /// Station. Default: the position at the start.
    pub at: Option<Place>,
    /// Distance within which the behaviour is inactive, m.
    #[schemars(range(min = 0, max = 1000), extend("default" = 4))]
    pub inner_radius_m: Parameter,
    /// Distance beyond which the boat drives at transit speed, m.
    #[schemars(range(min = 0, max = 1000), extend("default" = 15))]
    pub outer_radius_m: Parameter,
    /// Speed at the outer radius, falling to 0 at the inner one, m/s.
    #[schemars(range(min = 0, max = 60), extend("default" = 1.2))]
    pub outer_speed_m_s: Parameter,
    /// Speed beyond the outer radius, m/s.
    #[schemars(range(min = 0, max = 60), extend("default" = 2.5))]
    pub transit_speed_m_s: Parameter,
}

/// Closes in on a boat, weighing rate of closure against closest point of approach (CPA).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CutRange {
    /// Target.
    pub contact: Boat,
    /// Weighting, from 0 (only rate of closure) to 100 (only CPA).
    #[schemars(range(min = 0, max = 100), extend("default" = 50))]
    pub patience: Parameter,
    /// Time horizon for evaluating courses, s.
    #[schemars(range(min = 0.1, max = 600), extend("default" = 15))]
    pub time_on_leg_s: Parameter,
    /// Distance at which it gives up, m; 0: never.
    #[schemars(range(min = 0, max = 100_000), extend("default" = 0))]
    pub giveup_m: Parameter,
}

/// Keeps a position relative to a moving boat.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Trail {
    /// Target.
    pub contact: Boat,
    /// Distance of that position from the target, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 50))]
    pub range_m: Parameter,
    /// Direction of that position from the target, degrees clockwise from its bow; 180 is astern.
    #[schemars(range(min = -360, max = 360), extend("default" = 180))]
    pub angle_deg: Parameter,
    /// Distance from that position within which the boat matches the target's course and speed, m.
    #[schemars(range(min = 0, max = 1000), extend("default" = 5))]
    pub radius_m: Parameter,
    /// Maximum speed, m/s.
    #[schemars(range(min = 0, max = 60), extend("default" = 5))]
    pub speed_m_s: Parameter,
}

/// Steers for the earliest meeting point with a boat (lead pursuit).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Intercept {
    /// Target.
    pub contact: Boat,
    /// Speed, m/s.
    #[schemars(range(min = 0, max = 60), extend("default" = 5))]
    pub speed_m_s: Parameter,
    /// Distance at which it gives up, m; 0: never.
    #[schemars(range(min = 0, max = 100_000), extend("default" = 0))]
    pub giveup_m: Parameter,
}

/// Keeps between a place and an enemy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Shield {
    /// Guarded place.
    pub guarded: Place,
    /// Enemy.
    #[schemars(extend("default" = "nearest_attacker"))]
    pub against: Boat,
    /// Distance from the guarded place towards the enemy, at most half-way, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 10))]
    pub distance_m: Parameter,
    /// Distance from its station within which the boat matches the speed of the guarded place, m.
    #[schemars(range(min = 0, max = 1000), extend("default" = 3))]
    pub radius_m: Parameter,
    /// Maximum speed, m/s.
    #[schemars(range(min = 0, max = 60), extend("default" = 5))]
    pub speed_m_s: Parameter,
}

/// Attracts the boat to a place, more strongly the nearer the place is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Attractor {
    /// Place.
    pub to: Place,
    /// Distance with full weight, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 10))]
    pub inner_m: Parameter,
    /// Distance with zero weight, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 50))]
    pub outer_m: Parameter,
    /// Speed, m/s.
    #[schemars(range(min = 0, max = 60), extend("default" = 5))]
    pub speed_m_s: Parameter,
}

/// Avoids other boats by closest point of approach (CPA), with one objective function per contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("x-weight" = 300))]
pub struct AvoidCollision {
    /// Boats to avoid.
    #[schemars(extend("default" = "all"))]
    pub contacts: Contacts,
    /// Distance with full weight, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 9))]
    pub inner_m: Parameter,
    /// Distance with zero weight, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 15))]
    pub outer_m: Parameter,
    /// CPA with half utility, m; less is worse.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 3))]
    pub cpa_min_m: Parameter,
    /// CPA with full utility, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 6))]
    pub cpa_max_m: Parameter,
    /// Time horizon for evaluating courses, s.
    #[schemars(range(min = 0.1, max = 600), extend("default" = 20))]
    pub time_on_leg_s: Parameter,
    /// How the weight falls between the two distances.
    #[schemars(extend("default" = "linear"))]
    pub grade: Grade,
    /// Distance to another boat at which the boat stops, m. Default: never.
    #[schemars(range(min = 0.1, max = 1000))]
    pub halt_m: Option<Parameter>,
    /// Distance to every other boat beyond which the boat resumes, m. Default: 3 × `halt_m`.
    #[schemars(range(min = 0, max = 1000))]
    pub release_m: Option<Parameter>,
    /// Time after which the boat resumes anyway, s; it stops again only once it has been clear of
    /// others. Default: never.
    #[schemars(range(min = 0.1, max = 86_400))]
    pub release_s: Option<Parameter>,
}

/// The boats that a behaviour considers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Contacts {
    /// All other boats.
    All,
    /// All enemies.
    Enemies,
    /// Enemies that could tag this boat now: untagged, while this boat is on or near their side.
    Taggers,
    /// The enemy assigned to this boat.
    Opponent,
    /// Teammates.
    Mates,
    /// Boats with which no tag is possible: teammates, tagged enemies and, while this boat is
    /// tagged, all boats.
    NoTag,
}

/// How a weight falls with distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Grade {
    /// Linearly.
    Linear,
    /// With exponent 1.5.
    Quasi,
    /// Quadratically.
    Quadratic,
}

/// Avoids the field's obstacles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("x-weight" = 300))]
pub struct AvoidObstacle {
    /// Distance with full weight, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 4))]
    pub inner_m: Parameter,
    /// Distance with zero weight, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 15))]
    pub outer_m: Parameter,
    /// Passing distance with half utility, m; less is worse.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 1))]
    pub cpa_min_m: Parameter,
    /// Passing distance with full utility, m.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 4))]
    pub cpa_max_m: Parameter,
    /// Time horizon for evaluating courses, s.
    #[schemars(range(min = 0.1, max = 600), extend("default" = 20))]
    pub time_on_leg_s: Parameter,
}

/// Keeps the boat on the field, and brings it back slowly if it leaves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("x-weight" = 300))]
pub struct OpRegion {
    /// Margin inside the field's edges, m; negative values enlarge the region.
    #[schemars(range(min = -1000, max = 1000), extend("default" = 0))]
    pub margin_m: Parameter,
    /// Distance inside the edge within which the boat turns away from courses that lead out, m.
    #[schemars(range(min = 0, max = 1000), extend("default" = 6))]
    pub save_m: Parameter,
    /// Distance outside the region beyond which `beyond_halt` applies, m.
    #[schemars(range(min = 0, max = 100_000), extend("default" = 30))]
    pub halt_m: Parameter,
    /// Action beyond `halt_m`.
    #[schemars(extend("default" = "comes_back"))]
    pub beyond_halt: BeyondHalt,
    /// Time outside before the boat counts as outside, s.
    #[schemars(range(min = 0, max = 600), extend("default" = 1))]
    pub exit_s: Parameter,
    /// Time inside before the boat counts as inside, s.
    #[schemars(range(min = 0, max = 600), extend("default" = 1))]
    pub entry_s: Parameter,
    /// Speed on the way back, m/s.
    #[schemars(range(min = 0, max = 60), extend("default" = 0.5))]
    pub recovery_speed_m_s: Parameter,
    /// Look-ahead time for avoiding courses that lead out, s.
    #[schemars(range(min = 0, max = 600), extend("default" = 6))]
    pub lookahead_s: Parameter,
}

/// What a boat does beyond `halt_m`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BeyondHalt {
    /// The boat returns.
    ComesBack,
    /// The boat stops its thrusters and drifts until recovered, as in MOOS-IvP.
    Stops,
}

/// Slows down near other boats.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MaxSpeed {
    /// Maximum speed, m/s.
    #[schemars(range(min = 0, max = 60))]
    pub speed_m_s: Parameter,
    /// Excess speed with zero utility, m/s.
    #[schemars(range(min = 0, max = 60), extend("default" = 0.5))]
    pub tolerance_m_s: Parameter,
    /// Distance to a boat within which the limit applies, m; 0: always.
    #[schemars(range(min = 0, max = 10_000), extend("default" = 20))]
    pub range_m: Parameter,
    /// Angle from the bow, to either side, within which boats count, degrees.
    #[schemars(range(min = 0, max = 180), extend("default" = 55))]
    pub angle_deg: Parameter,
    /// Boats to consider.
    #[schemars(extend("default" = "all"))]
    pub contacts: Contacts,
}

/// Holds a heading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ConstantHeading {
    /// Compass heading, degrees.
    #[schemars(range(min = -360, max = 360))]
    pub heading_deg: Parameter,
    /// Half width of the peak, degrees.
    #[schemars(range(min = 0, max = 180), extend("default" = 10))]
    pub peak_width_deg: Parameter,
    /// Width from the peak to zero, degrees.
    #[schemars(range(min = 0, max = 180), extend("default" = 170))]
    pub base_width_deg: Parameter,
}

/// Holds a speed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ConstantSpeed {
    /// Speed, m/s.
    #[schemars(range(min = 0, max = 60))]
    pub speed_m_s: Parameter,
    /// Half width of the peak, m/s.
    #[schemars(range(min = 0, max = 60), extend("default" = 0))]
    pub peak_width_m_s: Parameter,
    /// Width from the peak to zero, m/s.
    #[schemars(range(min = 0, max = 60), extend("default" = 0.2))]
    pub base_width_m_s: Parameter,
}

/// Discourages turns away from the recent mean heading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MemoryTurnLimit {
    /// Averaging time, s.
    #[schemars(range(min = 0.1, max = 600), extend("default" = 20))]
    pub memory_s: Parameter,
    /// Turn without penalty, degrees to either side.
    #[schemars(range(min = 0, max = 180), extend("default" = 45))]
    pub turn_range_deg: Parameter,
}

/// Only waits; completes after `duration_s`, which is required.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Timer {}

/// Prefers zero speed; safety behaviours may still move the boat.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FullStop {}
