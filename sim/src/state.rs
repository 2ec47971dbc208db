//! What changes in a world, and how it becomes bytes.

use crate::flaw::FlawState;
use crate::hull::Planar;
use crate::kinematic::KinematicState;
use crate::sensor::{Reading, SensorState};
use crate::thruster::Shaft;
use game::rules::Standing;
use game::{Pose, SimTime};
use serde::{Deserialize, Serialize};
use thiserror::Error;
use xxhash_rust::xxh3;

/// Everything that changes in a world. Nothing else is remembered from tick to tick: what a step does follows from this
/// and the orders. What stands between minds and boats is no part of the world: orders in force, messages under way,
/// sightings and watchdogs belong to [`Contest`](crate::Contest), whose digest covers them and which has no snapshot.
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
    /// How the game stands.
    pub standing: Standing,
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

/// What a snapshot begins with: name, layout version.
const MAGIC: [u8; 5] = *b"SQLW\x03";

/// Why bytes are not a snapshot of this world.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum RestoreError {
    /// Not a snapshot, or of another layout.
    #[error("not a snapshot of this version of Squall")]
    NotASnapshot,
    /// A snapshot of another scenario or seed: the sea would be another.
    #[error("a snapshot of another scenario, of another seed, or of other versions of its files")]
    OtherScenario,
    /// A snapshot that was cut or changed.
    #[error("the snapshot is damaged")]
    Damaged,
}

impl State {
    /// The state as bytes, marked with the scenario it belongs to.
    #[must_use]
    pub fn snapshot(&self, scenario_mark: u64) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(scenario_mark.to_le_bytes());
        let body = self.bytes();
        bytes.extend(xxh3::xxh3_64(&body).to_le_bytes());
        bytes.extend(body);
        bytes
    }

    /// The state in a snapshot of the same scenario.
    ///
    /// # Errors
    /// [`RestoreError`] says what is wrong with the bytes.
    pub fn from_snapshot(bytes: &[u8], scenario_mark: u64) -> Result<State, RestoreError> {
        let rest = bytes.strip_prefix(&MAGIC).ok_or(RestoreError::NotASnapshot)?;
        let (mark, rest) = rest.split_at_checked(8).ok_or(RestoreError::Damaged)?;
        let (check, body) = rest.split_at_checked(8).ok_or(RestoreError::Damaged)?;
        if mark != scenario_mark.to_le_bytes() {
            return Err(RestoreError::OtherScenario);
        }
        if check != xxh3::xxh3_64(body).to_le_bytes() {
            return Err(RestoreError::Damaged);
        }
        postcard::from_bytes(body).map_err(|_| RestoreError::Damaged)
    }

    /// 128 bits that differ when any bit of the state differs.
    #[must_use]
    pub fn digest(&self) -> u128 {
        xxh3::xxh3_128(&self.bytes())
    }

    fn bytes(&self) -> Vec<u8> {
        postcard::to_stdvec(self).expect("a state of plain numbers always encodes")
    }
}
