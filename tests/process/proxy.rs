//! A TCP proxy whose links can be cut or stalled.

use socket2::SockRef;
use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Pass bytes on.
pub(crate) const PASS: u8 = 0;
/// Accept all bytes, but pass none on.
pub(crate) const SWALLOW: u8 = 1;
/// Refuse connections.
pub(crate) const REFUSE: u8 = 2;
/// Stop reading: bytes stay with the sender, as with a cut cable.
pub(crate) const STALL: u8 = 3;

/// Approximate number of bytes read beyond those passed on.
const BUFFER: usize = 4096;

/// A proxy on a free loopback port.
pub(crate) struct Proxy {
    pub(crate) port: u16,
    state: Arc<AtomicU8>,
    open: Arc<Mutex<Vec<TcpStream>>>,
}

impl Proxy {
    pub(crate) fn start(to: String) -> Proxy {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let port = listener.local_addr().expect("bound").port();
        let state = Arc::new(AtomicU8::new(PASS));
        let open = Arc::new(Mutex::new(Vec::new()));
        let now = Arc::clone(&state);
        let streams = Arc::clone(&open);
        std::thread::spawn(move || {
            for inner in listener.incoming().map_while(Result::ok) {
                if now.load(Ordering::Relaxed) == REFUSE {
                    continue;
                }
                let Ok(outer) = TcpStream::connect(&to) else {
                    continue;
                };
                for (from, into) in [(&inner, &outer), (&outer, &inner)] {
                    let _ = SockRef::from(from).set_recv_buffer_size(BUFFER);
                    let from = from.try_clone().expect("a stream");
                    let into = into.try_clone().expect("a stream");
                    let now = Arc::clone(&now);
                    std::thread::spawn(move || pass(from, into, &now));
                }
                streams.lock().expect("whole").extend([inner, outer]);
            }
        });
        Proxy { port, state, open }
    }

    pub(crate) fn set(&self, state: u8) {
        self.state.store(state, Ordering::Relaxed);
    }

    pub(crate) fn cut(&self) {
        for stream in self.open.lock().expect("whole").drain(..) {
            let _ = stream.shutdown(Shutdown::Both);
        }
    }
}

/// Transfers bytes one way. A connection that has begun to swallow never returns the swallowed
/// bytes.
fn pass(mut from: TcpStream, mut into: TcpStream, state: &AtomicU8) {
    let mut buffer = [0; BUFFER];
    let mut swallowing = false;
    while let Ok(count) = from.read(&mut buffer) {
        while state.load(Ordering::Relaxed) == STALL {
            std::thread::sleep(Duration::from_millis(10));
        }
        swallowing |= state.load(Ordering::Relaxed) == SWALLOW;
        if count == 0 {
            break;
        }
        if !swallowing && into.write_all(&buffer[..count]).is_err() {
            break;
        }
    }
    let _ = into.shutdown(Shutdown::Both);
}
