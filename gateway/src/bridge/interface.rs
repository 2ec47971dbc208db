//! The interface of a bridge: its inputs and outputs.

use crate::config::{CompassFrame, Gateway};
use messages::Order;
use messages::external::{FleetCommand, OperatorCommand};
use messages::picture::Nav;
use primitives::SimTime;
use primitives::frame::Ned;
use rules::Field;
use serde::{Deserialize, Serialize};

/// What a bridge is made for; constant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The boat's name.
    pub vehicle: String,
    /// How it is driven and stopped.
    pub gateway: Gateway,
    /// Where it plays, if that is known from the beginning; else [`Input::Site`] says so.
    #[serde(flatten)]
    pub site: Option<Site>,
    /// Whether it arms by itself, once, as soon as it is ready.
    pub arms_itself: bool,
    /// Whether the boat is sent nothing but standby, whatever it would be sent.
    #[serde(default)]
    pub dry_run: bool,
    /// Whether its pre-flight check lets it be armed.
    #[serde(default)]
    pub preflight: Preflight,
}

/// Whether the pre-flight check of a boat lets it be armed.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Preflight {
    /// None is asked for.
    #[default]
    NotRequired,
    /// There is the report of one that it has passed.
    Passed,
    /// This person answers for arming without one.
    WaivedBy(String),
    /// There is no such report, and why.
    Missing(String),
}

impl Preflight {
    /// What is missing for arming, if anything.
    #[must_use]
    pub fn missing(&self) -> Option<&String> {
        if let Preflight::Missing(why) = self { Some(why) } else { None }
    }
}

/// What only a game says: where a boat plays, and how long it is there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Site {
    /// The field.
    pub field: Field,
    /// The boat's length, m.
    pub length_m: f64,
    /// Declination, east positive, rad.
    pub declination_rad: f64,
}

impl Site {
    /// What must be added to a heading of a compass that shows this to make it true, rad.
    #[must_use]
    pub fn compass_to_true_rad(&self, compass: CompassFrame) -> f64 {
        match compass {
            CompassFrame::Magnetic => self.declination_rad,
            CompassFrame::True => 0.0,
        }
    }
}

/// An input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Input {
    /// The link is up.
    LinkUp,
    /// The link is down.
    LinkDown,
    /// Bytes from the boat.
    // Recorded apart, as messages of the link with their direction: as JSON numbers they would
    // take four times the room.
    #[serde(skip)]
    Bytes(Vec<u8>),
    /// The sim has let the boat join: earlier orders do not count.
    Joined,
    /// An order, and the time of the picture that it answers.
    // With the time of the picture that it answers: that, and not the message, makes an order
    // fresh. A sim that repeats itself keeps no boat moving.
    Order(Order, SimTime),
    /// An order that could not be read.
    BadOrder,
    /// An order from a time that the game has not come to.
    OrderAhead,
    /// An order from before the boat joined.
    OldOrder,
    /// Positions of the other real boats.
    Others(Vec<Ned>),
    /// An operator's command for this boat.
    Operator(OperatorCommand),
    /// An operator's command for all boats.
    Fleet(FleetCommand),
    /// A game was found, and says where the boat plays.
    Site(Box<Site>),
    /// The gateway did not run for so long, s, that its guard may have stopped the boat.
    Hung(f64),
    /// Time passes.
    Tick,
}

/// What an input results in.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Output {
    /// Bytes to the boat, to be written at once.
    pub bytes: Vec<u8>,
    /// Navigation, if there is news of it.
    pub nav: Option<NavOut>,
    /// What happened.
    pub events: Vec<Event>,
    /// Why an operator's request is refused.
    pub refused: Option<String>,
    /// Whether the bytes carry an order that had not been sent yet.
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
    /// A log message of the shell.
    Remark(String),
}
