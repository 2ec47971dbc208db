//! The changing state of a world.

use crate::flaw::FlawState;
use crate::hull::Planar;
use crate::kinematic::KinematicState;
use crate::sensor::{Reading, SensorState};
use crate::thruster::Shaft;
use primitives::{Pose, SimTime};
use serde::{Deserialize, Serialize};

/// The complete changing state of a world: a step depends only on this and the commands. The state
/// of a game (standing, orders in force, messages in transit, sightings) belongs to
/// [`Contest`](crate::Contest), whose snapshot contains both.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Physics ticks since the start.
    pub tick: u64,
    /// Simulated time since the start.
    pub now: SimTime,
    /// Boats, by vehicle index.
    pub boats: Vec<BoatState>,
    /// Flaw state of the thrusters, by vehicle index.
    pub flaws: Vec<FlawState>,
    /// State of the point boats, in vehicle order.
    pub points: Vec<KinematicState>,
    /// State and reading of the sensors, in the order of vehicles with sensors.
    pub senses: Vec<(SensorState, Reading)>,
}

/// The changing state of one boat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BoatState {
    /// Position and heading.
    pub pose: Pose,
    /// Velocity over the ground in body axes.
    pub nu: Planar,
    /// Change of `nu` in the last tick, as measured by accelerometers.
    pub nu_change: Planar,
    /// Port thruster.
    pub port: Shaft,
    /// Starboard thruster.
    pub starboard: Shaft,
    /// State of the front seat's speed loop, N.
    pub speed_integral_newton: f64,
    /// Whether the boat's state became non-finite; the boat then stays at rest and out of play.
    pub quarantined: bool,
}
