//! The records of an MCAP file one by one, up to where it was cut.
//!
//! The library's own readers hold a chunk to be one piece: of one that was cut nothing would be left. Our chunks are not
//! compressed, so the records in it can be read as far as they go.

use mcap::records::{Record, op};
use std::ops::Range;

/// Opcode and length before every record.
const PREFIX: usize = 9;

/// Why a file ends before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    /// The last record is whole.
    AtEnd,
    /// The rest is missing.
    Cut,
}

/// Calls `take` with every record and the place of its body in `bytes`, those in chunks included.
pub(super) fn walk(
    bytes: &[u8],
    mut take: impl FnMut(Record<'_>, Range<usize>) -> Result<(), String>,
) -> Result<Stop, String> {
    if bytes.len() < mcap::MAGIC.len() || !bytes.starts_with(mcap::MAGIC) {
        return Err("it does not begin as MCAP files do".to_owned());
    }
    let mut place = mcap::MAGIC.len();
    let mut stop = Stop::Cut;
    while let Some((opcode, body)) = record_at(bytes, place, bytes.len()) {
        if opcode == op::CHUNK {
            let inner = chunk_records(bytes, &body)?;
            records_in(bytes, inner, &mut take)?;
        } else if body.end <= bytes.len() {
            if opcode == op::DATA_END {
                stop = Stop::AtEnd;
            }
            give(bytes, opcode, body.clone(), &mut take)?;
        }
        place = body.end;
        if stop == Stop::AtEnd {
            break;
        }
    }
    Ok(stop)
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
    let record = mcap::parse_record(opcode, &bytes[body.clone()]);
    take(record.map_err(|e| format!("the record at byte {} is damaged: {e}", body.start))?, body)
}

/// The place of the records in a chunk, as far as they are there.
fn chunk_records(bytes: &[u8], body: &Range<usize>) -> Result<Range<usize>, String> {
    // Times of the first and the last message, size, and a checksum of what follows the name of the compression.
    const NUMBERS: usize = 3 * 8 + 4;
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
