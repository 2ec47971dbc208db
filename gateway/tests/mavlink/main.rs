//! Tests MAVLink: frames from a different program, and an ArduPilot boat in a closed loop with its
//! gateway, in memory.

#[path = "../closed_loop/boat.rs"]
#[allow(dead_code, reason = "only the tests of a Surveyor use all of it")]
mod boat;
mod closed_loop;
mod foreign_order;
mod framing;
mod ground_station;
mod guided;
mod preflight;
mod rig;
mod rover_sitl;
mod station;
