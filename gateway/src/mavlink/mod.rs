//! MAVLink as ArduPilot's boats speak it: bytes to messages and back, with no port and no clock.
//!
//! The messages themselves are those of the crate `mavlink`, dialect `common`. Frames of version 2 are written; 1 and 2 are read.
//! Signatures are neither written nor checked.

mod framer;
mod rover_mode;
mod text;

pub use ::mavlink::dialects::common as dialect;
pub use framer::{Counts, FRAME_MAX, Framer, Received};
pub use rover_mode::RoverMode;
pub use text::message_text;

use ::mavlink::{MAVLinkV2MessageRaw, MavHeader};
use dialect::MavMessage;

/// The component of an autopilot.
pub const AUTOPILOT: u8 = 1;

/// Writes the messages of one system and component.
#[derive(Clone, Copy, Debug)]
pub struct Writer {
    system: u8,
    component: u8,
    sequence: u8,
}

impl Writer {
    /// Of this system and component.
    #[must_use]
    pub fn new(system: u8, component: u8) -> Writer {
        Writer { system, component, sequence: 0 }
    }

    /// Appends a message.
    pub fn write(&mut self, message: &MavMessage, out: &mut Vec<u8>) {
        let header = MavHeader { system_id: self.system.into(), component_id: self.component, sequence: self.sequence };
        let mut frame = MAVLinkV2MessageRaw::new();
        frame.serialize_message(header, message);
        out.extend_from_slice(frame.raw_bytes());
        // Receivers count lost frames by gaps in it.
        self.sequence = self.sequence.wrapping_add(1);
    }
}
