//! The ROS 2 bridge: a game as nodes, topics and services of ROS 2 over `rmw_zenoh`.
//!
//! The bridge is a node like any other: an observer, and the agent of the boats driven from ROS 2,
//! if any. Measurements and truth never mix. A boat's own measurements come from its team's
//! picture, and are published only for boats that the bridge drives. The truth comes from
//! observers' frames, and is published under `truth/`.
//!
//! Only [`convert`] converts Squall's north-east-down coordinates to those of REP 103 and REP 105.
//! Keys, tokens and attachments are in [`name`], type hashes in [`type_hash`].

pub mod convert;
pub mod diagnostics;
pub mod markers;
pub mod message;
pub mod name;
pub mod node;
pub mod package;
pub mod set_point;
pub mod type_hash;
