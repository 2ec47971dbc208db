//! What comes to the gateway loop from its other threads, and wakes it.

use super::NodeError;
use super::game_finder::FoundGame;
use crate::link::LinkEvent;
use crate::supervisor::Scope;
use bus::game_search::Joined;
use bus::{Inbox, InboxSender, Query, inbox};
use game::external::{ExternalOrder, GatewayCommand, OperatorReply};
use parking_lot::Mutex;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::SyncSender;
use std::time::Instant;

/// The most calls that wait for the loop.
const CALLS_MAX: usize = 4096;
/// The most requests of operators that wait, of those at the hub and of those at the control port.
const REQUESTS_MAX: usize = 64;

/// What wakes the loop.
pub(super) enum Call {
    Link(LinkEvent),
    /// There is a new order in `latest_order`.
    Order,
    Frame(Vec<u8>),
    /// There is an E-stop or a request, which are read before calls.
    Look,
    Release,
    Joined(Joined),
    SimGone,
    /// There is no game yet, for this reason.
    Looking(String),
    Remark(String),
}

/// A request at the control port, and where the reply to it goes.
pub(super) type PortRequest = (GatewayCommand, SyncSender<OperatorReply>);

/// Where others put their input for the loop.
#[derive(Clone)]
pub(super) struct LoopInput {
    pub(super) calls: InboxSender<Call>,
    /// The latest order, and when it came. However many come, only the latest waits.
    pub(super) latest_order: Arc<Mutex<Option<(ExternalOrder, Instant)>>>,
    stops: Arc<Stops>,
    found: Arc<Mutex<Option<Result<FoundGame, NodeError>>>>,
    queries: InboxSender<Query>,
    port_requests: InboxSender<PortRequest>,
}

/// Where the loop reads it.
pub(super) struct LoopOutput {
    pub(super) calls: Inbox<Call>,
    pub(super) latest_order: Arc<Mutex<Option<(ExternalOrder, Instant)>>>,
    pub(super) queries: Inbox<Query>,
    pub(super) port_requests: Inbox<PortRequest>,
    stops: Arc<Stops>,
    found: Arc<Mutex<Option<Result<FoundGame, NodeError>>>>,
}

/// E-stops that came and that the loop has not carried out. They wait behind nothing, and nothing can displace them.
#[derive(Default)]
struct Stops {
    boat: AtomicBool,
    fleet: AtomicBool,
}

impl Stops {
    fn of(&self, scope: Scope) -> &AtomicBool {
        match scope {
            Scope::Boat => &self.boat,
            Scope::Fleet => &self.fleet,
        }
    }
}

/// Both ends.
pub(super) fn loop_input() -> (LoopInput, LoopOutput) {
    let (calls, calls_out) = inbox(CALLS_MAX);
    let (queries, queries_out) = inbox(REQUESTS_MAX);
    let (port_requests, port_requests_out) = inbox(REQUESTS_MAX);
    let (latest_order, stops, found) = Default::default();
    let input = LoopInput { calls, latest_order, stops, found, queries, port_requests };
    let output = LoopOutput {
        calls: calls_out,
        latest_order: Arc::clone(&input.latest_order),
        queries: queries_out,
        port_requests: port_requests_out,
        stops: Arc::clone(&input.stops),
        found: Arc::clone(&input.found),
    };
    (input, output)
}

impl LoopInput {
    /// An E-stop.
    pub(super) fn stop(&self, scope: Scope) {
        // Of many only the first wakes the loop: they cannot fill the inbox.
        if !self.stops.of(scope).swap(true, Ordering::SeqCst) {
            self.wake();
        }
    }

    /// Whether an E-stop waits to be carried out.
    pub(super) fn has_stop(&self) -> bool {
        [Scope::Boat, Scope::Fleet].iter().any(|scope| self.stops.of(*scope).load(Ordering::SeqCst))
    }

    /// The game, or why there is none. It cannot be displaced either.
    pub(super) fn found(&self, found: Result<FoundGame, NodeError>) {
        *self.found.lock() = Some(found);
        self.wake();
    }

    /// A query of an operator.
    pub(super) fn query(&self, query: Query) {
        self.queries.put(query);
        self.wake();
    }

    /// A request at the control port.
    pub(super) fn request(&self, request: PortRequest) {
        self.port_requests.put(request);
        self.wake();
    }

    /// A full inbox need not take this: then the loop has calls to read, and looks at the rest before each of them.
    fn wake(&self) {
        self.calls.put(Call::Look);
    }
}

impl LoopOutput {
    /// Takes the game that was found, once.
    pub(super) fn take_found(&self) -> Option<Result<FoundGame, NodeError>> {
        self.found.lock().take()
    }

    /// Takes the E-stop that is to be carried out, if there is one.
    pub(super) fn take_stop(&self, scope: Scope) -> bool {
        self.stops.of(scope).swap(false, Ordering::SeqCst)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn a_full_inbox_takes_stops_all_the_same_and_stops_do_not_fill_it() {
        let (input, output) = loop_input();
        (0..2 * CALLS_MAX).for_each(|_| input.stop(Scope::Fleet));
        assert!(matches!(output.calls.take(Duration::ZERO), Some(Call::Look)) && output.calls.take_now().is_none());
        assert!(output.take_stop(Scope::Fleet) && !output.take_stop(Scope::Fleet));
        (0..2 * CALLS_MAX).for_each(|_| input.calls.put(Call::Release));
        assert!(!input.has_stop());
        input.stop(Scope::Boat);
        assert!(input.has_stop() && output.take_stop(Scope::Boat) && !output.take_stop(Scope::Fleet));
        assert!(output.calls.take_now().is_some(), "the loop is awake");
    }
}
