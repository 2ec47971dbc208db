//! The payloads of a boat, such as a camera or a sonde: their ports as users type them, and their
//! recordings.
//!
//! `node::payload` passes the bytes on; there are no sockets or clocks here.

pub mod exo2;
mod port;
mod record;

pub use port::{Exo2Port, PayloadPort, PayloadPortError};
pub use record::PayloadEncoder;
