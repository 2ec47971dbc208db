//! Recognises the format of a log by its content.

use crate::{ImportError, file_error};
use std::io::Read;
use std::path::Path;

/// Number of bytes read to recognise a format.
const HEAD: u64 = 4096;
/// Plausible UNIX times in a log, µs: from 2000 to 2100.
pub(crate) const TIMES_US: std::ops::Range<u64> = 946_684_800_000_000..4_102_444_800_000_000;
/// The first byte of a frame in MAVLink 1 and in MAVLink 2.
const MAVLINK_STARTS: [u8; 2] = [0xFE, 0xFD];

/// The format of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A MOOS log.
    Alog,
    /// An ArduPilot on-board log.
    Dataflash,
    /// A MAVLink telemetry log: frames, each preceded by its UNIX time.
    Tlog,
    /// A ROS 2 bag in MCAP.
    Mcap,
    /// A ROS 1 bag.
    Bag1,
    /// A Squall recording of a game or of a gateway.
    Squall,
    /// NMEA 0183 sentences.
    Nmea,
    /// A CSV table.
    Csv,
}

impl Format {
    /// The format's name.
    pub const fn name(self) -> &'static str {
        match self {
            Format::Alog => "MOOS log",
            Format::Dataflash => "ArduPilot on-board log",
            Format::Tlog => "MAVLink telemetry log",
            Format::Mcap => "ROS 2 bag (MCAP)",
            Format::Bag1 => "ROS 1 bag",
            Format::Squall => "Squall recording",
            Format::Nmea => "NMEA 0183 log",
            Format::Csv => "CSV table",
        }
    }

    /// Recognises the format of a file. Squall's recordings are MCAP files too, so they are
    /// reported as [`Format::Mcap`]; only [`read`](crate::read) tells them apart.
    ///
    /// # Errors
    /// If the file is empty, cannot be read, or must first be converted or decompressed.
    pub fn of(path: &Path) -> Result<Format, ImportError> {
        let mut head = vec![];
        let read = primitives::input_file::open(path)
            .and_then(|file| file.take(HEAD).read_to_end(&mut head));
        read.map_err(|error| file_error(path, error))?;
        let convert = |what: &str, how: &str| Err(file_error(path, format!("{what}; {how}")));
        match head.as_slice() {
            [] => convert("the file is empty", "expected a log"),
            head if head.starts_with(b"%%%%%%%%") => Ok(Format::Alog),
            [0xA3, 0x95, ..] => Ok(Format::Dataflash),
            head if head.starts_with(b"\x89MCAP0\r\n") => Ok(Format::Mcap),
            head if head.starts_with(b"#ROSBAG V2.0\n") => Ok(Format::Bag1),
            head if head.starts_with(b"SQLite format 3\0") => convert(
                "an SQLite database, such as a rosbag2 `.db3`",
                "convert it to MCAP, for example with: rosbags-convert --src BAG --dst BAG_mcap --dst-storage mcap",
            ),
            [0x1F, 0x8B, ..] | [b'P', b'K', 3, 4, ..] | [0x28, 0xB5, 0x2F, 0xFD, ..] => {
                convert("a compressed file", "decompress it first")
            }
            head if is_tlog(head) => Ok(Format::Tlog),
            head if has_sentences(head) => Ok(Format::Nmea),
            _ => Ok(Format::Csv),
        }
    }
}

/// Whether a file begins with a UNIX time (µs, big endian) and the start of a frame.
fn is_tlog(head: &[u8]) -> bool {
    let time = head.first_chunk().map(|bytes| u64::from_be_bytes(*bytes));
    time.is_some_and(|time| TIMES_US.contains(&time))
        && head
            .get(8)
            .is_some_and(|byte| MAVLINK_STARTS.contains(byte))
}

/// Whether a line contains a sentence with a valid checksum.
fn has_sentences(head: &[u8]) -> bool {
    let mut framer = gateway::nmea::Framer::new();
    let mut sentences = 0;
    for line in head.split(|byte| *byte == b'\n') {
        let start = line.iter().position(|byte| *byte == b'$');
        if let Some(start) = start {
            framer.push(&line[start..], &mut |_| sentences += 1);
            framer.push(b"\n", &mut |_| sentences += 1);
        }
    }
    sentences > 0
}
