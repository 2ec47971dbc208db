//! Behaviours: what a boat's helm weighs against each other, with their parameters as checked.
//!
//! Every number may be an expression, which is evaluated anew at every decision: that is how behaviours are updated
//! while they run. Angles are compass degrees as in files.

use super::expression::{Expression, Values};
use super::{Boat, Place};
use serde::{Deserialize, Serialize};

/// A behaviour of a strategy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Behaviour {
    /// Its name, unique in the program.
    pub name: String,
    /// Whether it may run in each mode, by mode; for parents as for leaves.
    pub modes: Vec<bool>,
    /// It runs only while this holds.
    pub when: Option<Expression>,
    /// Its priority weight, 0 to 1000.
    pub weight: Parameter,
    /// It is complete after running for this long, s.
    pub duration_s: Option<Parameter>,
    /// Whether it starts again after it was complete.
    pub perpetual: bool,
    /// What it posts, and when.
    pub posts: Vec<Post>,
    /// What it does.
    pub task: Task,
}

/// A number of a behaviour, which may follow the game.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Its value.
    pub expression: Expression,
    /// The values it may have; others become the nearest of these.
    pub range: (f64, f64),
}

impl Parameter {
    /// Its value now.
    #[must_use]
    pub fn value(&self, values: &impl Values) -> f64 {
        self.expression.value(values).clamp(self.range.0, self.range.1)
    }

    /// Its value, if that is always the same.
    #[must_use]
    pub fn constant(&self) -> Option<f64> {
        self.expression.constant().map(|value| value.clamp(self.range.0, self.range.1))
    }
}

/// A value given to a variable at a moment of a behaviour's life.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Post {
    /// When.
    pub at: Moment,
    /// The variable, by index.
    pub variable: u16,
    /// Its new value.
    pub value: Expression,
}

/// A moment of a behaviour's life.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Moment {
    /// It begins to run.
    Run,
    /// It stops running.
    Idle,
    /// It begins to influence the helm.
    Active,
    /// It stops doing so.
    Inactive,
    /// It reaches one of its points, or its time.
    Reach,
    /// It is complete.
    Complete,
}

/// What a behaviour does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "each says it itself")]
pub enum Task {
    Waypoint(Waypoint),
    Loiter(Loiter),
    StationKeep(StationKeep),
    CutRange(CutRange),
    Trail(Trail),
    Intercept(Intercept),
    AvoidCollision(AvoidCollision),
    AvoidObstacle(AvoidObstacle),
    OpRegion(OpRegion),
    MaxSpeed(MaxSpeed),
    ConstantHeading(ConstantHeading),
    ConstantSpeed(ConstantSpeed),
    MemoryTurnLimit(MemoryTurnLimit),
    Timer(Timer),
    FullStop(FullStop),
    Shield(Shield),
    Attractor(Attractor),
    Policy(Policy),
}

impl Task {
    /// The kind's name in files.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Task::Waypoint(_) => "waypoint",
            Task::Loiter(_) => "loiter",
            Task::StationKeep(_) => "station_keep",
            Task::CutRange(_) => "cut_range",
            Task::Trail(_) => "trail",
            Task::Intercept(_) => "intercept",
            Task::AvoidCollision(_) => "avoid_collision",
            Task::AvoidObstacle(_) => "avoid_obstacle",
            Task::OpRegion(_) => "op_region",
            Task::MaxSpeed(_) => "max_speed",
            Task::ConstantHeading(_) => "constant_heading",
            Task::ConstantSpeed(_) => "constant_speed",
            Task::MemoryTurnLimit(_) => "memory_turn_limit",
            Task::Timer(_) => "timer",
            Task::FullStop(_) => "full_stop",
            Task::Shield(_) => "shield",
            Task::Attractor(_) => "attractor",
            Task::Policy(_) => "policy",
        }
    }
}

/// Drives along a list of points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Waypoint {
    /// The points, in order.
    pub points: Vec<Place>,
    /// In the order given, or backwards.
    pub reverse: bool,
    /// How often the list is driven again after the first time.
    pub repeat: Parameter,
    /// Desired speed, m/s.
    pub speed_m_s: Parameter,
    /// A point nearer than this is reached, m.
    pub capture_radius_m: Parameter,
    /// A point within this that draws away again is reached, m.
    pub slip_radius_m: Parameter,
    /// Steers for the point of the line between two points that lies this far ahead, m; 0 steers for the next point.
    pub lead_m: Parameter,
    /// How much course counts against speed, 0 to 1.
    pub course_share: Parameter,
}

/// Drives round and round a convex polygon.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Loiter {
    /// Its shape.
    pub shape: Shape,
    /// Which way round.
    pub turn: Turn,
    /// Desired speed, m/s.
    pub speed_m_s: Parameter,
    /// A corner nearer than this is passed, m.
    pub capture_radius_m: Parameter,
    /// A corner within this that draws away again is passed, m.
    pub slip_radius_m: Parameter,
    /// Farther than this from the polygon it goes there first, m.
    pub acquire_m: Parameter,
}

/// A convex polygon.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Shape {
    /// By its corners, in order.
    Corners(Vec<Place>),
    /// An ellipse with axes along and across the field.
    Ellipse {
        /// Its centre.
        centre: Place,
        /// Full extent along the field, m.
        along_m: f64,
        /// Full extent across it, m.
        across_m: f64,
        /// By how many corners.
        corners: usize,
    },
}

/// Which way round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Turn {
    /// With the hands of a clock, seen from above.
    Clockwise,
    /// Against them.
    Counterclockwise,
    /// As the boat heads when it comes.
    Best,
}

/// Holds a place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StationKeep {
    /// The place; none is where the boat was when it began.
    pub at: Option<Place>,
    /// Within this it does nothing, m.
    pub inner_radius_m: Parameter,
    /// From here outwards it goes at the transit speed, m.
    pub outer_radius_m: Parameter,
    /// The speed that it reaches at the outer radius, rising from 0 at the inner one, m/s.
    pub outer_speed_m_s: Parameter,
    /// The speed outside of it, m/s.
    pub transit_speed_m_s: Parameter,
}

/// Closes in on a boat: a blend of the rate of closure and the closest point of approach.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CutRange {
    /// Which boat.
    pub contact: Boat,
    /// 0 looks only at the rate of closure, 100 only at the closest point of approach.
    pub patience: Parameter,
    /// How long a course is thought to be held, s.
    pub time_on_leg_s: Parameter,
    /// Farther than this it gives up, m; 0 never does.
    pub giveup_m: Parameter,
}

/// Keeps a place relative to a boat that moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trail {
    /// Which boat.
    pub contact: Boat,
    /// How far from it, m.
    pub range_m: Parameter,
    /// In which direction from its bow, degrees clockwise: 180 is astern.
    pub angle_deg: Parameter,
    /// Nearer than this to the place it takes the contact's own course and speed, m.
    pub radius_m: Parameter,
    /// The fastest it goes, m/s.
    pub speed_m_s: Parameter,
}

/// Steers for the point where it can meet a boat soonest (lead pursuit).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Intercept {
    /// Which boat.
    pub contact: Boat,
    /// Speed, m/s.
    pub speed_m_s: Parameter,
    /// Farther than this it gives up, m; 0 never does.
    pub giveup_m: Parameter,
}

/// Keeps clear of other boats, by closest point of approach. One for each contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AvoidCollision {
    /// Which boats.
    pub contacts: Contacts,
    /// Nearer than this it has its full weight, m.
    pub inner_m: Parameter,
    /// Farther than this it has none, m.
    pub outer_m: Parameter,
    /// A closest point of approach of this is worth half, a nearer one less, m.
    pub cpa_min_m: Parameter,
    /// One of this or more is worth everything, m.
    pub cpa_max_m: Parameter,
    /// How long a course is thought to be held, s.
    pub time_on_leg_s: Parameter,
    /// How the weight falls from the inner to the outer distance.
    pub grade: Grade,
}

/// Whose boats are meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Contacts {
    /// All others.
    All,
    /// The enemy's.
    Enemies,
    /// The enemy's that could tag this boat now: not tagged, and this boat is on their side or near it.
    Taggers,
    /// The own team's.
    Mates,
}

/// How a weight falls with distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AvoidObstacle {
    /// Nearer than this to the edge it has its full weight, m.
    pub inner_m: Parameter,
    /// Farther than this it has none, m.
    pub outer_m: Parameter,
    /// A pass of this is worth half, a nearer one less, m.
    pub cpa_min_m: Parameter,
    /// One of this or more is worth everything, m.
    pub cpa_max_m: Parameter,
    /// How long a course is thought to be held, s.
    pub time_on_leg_s: Parameter,
}

/// Keeps the boat on the field, and brings it back slowly if it got out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OpRegion {
    /// The region: the field shrunk by this, m; negative is wider.
    pub margin_m: Parameter,
    /// Nearer than this to the edge, inside, it turns away from courses that lead out, m.
    pub save_m: Parameter,
    /// Farther out than this the boat stops, m.
    pub halt_m: Parameter,
    /// How long a boat is out before it counts as out, s.
    pub exit_s: Parameter,
    /// How long it is in again before it counts as in, s.
    pub entry_s: Parameter,
    /// How fast it comes back, m/s.
    pub recovery_speed_m_s: Parameter,
    /// It turns away when a course leads out sooner than this, s.
    pub lookahead_s: Parameter,
}

/// Slows down near other boats.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MaxSpeed {
    /// The speed allowed, m/s.
    pub speed_m_s: Parameter,
    /// How much above it is worth nothing, m/s.
    pub tolerance_m_s: Parameter,
    /// Only while a boat is nearer than this, m; 0 is always.
    pub range_m: Parameter,
    /// Only for boats within this angle of the bow on either side, degrees.
    pub angle_deg: Parameter,
    /// Which boats.
    pub contacts: Contacts,
}

/// Holds a heading.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConstantHeading {
    /// The heading, compass degrees.
    pub heading_deg: Parameter,
    /// Half width of the peak, degrees.
    pub peak_width_deg: Parameter,
    /// From the peak down to nothing, degrees.
    pub base_width_deg: Parameter,
}

/// Holds a speed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConstantSpeed {
    /// The speed, m/s.
    pub speed_m_s: Parameter,
    /// Half width of the peak, m/s.
    pub peak_width_m_s: Parameter,
    /// From the peak down to nothing, m/s.
    pub base_width_m_s: Parameter,
}

/// Discourages turns away from the mean heading of the last while.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MemoryTurnLimit {
    /// How long it remembers, s.
    pub memory_s: Parameter,
    /// How far a turn costs nothing, degrees to either side.
    pub turn_range_deg: Parameter,
}

/// Does nothing but wait: complete when its `duration_s` is over.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Timer {}

/// Would like the boat to lie still; safety may move it all the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FullStop {}

/// Keeps between what it guards and the nearest enemy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shield {
    /// What it guards.
    pub guarded: Place,
    /// From whom.
    pub against: Boat,
    /// How far from what it guards it keeps, towards the enemy, m; never beyond the middle between the two.
    pub distance_m: Parameter,
    /// Within this of its station it takes the speed of what it guards, m.
    pub radius_m: Parameter,
    /// The fastest it goes, m/s.
    pub speed_m_s: Parameter,
}

/// Draws the boat to a place, the more the nearer it is, and not at all beyond a distance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Attractor {
    /// The place or boat.
    pub to: Place,
    /// Nearer than this it has its full weight, m.
    pub inner_m: Parameter,
    /// Farther than this it has none, m.
    pub outer_m: Parameter,
    /// Speed, m/s.
    pub speed_m_s: Parameter,
}

/// Who proposes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Proposer {
    /// A program: in lockstep it is waited for.
    #[default]
    Program,
    /// A person ashore: nothing waits.
    Person,
}

/// Lets a policy outside of the helm propose course and speed, weighed with everything else.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Policy {
    /// Who proposes.
    pub by: Proposer,
    /// A proposal older than this is not heard any more, s.
    pub ttl_s: Parameter,
    /// Half width of the peak at the proposed course, degrees.
    pub peak_width_deg: Parameter,
    /// From there down to nothing, degrees.
    pub base_width_deg: Parameter,
    /// How much course counts against speed, 0 to 1.
    pub course_share: Parameter,
}
