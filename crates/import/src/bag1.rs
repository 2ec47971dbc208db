//! Bags of ROS 1, version 2.0 (<https://wiki.ros.org/Bags/Format/2.0>).

use crate::ros::{Bag, Encoding};
use crate::{Found, ImportError, bytes_of, file_error};
use recording::logs::name_of;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

const MAGIC: &[u8] = b"#ROSBAG V2.0\n";
/// Kinds of records, in their header field `op`.
const MESSAGE: u8 = 2;
const CHUNK: u8 = 5;
const CONNECTION: u8 = 7;
/// Maximum number of bytes decompressed from a chunk; `rosbag record` writes chunks of 768 kB.
const CHUNK_MAX: u64 = 256 << 20;

/// A record: the fields of its header, and its data.
struct Record<'a> {
    fields: BTreeMap<&'a [u8], &'a [u8]>,
    data: &'a [u8],
}

/// Topic and type, by connection number.
type Connections = BTreeMap<u32, (String, String)>;

pub(crate) fn read(path: &Path, boat: Option<&str>) -> Result<Found, ImportError> {
    let bytes = bytes_of(path)?;
    let mut bag = Bag::default();
    let mut connections = Connections::new();
    let mut rest = &bytes[MAGIC.len().min(bytes.len())..];
    while let Some(record) = next_record(&mut rest) {
        if record.op() != Some(CHUNK) {
            add(&record, &mut connections, &mut bag);
            continue;
        }
        let at = bytes.len() - rest.len();
        let chunk = chunk(&record).map_err(|reason| {
            file_error(path, format!("the chunk that ends at byte {at}: {reason}"))
        })?;
        let mut inner = &chunk[..];
        while let Some(record) = next_record(&mut inner) {
            add(&record, &mut connections, &mut bag);
        }
    }
    let stem = name_of(&path.file_stem().unwrap_or_default().to_string_lossy());
    let mut found = bag.found(boat, &stem);
    if !rest.is_empty() {
        found.notes.push(format!(
            "truncated: the last {} bytes are ignored",
            rest.len()
        ));
    }
    Ok(found)
}

impl Record<'_> {
    fn op(&self) -> Option<u8> {
        self.fields.get(&b"op"[..])?.first().copied()
    }

    fn u32(&self, name: &str) -> Option<u32> {
        let field = self.fields.get(name.as_bytes())?.first_chunk()?;
        Some(u32::from_le_bytes(*field))
    }
}

/// Splits off the next record; `None` at the end, or if it is incomplete.
fn next_record<'a>(rest: &mut &'a [u8]) -> Option<Record<'a>> {
    let mut bytes = *rest;
    let mut header = next_block(&mut bytes)?;
    let data = next_block(&mut bytes)?;
    let mut fields = BTreeMap::new();
    while let Some(field) = next_block(&mut header) {
        let equals = field.iter().position(|byte| *byte == b'=')?;
        fields.insert(&field[..equals], &field[equals + 1..]);
    }
    *rest = bytes;
    Some(Record { fields, data })
}

/// Splits off a block of bytes, which follows its length.
fn next_block<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    let (length, after) = rest.split_first_chunk::<4>()?;
    let length = usize::try_from(u32::from_le_bytes(*length)).ok()?;
    let (block, after) = after.split_at_checked(length)?;
    *rest = after;
    Some(block)
}

/// The records of a chunk, decompressed.
fn chunk<'a>(record: &Record<'a>) -> Result<Cow<'a, [u8]>, String> {
    let compression = record.fields.get(&b"compression"[..]).copied();
    let mut chunk = vec![];
    let read = match compression.unwrap_or_default() {
        b"" | b"none" => return Ok(Cow::Borrowed(record.data)),
        b"lz4" => lz4_flex::frame::FrameDecoder::new(record.data)
            .take(CHUNK_MAX)
            .read_to_end(&mut chunk),
        b"bz2" => bzip2::read::BzDecoder::new(record.data)
            .take(CHUNK_MAX)
            .read_to_end(&mut chunk),
        other => {
            let name = String::from_utf8_lossy(other);
            return Err(format!(
                "compressed with {name:?}, expected none, lz4 or bz2"
            ));
        }
    };
    read.map_err(|error| format!("cannot be decompressed: {error}"))?;
    Ok(Cow::Owned(chunk))
}

/// Adds a connection or a message.
fn add(record: &Record<'_>, connections: &mut Connections, bag: &mut Bag) {
    let Some((op, connection)) = record.op().zip(record.u32("conn")) else {
        return;
    };
    if op == CONNECTION {
        // The data is itself a header, which contains the type.
        let mut data = record.data;
        let mut message_type = String::new();
        while let Some(field) = next_block(&mut data) {
            if let Some(value) = field.strip_prefix(b"type=") {
                message_type = String::from_utf8_lossy(value).into_owned();
            }
        }
        let topic = record
            .fields
            .get(&b"topic"[..])
            .copied()
            .unwrap_or_default();
        let topic = String::from_utf8_lossy(topic).into_owned();
        connections.insert(connection, (topic, message_type));
    } else if op == MESSAGE
        && let Some((topic, message_type)) = connections.get(&connection)
    {
        let time = record.fields.get(&b"time"[..]).copied().unwrap_or_default();
        let mut parts = time
            .chunks_exact(4)
            .map(|four| u32::from_le_bytes([four[0], four[1], four[2], four[3]]));
        let mut part = || f64::from(parts.next().unwrap_or(0));
        let log_s = part() + 1e-9 * part();
        bag.add(topic, message_type, Encoding::Packed, log_s, record.data);
    }
}
