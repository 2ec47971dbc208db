//! MAVLink as used by ArduPilot's boats: converts bytes to messages and back, without ports or
//! clocks.
//!
//! The messages are those of the crate `mavlink`, dialect `common`. This module writes frames of
//! version 2, and reads versions 1 and 2. Signatures are neither written nor checked.

mod framer;
pub(crate) mod position;
mod rover_mode;
mod text;

pub use ::mavlink::dialects::common as dialect;
pub use framer::{Counts, FRAME_MAX, Frame, Framer, Received, Unreadable};
pub(crate) use position::{e7, lat_lon, on_globe};
pub use rover_mode::RoverMode;
pub use text::message_text;

use ::mavlink::{MAV_STX_V2, MAVLinkV2MessageRaw, MavHeader, calculate_crc};
use dialect::MavMessage;

/// The component number of an autopilot.
pub const AUTOPILOT: u8 = 1;

/// Writes the messages of one system and component.
#[derive(Clone, Copy, Debug)]
pub struct Writer {
    pub(crate) system: u8,
    component: u8,
    sequence: u8,
}

impl Writer {
    /// A writer for this system and component.
    pub fn new(system: u8, component: u8) -> Writer {
        Writer {
            system,
            component,
            sequence: 0,
        }
    }

    /// Appends a message that the dialect cannot express, from its number, its CRC_EXTRA byte, and
    /// its payload.
    pub fn write_raw(&mut self, id: u32, extra_crc: u8, payload: &[u8], out: &mut Vec<u8>) {
        // Version 2 omits trailing zeros, but never the first byte.
        let len = payload
            .iter()
            .rposition(|byte| *byte != 0)
            .map_or(1, |last| last + 1);
        let [a, b, c, _] = id.to_le_bytes();
        let mut frame = vec![
            MAV_STX_V2,
            len as u8,
            0,
            0,
            self.sequence,
            self.system,
            self.component,
            a,
            b,
            c,
        ];
        frame.extend(&payload[..len]);
        let checksum = calculate_crc(&frame[1..], extra_crc);
        out.extend(frame);
        out.extend(checksum.to_le_bytes());
        self.sequence = self.sequence.wrapping_add(1);
    }

    /// Appends a message.
    pub fn write(&mut self, message: &MavMessage, out: &mut Vec<u8>) {
        let header = MavHeader {
            system_id: self.system.into(),
            component_id: self.component,
            sequence: self.sequence,
        };
        let mut frame = MAVLinkV2MessageRaw::new();
        frame.serialize_message(header, message);
        out.extend_from_slice(frame.raw_bytes());
        // Receivers count lost frames from gaps in the sequence numbers.
        self.sequence = self.sequence.wrapping_add(1);
    }
}
