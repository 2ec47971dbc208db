//! The environment of nodes: the clock, randomness, waiting, threads and the opening of sessions,
//! behind one interface.
//!
//! Programs use [`System`]. Tests of whole games replace it (`crates/simulated_network`): the code
//! of nodes is identical in both, and no program contains a simulated network.

use crate::session::Session;
use crate::zenoh_session::ZenohSession;
use crate::{BusError, Net};
use messages::topic::GameName;
use scenario::Scenario;
use std::io;
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The environment of nodes.
pub trait Runtime: Send + Sync {
    /// The current time.
    fn now(&self) -> Instant;

    /// How long the machine has been suspended since boot.
    fn suspended(&self) -> Duration;

    /// Blocks for this long.
    fn sleep(&self, time: Duration);

    /// Fills `bytes` with random data.
    fn fill_random(&self, bytes: &mut [u8]);

    /// Starts a thread of this node. Returns no handle if the thread cannot be joined; then
    /// [`Runtime::wait`] waits for its end.
    ///
    /// # Errors
    /// If the system cannot start a thread.
    fn spawn(
        &self,
        name: &str,
        body: Box<dyn FnOnce() + Send>,
    ) -> io::Result<Option<JoinHandle<()>>>;

    /// Signals that the value at `address` has changed.
    fn notify(&self, address: usize);

    /// Waits until the value at `address` changes or the deadline passes (`None`: no deadline), and
    /// returns whether time is left. Returns `None` if this runtime waits on condition variables.
    fn wait(&self, address: usize, deadline: Option<Instant>) -> Option<bool>;

    /// Whether nodes can be reached through their own sockets in addition to their sessions.
    fn has_sockets(&self) -> bool;

    /// Opens the hub session of a game.
    ///
    /// # Errors
    /// [`BusError`] if it cannot listen at its endpoints.
    fn open_hub(
        &self,
        net: &Net,
        game: &GameName,
        scenario: &Scenario,
    ) -> Result<Arc<dyn Session>, BusError>;

    /// Opens a session connected to a hub.
    ///
    /// # Errors
    /// [`BusError`] if no hub listens there now.
    fn open_leaf(&self, net: &Net) -> Result<Arc<dyn Session>, BusError>;
}

/// The runtime of this process, if it is not [`System`].
static REPLACED: OnceLock<&'static dyn Runtime> = OnceLock::new();

/// The runtime of this process.
pub(crate) fn runtime() -> &'static dyn Runtime {
    // There is one runtime per process, not passed to each constructor: a boat's supervisor, an
    // inbox and a stop order would all have to hold it, and two runtimes could meet in one node.
    REPLACED.get().copied().unwrap_or(&System)
}

/// An unpredictable random number.
pub fn random_number() -> u64 {
    u64::from_le_bytes(random_bytes())
}

/// Unpredictable random bytes, for challenges, tickets and session names.
///
/// # Panics
/// If the operating system cannot provide randomness.
pub fn random_bytes<const N: usize>() -> [u8; N] {
    let mut bytes = [0; N];
    runtime().fill_random(&mut bytes);
    bytes
}

/// Replaces [`System`] in this process. Call it before any use of the network; only the first call
/// has an effect.
pub fn replace_runtime(runtime: &'static dyn Runtime) {
    REPLACED.get_or_init(|| runtime);
}

/// The operating system, and zenoh.
pub struct System;

impl Runtime for System {
    #[expect(
        clippy::disallowed_methods,
        reason = "the one place where nodes read the clock"
    )]
    fn now(&self) -> Instant {
        Instant::now()
    }

    fn suspended(&self) -> Duration {
        #[cfg(target_os = "linux")]
        {
            use rustix::time::{ClockId, clock_gettime};
            let read = |id| Duration::try_from(clock_gettime(id)).unwrap_or_default();
            // Read in this order, so that the difference is never too large.
            let boot_time = read(ClockId::Boottime);
            // `CLOCK_MONOTONIC` stops while a machine is suspended, `CLOCK_BOOTTIME` does not. The
            // difference is time lost, for example with the lid closed, which a sim counts against
            // no node.
            boot_time.saturating_sub(read(ClockId::Monotonic))
        }
        #[cfg(not(target_os = "linux"))]
        Duration::ZERO
    }

    #[expect(
        clippy::disallowed_methods,
        reason = "the one place where nodes wait for time to pass"
    )]
    fn sleep(&self, time: Duration) {
        std::thread::sleep(time);
    }

    fn fill_random(&self, bytes: &mut [u8]) {
        getrandom::fill(bytes).expect("the operating system has randomness");
    }

    fn spawn(
        &self,
        name: &str,
        body: Box<dyn FnOnce() + Send>,
    ) -> io::Result<Option<JoinHandle<()>>> {
        std::thread::Builder::new()
            .name(name.to_owned())
            .spawn(body)
            .map(Some)
    }

    fn notify(&self, _: usize) {}

    fn wait(&self, _: usize, _: Option<Instant>) -> Option<bool> {
        None
    }

    fn has_sockets(&self) -> bool {
        true
    }

    fn open_hub(
        &self,
        net: &Net,
        game: &GameName,
        scenario: &Scenario,
    ) -> Result<Arc<dyn Session>, BusError> {
        Ok(Arc::new(ZenohSession::hub(net, game, scenario)?))
    }

    fn open_leaf(&self, net: &Net) -> Result<Arc<dyn Session>, BusError> {
        Ok(Arc::new(ZenohSession::leaf(net)?))
    }
}
