//! A pseudo-terminal of our own, which other programs open like a boat's serial line.

use super::clock::{self, TICK};
use super::interface::LinkError;
use parking_lot::Mutex;
use rustix::fs::{Mode, OFlags};
use rustix::pty::OpenptFlags;
use rustix::termios::{OptionalActions, QueueSelector};
use serial2::SerialPort;
use std::ffi::OsStr;
use std::fs;
use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Time after which unread bytes are discarded: a program that opens the terminal later needs the
/// boat's current position, not an old one.
const UNREAD_MAX: Duration = Duration::from_millis(500);

/// Both ends of a pseudo-terminal. We keep the slave open, too: on Linux, a master without an open
/// slave returns errors, and the next process to open it would find echo and line editing enabled.
pub(super) struct Pty {
    master: SerialPort,
    slave: OwnedFd,
    path: PathBuf,
    link: Option<PathBuf>,
    reader: Mutex<ReaderState>,
    flushes: AtomicU64,
}

/// The state of the reader.
#[derive(Default)]
struct ReaderState {
    /// Start of the current period in which there have always been unread bytes.
    unread_since: Option<Instant>,
    /// When the newest unread write began.
    begun_at: Option<Instant>,
}

impl Pty {
    /// Opens a raw pseudo-terminal, with a symlink to it if requested.
    pub(super) fn open(link: Option<&Path>) -> Result<Pty, LinkError> {
        let (master, slave, path) = pair().map_err(|e| LinkError::Pty {
            reason: e.to_string(),
        })?;
        // Create this before the symlink, so that a failure leaves no symlink behind.
        let mut pty = Pty {
            master,
            slave,
            path,
            link: None,
            reader: Mutex::default(),
            flushes: AtomicU64::new(0),
        };
        if let Some(link) = link {
            make_symlink(link, &pty.path)?;
            pty.link = Some(link.to_owned());
        }
        Ok(pty)
    }

    /// The path that others open.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn read(&self, buffer: &mut [u8]) -> io::Result<usize> {
        self.master.read(buffer)
    }

    pub(super) fn write(&self, bytes: &[u8]) -> io::Result<usize> {
        self.master.write(bytes)
    }

    /// Number of times that unread bytes have been discarded.
    pub(super) fn flushes(&self) -> u64 {
        self.flushes.load(Ordering::Relaxed)
    }

    /// Before a write: discards bytes that have been unread for too long.
    pub(super) fn begin(&self) -> io::Result<()> {
        let mut reader = self.reader.lock();
        reader.begun_at = Some(clock::now());
        if self.unread_for(&mut reader)? >= UNREAD_MAX {
            self.discard(&mut reader)
        } else {
            Ok(())
        }
    }

    /// Called regularly: discards bytes that have been unread for too long, unless some were
    /// written recently.
    pub(super) fn flush_if_stale(&self) -> io::Result<()> {
        let mut reader = self.reader.lock();
        let is_old = reader
            .begun_at
            .is_none_or(|at| clock::since(at) >= UNREAD_MAX);
        let unread_for = self.unread_for(&mut reader)?;
        if is_old && unread_for >= UNREAD_MAX {
            self.discard(&mut reader)
        } else {
            Ok(())
        }
    }

    /// For how long there have been unread bytes without a break.
    fn unread_for(&self, reader: &mut ReaderState) -> io::Result<Duration> {
        // The system reports neither that a process has opened the slave nor that it has read, but
        // the fill level of the slave's queue shows it.
        let is_unread = rustix::io::ioctl_fionread(&self.slave)? > 0;
        let since = reader.unread_since.filter(|_| is_unread);
        reader.unread_since = since.or_else(|| is_unread.then(clock::now));
        Ok(since.map_or(Duration::ZERO, clock::since))
    }

    fn discard(&self, reader: &mut ReaderState) -> io::Result<()> {
        reader.unread_since = None;
        self.flushes.fetch_add(1, Ordering::Relaxed);
        // Flush the slave: flushing the master would discard bytes that others wrote to us.
        Ok(rustix::termios::tcflush(
            &self.slave,
            QueueSelector::IFlush,
        )?)
    }
}

impl Drop for Pty {
    fn drop(&mut self) {
        let Some(link) = &self.link else { return };
        // The path may belong to another process by now.
        if fs::read_link(link).is_ok_and(|target| target == self.path) {
            drop(fs::remove_file(link));
        }
    }
}

fn pair() -> io::Result<(SerialPort, OwnedFd, PathBuf)> {
    let master =
        rustix::pty::openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
    rustix::pty::grantpt(&master)?;
    rustix::pty::unlockpt(&master)?;
    let name = rustix::pty::ptsname(&master, Vec::new())?;
    let path = PathBuf::from(OsStr::from_bytes(name.as_bytes()));
    let slave = rustix::fs::open(
        &path,
        OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC,
        Mode::empty(),
    )?;
    let mut settings = rustix::termios::tcgetattr(&slave)?;
    // Without raw mode, the line discipline echoes the back seat's bytes and converts CR to LF.
    settings.make_raw();
    rustix::termios::tcsetattr(&slave, OptionalActions::Now, &settings)?;
    rustix::fs::fcntl_setfl(&master, OFlags::NONBLOCK)?;
    let mut master = SerialPort::from(master);
    master.set_read_timeout(TICK)?;
    master.set_write_timeout(TICK)?;
    Ok((master, slave, path))
}

/// Links `link` to `target`. Replaces an old symlink, but no other file.
fn make_symlink(link: &Path, target: &Path) -> Result<(), LinkError> {
    let refused = |reason: String| LinkError::Symlink {
        path: link.to_owned(),
        reason,
    };
    // Replace only symlinks: a killed process leaves its own behind, but any other file may be a
    // user's.
    match fs::symlink_metadata(link) {
        Ok(found) if !found.is_symlink() => {
            return Err(refused(
                "a file of a different kind exists there, expected no file or an old symlink"
                    .to_owned(),
            ));
        }
        Ok(_) => fs::remove_file(link).map_err(|e| refused(e.to_string()))?,
        Err(_) => {}
    }
    symlink(target, link).map_err(|e| refused(e.to_string()))
}
