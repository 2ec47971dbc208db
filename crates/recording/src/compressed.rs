//! Decompresses MCAP files that other programs have compressed: `mcap compress`, rosbag2, Foxglove.

use crate::RecordingError;
use crate::records::{CHUNK_NUMBERS, record_at};
use crate::source::Source;
use mcap::records::op;
use std::io::{Error, Read};
use std::ops::Range;

/// Size limit of the decompressed file, which is kept in memory, bytes.
const BYTES_MAX: u64 = 2 << 30;
/// Maximum length of a compression's name, bytes.
const NAME_MAX: u64 = 40;

/// The file with all its chunks decompressed; unchanged if no chunk is compressed.
///
/// # Errors
/// [`RecordingError::Foreign`] for an unknown compression, damaged data, or a file that is too
/// large.
pub(crate) fn expanded(source: Source) -> Result<Source, RecordingError> {
    const MAGIC: u64 = mcap::MAGIC.len() as u64;
    let end = source.length;
    let mut out: Option<Vec<u8>> = None;
    let mut place = MAGIC;
    while let Some((opcode, body)) = record_at(&source, place, end)? {
        let is_whole = body.end <= end;
        let name = if opcode == op::CHUNK && is_whole {
            compression(&source, &body)?
        } else {
            String::new()
        };
        if !name.is_empty() && out.is_none() {
            if place > BYTES_MAX {
                return Err(too_long());
            }
            out = Some(source.read(0..place)?);
        }
        if let Some(out) = &mut out {
            let room = BYTES_MAX.saturating_sub(out.len() as u64);
            if body.end.min(end) - place > room {
                return Err(too_long());
            }
            if !name.is_empty() {
                expand(&source, &body, &name, room, out)?;
            } else if opcode == op::DATA_END {
                // The old checksum is that of the compressed data.
                let length = body.end - body.start;
                out.push(opcode);
                out.extend(length.to_le_bytes());
                out.extend(vec![0; length.min(room) as usize]);
            } else {
                out.extend(source.read(place..body.end.min(end))?);
            }
        }
        place = body.end;
        if opcode == op::DATA_END || !is_whole {
            break;
        }
    }
    Ok(out.map_or(source, Source::of))
}

/// The name of a chunk's compression; empty if it is not compressed.
fn compression(source: &Source, chunk: &Range<u64>) -> Result<String, RecordingError> {
    let at = chunk.start + CHUNK_NUMBERS;
    let length = source.array(at)?.map_or(0, u32::from_le_bytes);
    let length = u64::from(length).min(NAME_MAX);
    let name = at + 4..(at + 4 + length).min(chunk.end);
    Ok(if name.is_empty() {
        String::new()
    } else {
        String::from_utf8_lossy(&source.read(name)?).into_owned()
    })
}

/// Decompresses a chunk and appends it as a chunk without compression.
fn expand(
    source: &Source,
    chunk: &Range<u64>,
    name: &str,
    room: u64,
    out: &mut Vec<u8>,
) -> Result<(), RecordingError> {
    let damaged = |reason: &dyn std::fmt::Display| {
        RecordingError::Foreign(format!(
            "the chunk at byte {} cannot be decompressed: {reason}",
            chunk.start
        ))
    };
    let numbers = source.read(chunk.start..chunk.start + CHUNK_NUMBERS)?;
    let stated = source
        .array(chunk.start + 16)?
        .map_or(0, u64::from_le_bytes);
    let room = room.min(stated);
    let from = chunk.start + CHUNK_NUMBERS + 4 + name.len() as u64 + 8;
    let packed = source.read(from.min(chunk.end)..chunk.end)?;
    let mut records = Vec::new();
    let read = |reader: &mut dyn Read, records: &mut Vec<u8>| -> Result<usize, Error> {
        reader.take(room + 1).read_to_end(records)
    };
    let result = match name {
        "zstd" => ruzstd::decoding::StreamingDecoder::new(&packed[..])
            .map_err(Error::other)
            .and_then(|mut decoder| read(&mut decoder, &mut records)),
        "lz4" => read(
            &mut lz4_flex::frame::FrameDecoder::new(&packed[..]),
            &mut records,
        ),
        _ => {
            return Err(RecordingError::Foreign(format!(
                "it is compressed with {name:?}, expected zstd, lz4 or no compression"
            )));
        }
    };
    let length = result.map_err(|e| damaged(&e))? as u64;
    if length > room {
        return Err(if stated == room {
            damaged(&format_args!("longer than the stated {stated} bytes"))
        } else {
            too_long()
        });
    }
    out.push(op::CHUNK);
    out.extend((CHUNK_NUMBERS + 4 + 8 + length).to_le_bytes());
    out.extend(numbers);
    out.extend([0; 4]);
    out.extend(length.to_le_bytes());
    out.extend(records);
    Ok(())
}

fn too_long() -> RecordingError {
    RecordingError::Foreign(format!(
        "decompressed, it is longer than {BYTES_MAX} bytes; decompress it first, for example with: mcap decompress"
    ))
}
