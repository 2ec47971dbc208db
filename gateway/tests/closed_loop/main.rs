//! The gateway and the emulated boat in a closed loop in memory: the test controls time and injects faults.

mod emulator;
mod faults;
mod link_faults;
mod missions;
mod nominal;
mod oracle;
mod recording;
mod rig;
