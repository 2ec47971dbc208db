//! The payloads of a boat, such as a camera or a sonde: their ports as people type them, and what is recorded of them.
//!
//! What passes the bytes on is in `node::payload`; here is neither socket nor clock.

pub mod exo2;
mod port;
mod record;

pub use port::{Exo2Port, PayloadPort, PayloadPortError};
pub use record::PayloadEncoder;
