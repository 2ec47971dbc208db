//! A pseudo-terminal of our own, which others open as if a boat was on a serial line.

use super::LinkError;
use super::clock::{self, TICK};
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

/// What nobody has read for this long is discarded: whoever opens the terminal later wants to know where
/// the boat is, not where it was.
const UNREAD_MAX: Duration = Duration::from_millis(500);

/// Both ends of a pseudo-terminal. We keep the slave open too: without anybody on it the master could not
/// be written, and the next one on it would find echo and line editing switched on again.
pub(super) struct Pty {
    master: SerialPort,
    slave: OwnedFd,
    path: PathBuf,
    link: Option<PathBuf>,
    reader: Mutex<ReaderState>,
    flushes: AtomicU64,
}

/// What is known of the reader.
#[derive(Default)]
struct ReaderState {
    /// Since when there has always been something that nobody read.
    unread_since: Option<Instant>,
    /// When the newest in it was begun.
    begun_at: Option<Instant>,
}

impl Pty {
    /// Opens one, raw, with a symlink to it if wanted.
    pub(super) fn open(link: Option<&Path>) -> Result<Pty, LinkError> {
        // The slave stays open here as well: a master whose last slave closes reports an error
        // on Linux until somebody opens it again.
        let (master, slave, path) = pair().map_err(|e| LinkError::Pty { reason: e.to_string() })?;
        // Made before the symlink is, so that a refusal leaves nothing behind.
        let mut pty = Pty { master, slave, path, link: None, reader: Mutex::default(), flushes: AtomicU64::new(0) };
        if let Some(link) = link {
            make_symlink(link, &pty.path)?;
            pty.link = Some(link.to_owned());
        }
        Ok(pty)
    }

    /// What others open.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn read(&self, buffer: &mut [u8]) -> io::Result<usize> {
        self.master.read(buffer)
    }

    pub(super) fn write(&self, bytes: &[u8]) -> io::Result<usize> {
        self.master.write(bytes)
    }

    /// How often unread bytes were discarded.
    pub(super) fn flushes(&self) -> u64 {
        self.flushes.load(Ordering::Relaxed)
    }

    /// Before a write: discards what was not read for some time.
    pub(super) fn begin(&self) -> io::Result<()> {
        let mut reader = self.reader.lock();
        reader.begun_at = Some(clock::now());
        if self.unread_for(&mut reader)? >= UNREAD_MAX { self.discard(&mut reader) } else { Ok(()) }
    }

    /// Now and then: discards what was not read for some time, if nothing in it is new. There is no notification
    /// that somebody opened the slave, but a reader empties it.
    pub(super) fn flush_if_stale(&self) -> io::Result<()> {
        let mut reader = self.reader.lock();
        let is_old = reader.begun_at.is_none_or(|at| clock::since(at) >= UNREAD_MAX);
        let unread_for = self.unread_for(&mut reader)?;
        if is_old && unread_for >= UNREAD_MAX { self.discard(&mut reader) } else { Ok(()) }
    }

    /// Discards all that has not been read.
    pub(super) fn flush(&self) -> io::Result<()> {
        self.discard(&mut self.reader.lock())
    }

    /// For how long there has always been something to read.
    fn unread_for(&self, reader: &mut ReaderState) -> io::Result<Duration> {
        // No event tells that somebody reads; the fill of the slave's queue does.
        let is_unread = rustix::io::ioctl_fionread(&self.slave)? > 0;
        let since = reader.unread_since.filter(|_| is_unread);
        reader.unread_since = since.or_else(|| is_unread.then(clock::now));
        Ok(since.map_or(Duration::ZERO, clock::since))
    }

    fn discard(&self, reader: &mut ReaderState) -> io::Result<()> {
        reader.unread_since = None;
        self.flushes.fetch_add(1, Ordering::Relaxed);
        // On the slave: flushing the master would discard what the others wrote to us.
        Ok(rustix::termios::tcflush(&self.slave, QueueSelector::IFlush)?)
    }
}

impl Drop for Pty {
    fn drop(&mut self) {
        let Some(link) = &self.link else { return };
        // It may belong to another process by now.
        if fs::read_link(link).is_ok_and(|target| target == self.path) {
            drop(fs::remove_file(link));
        }
    }
}

fn pair() -> io::Result<(SerialPort, OwnedFd, PathBuf)> {
    let master = rustix::pty::openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
    rustix::pty::grantpt(&master)?;
    rustix::pty::unlockpt(&master)?;
    let name = rustix::pty::ptsname(&master, Vec::new())?;
    let path = PathBuf::from(OsStr::from_bytes(name.as_bytes()));
    let slave = rustix::fs::open(&path, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?;
    let mut settings = rustix::termios::tcgetattr(&slave)?;
    // Otherwise the line discipline echoes what the back seat writes and turns CR into LF.
    settings.make_raw();
    rustix::termios::tcsetattr(&slave, OptionalActions::Now, &settings)?;
    rustix::fs::fcntl_setfl(&master, OFlags::NONBLOCK)?;
    let mut master = SerialPort::from(master);
    master.set_read_timeout(TICK)?;
    master.set_write_timeout(TICK)?;
    Ok((master, slave, path))
}

/// Makes `link` point to `target`, over an old symlink but over nothing else.
fn make_symlink(link: &Path, target: &Path) -> Result<(), LinkError> {
    let refused = |reason: String| LinkError::Symlink { path: link.to_owned(), reason };
    // Symlinks are replaced, since a killed process leaves its own behind; anything else may be
    // somebody's file.
    match fs::symlink_metadata(link) {
        Ok(found) if !found.is_symlink() => {
            return Err(refused("something else is there, allowed: nothing, or an old symlink".to_owned()));
        }
        Ok(_) => fs::remove_file(link).map_err(|e| refused(e.to_string()))?,
        Err(_) => {}
    }
    symlink(target, link).map_err(|e| refused(e.to_string()))
}
