//! A UDP socket that is read as long as it is kept.

use super::DATAGRAM_MAX;
use crate::clock;
use std::io;
use std::net::UdpSocket;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// How often the thread that reads looks whether it is to end.
const LOOK: Duration = Duration::from_millis(100);

/// A UDP socket and the thread that reads it. Dropped, it is closed.
pub struct DatagramPort {
    is_closing: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl DatagramPort {
    /// Calls `serve` with every datagram that is not too long, and sends back what it gives.
    ///
    /// # Errors
    /// If the system has no thread to give.
    pub fn open(
        socket: UdpSocket,
        name: &str,
        mut serve: impl FnMut(&[u8]) -> Option<Vec<u8>> + Send + 'static,
    ) -> io::Result<DatagramPort> {
        socket.set_read_timeout(Some(LOOK))?;
        let is_closing = Arc::new(AtomicBool::new(false));
        let closing = Arc::clone(&is_closing);
        let read = move || {
            let mut buffer = [0; DATAGRAM_MAX + 1];
            while !closing.load(Ordering::SeqCst) {
                match socket.recv_from(&mut buffer) {
                    Ok((count, from)) if count <= DATAGRAM_MAX => {
                        // An answer that is lost is asked for again.
                        serve(&buffer[..count]).into_iter().for_each(|answer| drop(socket.send_to(&answer, from)));
                    }
                    Ok(_) => {}
                    // Nobody listens where a request was sent: somebody may later.
                    Err(e) if e.kind() == io::ErrorKind::ConnectionRefused => {}
                    Err(e) if matches!(e.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => {}
                    Err(_) => clock::rest(LOOK),
                }
            }
        };
        let thread = std::thread::Builder::new().name(name.to_owned()).spawn(read)?;
        Ok(DatagramPort { is_closing, thread: Some(thread) })
    }

    /// Ends the thread soon; dropping this waits for it.
    pub(super) fn close(&self) {
        self.is_closing.store(true, Ordering::SeqCst);
    }
}

impl Drop for DatagramPort {
    fn drop(&mut self) {
        self.close();
        // A thread that panicked has nothing to give back.
        self.thread.take().map(JoinHandle::join).into_iter().for_each(drop);
    }
}
