//! The records of an MCAP file one by one, up to where it was cut.
//!
//! The library's own readers hold a chunk to be one piece: of one that was cut nothing would be left. Our chunks are not
//! compressed, so the records in it can be read as far as they go.

use mcap::records::{Record, op};
use std::fmt::Display;
use std::ops::Range;

/// Opcode and length before every record.
const PREFIX: usize = 9;
/// In a chunk, before its checksum: times of the first and the last message, and size.
const CHUNK_CRC_AT: usize = 3 * 8;

/// How far a file goes, and what of it can be relied on.
#[derive(Debug)]
pub(crate) struct Extent {
    /// Whether the rest of the file is missing.
    pub(crate) is_cut: bool,
    /// The bytes that are not what was written, by the checksum of their chunk; if no chunk is to blame, all of them.
    pub(crate) damage: Vec<Range<usize>>,
}

/// Calls `take` with every schema, channel, message and metadata, and the place of its body in `bytes`, those in chunks
/// included. Of a damaged chunk the records are given up to the first that makes no sense.
pub(crate) fn for_each_record(
    bytes: &[u8],
    mut take: impl FnMut(Record<'_>, Range<usize>) -> Result<(), String>,
) -> Result<Extent, String> {
    if bytes.len() < mcap::MAGIC.len() || !bytes.starts_with(mcap::MAGIC) {
        return Err("it does not begin as MCAP files do".to_owned());
    }
    let mut place = mcap::MAGIC.len();
    let mut is_cut = true;
    let mut damage = Vec::new();
    while let Some((opcode, body)) = record_at(bytes, place, bytes.len()) {
        if opcode == op::CHUNK {
            let inner = chunk_records(bytes, &body)?;
            let is_whole = body.end <= bytes.len();
            let is_damaged = is_whole && !agrees(bytes, body.start + CHUNK_CRC_AT, inner.clone());
            if is_damaged {
                damage.push(inner.clone());
            }
            match records_in(bytes, inner, &mut take) {
                Err(_) if is_damaged => {}
                other => other?,
            }
        } else if body.end <= bytes.len() {
            if opcode == op::DATA_END {
                is_cut = false;
                if damage.is_empty() && !agrees(bytes, body.start, 0..place) {
                    damage.push(0..place);
                }
            }
            give(bytes, opcode, body.clone(), &mut take)?;
        }
        place = body.end;
        if !is_cut {
            break;
        }
    }
    Ok(Extent { is_cut, damage })
}

/// Whether the checksum (CRC-32) that stands there is that of the bytes in `place`; 0 says that there is none.
fn agrees(bytes: &[u8], checksum_at: usize, place: Range<usize>) -> bool {
    let written =
        bytes.get(checksum_at..).and_then(|rest| rest.first_chunk()).map_or(0, |crc| u32::from_le_bytes(*crc));
    written == 0 || written == crc32fast::hash(&bytes[place])
}

/// Opcode and body of the record there; the body may reach beyond what is there.
fn record_at(bytes: &[u8], place: usize, end: usize) -> Option<(u8, Range<usize>)> {
    let prefix = bytes.get(place..place.checked_add(PREFIX)?).filter(|_| place + PREFIX <= end)?;
    let length = usize::try_from(u64::from_le_bytes(prefix[1..].try_into().ok()?)).ok()?;
    let from = place + PREFIX;
    Some((prefix[0], from..from.checked_add(length)?))
}

fn records_in(
    bytes: &[u8],
    inner: Range<usize>,
    take: &mut impl FnMut(Record<'_>, Range<usize>) -> Result<(), String>,
) -> Result<(), String> {
    let mut place = inner.start;
    while let Some((opcode, body)) = record_at(bytes, place, inner.end).filter(|(_, body)| body.end <= inner.end) {
        place = body.end;
        give(bytes, opcode, body, take)?;
    }
    Ok(())
}

fn give(
    bytes: &[u8],
    opcode: u8,
    body: Range<usize>,
    take: &mut impl FnMut(Record<'_>, Range<usize>) -> Result<(), String>,
) -> Result<(), String> {
    let damaged = |reason: &dyn Display| format!("the record at byte {} is damaged: {reason}", body.start);
    let content = &bytes[body.clone()];
    // What texts are in it, after how many bytes, and whether a list of texts follows. Other kinds are of no interest.
    let (fixed, texts, has_list) = match opcode {
        op::SCHEMA => (2, 3, false),
        op::CHANNEL => (4, 2, true),
        op::MESSAGE => (0, 0, false),
        op::METADATA => (0, 1, true),
        _ => return Ok(()),
    };
    // The library makes room for as much as a length says before it looks whether that is there.
    if texts_of(content, fixed, texts, has_list).is_none() {
        return Err(damaged(&"a text in it is longer than the record"));
    }
    let record = mcap::parse_record(opcode, content).map_err(|e| damaged(&e))?;
    take(record, body)
}

/// Whether so many texts are in there, as long as they say; nothing if not.
fn texts_of(content: &[u8], fixed: usize, texts: usize, has_list: bool) -> Option<()> {
    let mut rest = content.get(fixed..)?;
    for _ in 0..texts {
        (_, rest) = text(rest)?;
    }
    let (mut list, _) = if has_list { text(rest)? } else { (&[][..], rest) };
    while !list.is_empty() {
        (_, list) = text(list)?;
    }
    Some(())
}

/// A text with its length before it, and what comes after it.
fn text(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk::<4>()?;
    rest.split_at_checked(usize::try_from(u32::from_le_bytes(*length)).ok()?)
}

/// The place of the records in a chunk, as far as they are there.
fn chunk_records(bytes: &[u8], body: &Range<usize>) -> Result<Range<usize>, String> {
    // The checksum is of what follows the name of the compression.
    const NUMBERS: usize = CHUNK_CRC_AT + 4;
    let nothing = Ok(bytes.len()..bytes.len());
    let number = |from: usize, size: usize| bytes.get(from..from + size);
    let Some(name_length) = number(body.start + NUMBERS, 4) else { return nothing };
    let name_length = u32::from_le_bytes(name_length.try_into().map_err(|_| "unreachable")?) as usize;
    let name_at = body.start + NUMBERS + 4;
    let Some(name) = number(name_at, name_length) else { return nothing };
    if !name.is_empty() {
        let name = String::from_utf8_lossy(name);
        return Err(format!("it is compressed ({name}); recordings of Squall are not"));
    }
    let from = name_at + name_length + 8;
    let end = body.end.min(bytes.len());
    Ok(from.min(end)..end)
}
