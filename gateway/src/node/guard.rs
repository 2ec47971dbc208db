//! The guard of a gateway: a small process that stops the boat when the gateway dies, hangs or is suspended.
//!
//! It has a duplicate of the link, which a killed process cannot take with it, and one end of a pair of sockets. Over that the
//! gateway sends what stops the boat by its protocol, a heartbeat from its loop, every new link, and that it ends in order. Without a
//! heartbeat for [`SILENCE`], or when the other end is closed, it writes what stops the boat: thrust zero and standby.

use bus::clock;
use parking_lot::Mutex;
use rustix::net::sockopt::{Timeout, set_socket_timeout};
use rustix::net::{
    AddressFamily, RecvAncillaryBuffer, RecvAncillaryMessage, RecvFlags, SendAncillaryBuffer, SendAncillaryMessage,
    SendFlags, Shutdown, SocketFlags, SocketType, recvmsg, sendmsg, shutdown, socketpair,
};
use std::io::{self, IoSlice, IoSliceMut};
use std::mem::MaybeUninit;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How often the loop shows that it runs.
pub(super) const HEARTBEAT: Duration = Duration::from_millis(100);
/// Without a heartbeat for so long the gateway counts as hung.
const SILENCE: Duration = Duration::from_millis(400);
/// From here on the loop itself takes it that the guard has stopped the boat: less, so that the two never miss each other.
pub(super) const HUNG: Duration = Duration::from_millis(350);
/// How often the boat is sent standby meanwhile, and how often after the gateway has died.
const AGAIN: Duration = Duration::from_millis(100);
const LAST_WORDS: usize = 4;
/// How long one sentence may take.
const WRITE_MAX: Duration = Duration::from_millis(50);

/// What the gateway tells its guard: a byte each, and what stops the boat after the byte of that.
const ALIVE: u8 = b'.';
const LINK: u8 = b'+';
const NO_LINK: u8 = b'-';
const ENDS: u8 = b'!';
const STOP: u8 = b'=';
/// The longest message to the guard, bytes.
const TOLD_MAX: usize = 1024;

/// The gateway's end.
#[derive(Clone)]
pub(super) struct Guarded(Arc<Inner>);

struct Inner {
    socket: OwnedFd,
    process: Mutex<Child>,
    is_gone: AtomicBool,
    /// What stops the boat, as the guard was last told.
    stop: Mutex<Vec<u8>>,
}

impl Guarded {
    /// Starts the guard, by a command that calls [`guard`] with its standard input, of a boat that this stops.
    pub(super) fn start(mut command: Command, stop: &[u8]) -> io::Result<Guarded> {
        // Packets with their boundaries, descriptors may travel along, and the kernel tells the
        // other end when a process dies.
        let (socket, its_end) = socketpair(AddressFamily::UNIX, SocketType::SEQPACKET, SocketFlags::CLOEXEC, None)?;
        // What ends the gateway by its terminal must not end the guard with it.
        command.stdin(Stdio::from(its_end)).stdout(Stdio::null()).process_group(0);
        let process = Mutex::new(command.spawn()?);
        let is_gone = AtomicBool::new(false);
        let guarded = Guarded(Arc::new(Inner { socket, process, is_gone, stop: Mutex::default() }));
        guarded.stop_with(stop);
        Ok(guarded)
    }

    /// The loop runs. Whether the guard does, the first time that it does not.
    pub(super) fn beat(&self) -> bool {
        self.send(&[ALIVE], None) || self.0.is_gone.swap(true, Ordering::Relaxed)
    }

    /// This stops the boat from now on.
    pub(super) fn stop_with(&self, message: &[u8]) {
        let mut stop = self.0.stop.lock();
        if *stop != message && self.send(&[&[STOP], message].concat(), None) {
            message.clone_into(&mut stop);
        }
    }

    /// There is a new link, or none.
    pub(super) fn link(&self, descriptor: Option<BorrowedFd<'_>>) {
        self.send(&[if descriptor.is_some() { LINK } else { NO_LINK }], descriptor);
    }

    /// The gateway has stopped the boat itself, and ends.
    pub(super) fn end(&self) {
        self.send(&[ENDS], None);
    }

    /// Whether the guard could be told; one that is suspended takes nothing more some time, and is there.
    fn send(&self, what: &[u8], descriptor: Option<BorrowedFd<'_>>) -> bool {
        let descriptors: Vec<BorrowedFd<'_>> = descriptor.into_iter().collect();
        let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(1))];
        let mut control = SendAncillaryBuffer::new(&mut space);
        if !descriptors.is_empty() {
            control.push(SendAncillaryMessage::ScmRights(&descriptors));
        }
        // The loop must not wait for its guard, and a guard that is gone must not kill the
        // gateway by SIGPIPE.
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
        // One that was not told of an end waits for this one: it ends as if this process had died.
        let _ = shutdown(&self.socket, Shutdown::Both);
        drop(self.process.lock().wait());
    }
}

/// What the guard heard.
enum Heard {
    Told(u8, Option<OwnedFd>),
    /// This stops the boat.
    Stop(Vec<u8>),
    /// Nothing, for [`SILENCE`] or as long as it waits.
    Nothing,
    /// The other end is closed.
    Died,
}

/// The guard itself, until the gateway has ended; `remark` is told what it does.
///
/// # Errors
/// If the socket cannot be used.
pub fn guard(socket: impl AsFd, remark: &mut dyn FnMut(&str)) -> io::Result<()> {
    let mut link: Option<OwnedFd> = None;
    let (mut stop, mut is_hung) = (Vec::new(), false);
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
                remark("the gateway runs again");
            }
            Heard::Told(..) => {}
            Heard::Nothing => {
                if let Some(link) = &link {
                    write(link, &stop);
                    if !is_hung {
                        remark("the gateway hangs: its boat is sent zero thrust and standby");
                    }
                }
                // Without a link there is nothing to say, and nobody to tell that the gateway
                // hangs.
                is_hung |= link.is_some();
            }
            Heard::Died => {
                let Some(link) = &link else { return Ok(()) };
                write(link, &stop);
                remark("the gateway has died: its boat is sent zero thrust and standby");
                // Again, for links that lose bytes, and against whatever the dead gateway had
                // queued in the kernel.
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
    // A signal is no silence.
    let received = rustix::io::retry_on_intr(|| {
        recvmsg(socket, &mut [IoSliceMut::new(&mut bytes)], &mut control, RecvFlags::CMSG_CLOEXEC)
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

/// Writes it all, if there is room in time.
fn write(link: &OwnedFd, bytes: &[u8]) {
    let (start, mut rest) = (clock::now(), bytes);
    while !rest.is_empty() && clock::since(start) < WRITE_MAX {
        match rustix::io::write(link, rest) {
            Ok(count) => rest = &rest[count..],
            // Sockets have waited for a moment by themselves; lines have not.
            Err(rustix::io::Errno::AGAIN | rustix::io::Errno::INTR) => clock::rest(Duration::from_millis(2)),
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
        // Like a guard it reads until the other end is closed.
        let guarded = Guarded::start(Command::new("cat"), b"stop").expect("it starts");
        let (sender, dropped) = channel();
        std::thread::spawn(move || {
            drop(guarded);
            sender.send(())
        });
        assert_eq!(dropped.recv_timeout(Duration::from_secs(10)), Ok(()));
    }
}
