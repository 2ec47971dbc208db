//! What changes in a world.

use crate::flaw::FlawState;
use crate::hull::Planar;
use crate::kinematic::KinematicState;
use crate::sensor::{Reading, SensorState};
use crate::thruster::Shaft;
use primitives::{Pose, SimTime};
use serde::{Deserialize, Serialize};

/// Everything that changes in a world. Nothing else is remembered from tick to tick: what a step does follows from this
/// and the commands. What a game adds to it (the standing, orders in force, messages under way, sightings) belongs to
/// [`Contest`](crate::Contest), whose snapshot holds both.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Physics ticks since the start.
    pub tick: u64,
    /// Simulated time since the start.
    pub now: SimTime,
    /// By vehicle.
    pub boats: Vec<BoatState>,
    /// By vehicle: what its thrusters' flaws remember.
    pub flaws: Vec<FlawState>,
    /// The point boats among the vehicles, in their order.
    pub points: Vec<KinematicState>,
    /// Of the vehicles with sensors, in their order: what those remember, and what they tell.
    pub senses: Vec<(SensorState, Reading)>,
}

/// Everything that changes about one boat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BoatState {
    /// Where it is.
    pub pose: Pose,
    /// Velocity over the ground in body axes.
    pub nu: Planar,
    /// By how much that changed in the last tick: what accelerometers feel.
    pub nu_change: Planar,
    /// Port thruster.
    pub port: Shaft,
    /// Starboard thruster.
    pub starboard: Shaft,
    /// Memory of the front seat's speed loop, N.
    pub speed_integral_newton: f64,
    /// Whether its numbers went bad: it lies still and plays no more.
    pub quarantined: bool,
}
