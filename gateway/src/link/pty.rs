//! A pseudo-terminal of our own, which others open as if a boat was on a serial line.

use super::clock;
use super::outbox::lock;
use super::peer::{End, Seat, Served};
use super::port::{Port, TICK};
use super::threads::{Threads, Woken};
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
    attention: Mutex<Attention>,
    flushes: AtomicU64,
}

/// What we know of somebody who reads.
#[derive(Default)]
struct Attention {
    /// Since when there has always been something that nobody read.
    unread_since: Option<Instant>,
    /// When the newest in it was begun.
    begun_at: Option<Instant>,
}

impl Pty {
    /// Opens one, raw, with a symlink to it if wanted.
    pub(super) fn open(link: Option<&Path>) -> Result<Pty, LinkError> {
        let (master, slave, path) = pair().map_err(|e| LinkError::Pty { reason: e.to_string() })?;
        // Made before the symlink is, so that a refusal leaves nothing behind.
        let mut pty = Pty { master, slave, path, link: None, attention: Mutex::default(), flushes: AtomicU64::new(0) };
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

    /// Before something new: what was not read for some time makes room for it.
    pub(super) fn begin(&self) -> io::Result<()> {
        let mut attention = lock(&self.attention);
        attention.begun_at = Some(clock::now());
        if self.unread_for(&mut attention)? >= FRESH { self.empty(&mut attention) } else { Ok(()) }
    }

    /// Now and then: throws away what was not read for some time, if nothing in it is new. Nothing tells us
    /// that somebody opened the slave, but somebody who reads empties it.
    pub(super) fn freshen(&self) -> io::Result<()> {
        let mut attention = lock(&self.attention);
        let is_old = attention.begun_at.is_none_or(|at| clock::since(at) >= FRESH);
        let unread_for = self.unread_for(&mut attention)?;
        if is_old && unread_for >= FRESH { self.empty(&mut attention) } else { Ok(()) }
    }

    /// Throws away all that has not been read.
    pub(super) fn flush(&self) -> io::Result<()> {
        self.empty(&mut lock(&self.attention))
    }

    /// For how long there has always been something to read.
    fn unread_for(&self, attention: &mut Attention) -> io::Result<Duration> {
        let is_unread = rustix::io::ioctl_fionread(&self.slave)? > 0;
        let since = attention.unread_since.filter(|_| is_unread);
        attention.unread_since = since.or_else(|| is_unread.then(clock::now));
        Ok(since.map_or(Duration::ZERO, clock::since))
    }

    fn empty(&self, attention: &mut Attention) -> io::Result<()> {
        attention.unread_since = None;
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
pub(super) fn keep(crew: &Arc<Threads>, pty: &Arc<Pty>) {
    let again = crew.settings.retry.0;
    loop {
        let port = Port::Pty(Arc::clone(pty));
        match Seat::take(crew, port, pty.path.display().to_string()).map(Seat::serve) {
            // There is no connection to break: who asks for that wants a clean start.
            Ok(Served { end: End::Asked, .. }) => drop(pty.flush()),
            Ok(_) => {}
            Err(e) => crew.tell(LinkEvent::Failed { reason: e.to_string(), again }),
        }
        // With both ends in our hands there is little that can break, and nothing to wait longer for.
        if crew.rest(again) == Woken::Stopped {
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
