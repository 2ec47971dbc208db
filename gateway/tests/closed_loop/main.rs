//! Tests the gateway with the emulated boat in a closed loop, in memory. The tests control time and
//! inject faults.
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
