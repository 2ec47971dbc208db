//! The UDP port at which ArduPilot's firmware (SITL) requests the motion of its boat.

use super::error::NodeError;
use crate::emulator::{FrontSeat, Servos, Sitl};
use bus::clock;
use messages::{Order, VehicleTruth};
use parking_lot::Mutex;
use primitives::SimTime;
use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// Interval at which the port checks for a reply to waiting firmware.
const REPLY_WAIT: Duration = Duration::from_millis(2);
/// Silence of the current firmware instance after which another may use the port.
const IDLE_MAX: Duration = Duration::from_secs(3);
/// Larger than any datagram from the firmware.
const DATAGRAM_MAX: usize = 512;

/// The firmware as the boat's front seat. The port is open as long as this value exists.
pub(super) struct SitlPort {
    firmware: Arc<Mutex<Sitl>>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    address: SocketAddr,
}

impl SitlPort {
    /// Opens the port.
    pub(super) fn open(listen: SocketAddr, servos: Servos) -> Result<SitlPort, NodeError> {
        let fail = |source| NodeError::SitlPort { listen, source };
        let socket = UdpSocket::bind(listen).map_err(fail)?;
        socket.set_read_timeout(Some(REPLY_WAIT)).map_err(fail)?;
        let address = socket.local_addr().map_err(fail)?;
        let firmware = Arc::new(Mutex::new(Sitl::new(servos)));
        let stop = Arc::new(AtomicBool::new(false));
        let (shared, ends) = (Arc::clone(&firmware), Arc::clone(&stop));
        let serve = move || serve(&socket, &shared, &ends);
        let thread = std::thread::Builder::new()
            .name("SITL port".to_owned())
            .spawn(serve)
            .map_err(fail)?;
        Ok(SitlPort {
            firmware,
            stop,
            thread: Some(thread),
            address,
        })
    }

    /// The port's address.
    pub(super) fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for SitlPort {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A panic of the thread has been printed already.
            drop(thread.join());
        }
    }
}

impl FrontSeat for SitlPort {
    fn take_remark(&mut self) -> Option<String> {
        self.firmware.lock().take_remark()
    }

    fn observe_truth(&mut self, now: SimTime, truth: &VehicleTruth) {
        self.firmware.lock().observe(now, truth);
    }

    fn order(&mut self, _now: SimTime) -> Order {
        self.firmware.lock().order()
    }
}

/// Answers one firmware instance until the port closes.
fn serve(socket: &UdpSocket, firmware: &Mutex<Sitl>, stop: &AtomicBool) {
    let mut user: Option<(SocketAddr, std::time::Instant)> = None;
    let mut buffer = [0; DATAGRAM_MAX];
    while !stop.load(Ordering::Relaxed) {
        // On a timeout, or the error from an earlier reply to a closed port, continue: a reply may
        // be due.
        if let Ok((count, from)) = socket.recv_from(&mut buffer) {
            let is_taken =
                user.is_some_and(|(by, heard)| by != from && clock::since(heard) < IDLE_MAX);
            if is_taken {
                continue;
            }
            user = Some((from, clock::now()));
            firmware.lock().receive(&buffer[..count]);
        }
        let reply = firmware.lock().reply();
        if let (Some(reply), Some((to, _))) = (reply, user) {
            // The firmware requests a lost reply again after a second.
            drop(socket.send_to(reply.as_bytes(), to));
        }
    }
}
