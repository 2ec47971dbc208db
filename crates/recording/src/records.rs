//! Reads the records of an MCAP file one by one, up to where it is truncated.
//!
//! The library's own readers treat a chunk as one unit and would lose a truncated one entirely. Our
//! chunks are uncompressed, so their records can be read up to the truncation. Compressed files are
//! decompressed beforehand.

use crate::RecordingError;
use crate::source::Source;
pub(crate) use mcap::records::Record;
use mcap::records::op;
use std::fmt::Display;
use std::ops::Range;

/// Size of the opcode and the length before every record.
const PREFIX: u64 = 9;
/// Offset of the checksum in a chunk, after the times of the first and last message, and the size.
const CHUNK_CRC_AT: u64 = 3 * 8;
/// Size of the numbers at the start of a chunk, before the name of its compression.
pub(crate) const CHUNK_NUMBERS: u64 = CHUNK_CRC_AT + 4;
/// Size of the fields before the bytes of a message: channel, number, and two times.
const MESSAGE_HEADER: u64 = 2 + 4 + 8 + 8;
/// Size of everything before the bytes of a message.
pub(crate) const MESSAGE_PREFIX: u64 = PREFIX + MESSAGE_HEADER;
/// The longest record that is read: longer than any network message or scenario.
const RECORD_MAX: u64 = 64 << 20;

/// The readable extent of a file.
#[derive(Debug)]
pub(crate) struct Extent {
    /// Whether the file is truncated.
    pub(crate) is_cut: bool,
    /// Byte ranges that do not match the checksum of their chunk; the whole file if the mismatch
    /// cannot be attributed to a chunk.
    pub(crate) damage: Vec<Range<u64>>,
}

/// Calls `take` with every schema, channel, message and metadata record, including those in chunks.
/// A message is passed as its header and the byte range of its content. The last argument is the
/// start of the record's chunk, or 0. A damaged chunk is read up to the first invalid record.
pub(crate) fn for_each_record(
    source: &Source,
    mut take: impl FnMut(Record<'_>, Range<u64>, u64),
) -> Result<Extent, RecordingError> {
    const MAGIC: usize = mcap::MAGIC.len();
    if source
        .array::<MAGIC>(0)?
        .is_none_or(|magic| magic != *mcap::MAGIC)
    {
        return Err(RecordingError::Foreign("it is not an MCAP file".to_owned()));
    }
    let end = source.length;
    let mut place = MAGIC as u64;
    let mut is_cut = true;
    let mut damage = Vec::new();
    while let Some((opcode, body)) = record_at(source, place, end)? {
        if opcode == op::CHUNK {
            let inner = chunk_records(source, &body)?;
            let is_whole = body.end <= end;
            let is_damaged = is_whole && !agrees(source, body.start + CHUNK_CRC_AT, inner.clone())?;
            if is_damaged {
                damage.push(inner.clone());
            }
            let chunk = inner.start;
            match records_in(source, inner, &mut |record, place| {
                take(record, place, chunk)
            }) {
                Err(RecordingError::Foreign(_)) if is_damaged => {}
                other => other?,
            }
        } else if body.end <= end {
            if opcode == op::DATA_END {
                is_cut = false;
                if damage.is_empty() && !agrees(source, body.start, 0..place)? {
                    damage.push(0..place);
                }
            }
            give(source, opcode, body.clone(), &mut |record, place| {
                take(record, place, 0)
            })?;
        }
        place = body.end;
        if !is_cut {
            break;
        }
    }
    Ok(Extent { is_cut, damage })
}

/// Whether the checksum (CRC-32) stored at `checksum_at` matches the bytes in `place`. A stored 0
/// means no checksum.
fn agrees(source: &Source, checksum_at: u64, place: Range<u64>) -> Result<bool, RecordingError> {
    let written = source.array(checksum_at)?.map_or(0, u32::from_le_bytes);
    Ok(written == 0 || written == source.checksum(place)?)
}

/// Opcode and body of the record at `place`; the body may extend beyond the available bytes.
pub(crate) fn record_at(
    source: &Source,
    place: u64,
    end: u64,
) -> Result<Option<(u8, Range<u64>)>, RecordingError> {
    let Some(from) = place.checked_add(PREFIX).filter(|from| *from <= end) else {
        return Ok(None);
    };
    let opcode = source.array::<1>(place)?;
    let length = source.array(place + 1)?.map(u64::from_le_bytes);
    let body = length
        .and_then(|length| from.checked_add(length))
        .map(|end| from..end);
    Ok(opcode.map(|[opcode]| opcode).zip(body))
}

/// Calls `take` with the records in `place`, either within a chunk or in a file without chunks.
pub(crate) fn records_in(
    source: &Source,
    inner: Range<u64>,
    take: &mut impl FnMut(Record<'_>, Range<u64>),
) -> Result<(), RecordingError> {
    let mut place = inner.start;
    while let Some((opcode, body)) =
        record_at(source, place, inner.end)?.filter(|(_, body)| body.end <= inner.end)
    {
        place = body.end;
        give(source, opcode, body, take)?;
    }
    Ok(())
}

fn give(
    source: &Source,
    opcode: u8,
    body: Range<u64>,
    take: &mut impl FnMut(Record<'_>, Range<u64>),
) -> Result<(), RecordingError> {
    let damaged = |reason: &dyn Display| {
        RecordingError::Foreign(format!(
            "the record at byte {} is damaged: {reason}",
            body.start
        ))
    };
    // Per opcode: the number of strings, the bytes before them, and whether a list of strings
    // follows. Other opcodes are ignored.
    let (fixed, texts, has_list) = match opcode {
        op::SCHEMA => (2, 3, false),
        op::CHANNEL => (4, 2, true),
        op::MESSAGE => (0, 0, false),
        op::METADATA => (0, 1, true),
        _ => return Ok(()),
    };
    let length = body.end - body.start;
    if length > RECORD_MAX {
        return Err(damaged(&format_args!(
            "it is {length} bytes long, expected at most {RECORD_MAX}"
        )));
    }
    let bytes_from = if opcode == op::MESSAGE {
        body.end.min(body.start + MESSAGE_HEADER)
    } else {
        body.end
    };
    let content = source.read(body.start..bytes_from)?;
    // The library allocates as much as a length field demands before checking that the bytes exist.
    if texts_of(&content, fixed, texts, has_list).is_none() {
        return Err(damaged(&"a string in it is longer than the record"));
    }
    let record = mcap::parse_record(opcode, &content).map_err(|e| damaged(&e))?;
    take(record, bytes_from..body.end);
    Ok(())
}

/// Checks that this many strings exist with their stated lengths; `None` if they do not.
fn texts_of(content: &[u8], fixed: usize, texts: usize, has_list: bool) -> Option<()> {
    let mut rest = content.get(fixed..)?;
    for _ in 0..texts {
        (_, rest) = text(rest)?;
    }
    let (mut list, _) = if has_list {
        text(rest)?
    } else {
        (&[][..], rest)
    };
    while !list.is_empty() {
        (_, list) = text(list)?;
    }
    Some(())
}

/// Splits off a string with its length prefix; returns the string and the rest.
fn text(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk::<4>()?;
    rest.split_at_checked(usize::try_from(u32::from_le_bytes(*length)).ok()?)
}

/// The byte range of the records in a chunk, as far as available.
fn chunk_records(source: &Source, body: &Range<u64>) -> Result<Range<u64>, RecordingError> {
    let end = source.length;
    let name_length = source
        .array(body.start + CHUNK_NUMBERS)?
        .map(|length| u64::from(u32::from_le_bytes(length)));
    let name_at = body.start + CHUNK_NUMBERS + 4;
    let Some(name_length) = name_length.filter(|length| name_at + length <= end) else {
        return Ok(end..end);
    };
    let from = name_at + name_length + 8;
    let end = body.end.min(end);
    Ok(from.min(end)..end)
}
