//! Setting a boat under way: a world whose boat is where, and moves as, somebody outside says.

use crate::hull::Planar;
use crate::thruster::Shaft;
use crate::world::World;
use game::{Pose, VehicleId};

/// Where the scenario's mark stands in a snapshot: after the name and the layout version.
const MARK: std::ops::Range<usize> = 5..13;

/// Puts a boat there, moving over the ground like this (body axes), its thrusters as they are; those can be set too.
///
/// # Panics
/// If there is no such vehicle.
pub fn set_under_way(
    world: &mut World,
    vehicle: VehicleId,
    pose: Pose,
    nu: Planar,
    shafts: impl FnOnce([&mut Shaft; 2]),
) {
    let mut state = world.state().clone();
    let boat = &mut state.boats[vehicle.index()];
    (boat.pose, boat.nu) = (pose, nu);
    shafts([&mut boat.port, &mut boat.starboard]);
    let mark: [u8; 8] = world.snapshot()[MARK].try_into().expect("a snapshot has a head");
    world.restore(&state.snapshot(u64::from_le_bytes(mark))).expect("the mark is its own");
}
