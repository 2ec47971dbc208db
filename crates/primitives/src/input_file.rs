//! Reads a user's input file up to a size limit. Only regular files are allowed, because pipes and
//! devices may never end.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{Error, ErrorKind, Read};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;

/// Size limit (bytes) of a table that this program appends to, and of a log: several million games.
pub const TABLE_BYTES_MAX: u64 = 2 << 30;

/// Opens a file for reading.
///
/// # Errors
/// The system's error, or an error if it is not a regular file.
pub fn open(path: &Path) -> Result<File, Error> {
    // A pipe is not even opened, because opening blocks until the pipe has a writer.
    is_file(&std::fs::metadata(path)?)?;
    // Some regular files of `/proc` never end: reading `kmsg` waits for the kernel's next message.
    // For files on disk this flag has no effect.
    let flags = rustix::fs::OFlags::NONBLOCK.bits() as i32;
    let file = OpenOptions::new()
        .read(true)
        .custom_flags(flags)
        .open(path)?;
    is_file(&file.metadata()?)?;
    Ok(file)
}

/// Reads a file of at most `bytes_max` bytes. The reported size cannot be relied on: it is 0 for
/// files of `/proc`.
///
/// # Errors
/// The system's error, or an error if the file is not regular or is too long.
pub fn read(path: &Path, bytes_max: u64) -> Result<Vec<u8>, Error> {
    let mut bytes = vec![];
    let file = open(path)?;
    let reported = file.metadata()?.len();
    // A file known to be too long is not read at all, because its bytes would fill the memory.
    let most = if reported > bytes_max {
        0
    } else {
        bytes_max.saturating_add(1)
    };
    let length = file.take(most).read_to_end(&mut bytes).map_err(|error| {
        let waits = error.kind() == ErrorKind::WouldBlock;
        if waits {
            Error::new(ErrorKind::InvalidInput, "it has no end")
        } else {
            error
        }
    })?;
    if reported.max(length as u64) > bytes_max {
        return Err(Error::new(
            ErrorKind::FileTooLarge,
            format!("it is longer than {bytes_max} bytes"),
        ));
    }
    Ok(bytes)
}

/// Reads a text file.
///
/// # Errors
/// As for [`read`], or an error if it is not UTF-8.
pub fn read_text(path: &Path, bytes_max: u64) -> Result<String, Error> {
    String::from_utf8(read(path, bytes_max)?)
        .map_err(|_| Error::new(ErrorKind::InvalidData, "it is not UTF-8"))
}

/// Converts UTF-16 content with a byte order mark, which some Windows programs save as "Unicode
/// text", to UTF-8. Returns all other content unchanged.
///
/// # Errors
/// If UTF-16 content is invalid.
pub fn utf_8(bytes: Vec<u8>) -> Result<Vec<u8>, String> {
    let order: fn([u8; 2]) -> u16 = match bytes.get(..2) {
        Some(b"\xff\xfe") => u16::from_le_bytes,
        Some(b"\xfe\xff") => u16::from_be_bytes,
        _ => return Ok(bytes),
    };
    let (units, rest) = bytes[2..].as_chunks();
    let text =
        char::decode_utf16(units.iter().map(|unit| order(*unit))).collect::<Result<String, _>>();
    match text {
        Ok(text) if rest.is_empty() => Ok(text.into_bytes()),
        _ => Err("damaged UTF-16 text, expected UTF-8".to_owned()),
    }
}

fn is_file(metadata: &Metadata) -> Result<(), Error> {
    let not_a_file = || Error::new(ErrorKind::InvalidInput, "it is not a file");
    metadata.is_file().then_some(()).ok_or_else(not_a_file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_to_a_limit_and_nothing_else_is() {
        let dir = tempfile::tempdir().expect("a directory");
        let file = dir.path().join("file");
        std::fs::write(&file, "12345").expect("it is written");
        assert_eq!(read(&file, 5).expect("it is short enough"), b"12345");
        let refused = |path: &Path, most| read(path, most).expect_err("it is refused").to_string();
        assert_eq!(refused(&file, 4), "it is longer than 4 bytes");
        assert_eq!(refused(dir.path(), 4), "it is not a file");
        assert!(refused(&dir.path().join("none"), 4).contains("No such file"));
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn what_has_no_end_is_not_read() {
        // Both report a size of 0. The first must be read in units of eight bytes.
        assert_eq!(
            std::fs::metadata("/proc/self/pagemap")
                .expect("it is there")
                .len(),
            0
        );
        let endless = read(Path::new("/proc/self/pagemap"), 1023).expect_err("it is refused");
        assert_eq!(endless.kind(), ErrorKind::FileTooLarge);
        // Only root may open it; other users are refused immediately.
        assert!(read(Path::new("/proc/kmsg"), 1 << 20).is_err());
        assert_eq!(
            read(Path::new("/dev/zero"), 10)
                .expect_err("it is refused")
                .kind(),
            ErrorKind::InvalidInput
        );
    }
}
