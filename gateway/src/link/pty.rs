//! A pseudo-terminal of our own, which others open as if a boat was on a serial line.

use super::backoff::Backoff;
use super::clock;
use super::crew::Crew;
use super::outbox::lock;
use super::peer::{End, Seat, Served};
use super::port::{Port, TICK};
use super::{LinkError, LinkEvent};
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
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// What nobody has read for this long is thrown away: whoever opens the terminal later wants to know where
/// the boat is, not where it was.
const FRESH: Duration = Duration::from_millis(500);

/// Both ends of a pseudo-terminal. We keep the slave open too: without anybody on it the master could not
/// be written, and the next one on it would find echo and line editing switched on again.
pub(super) struct Pty {
    master: SerialPort,
    slave: OwnedFd,
    path: PathBuf,
    link: Option<PathBuf>,
    /// Since when there has always been something that nobody read.
    unread_since: Mutex<Option<Instant>>,
    flushes: AtomicU64,
}

impl Pty {
    /// Opens one, raw, with a symlink to it if wanted.
    pub(super) fn open(link: Option<&Path>) -> Result<Pty, LinkError> {
        let (master, slave, path) = pair().map_err(|e| LinkError::Pty { reason: e.to_string() })?;
        // Made before the symlink is, so that a refusal leaves nothing behind.
        let mut pty =
            Pty { master, slave, path, link: None, unread_since: Mutex::new(None), flushes: AtomicU64::new(0) };
        if let Some(link) = link {
            point(link, &pty.path)?;
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

    /// How often unread bytes were thrown away.
    pub(super) fn flushes(&self) -> u64 {
        self.flushes.load(Ordering::Relaxed)
    }

    /// Throws away what has not been read for some time. Nothing tells us that somebody opened the slave,
    /// but somebody who reads empties it.
    pub(super) fn freshen(&self) -> io::Result<()> {
        let unread = rustix::io::ioctl_fionread(&self.slave)? > 0;
        let mut since = lock(&self.unread_since);
        match *since {
            Some(start) if unread && clock::since(start) >= FRESH => {
                *since = None;
                drop(since);
                self.flush()?;
            }
            Some(_) if unread => {}
            None if unread => *since = Some(clock::now()),
            _ => *since = None,
        }
        Ok(())
    }

    /// Throws away all that has not been read.
    pub(super) fn flush(&self) -> io::Result<()> {
        self.flushes.fetch_add(1, Ordering::Relaxed);
        // On the slave: flushing the master would throw away what the others wrote to us.
        Ok(rustix::termios::tcflush(&self.slave, QueueSelector::IFlush)?)
    }
}

impl Drop for Pty {
    fn drop(&mut self) {
        let Some(link) = &self.link else { return };
        // Somebody else's by now, perhaps.
        if fs::read_link(link).is_ok_and(|target| target == self.path) {
            drop(fs::remove_file(link));
        }
    }
}

/// Serves whoever opens it, until the link is closed.
pub(super) fn keep(crew: &Arc<Crew>, pty: &Arc<Pty>) {
    let mut backoff = Backoff::new(crew.settings.retry);
    loop {
        let port = Port::Pty(Arc::clone(pty));
        let served = Seat::take(crew, port, pty.path.display().to_string()).map(Seat::serve);
        let again = backoff.wait();
        match served {
            // There is no connection to break: who asks for that wants a clean start.
            Ok(Served { end: End::Asked, .. }) => {
                drop(pty.flush());
                backoff.reset();
            }
            Ok(Served { end: End::Stopped, .. }) => return,
            Ok(_) => drop(crew.pause(again)),
            Err(e) => {
                crew.tell(LinkEvent::Failed { reason: e.to_string(), again });
                crew.pause(again);
            }
        }
        if crew.is_stopped() {
            return;
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
    settings.make_raw();
    rustix::termios::tcsetattr(&slave, OptionalActions::Now, &settings)?;
    rustix::fs::fcntl_setfl(&master, OFlags::NONBLOCK)?;
    let mut master = SerialPort::from(master);
    master.set_read_timeout(TICK)?;
    master.set_write_timeout(TICK)?;
    Ok((master, slave, path))
}

/// Makes `link` point to `target`, over an old symlink but over nothing else.
fn point(link: &Path, target: &Path) -> Result<(), LinkError> {
    let refused = |reason: String| LinkError::Symlink { path: link.to_owned(), reason };
    match fs::symlink_metadata(link) {
        Ok(found) if !found.is_symlink() => {
            return Err(refused("something else is there, allowed: nothing, or an old symlink".to_owned()));
        }
        Ok(_) => fs::remove_file(link).map_err(|e| refused(e.to_string()))?,
        Err(_) => {}
    }
    symlink(target, link).map_err(|e| refused(e.to_string()))
}
