//! The interface of a bridge: its inputs and outputs.

use crate::config::Gateway;
use crate::geofence::Coasting;
use messages::Order;
use messages::external::{FleetCommand, OperatorCommand};
use messages::picture::Nav;
use primitives::SimTime;
use primitives::frame::Ned;
use rules::Field;
use serde::{Deserialize, Serialize};

/// The fixed configuration of a bridge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The boat's name.
    pub vehicle: String,
    /// How the boat is driven and stopped.
    pub gateway: Gateway,
    /// The boat's site, if known from the start; otherwise [`Input::Site`] supplies it.
    #[serde(flatten)]
    pub site: Option<Site>,
    /// Whether the bridge arms the boat once without a request, as soon as the boat is ready.
    pub arms_itself: bool,
    /// Whether to send the boat only standby, whatever the orders.
    #[serde(default)]
    pub dry_run: bool,
    /// Whether the pre-flight check allows arming.
    #[serde(default)]
    pub preflight: Preflight,
}

impl Plan {
    /// A boat that has no site yet, is armed by an operator and needs no pre-flight check.
    pub fn new(vehicle: &str, gateway: Gateway) -> Plan {
        let vehicle = vehicle.to_owned();
        let preflight = Preflight::NotRequired;
        Plan {
            vehicle,
            gateway,
            site: None,
            arms_itself: false,
            dry_run: false,
            preflight,
        }
    }
}

/// Whether a boat's pre-flight check allows arming.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Preflight {
    /// No check is required.
    #[default]
    NotRequired,
    /// The report of a passed check is available.
    Passed,
    /// This person takes responsibility for arming without a report.
    WaivedBy(String),
    /// The report is missing, for the given reason.
    Missing(String),
}

impl Preflight {
    /// The obstacle to arming, if any.
    pub(crate) fn missing(&self) -> Option<&String> {
        if let Preflight::Missing(why) = self {
            Some(why)
        } else {
            None
        }
    }
}

/// Properties that only a game defines: the field, and the boat's properties in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Site {
    /// The field in which the boat plays.
    pub field: Field,
    /// The boat's length, m.
    pub length_m: f64,
    /// Magnetic declination, east positive, rad.
    pub declination_rad: f64,
    /// How the boat coasts, if its boat file is known.
    #[serde(default)]
    pub coasting: Option<Coasting>,
}

/// An input of the bridge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Input {
    /// The link is up.
    LinkUp,
    /// The link is down.
    LinkDown,
    /// Bytes from the boat.
    // Recorded separately, as link messages with a direction: JSON numbers would take four times
    // the space.
    #[serde(skip)]
    Bytes(Vec<u8>),
    /// The sim has admitted the boat; earlier orders are ignored.
    Joined,
    /// An order, and the time of the picture that it answers.
    // The picture's time, not the message's, decides whether an order is fresh: a sim that keeps
    // sending the same order must not keep a boat moving.
    Order(Order, SimTime),
    /// An unreadable order.
    BadOrder,
    /// An order whose time the game has not yet reached.
    OrderAhead,
    /// An order from before the boat's admission.
    OldOrder,
    /// Positions of the other real boats.
    Others(Vec<Ned>),
    /// An operator's command for this boat.
    Operator(OperatorCommand),
    /// An operator's command for all boats.
    Fleet(FleetCommand),
    /// A game was found that defines the boat's site.
    Site(Box<Site>),
    /// The gateway was not running for this time, s; its guard may have stopped the boat.
    Hung(f64),
    /// Time has passed.
    Tick,
}

/// The bridge's response to an input.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Output {
    /// Bytes to write to the boat at once.
    pub bytes: Vec<u8>,
    /// Navigation data, if new.
    pub nav: Option<NavOut>,
    /// Events in order of occurrence.
    pub events: Vec<Event>,
    /// Why an operator's request was refused.
    pub refused: Option<String>,
    /// Whether the bytes contain an order that is sent for the first time.
    pub carries_order: bool,
    /// Whether the bytes stop the boat.
    pub stops: bool,
}

/// Navigation data for the sim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NavOut {
    /// The boat's position and motion.
    pub nav: Nav,
    /// Whether the data are reliable.
    pub valid: bool,
    /// Age of the fix, s.
    pub age_s: f64,
}

/// An event for the log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Event {
    /// The supervisor changed its state.
    State {
        /// The previous state.
        from: String,
        /// The new state.
        to: String,
    },
    /// Another boat came into the boat's path (`true`) or left it (`false`).
    Blocked(bool),
    /// A warning for the operator.
    Warning(String),
    /// A log message from the node that runs the bridge.
    Remark(String),
}
