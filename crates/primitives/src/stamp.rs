//! The common first field of high-rate messages, and their trait.

use crate::time::SimTime;
use serde::{Deserialize, Serialize};

/// A high-rate message: named and versioned.
pub trait Message {
    /// The ROS 2 name of the message, used in `Encoding`.
    const SCHEMA: &'static str;
    /// The version of its layout.
    const VERSION: u8;
    /// The oldest version that can still be read: the layout is the same, but some fields differ in
    /// meaning.
    const OLDEST: u8 = Self::VERSION;
}

/// The first field of every message.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stamp {
    /// Simulated time for which the content is valid, ns.
    pub valid_ns: SimTime,
    /// Number of the decision, counted from 0; in gateways' reports, a sequence number.
    pub seq: u64,
    /// Version of the message's layout.
    pub version: u8,
}
