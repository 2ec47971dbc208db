//! What goes into a bridge, and what comes out.

use game::external::OperatorCommand;
use game::frame::Ned;
use game::gateway::Gateway;
use game::picture::Nav;
use game::{Field, Order, SimTime};
use serde::{Deserialize, Serialize};

/// What a bridge is made for: it does not change.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The boat's name.
    pub vehicle: String,
    /// How it is driven and stopped.
    pub gateway: Gateway,
    /// Where it plays.
    pub field: Field,
    /// Its length, m.
    pub length_m: f64,
    /// Magnetic north, east of true, rad.
    pub declination_rad: f64,
    /// Whether it arms by itself, once, as soon as everything is there.
    pub arms_itself: bool,
}

/// Something that comes in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Input {
    /// The link is up.
    LinkUp,
    /// The link is down.
    LinkDown,
    /// Bytes from the boat.
    #[serde(skip)]
    Bytes(Vec<u8>),
    /// The sim has taken the boat in: what was ordered before does not count.
    Moored,
    /// An order, and the time of the picture that it answers.
    Order(Order, SimTime),
    /// Something that should have been an order and is none.
    BadOrder,
    /// Where the other real boats are.
    Others(Vec<Ned>),
    /// A person wants something.
    Operator(OperatorCommand),
    /// A person wants all boats to stop (or the stop to be over).
    Fleet(FleetCommand),
    /// Time passes.
    Tick,
}

/// What is said to all boats at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FleetCommand {
    /// Stop, and stay stopped.
    EStop,
    /// The stop is over.
    Release,
}

/// What goes out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outbox {
    /// Bytes to the boat, in one piece.
    pub bytes: Vec<u8>,
    /// Navigation, if there is news of it.
    pub nav: Option<NavOut>,
    /// What happened.
    pub events: Vec<Event>,
    /// Why a person's wish is not granted.
    pub refused: Option<String>,
    /// Whether the bytes carry an order that came in with this very input or before, and had not been sent yet.
    pub carries_order: bool,
}

/// Navigation on its way to the sim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NavOut {
    /// Where the boat is.
    pub nav: Nav,
    /// Whether it can be relied on.
    pub valid: bool,
    /// How old the fix is, s.
    pub age_s: f64,
}

/// Something that happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Event {
    /// The supervisor went from one state to another.
    State {
        /// Before.
        from: String,
        /// Now.
        to: String,
    },
    /// Another boat is in the way, or is no longer.
    Blocked(bool),
    /// Something that a person should know.
    Warning(String),
    /// Something that the shell saw and the core does not know of.
    Remark(String),
}
