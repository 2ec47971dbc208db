//! The bytes of a recording, read piecewise: memory holds at most one buffer, however long the file
//! is.

use parking_lot::Mutex;
use std::io::{BufReader, Cursor, Error, ErrorKind, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;

/// Size of the read-ahead, bytes. A chunk is many times larger.
const BUFFER: usize = 64 << 10;
/// Marks an unknown position: so far from any other that the next read always seeks.
const UNKNOWN: u64 = u64::MAX;

/// A source of bytes: a file or memory.
trait Bytes: Read + Seek + Send {}
impl<T: Read + Seek + Send> Bytes for T {}

/// The bytes of a recording, and their number when it was opened.
pub(crate) struct Source {
    reader: Mutex<Reader>,
    /// The number of bytes.
    pub(crate) length: u64,
}

struct Reader {
    bytes: BufReader<Box<dyn Bytes>>,
    /// The position of the next read.
    at: u64,
}

impl std::fmt::Debug for Source {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Source({} bytes)", self.length)
    }
}

impl Source {
    /// Opens a file.
    pub(crate) fn open(path: &Path) -> Result<Source, Error> {
        let file = primitives::input_file::open(path)?;
        let length = file.metadata()?.len();
        Ok(Source::new(Box::new(file), length))
    }

    /// Wraps bytes in memory.
    pub(crate) fn of(bytes: Vec<u8>) -> Source {
        let length = bytes.len() as u64;
        Source::new(Box::new(Cursor::new(bytes)), length)
    }

    fn new(bytes: Box<dyn Bytes>, length: u64) -> Source {
        Source {
            reader: Mutex::new(Reader {
                bytes: BufReader::with_capacity(BUFFER, bytes),
                at: 0,
            }),
            length,
        }
    }

    pub(crate) fn read(&self, place: Range<u64>) -> Result<Vec<u8>, Error> {
        // Allocate only for bytes that exist.
        let length = place
            .end
            .checked_sub(place.start)
            .filter(|_| place.end <= self.length);
        let length = length
            .and_then(|length| usize::try_from(length).ok())
            .ok_or(ErrorKind::UnexpectedEof)?;
        let mut bytes = vec![0; length];
        self.fill(place.start, &mut bytes)?;
        Ok(bytes)
    }

    /// Reads `N` bytes at `at`, if they exist.
    pub(crate) fn array<const N: usize>(&self, at: u64) -> Result<Option<[u8; N]>, Error> {
        if at.checked_add(N as u64).is_none_or(|end| end > self.length) {
            return Ok(None);
        }
        let mut bytes = [0; N];
        self.fill(at, &mut bytes)?;
        Ok(Some(bytes))
    }

    /// The checksum (CRC-32) of a range.
    pub(crate) fn checksum(&self, place: Range<u64>) -> Result<u32, Error> {
        let mut hasher = crc32fast::Hasher::new();
        let mut at = place.start;
        let mut piece = [0; 16 << 10];
        while at < place.end {
            let length = usize::try_from(place.end - at)
                .unwrap_or(usize::MAX)
                .min(piece.len());
            self.fill(at, &mut piece[..length])?;
            hasher.update(&piece[..length]);
            at += length as u64;
        }
        Ok(hasher.finalize())
    }

    fn fill(&self, at: u64, bytes: &mut [u8]) -> Result<(), Error> {
        self.reader.lock().fill(at, bytes)
    }
}

impl Reader {
    fn fill(&mut self, at: u64, bytes: &mut [u8]) -> Result<(), Error> {
        // After an error, the position is unknown.
        let from = std::mem::replace(&mut self.at, UNKNOWN);
        match i64::try_from(i128::from(at) - i128::from(from)) {
            Ok(distance) => self.bytes.seek_relative(distance)?,
            Err(_) => {
                self.bytes.seek(SeekFrom::Start(at))?;
            }
        }
        self.bytes.read_exact(bytes)?;
        self.at = at + bytes.len() as u64;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_place_is_read_in_any_order() {
        let all: Vec<u8> = (0..300_000_u32).map(|i| (i * 7 / 3) as u8).collect();
        let source = Source::of(all.clone());
        for place in [
            0..10,
            299_990..300_000,
            5..70_000,
            0..300_000,
            65_535..65_537,
            3..3,
        ] {
            let want = &all[place.start as usize..place.end as usize];
            assert_eq!(
                source.read(place.clone()).expect("it is there"),
                want,
                "{place:?}"
            );
            assert_eq!(
                source.checksum(place).expect("it is there"),
                crc32fast::hash(want)
            );
        }
        assert_eq!(
            source.array(299_998).expect("no error"),
            Some([all[299_998], all[299_999]])
        );
        assert_eq!(source.array::<3>(299_998).expect("no error"), None);
        for beyond in [299_999..300_001, 400_000..400_001, 0..u64::MAX] {
            assert!(source.read(beyond).is_err());
        }
        assert_eq!(
            source.read(1..3).expect("it is there"),
            all[1..3],
            "an error before does no harm"
        );
    }
}
