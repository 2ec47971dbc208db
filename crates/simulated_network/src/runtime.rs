//! The runtime of nodes in a simulation. Threads outside a simulation use the system.

use crate::scheduler::{self, current};
use crate::session::SimulatedSession;
use bus::{BusError, Net, Runtime, Session, System};
use messages::topic::GameName;
use scenario::Scenario;
use std::io;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The runtime of a process with simulated networks.
pub(crate) struct SimulatedRuntime;

impl Runtime for SimulatedRuntime {
    fn now(&self) -> Instant {
        scheduler::now().unwrap_or_else(|| System.now())
    }

    fn suspended(&self) -> Duration {
        if scheduler::is_inside() {
            Duration::ZERO
        } else {
            System.suspended()
        }
    }

    fn sleep(&self, time: Duration) {
        if scheduler::is_inside() {
            scheduler::wait_until(0, self.now().checked_add(time));
        } else {
            System.sleep(time);
        }
    }

    fn fill_random(&self, bytes: &mut [u8]) {
        if !scheduler::is_inside() {
            return System.fill_random(bytes);
        }
        // The bytes are derived from the seed; otherwise no game could be repeated.
        for part in bytes.chunks_mut(8) {
            let drawn = scheduler::random_number().unwrap_or_default().to_le_bytes();
            part.copy_from_slice(&drawn[..part.len()]);
        }
    }

    fn spawn(
        &self,
        name: &str,
        body: Box<dyn FnOnce() + Send>,
    ) -> io::Result<Option<JoinHandle<()>>> {
        let Some(current) = current() else {
            return System.spawn(name, body);
        };
        current.world.spawn(current.node, body);
        Ok(None)
    }

    fn notify(&self, address: usize) {
        scheduler::wake(address);
    }

    fn wait(&self, address: usize, deadline: Option<Instant>) -> Option<bool> {
        // A condition variable would block the only thread that may run.
        scheduler::is_inside().then(|| scheduler::wait_until(address, deadline))
    }

    fn has_sockets(&self) -> bool {
        !scheduler::is_inside()
    }

    fn open_hub(
        &self,
        net: &Net,
        game: &GameName,
        scenario: &Scenario,
    ) -> Result<Arc<dyn Session>, BusError> {
        if !scheduler::is_inside() {
            return System.open_hub(net, game, scenario);
        }
        let refused = |reason| BusError::Open {
            what: format!("listen on {}", net.listen.join(", ")),
            reason,
        };
        Ok(Arc::new(SimulatedSession::hub(net).map_err(refused)?))
    }

    fn open_leaf(&self, net: &Net) -> Result<Arc<dyn Session>, BusError> {
        if !scheduler::is_inside() {
            return System.open_leaf(net);
        }
        let refused = |reason| BusError::Open {
            what: format!("connect to {}", net.connect.join(", ")),
            reason,
        };
        Ok(Arc::new(SimulatedSession::leaf(net).map_err(refused)?))
    }
}
