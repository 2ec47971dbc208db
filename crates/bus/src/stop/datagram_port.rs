//! A UDP socket, and a thread that reads it until the port is dropped.

use super::DATAGRAM_MAX;
use crate::clock;
use std::io;
use std::net::UdpSocket;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// Interval at which the reading thread checks whether it must end.
const POLL: Duration = Duration::from_millis(100);

/// A UDP socket and the thread that reads it. Closed on drop.
pub struct DatagramPort {
    is_closing: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl DatagramPort {
    /// Calls `serve` with every datagram that is not too long, and sends the result back.
    ///
    /// # Errors
    /// If the system cannot set the socket's time limit or start a thread.
    pub fn open(
        socket: UdpSocket,
        name: &str,
        mut serve: impl FnMut(&[u8]) -> Option<Vec<u8>> + Send + 'static,
    ) -> io::Result<DatagramPort> {
        socket.set_read_timeout(Some(POLL))?;
        let is_closing = Arc::new(AtomicBool::new(false));
        let closing = Arc::clone(&is_closing);
        let read = move || {
            let mut buffer = [0; DATAGRAM_MAX + 1];
            while !closing.load(Ordering::SeqCst) {
                match socket.recv_from(&mut buffer) {
                    Ok((count, from)) if count <= DATAGRAM_MAX => {
                        // A lost answer is requested again.
                        serve(&buffer[..count])
                            .into_iter()
                            .for_each(|answer| drop(socket.send_to(&answer, from)));
                    }
                    Ok(_) => {}
                    // No process is listening at the target of a request yet.
                    Err(e) if e.kind() == io::ErrorKind::ConnectionRefused => {}
                    Err(e)
                        if matches!(
                            e.kind(),
                            io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut
                        ) => {}
                    Err(_) => clock::rest(POLL),
                }
            }
        };
        let thread = std::thread::Builder::new()
            .name(name.to_owned())
            .spawn(read)?;
        Ok(DatagramPort {
            is_closing,
            thread: Some(thread),
        })
    }

    /// Tells the thread to end; drop waits for it.
    pub(super) fn close(&self) {
        self.is_closing.store(true, Ordering::SeqCst);
    }
}

impl Drop for DatagramPort {
    fn drop(&mut self) {
        self.close();
        // A panicked thread has no result.
        self.thread
            .take()
            .map(JoinHandle::join)
            .into_iter()
            .for_each(drop);
    }
}
