//! The high-rate wire messages: one struct per topic, matching `msg/*.msg`.
//!
//! The structs use only ROS 2 types (fixed-width numbers, lists, nested messages), so tools with
//! the `.msg` files can decode our bytes. `-1` means "none". The low-rate control plane
//! ([`JoinRequest`], [`JoinReply`], [`Control`]) is JSON.

pub mod external;
pub mod helm;
pub mod input;
pub mod order;
pub mod picture;
pub mod refusal;
pub mod ros;
pub mod run_state;
pub mod topic;
pub mod water;

pub use order::Order;
pub use picture::Picture;
pub use primitives::stamp::{Message, Stamp};
pub use rules::event::EventRecord;

use crate::picture::{FlagView, Nav};
use primitives::id::VehicleId;
use primitives::time::SimTime;
use rules::event::Logged;
use scenario::Scenario;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// The true state of the game, for observers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Time and decision of the frame.
    pub stamp: Stamp,
    /// Boats, by vehicle index.
    pub vehicles: Vec<VehicleTruth>,
    /// The sea in the middle of the field.
    pub sea: SeaView,
    /// Flags, by flag index.
    pub flags: Vec<FlagView>,
    /// Points, by team.
    pub score: Vec<u32>,
    /// Events since the previous frame.
    pub events: Vec<EventRecord>,
    /// Whether operators have stopped all boats or are making them hold.
    pub stopped: bool,
    /// Whether the game is over.
    pub over: bool,
}

/// Wind and current at a place, as velocities over the ground, and the water level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SeaView {
    /// Wind towards north, 10 m above the water, m/s.
    pub wind_north_m_s: f64,
    /// Wind towards east, m/s.
    pub wind_east_m_s: f64,
    /// Current towards north, m/s.
    pub current_north_m_s: f64,
    /// Current towards east, m/s.
    pub current_east_m_s: f64,
    /// Height of the water above calm level, m.
    pub elevation_m: f64,
}

/// The true state of one boat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct VehicleTruth {
    /// The boat's position and motion over the ground.
    pub nav: Nav,
    /// Heave due to waves, m.
    pub heave_m: f64,
    /// Roll, starboard down, rad.
    pub roll_rad: f64,
    /// Pitch, bow up, rad.
    pub pitch_rad: f64,
    /// Thrust of the port thruster, N.
    pub port_newton: f64,
    /// Thrust of the starboard thruster, N.
    pub starboard_newton: f64,
    /// Whether the boat is tagged.
    pub tagged: bool,
    /// The flag that the boat carries, or -1.
    pub carrying: i16,
    /// Whether the boat is out of action.
    pub disabled: bool,
    /// Whether the boat is outside the field.
    pub outside: bool,
    /// Whether the agent of the boat is lost.
    pub agent_lost: bool,
    /// Whether the state of the boat became non-finite.
    pub quarantined: bool,
    /// Whether the boat is a real one whose last report is too old.
    pub nav_lost: bool,
}

/// The orders of one agent process, for all its boats.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Orders {
    /// The stamp of the answered picture.
    pub stamp: Stamp,
    /// The ticket from the sim's join reply.
    pub ticket: u64,
    /// One order per boat.
    pub orders: Vec<VehicleOrder>,
}

/// One order for one boat. Unused fields are zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VehicleOrder {
    /// The boat.
    pub vehicle: VehicleId,
    /// 0 hold, 1 steer, 2 thrust, 3 turn.
    pub kind: u8,
    /// For steer: the heading, rad clockwise from north. For turn: the change of heading, rad
    /// clockwise.
    pub heading_rad: f64,
    /// For steer and turn: the speed ahead, m/s.
    pub speed_m_s: f64,
    /// Thrust of the port thruster, -1 to 1.
    pub port: f64,
    /// Thrust of the starboard thruster, -1 to 1.
    pub starboard: f64,
}

impl VehicleOrder {
    /// The order for `vehicle` in wire form.
    pub fn new(vehicle: VehicleId, order: Order) -> VehicleOrder {
        let hold = VehicleOrder {
            vehicle,
            kind: 0,
            heading_rad: 0.0,
            speed_m_s: 0.0,
            port: 0.0,
            starboard: 0.0,
        };
        match order {
            Order::Hold => hold,
            Order::Steer {
                heading_rad,
                speed_m_s,
            } => VehicleOrder {
                kind: 1,
                heading_rad,
                speed_m_s,
                ..hold
            },
            Order::Thrust { port, starboard } => VehicleOrder {
                kind: 2,
                port,
                starboard,
                ..hold
            },
            Order::Turn { by_rad, speed_m_s } => VehicleOrder {
                kind: 3,
                heading_rad: by_rad,
                speed_m_s,
                ..hold
            },
        }
    }

    /// Decodes the order, if its kind is known.
    pub fn order(&self) -> Option<Order> {
        match self.kind {
            0 => Some(Order::Hold),
            1 => Some(Order::Steer {
                heading_rad: self.heading_rad,
                speed_m_s: self.speed_m_s,
            }),
            2 => Some(Order::Thrust {
                port: self.port,
                starboard: self.starboard,
            }),
            3 => Some(Order::Turn {
                by_rad: self.heading_rad,
                speed_m_s: self.speed_m_s,
            }),
            _ => None,
        }
    }
}

impl Frame {
    /// Events since the previous frame, except those about boats, flags or teams that the game
    /// lacks.
    pub fn logged<'a>(&'a self, scenario: &'a Scenario) -> impl Iterator<Item = Logged> + 'a {
        self.events
            .iter()
            .filter_map(EventRecord::logged)
            .filter(|logged| scenario.has(logged.event))
    }
}

impl Message for Frame {
    const SCHEMA: &'static str = "squall_msgs/msg/Frame";
    const VERSION: u8 = 3;
}

impl Message for Orders {
    const SCHEMA: &'static str = "squall_msgs/msg/Orders";
    const VERSION: u8 = 2;
}

/// Team messages of minds: the values of shared variables at one decision.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Say {
    /// Time and decision of the values.
    pub stamp: Stamp,
    /// The words of all boats of one process.
    pub words: Vec<Word>,
}

/// A shared variable of one boat.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Word {
    /// The boat.
    pub vehicle: VehicleId,
    /// The variable: a hash of its name and its possible values.
    pub key: u64,
    /// The value: booleans are 0 and 1, strings are indices from 0.
    pub value: f64,
}

/// The proposal of an external policy for a boat.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PolicyProposal {
    /// Time and decision of the proposal.
    pub stamp: Stamp,
    /// The boat.
    pub vehicle: VehicleId,
    /// Desired course, rad clockwise from north.
    pub course_rad: f64,
    /// Desired speed, m/s.
    pub speed_m_s: f64,
}

impl Message for Say {
    const SCHEMA: &'static str = "squall_msgs/msg/Say";
    const VERSION: u8 = 1;
}

impl Message for PolicyProposal {
    const SCHEMA: &'static str = "squall_msgs/msg/PolicyProposal";
    const VERSION: u8 = 1;
}

/// First request of an agent or a gateway to the sim.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct JoinRequest {
    /// The node's version of Squall.
    pub version: String,
    /// The requested role.
    pub role: Role,
    /// A name for the process, unique on the network.
    pub node: String,
    /// Names of the requested vehicles.
    pub vehicles: Vec<String>,
}

/// The role of a joining node for its vehicles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, strum::Display)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Role {
    /// Decides for the vehicles.
    Agent,
    /// Connects real boats.
    Gateway,
}

/// The sim's reply to a join request.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum JoinReply {
    /// The node has joined.
    Granted {
        /// The ticket that every order or report must carry.
        ticket: u64,
        /// The vehicles, in the requested order.
        vehicles: Vec<VehicleId>,
        /// Game time of joining. Earlier messages are not meant for this node.
        now_ns: SimTime,
    },
    /// The vehicle belongs to a different node. A later retry may succeed.
    Busy {
        /// The vehicle.
        vehicle: String,
    },
    /// Permanently refused: do not retry.
    Refused {
        /// The reason.
        reason: String,
    },
}

/// A control command for a game.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Control {
    /// Ends the game now.
    Stop,
    /// Starts the game again with this seed.
    Reset(u64),
    /// Pauses the game. Real boats hold in the meantime.
    Pause,
    /// Resumes a paused game.
    Resume,
    /// In a paused game, plays one decision.
    Step,
    /// Limits the speed to this many simulated seconds per second; `None` removes the limit, in
    /// lockstep only. A lockstep game plays no faster than that, a real-time game at exactly that
    /// speed. A game with real boats keeps its pace.
    Speed(Option<f64>),
    /// Makes all boats hold while the game continues.
    Halt,
    /// Ends `Halt`.
    GoOn,
    /// Stops all boats, real and simulated, until released.
    EStop,
    /// Ends the E-stop. Real boats have to be armed again.
    Release,
}

/// The sim's reply to a [`Control`] request: the reason if it was refused.
pub type ControlReply = Result<(), String>;

impl Control {
    /// Whether the command stops boats or makes them hold; such commands need no token.
    pub fn stops(self) -> bool {
        matches!(self, Control::EStop | Control::Halt)
    }

    /// The permitted speeds, simulated seconds per second.
    pub const SPEEDS: RangeInclusive<f64> = 0.01..=1000.0;
}

/// A sim's public description of its game.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GameInfo {
    /// The sim's version of Squall.
    pub version: String,
    /// How the game is paced.
    pub pace: String,
    /// The validated scenario, with the seed of this game.
    pub scenario: Scenario,
}
