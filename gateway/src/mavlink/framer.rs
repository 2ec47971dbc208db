//! Splits incoming bytes into messages, and counts what it discards.
//!
//! The framer keeps at most one frame. After a damaged frame, it continues from the byte after the
//! frame's start, so that it still finds a valid frame within a wrongly stated length.

use super::dialect::MavMessage;
use ::mavlink::{MAV_STX, MAV_STX_V2, MavlinkVersion, Message, calculate_crc};
use std::collections::BTreeMap;

/// Maximum bytes of a frame: version 2, full payload, with a signature.
pub const FRAME_MAX: usize = 10 + 255 + 2 + SIGNATURE;
const SIGNATURE: usize = 13;
/// The flag of a signed frame of version 2.
const SIGNED: u8 = 1;
/// Maximum number of unknown message numbers stored.
// Any sender on the link can choose message numbers, so the table must have a limit.
const UNKNOWN_MAX: usize = 64;

/// Number and CRC_EXTRA byte of requests in ArduPilot's own dialect that need a reply, although
/// this program cannot read them: FENCE_POINT, FENCE_FETCH_POINT, RALLY_POINT and
/// RALLY_FETCH_POINT.
const REQUESTS: [(u32, u8); 4] = [(160, 78), (161, 68), (175, 138), (176, 234)];

/// A message and its sender.
#[derive(Clone, Debug, PartialEq)]
pub struct Received {
    /// The system that sent it.
    pub system: u8,
    /// The component that sent it.
    pub component: u8,
    /// The message.
    pub message: MavMessage,
}

/// A message with a valid checksum that the dialect cannot express, because the message or one of
/// its values is unknown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unreadable {
    /// The system that sent it.
    pub system: u8,
    /// The component that sent it.
    pub component: u8,
    /// The number of the message.
    pub id: u32,
    /// The payload, without the trailing zeros that version 2 omits.
    pub payload: Vec<u8>,
}

impl Unreadable {
    /// A byte of the payload.
    pub fn byte(&self, at: usize) -> u8 {
        self.payload.get(at).copied().unwrap_or(0)
    }
}

/// A complete frame of a known message.
#[derive(Clone, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "a frame is handled at once and never stored"
)]
pub enum Frame {
    /// The message could be read.
    Read(Received),
    /// It could not be read.
    Unreadable(Unreadable),
}

/// Counts of frames and bytes read by a [`Framer`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Messages read.
    pub messages: u64,
    /// Frames of known messages with a wrong checksum.
    pub bad_checksum: u64,
    /// Bytes outside frames.
    pub garbage: u64,
    /// Messages with a value that the dialect does not know.
    pub unreadable: u64,
    /// Messages unknown to the dialect, by number; each is counted once the next frame begins.
    /// Beyond a limit, new numbers count as `u32::MAX`.
    pub unknown: BTreeMap<u32, u64>,
}

/// Splits a byte stream into messages.
#[derive(Clone, Debug, Default)]
pub struct Framer {
    buffer: Vec<u8>,
    counts: Counts,
}

/// The offsets of a frame's parts.
struct Layout {
    version: MavlinkVersion,
    id: u32,
    system: u8,
    component: u8,
    /// Start and end of the payload.
    payload: (usize, usize),
    /// The length of the complete frame.
    len: usize,
}

impl Layout {
    /// The layout of bytes that begin like a frame; `Ok(None)` if there are too few of them.
    fn of(bytes: &[u8]) -> Result<Option<Layout>, NotAFrame> {
        match *bytes {
            [MAV_STX, len, _, system, component, id, ..] => {
                let end = 6 + usize::from(len);
                Ok(Some(Layout {
                    version: MavlinkVersion::V1,
                    id: u32::from(id),
                    system,
                    component,
                    payload: (6, end),
                    len: end + 2,
                }))
            }
            // A receiver that does not know an incompatibility flag must discard the frame.
            [MAV_STX_V2, _, flags, ..] if flags & !SIGNED != 0 => Err(NotAFrame),
            [MAV_STX_V2, len, flags, _, _, system, component, a, b, c, ..] => {
                let end = 10 + usize::from(len);
                let signature = if flags & SIGNED == 0 { 0 } else { SIGNATURE };
                Ok(Some(Layout {
                    version: MavlinkVersion::V2,
                    id: u32::from_le_bytes([a, b, c, 0]),
                    system,
                    component,
                    payload: (10, end),
                    len: end + 2 + signature,
                }))
            }
            [MAV_STX | MAV_STX_V2, ..] | [] => Ok(None),
            _ => Err(NotAFrame),
        }
    }

    fn is_known(&self) -> bool {
        self.extra_crc().is_some()
    }

    /// The CRC_EXTRA byte of the message, if known.
    fn extra_crc(&self) -> Option<u8> {
        let request = REQUESTS.iter().find(|(id, _)| *id == self.id);
        request.map(|(_, extra_crc)| *extra_crc).or_else(|| {
            let message = MavMessage::default_message_from_id(self.id);
            message.map(|_| MavMessage::extra_crc(self.id))
        })
    }

    fn has_right_checksum(&self, frame: &[u8]) -> bool {
        let (_, end) = self.payload;
        let stated = u16::from_le_bytes([frame[end], frame[end + 1]]);
        self.extra_crc()
            .is_some_and(|extra_crc| calculate_crc(&frame[1..end], extra_crc) == stated)
    }
}

/// Whether bytes begin with a complete frame of a known message, with a valid checksum.
fn begins_with_good_frame(bytes: &[u8]) -> bool {
    let Ok(Some(layout)) = Layout::of(bytes) else {
        return false;
    };
    layout.is_known()
        && bytes.len() >= layout.len
        && layout.has_right_checksum(&bytes[..layout.len])
}

/// These bytes do not begin a frame.
struct NotAFrame;

impl Framer {
    /// An empty framer.
    pub fn new() -> Framer {
        Framer::default()
    }

    /// Drops an incomplete frame.
    pub fn interrupt(&mut self) {
        self.counts.garbage += self.buffer.len() as u64;
        self.buffer.clear();
    }

    /// Accepts bytes, however they are split and with any garbage. Calls `take` with each message
    /// with a valid checksum, in order.
    pub fn push(&mut self, bytes: &[u8], take: &mut dyn FnMut(Received)) {
        self.push_frames(bytes, &mut |frame| {
            if let Frame::Read(received) = frame {
                take(received);
            }
        });
    }

    /// Like [`Framer::push`], but includes frames that cannot be read.
    pub fn push_frames(&mut self, bytes: &[u8], take: &mut dyn FnMut(Frame)) {
        self.buffer.extend_from_slice(bytes);
        let buffer = std::mem::take(&mut self.buffer);
        let mut at = 0;
        loop {
            match Layout::of(&buffer[at..]) {
                Err(NotAFrame) => {
                    self.counts.garbage += 1;
                    at += 1;
                }
                Ok(Some(layout)) if !layout.is_known() => {
                    match self.pass_unknown(&layout, &buffer[at..]) {
                        0 => break,
                        count => at += count,
                    }
                }
                Ok(Some(layout)) if buffer.len() - at >= layout.len => {
                    at += self.read(&layout, &buffer[at..at + layout.len], take);
                }
                Ok(_) => break,
            }
        }
        self.buffer = buffer;
        self.buffer.drain(..at);
    }

    /// The counts so far.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }

    /// Skips bytes that begin like a frame of an unknown message; returns the number of bytes
    /// consumed, 0 while undecided.
    fn pass_unknown(&mut self, layout: &Layout, bytes: &[u8]) -> usize {
        // A checksum includes a byte from the message's definition, so it cannot be checked for an
        // unknown message. Noise that looks like a frame start is detected by a valid frame within
        // the stated length, or by the byte after that length. More bytes never change a decision
        // made with fewer bytes, so the result does not depend on the split.
        let inside = &bytes[..layout.len.min(bytes.len())];
        let is_noise = (1..inside.len()).any(|at| begins_with_good_frame(&inside[at..]));
        match bytes.get(layout.len) {
            None if !is_noise => 0,
            Some(&(MAV_STX | MAV_STX_V2)) if !is_noise => {
                let key = if self.counts.unknown.len() < UNKNOWN_MAX {
                    layout.id
                } else {
                    u32::MAX
                };
                *self.counts.unknown.entry(key).or_default() += 1;
                layout.len
            }
            _ => {
                self.counts.garbage += 1;
                1
            }
        }
    }

    /// Reads a complete frame; returns the number of bytes consumed.
    fn read(&mut self, layout: &Layout, frame: &[u8], take: &mut dyn FnMut(Frame)) -> usize {
        let Layout {
            version,
            id,
            system,
            component,
            payload: (start, end),
            len,
        } = *layout;
        if !layout.has_right_checksum(frame) {
            self.counts.bad_checksum += 1;
            self.counts.garbage += 1;
            // Skip one byte, not the whole frame: a false start inside other data would swallow
            // real frames within its stated length.
            return 1;
        }
        match MavMessage::parse(version, id, &frame[start..end]) {
            Ok(message) => {
                self.counts.messages += 1;
                take(Frame::Read(Received {
                    system,
                    component,
                    message,
                }));
            }
            Err(_) => {
                self.counts.unreadable += 1;
                let payload = frame[start..end].to_vec();
                take(Frame::Unreadable(Unreadable {
                    system,
                    component,
                    id,
                    payload,
                }));
            }
        }
        len
    }
}
