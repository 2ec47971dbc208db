//! What goes over the wire every tick: one struct a topic, in step with `msg/*.msg`.
//!
//! The structs keep to what ROS 2 can say (fixed-width numbers, lists, nested messages), so that
//! tools which know the `.msg` files read our bytes without us. `-1` stands for "none".
//! The low-rate control plane ([`JoinRequest`], [`JoinReply`], [`Control`]) is JSON.

pub mod external;
pub mod helm;
pub mod input;
pub mod order;
pub mod payload;
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

/// The truth about everything, for observers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// When.
    pub stamp: Stamp,
    /// By vehicle.
    pub vehicles: Vec<VehicleTruth>,
    /// The sea in the middle of the field.
    pub sea: SeaView,
    /// By flag.
    pub flags: Vec<FlagView>,
    /// Points, by team.
    pub score: Vec<u32>,
    /// What happened since the frame before.
    pub events: Vec<EventRecord>,
    /// Whether people ashore have stopped all boats, or make them hold.
    pub stopped: bool,
    /// Whether the game is over.
    pub over: bool,
}

/// Wind and current at a place, as velocities over the ground, and the height of the water.
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
    /// How much higher the water stands than in calm, m.
    pub elevation_m: f64,
}

/// The truth about one boat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct VehicleTruth {
    /// Where it is and how it moves over the ground.
    pub nav: Nav,
    /// How far the waves have lifted it, m.
    pub heave_m: f64,
    /// Roll, starboard down, rad.
    pub roll_rad: f64,
    /// Pitch, bow up, rad.
    pub pitch_rad: f64,
    /// Thrust of the port thruster, N.
    pub port_newton: f64,
    /// Thrust of the starboard thruster, N.
    pub starboard_newton: f64,
    /// Whether it is tagged.
    pub tagged: bool,
    /// The flag it carries, or -1.
    pub carrying: i16,
    /// Whether it is out of action by power play.
    pub disabled: bool,
    /// Whether it is outside of the field.
    pub outside: bool,
    /// Whether its agent is lost.
    pub agent_lost: bool,
    /// Whether its numbers went bad.
    pub quarantined: bool,
    /// Whether it is a real one whose last report is too old.
    pub nav_lost: bool,
}

/// The orders of one agent process, for all boats it minds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Orders {
    /// The picture that they answer.
    pub stamp: Stamp,
    /// The ticket that the sim gave when the agent joined.
    pub ticket: u64,
    /// One order a boat.
    pub orders: Vec<VehicleOrder>,
}

/// One order for one boat. Numbers that its kind does not have are zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VehicleOrder {
    /// The boat.
    pub vehicle: VehicleId,
    /// 0 hold, 1 steer, 2 thrust, 3 turn.
    pub kind: u8,
    /// To steer: the heading, rad clockwise from north. To turn: by how much, rad clockwise.
    pub heading_rad: f64,
    /// To steer and to turn: the speed ahead, m/s.
    pub speed_m_s: f64,
    /// Thrust of the port thruster, -1 to 1.
    pub port: f64,
    /// Thrust of the starboard thruster, -1 to 1.
    pub starboard: f64,
}

impl VehicleOrder {
    /// The order for `vehicle` in wire form.
    #[must_use]
    pub fn new(vehicle: VehicleId, order: Order) -> VehicleOrder {
        let hold = VehicleOrder { vehicle, kind: 0, heading_rad: 0.0, speed_m_s: 0.0, port: 0.0, starboard: 0.0 };
        match order {
            Order::Hold => hold,
            Order::Steer { heading_rad, speed_m_s } => VehicleOrder { kind: 1, heading_rad, speed_m_s, ..hold },
            Order::Thrust { port, starboard } => VehicleOrder { kind: 2, port, starboard, ..hold },
            Order::Turn { by_rad, speed_m_s } => VehicleOrder { kind: 3, heading_rad: by_rad, speed_m_s, ..hold },
        }
    }

    /// The order, if its kind is one we know.
    #[must_use]
    pub fn order(&self) -> Option<Order> {
        match self.kind {
            0 => Some(Order::Hold),
            1 => Some(Order::Steer { heading_rad: self.heading_rad, speed_m_s: self.speed_m_s }),
            2 => Some(Order::Thrust { port: self.port, starboard: self.starboard }),
            3 => Some(Order::Turn { by_rad: self.heading_rad, speed_m_s: self.speed_m_s }),
            _ => None,
        }
    }
}

impl Frame {
    /// What happened since the frame before, but for what names something that is not in the game.
    pub fn logged<'a>(&'a self, scenario: &'a Scenario) -> impl Iterator<Item = Logged> + 'a {
        self.events.iter().filter_map(EventRecord::logged).filter(|logged| scenario.has(logged.event))
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

/// What minds tell their team: the values of shared variables, as of one decision.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Say {
    /// When, and after which decision.
    pub stamp: Stamp,
    /// The words of all boats that one process minds.
    pub words: Vec<Word>,
}

/// A shared variable of one boat.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Word {
    /// Whose.
    pub vehicle: VehicleId,
    /// Which: a hash of its name and of what it can be.
    pub key: u64,
    /// Its value: truths are 0 and 1, texts count from 0.
    pub value: f64,
}

/// What a policy outside of the helm proposes for a boat.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PolicyProposal {
    /// For which decision.
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

/// What an agent or a gateway asks of the sim before anything else.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct JoinRequest {
    /// The node's version of Squall.
    pub version: String,
    /// What it wants to be.
    pub role: Role,
    /// A name for the process, unique on the network.
    pub node: String,
    /// The vehicles it wants, by name.
    pub vehicles: Vec<String>,
}

/// What a node that joins does for its vehicles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, strum::Display)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Role {
    /// Decides for them.
    Agent,
    /// Connects real boats.
    Gateway,
}

/// What the sim answers.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum JoinReply {
    /// The node has joined.
    Granted {
        /// To be shown with every order or report.
        ticket: u64,
        /// The vehicles, in the order asked for.
        vehicles: Vec<VehicleId>,
        /// Time of the game: what was made before it was not made for this node.
        now_ns: SimTime,
    },
    /// Not now: somebody else has the vehicle. Asking again later may help.
    Busy {
        /// The vehicle.
        vehicle: String,
    },
    /// No, and asking again will not help.
    Refused {
        /// Why.
        reason: String,
    },
}

/// What the shore asks of a game.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Control {
    /// Ends the game now.
    Stop,
    /// Stands still until resumed. Real boats hold meanwhile.
    Pause,
    /// Goes on.
    Resume,
    /// Where it is paused: plays one decision.
    Step,
    /// Plays so many simulated seconds a second; none is as fast as can be. A game in lockstep plays no faster than that,
    /// one by the clock as fast as that. A game with real boats keeps its pace.
    Speed(Option<f64>),
    /// All boats hold for now, the game goes on.
    Halt,
    /// They may go on.
    GoOn,
    /// All boats stop, real and simulated, and stay stopped.
    EStop,
    /// The stop is over. Real boats have to be armed again.
    Release,
}

/// What the sim answers to a [`Control`] that is asked of it: why it was refused, if it was.
pub type ControlReply = Result<(), String>;

impl Control {
    /// Whether it stops boats, or the game's clock for them: that anybody may do.
    #[must_use]
    pub fn stops(self) -> bool {
        matches!(self, Control::EStop | Control::Halt)
    }

    /// The speeds that may be asked for, simulated seconds a second.
    pub const SPEEDS: RangeInclusive<f64> = 0.01..=1000.0;
}

/// What a sim says of its game to anyone who asks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GameInfo {
    /// The sim's version of Squall.
    pub version: String,
    /// How the game is paced.
    pub pace: String,
    /// The checked scenario, with the seed of this game.
    pub scenario: Scenario,
}
