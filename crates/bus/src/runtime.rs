//! What nodes run on: the clock, randomness, waiting, threads and the opening of sessions, behind one interface.
//!
//! A program has [`System`]. Tests of whole games replace all of it at once (`crates/simulated_network`), so the code of a node is the
//! same in both to the byte, and no program contains a simulated network.

use crate::session::Session;
use crate::zenoh_session::ZenohSession;
use crate::{BusError, Net};
use messages::topic::GameName;
use scenario::Scenario;
use std::io;
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// What nodes run on.
pub trait Runtime: Send + Sync {
    /// This moment.
    fn now(&self) -> Instant;

    /// How long the machine has been suspended since it was started.
    fn suspended(&self) -> Duration;

    /// Lets this much time pass.
    fn sleep(&self, time: Duration);

    /// Fills `bytes` with random ones.
    fn fill_random(&self, bytes: &mut [u8]);

    /// Starts a thread of this node. Gives no handle where nobody can join it: its end is then waited for by [`Runtime::wait`].
    ///
    /// # Errors
    /// If the system has no thread to give.
    fn spawn(&self, name: &str, body: Box<dyn FnOnce() + Send>) -> io::Result<Option<JoinHandle<()>>>;

    /// Says that the value at `address` has changed.
    fn notify(&self, address: usize);

    /// Waits until the value at `address` changes or the deadline passes (none: for ever), and says whether there is time left. `None`:
    /// this runtime leaves waiting to condition variables.
    fn wait(&self, address: usize, deadline: Option<Instant>) -> Option<bool>;

    /// Whether nodes can be reached by sockets of their own, beside their sessions.
    fn has_sockets(&self) -> bool;

    /// Opens the session of the hub of a game.
    ///
    /// # Errors
    /// [`BusError`] if it cannot listen where it should.
    fn open_hub(&self, net: &Net, game: &GameName, scenario: &Scenario) -> Result<Arc<dyn Session>, BusError>;

    /// Opens a session that is connected to a hub.
    ///
    /// # Errors
    /// [`BusError`] if nobody listens there now.
    fn open_leaf(&self, net: &Net) -> Result<Arc<dyn Session>, BusError>;
}

/// What this process runs on, where that is not [`System`].
static REPLACED: OnceLock<&'static dyn Runtime> = OnceLock::new();

/// What this process runs on.
pub(crate) fn runtime() -> &'static dyn Runtime {
    // One for the process, not one passed to each constructor: a boat's supervisor, an inbox and a
    // stop order would all have to hold it, and two could meet in one node.
    REPLACED.get().copied().unwrap_or(&System)
}

/// Lets this process run on something else than [`System`]: before it does anything on the network. Only the first call counts.
pub fn replace_runtime(runtime: &'static dyn Runtime) {
    REPLACED.get_or_init(|| runtime);
}

/// The operating system, and zenoh.
pub struct System;

impl Runtime for System {
    #[expect(clippy::disallowed_methods, reason = "the one place where nodes read the clock")]
    fn now(&self) -> Instant {
        Instant::now()
    }

    fn suspended(&self) -> Duration {
        #[cfg(target_os = "linux")]
        {
            use rustix::time::{ClockId, clock_gettime};
            let read = |id| Duration::try_from(clock_gettime(id)).unwrap_or_default();
            // In this order the difference is never too large.
            let boot_time = read(ClockId::Boottime);
            // `CLOCK_MONOTONIC` stands still while a machine is suspended, `CLOCK_BOOTTIME` does
            // not: the difference is the time that a closed lid has cost, for which a sim blames
            // nobody.
            boot_time.saturating_sub(read(ClockId::Monotonic))
        }
        #[cfg(not(target_os = "linux"))]
        Duration::ZERO
    }

    #[expect(clippy::disallowed_methods, reason = "the one place where nodes wait for time to pass")]
    fn sleep(&self, time: Duration) {
        std::thread::sleep(time);
    }

    fn fill_random(&self, bytes: &mut [u8]) {
        getrandom::fill(bytes).expect("the operating system has randomness");
    }

    fn spawn(&self, name: &str, body: Box<dyn FnOnce() + Send>) -> io::Result<Option<JoinHandle<()>>> {
        std::thread::Builder::new().name(name.to_owned()).spawn(body).map(Some)
    }

    fn notify(&self, _: usize) {}

    fn wait(&self, _: usize, _: Option<Instant>) -> Option<bool> {
        None
    }

    fn has_sockets(&self) -> bool {
        true
    }

    fn open_hub(&self, net: &Net, game: &GameName, scenario: &Scenario) -> Result<Arc<dyn Session>, BusError> {
        Ok(Arc::new(ZenohSession::hub(net, game, scenario)?))
    }

    fn open_leaf(&self, net: &Net) -> Result<Arc<dyn Session>, BusError> {
        Ok(Arc::new(ZenohSession::leaf(net)?))
    }
}
