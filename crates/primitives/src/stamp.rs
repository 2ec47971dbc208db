//! How every per-tick message begins, and what makes it one.

use crate::time::SimTime;
use serde::{Deserialize, Serialize};

/// A per-tick message: named and versioned.
pub trait Message {
    /// The ROS 2 name of the message, as `Encoding` carries it.
    const SCHEMA: &'static str;
    /// The version of its layout.
    const VERSION: u8;
    /// The oldest version that is still read: its layout is the same, but not what all of it means.
    const OLDEST: u8 = Self::VERSION;
}

/// How every message begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stamp {
    /// Simulated time at which the content holds, ns.
    pub valid_ns: SimTime,
    /// Decision tick, counted from 0.
    pub seq: u64,
    /// Version of the message's layout.
    pub version: u8,
}
