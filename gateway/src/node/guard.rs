//! The guard of a gateway: a small process that stops the boat when the gateway dies, hangs or is
//! suspended.
//!
//! It holds a duplicate of the link's file descriptor, which outlives a killed process, and one end
//! of a socket pair. Through the pair, the gateway sends the stop message of its protocol, a
//! heartbeat from its loop, every new link, and notice of an orderly exit. Without a heartbeat for
//! [`SILENCE`], or when the other end closes, the guard writes the stop message: zero thrust and
//! standby.

use bus::clock;
use parking_lot::Mutex;
use rustix::net::sockopt::{Timeout, set_socket_timeout};
use rustix::net::{
    AddressFamily, RecvAncillaryBuffer, RecvAncillaryMessage, RecvFlags, SendAncillaryBuffer,
    SendAncillaryMessage, SendFlags, Shutdown, SocketFlags, SocketType, recvmsg, sendmsg, shutdown,
    socketpair,
};
use std::io::{self, IoSlice, IoSliceMut};
use std::mem::MaybeUninit;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How often the loop sends a heartbeat.
pub(super) const HEARTBEAT: Duration = Duration::from_millis(100);
/// Time without a heartbeat after which the gateway is treated as hung.
const SILENCE: Duration = Duration::from_millis(400);
/// Time without a heartbeat after which the loop itself assumes that the guard has stopped the
/// boat: shorter than [`SILENCE`], so that the loop never misses such a stop.
pub(super) const HUNG: Duration = Duration::from_millis(350);
/// Interval at which the guard repeats standby while the gateway hangs and after it has died.
const AGAIN: Duration = Duration::from_millis(100);
const LAST_WORDS: usize = 4;
/// Maximum time to write one sentence.
const WRITE_MAX: Duration = Duration::from_millis(50);

/// Messages to the guard: one byte each. The stop message follows the byte `STOP`.
const ALIVE: u8 = b'.';
const LINK: u8 = b'+';
const NO_LINK: u8 = b'-';
const ENDS: u8 = b'!';
const STOP: u8 = b'=';
/// Maximum size of a message to the guard, bytes.
const TOLD_MAX: usize = 1024;

/// The gateway's end.
#[derive(Clone)]
pub(super) struct Guarded(Arc<Inner>);

struct Inner {
    socket: OwnedFd,
    process: Mutex<Child>,
    is_gone: AtomicBool,
    /// The stop message that the guard last received.
    stop: Mutex<Vec<u8>>,
}

impl Guarded {
    /// Starts the guard with a command that calls [`guard`] on its standard input. The message
    /// `stop` stops the boat.
    pub(super) fn start(mut command: Command, stop: &[u8]) -> io::Result<Guarded> {
        // Packets keep their boundaries and can carry descriptors, and the kernel notifies the
        // other end when a process dies.
        let (socket, its_end) = socketpair(
            AddressFamily::UNIX,
            SocketType::SEQPACKET,
            SocketFlags::CLOEXEC,
            None,
        )?;
        // A signal from the terminal that ends the gateway must not end the guard.
        command
            .stdin(Stdio::from(its_end))
            .stdout(Stdio::null())
            .process_group(0);
        let process = Mutex::new(command.spawn()?);
        let is_gone = AtomicBool::new(false);
        let guarded = Guarded(Arc::new(Inner {
            socket,
            process,
            is_gone,
            stop: Mutex::default(),
        }));
        guarded.stop_with(stop);
        Ok(guarded)
    }

    /// Reports that the loop is running. Returns `false` the first time that the guard is found to
    /// be dead.
    pub(super) fn beat(&self) -> bool {
        self.send(&[ALIVE], None) || self.0.is_gone.swap(true, Ordering::Relaxed)
    }

    /// Sets the stop message to use from now on.
    pub(super) fn stop_with(&self, message: &[u8]) {
        let mut stop = self.0.stop.lock();
        if *stop != message && self.send(&[&[STOP], message].concat(), None) {
            message.clone_into(&mut stop);
        }
    }

    /// Passes a new link to the guard, or tells it that the link is lost.
    pub(super) fn link(&self, descriptor: Option<BorrowedFd<'_>>) {
        self.send(
            &[if descriptor.is_some() { LINK } else { NO_LINK }],
            descriptor,
        );
    }

    /// Reports that the gateway has stopped the boat itself and is exiting.
    pub(super) fn end(&self) {
        self.send(&[ENDS], None);
    }

    /// Sends a message. Returns whether the guard still exists. A message to a suspended guard is
    /// lost once its queue is full.
    fn send(&self, what: &[u8], descriptor: Option<BorrowedFd<'_>>) -> bool {
        let descriptors: Vec<BorrowedFd<'_>> = descriptor.into_iter().collect();
        let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(1))];
        let mut control = SendAncillaryBuffer::new(&mut space);
        if !descriptors.is_empty() {
            control.push(SendAncillaryMessage::ScmRights(&descriptors));
        }
        // The loop must not wait for its guard, and a dead guard must not kill the gateway with
        // SIGPIPE.
        let flags = SendFlags::DONTWAIT | SendFlags::NOSIGNAL;
        match sendmsg(&self.0.socket, &[IoSlice::new(what)], &mut control, flags) {
            Ok(_) => true,
            // A guard that is slow to read is alive: its queue is full of heartbeats.
            Err(e) => e == rustix::io::Errno::AGAIN,
        }
    }
}

impl Drop for Inner {
    fn drop(&mut self) {
        // A guard that did not receive the exit notice treats this as the death of the process.
        let _ = shutdown(&self.socket, Shutdown::Both);
        drop(self.process.lock().wait());
    }
}

/// An input of the guard.
enum Heard {
    Told(u8, Option<OwnedFd>),
    /// The stop message.
    Stop(Vec<u8>),
    /// Nothing within the time limit.
    Nothing,
    /// The other end has closed.
    Died,
}

/// Runs the guard until the gateway has ended; reports its actions through `remark`.
///
/// # Errors
/// If the socket cannot be used.
pub fn guard(socket: impl AsFd, remark: &mut dyn FnMut(&str)) -> io::Result<()> {
    let mut link: Option<OwnedFd> = None;
    let mut stop = Vec::new();
    let mut is_hung = false;
    loop {
        let wait = if is_hung { AGAIN } else { SILENCE };
        set_socket_timeout(&socket, Timeout::Recv, Some(wait))?;
        match hear(socket.as_fd())? {
            Heard::Told(ENDS, _) => return Ok(()),
            Heard::Stop(message) => stop = message,
            Heard::Told(LINK, descriptor) => link = descriptor,
            Heard::Told(NO_LINK, _) => link = None,
            Heard::Told(..) if is_hung => {
                is_hung = false;
                remark("the gateway is running again");
            }
            Heard::Told(..) => {}
            Heard::Nothing => {
                if let Some(link) = &link {
                    write(link, &stop);
                    if !is_hung {
                        remark("the gateway has hung: sending zero thrust and standby to its boat");
                    }
                }
                // Without a link there is nothing to send, and no hang to report.
                is_hung |= link.is_some();
            }
            Heard::Died => {
                let Some(link) = &link else { return Ok(()) };
                write(link, &stop);
                remark("the gateway has died: sending zero thrust and standby to its boat");
                // Repeat it for lossy links, and because the dead gateway may have left data queued
                // in the kernel.
                for _ in 1..LAST_WORDS {
                    clock::rest(AGAIN);
                    write(link, &stop);
                }
                return Ok(());
            }
        }
    }
}

fn hear(socket: BorrowedFd<'_>) -> io::Result<Heard> {
    let mut bytes = [0; TOLD_MAX];
    let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(1))];
    let mut control = RecvAncillaryBuffer::new(&mut space);
    // A signal does not end the wait.
    let received = rustix::io::retry_on_intr(|| {
        recvmsg(
            socket,
            &mut [IoSliceMut::new(&mut bytes)],
            &mut control,
            RecvFlags::CMSG_CLOEXEC,
        )
    });
    match received {
        Ok(received) if received.bytes == 0 => Ok(Heard::Died),
        Ok(received) if bytes[0] == STOP => Ok(Heard::Stop(bytes[1..received.bytes].to_vec())),
        Ok(_) => {
            let descriptors = control.drain().filter_map(|message| match message {
                RecvAncillaryMessage::ScmRights(mut descriptors) => descriptors.next(),
                _ => None,
            });
            Ok(Heard::Told(bytes[0], descriptors.last()))
        }
        Err(rustix::io::Errno::AGAIN) => Ok(Heard::Nothing),
        Err(rustix::io::Errno::CONNRESET | rustix::io::Errno::PIPE) => Ok(Heard::Died),
        Err(e) => Err(e.into()),
    }
}

/// Writes all bytes if the port accepts them in time.
fn write(link: &OwnedFd, bytes: &[u8]) {
    let start = clock::now();
    let mut rest = bytes;
    while !rest.is_empty() && clock::since(start) < WRITE_MAX {
        match rustix::io::write(link, rest) {
            Ok(count) => rest = &rest[count..],
            // Sockets have already waited briefly; serial lines have not.
            Err(rustix::io::Errno::AGAIN | rustix::io::Errno::INTR) => {
                clock::rest(Duration::from_millis(2))
            }
            Err(_) => return,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn a_guard_that_was_not_told_of_the_end_is_not_waited_for_without_end() {
        // Like a guard, `cat` reads until the other end closes.
        let guarded = Guarded::start(Command::new("cat"), b"stop").expect("it starts");
        let (sender, dropped) = channel();
        std::thread::spawn(move || {
            drop(guarded);
            sender.send(())
        });
        assert_eq!(dropped.recv_timeout(Duration::from_secs(10)), Ok(()));
    }
}
