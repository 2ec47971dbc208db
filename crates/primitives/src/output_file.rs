//! Writes a user's output file without waiting for a reader: a named pipe without a reader is an
//! error.

use rustix::fs::OFlags;
use std::fs::{File, OpenOptions};
use std::io::{Error, ErrorKind, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;

/// Creates a file, or empties an existing one.
///
/// # Errors
/// The system's error, or an error if it is a pipe without a reader.
pub fn create(path: &Path) -> Result<File, Error> {
    let mut options = OpenOptions::new();
    options
        .write(true)
        .create(true)
        .truncate(true)
        .custom_flags(OFlags::NONBLOCK.bits() as i32);
    let file = options.open(path).map_err(|error| {
        let is_unread = error.raw_os_error() == Some(rustix::io::Errno::NXIO.raw_os_error());
        if is_unread {
            Error::new(ErrorKind::InvalidInput, "it is a pipe without a reader")
        } else {
            error
        }
    })?;
    // Opening did not block; writing to a pipe with a reader may.
    rustix::fs::fcntl_setfl(&file, OFlags::empty())?;
    Ok(file)
}

/// Writes a whole file.
///
/// # Errors
/// As for [`create`].
pub fn write(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), Error> {
    create(path)?.write_all(bytes.as_ref())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::Command;

    #[test]
    fn a_pipe_is_written_if_somebody_reads_it() {
        let dir = tempfile::tempdir().expect("a folder");
        let pipe = dir.path().join("pipe");
        assert!(
            Command::new("mkfifo")
                .arg(&pipe)
                .status()
                .expect("mkfifo is there")
                .success()
        );
        assert_eq!(
            write(&pipe, "1").expect_err("nobody reads it").to_string(),
            "it is a pipe without a reader"
        );
        let reader = OpenOptions::new()
            .read(true)
            .custom_flags(OFlags::NONBLOCK.bits() as i32)
            .open(&pipe);
        let reader = reader.expect("it is opened");
        write(&pipe, "1").expect("it is read");
        drop(reader);
        let file = dir.path().join("file");
        write(&file, "longer")
            .and_then(|()| write(&file, "short"))
            .expect("it is written");
        assert_eq!(std::fs::read(&file).expect("it is there"), b"short");
    }
}
