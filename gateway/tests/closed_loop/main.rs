//! The gateway and the emulated boat in a closed loop in memory: the test controls time and injects
//! faults.
//!
//! Most tests are text files (see `scenarios/README.md`).

mod boat;
mod emulator;
mod oracle;
mod random;
mod rate;
mod recording;
mod rig;
mod script;
mod tamper;
