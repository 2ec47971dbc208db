//! The framer: cuts whatever comes down a wire into messages, and counts what it had to leave.
//!
//! It keeps at most one frame. After damage it looks for the next frame from the byte behind the one that began the damaged frame, so
//! that a frame inside of what a wrong length covers is found.

use super::dialect::MavMessage;
use ::mavlink::{MAV_STX, MAV_STX_V2, MavlinkVersion, Message, calculate_crc};
use std::collections::BTreeMap;

/// The longest frame, bytes: version 2, all of the payload, with a signature.
pub const FRAME_MAX: usize = 10 + 255 + 2 + SIGNATURE;
const SIGNATURE: usize = 13;
/// The flag of a frame of version 2 that has a signature.
const SIGNED: u8 = 1;
/// How many numbers of unknown messages are kept.
// Numbers come from whoever is on the link: the table must not grow with them.
const UNKNOWN_MAX: usize = 64;

/// A message, and whose it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Received {
    /// The system that sent it.
    pub system: u8,
    /// The component of it.
    pub component: u8,
    /// The message.
    pub message: MavMessage,
}

/// A message with a right checksum that the dialect cannot express, since one of its values is not known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unreadable {
    /// The system that sent it.
    pub system: u8,
    /// The component of it.
    pub component: u8,
    /// Its number.
    pub id: u32,
    /// Its payload, without the zeros at the end that version 2 omits.
    pub payload: Vec<u8>,
}

impl Unreadable {
    /// A byte of the payload.
    #[must_use]
    pub fn byte(&self, at: usize) -> u8 {
        self.payload.get(at).copied().unwrap_or(0)
    }
}

/// A whole frame of a known message.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a frame is handled at once and never stored")]
pub enum Frame {
    /// Its message could be read.
    Read(Received),
    /// It could not.
    Unreadable(Unreadable),
}

/// What came through a [`Framer`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Messages that were read.
    pub messages: u64,
    /// Frames of known messages with a wrong checksum.
    pub bad_checksum: u64,
    /// Bytes outside of frames.
    pub garbage: u64,
    /// Messages with a value that the dialect does not know.
    pub unreadable: u64,
    /// Messages that the dialect does not know, by their number; they count when the next frame begins behind them.
    pub unknown: BTreeMap<u32, u64>,
}

/// Cuts a byte stream into messages.
#[derive(Clone, Debug, Default)]
pub struct Framer {
    buffer: Vec<u8>,
    counts: Counts,
}

/// Where the parts of a frame are.
struct Layout {
    version: MavlinkVersion,
    id: u32,
    system: u8,
    component: u8,
    /// Where the payload begins and ends.
    payload: (usize, usize),
    /// How long the whole frame is.
    len: usize,
}

impl Layout {
    /// The layout of what begins like a frame; `Ok(None)` if too little of it is there.
    fn of(bytes: &[u8]) -> Result<Option<Layout>, NotAFrame> {
        match *bytes {
            [MAV_STX, len, _, system, component, id, ..] => {
                let end = 6 + usize::from(len);
                let (version, id) = (MavlinkVersion::V1, u32::from(id));
                Ok(Some(Layout { version, id, system, component, payload: (6, end), len: end + 2 }))
            }
            // Whoever does not understand such a flag must leave the frame.
            [MAV_STX_V2, _, flags, ..] if flags & !SIGNED != 0 => Err(NotAFrame),
            [MAV_STX_V2, len, flags, _, _, system, component, a, b, c, ..] => {
                let end = 10 + usize::from(len);
                let signature = if flags & SIGNED == 0 { 0 } else { SIGNATURE };
                let (version, id) = (MavlinkVersion::V2, u32::from_le_bytes([a, b, c, 0]));
                Ok(Some(Layout { version, id, system, component, payload: (10, end), len: end + 2 + signature }))
            }
            [MAV_STX | MAV_STX_V2, ..] | [] => Ok(None),
            _ => Err(NotAFrame),
        }
    }

    fn is_known(&self) -> bool {
        MavMessage::default_message_from_id(self.id).is_some()
    }

    fn has_right_checksum(&self, frame: &[u8]) -> bool {
        let (_, end) = self.payload;
        let stated = u16::from_le_bytes([frame[end], frame[end + 1]]);
        calculate_crc(&frame[1..end], MavMessage::extra_crc(self.id)) == stated
    }
}

/// Whether bytes begin with the whole frame of a known message, with a right checksum.
fn begins_with_good_frame(bytes: &[u8]) -> bool {
    let Ok(Some(layout)) = Layout::of(bytes) else { return false };
    layout.is_known() && bytes.len() >= layout.len && layout.has_right_checksum(&bytes[..layout.len])
}

/// These bytes begin no frame.
struct NotAFrame;

impl Framer {
    /// Without anything yet.
    #[must_use]
    pub fn new() -> Framer {
        Framer::default()
    }

    /// Forgets a frame that is under way.
    pub fn interrupt(&mut self) {
        self.counts.garbage += self.buffer.len() as u64;
        self.buffer.clear();
    }

    /// Takes bytes as they come (any split, any garbage); calls `take` with each message with a right checksum, in order.
    pub fn push(&mut self, bytes: &[u8], take: &mut dyn FnMut(Received)) {
        self.push_frames(bytes, &mut |frame| {
            if let Frame::Read(received) = frame {
                take(received);
            }
        });
    }

    /// As [`Framer::push`], with the frames that cannot be read as well.
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
                Ok(Some(layout)) if !layout.is_known() => match self.pass_unknown(&layout, &buffer[at..]) {
                    0 => break,
                    count => at += count,
                },
                Ok(Some(layout)) if buffer.len() - at >= layout.len => {
                    at += self.read(&layout, &buffer[at..at + layout.len], take);
                }
                Ok(_) => break,
            }
        }
        self.buffer = buffer;
        self.buffer.drain(..at);
    }

    /// What came through so far.
    #[must_use]
    pub fn counts(&self) -> &Counts {
        &self.counts
    }

    /// Passes over what begins like a frame of an unknown message; returns how many bytes are done with, 0 while that is open.
    fn pass_unknown(&mut self, layout: &Layout, bytes: &[u8]) -> usize {
        // The checksum of a message includes a byte that only its definition tells, so that of
        // an unknown one cannot be checked. Noise that looks like its beginning shows by a good
        // frame within its stated length, or by what follows it. More bytes never change what
        // fewer have decided: the same comes of every split.
        let inside = &bytes[..layout.len.min(bytes.len())];
        let is_noise = (1..inside.len()).any(|at| begins_with_good_frame(&inside[at..]));
        match bytes.get(layout.len) {
            None if !is_noise => 0,
            Some(&(MAV_STX | MAV_STX_V2)) if !is_noise => {
                let key = if self.counts.unknown.len() < UNKNOWN_MAX { layout.id } else { u32::MAX };
                *self.counts.unknown.entry(key).or_default() += 1;
                layout.len
            }
            _ => {
                self.counts.garbage += 1;
                1
            }
        }
    }

    /// Reads a whole frame; returns how many bytes of it are done with.
    fn read(&mut self, layout: &Layout, frame: &[u8], take: &mut dyn FnMut(Frame)) -> usize {
        let Layout { version, id, system, component, payload: (start, end), len } = *layout;
        if !layout.has_right_checksum(frame) {
            self.counts.bad_checksum += 1;
            self.counts.garbage += 1;
            // One byte and not the whole frame: a false start inside other data would swallow
            // real frames that follow within its stated length.
            return 1;
        }
        match MavMessage::parse(version, id, &frame[start..end]) {
            Ok(message) => {
                self.counts.messages += 1;
                take(Frame::Read(Received { system, component, message }));
            }
            Err(_) => {
                self.counts.unreadable += 1;
                let payload = frame[start..end].to_vec();
                take(Frame::Unreadable(Unreadable { system, component, id, payload }));
            }
        }
        len
    }
}
