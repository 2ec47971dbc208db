//! A lock on the link to a boat, held by at most one of this user's gateways on this machine.

use crate::local_registry::private_folder;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::PathBuf;
use thiserror::Error;

/// Maximum length of a process number, bytes.
const HOLDER_MAX: u64 = 32;

/// The lock on a link, which the system releases when the process ends, for whatever reason.
#[derive(Debug)]
pub struct LinkLock(
    #[expect(
        dead_code,
        reason = "the system holds the lock as long as the file is open"
    )]
    File,
);

/// Why locking a link failed.
#[derive(Debug, Error)]
pub enum LinkLockError {
    /// A different process holds the link.
    #[error("another gateway on this machine holds the link {link}: {}", .holder.map_or("a process that is \
        ending".to_owned(), |pid| format!("process {pid}")))]
    Held {
        /// The address of the link, as the user typed it.
        link: String,
        /// The holder's process number, if it recorded one.
        holder: Option<u32>,
    },
    /// The lock file cannot be created.
    #[error("the link {link} cannot be locked: {source}")]
    File {
        /// The address of the link, as the user typed it.
        link: String,
        /// The system's error.
        source: io::Error,
    },
}

impl LinkLock {
    /// Locks the link with this address, as the user typed it.
    ///
    /// # Errors
    /// [`LinkLockError`] if another process holds the link, or if the lock file cannot be used.
    pub fn take(link: &str) -> Result<LinkLock, LinkLockError> {
        let failed = |source| LinkLockError::File {
            link: link.to_owned(),
            source,
        };
        let path = path(link).map_err(failed)?;
        let options = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .mode(0o600)
            .clone();
        let mut file = options.open(path).map_err(failed)?;
        // Use a system lock, not the existence of a file: the lock ends with its process, however
        // the process ends.
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(LinkLockError::Held {
                    link: link.to_owned(),
                    holder: read(&mut file),
                });
            }
            Err(TryLockError::Error(e)) => return Err(failed(e)),
        }
        let named = file
            .set_len(0)
            .and_then(|()| file.rewind())
            .and_then(|()| write!(file, "{}", std::process::id()));
        named.map_err(failed)?;
        Ok(LinkLock(file))
    }

    /// The process that holds the link, if any.
    pub fn holder(link: &str) -> Option<u32> {
        let mut file = OpenOptions::new().read(true).open(path(link).ok()?).ok()?;
        match file.try_lock_shared() {
            Err(TryLockError::WouldBlock) => read(&mut file),
            _ => None,
        }
    }
}

fn read(file: &mut File) -> Option<u32> {
    let mut text = String::new();
    file.take(HOLDER_MAX).read_to_string(&mut text).ok()?;
    text.trim().parse().ok()
}

/// The lock file of a link; a device is identified by its real path, not by a symbolic link.
fn path(link: &str) -> io::Result<PathBuf> {
    let device = link
        .strip_prefix("serial://")
        .map(|rest| rest.split('?').next().unwrap_or(rest));
    let real = device
        .and_then(|device| std::fs::canonicalize(device).ok())
        .map(|path| path.display().to_string());
    let name = real.unwrap_or_else(|| link.to_owned());
    let fit = |c: char| {
        if c.is_ascii_alphanumeric() || matches!(c, '.' | '-') {
            c
        } else {
            '_'
        }
    };
    Ok(private_folder()?.join(format!(
        "{}.link",
        name.chars().map(fit).take(200).collect::<String>()
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_can_be_locked_only_once_until_its_holder_releases_it() {
        let link = format!("tcp://test-of-link-lock:{}", std::process::id());
        assert_eq!(LinkLock::holder(&link), None);
        let lock = LinkLock::take(&link).expect("nobody holds it");
        assert_eq!(LinkLock::holder(&link), Some(std::process::id()));
        let refused = LinkLock::take(&link).expect_err("it is locked");
        assert!(
            refused
                .to_string()
                .contains(&format!("process {}", std::process::id())),
            "{refused}"
        );
        let other = LinkLock::take(&format!("{link}1")).expect("another link");
        drop(lock);
        LinkLock::take(&link).expect("it is free");
        drop(other);
        for link in [link.clone(), format!("{link}1")] {
            std::fs::remove_file(path(&link).expect("a path")).expect("it is ours");
        }
    }
}
