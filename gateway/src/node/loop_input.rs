//! What comes to the gateway loop from its other threads, and wakes it.

use super::error::NodeError;
use super::found_game::FoundGame;
use crate::link::LinkEvent;
use crate::supervisor::Scope;
use bus::game_search::Joined;
use bus::{Inbox, InboxSender, Query, Watched, inbox};
use messages::external::{ExternalOrder, GatewayCommand, OperatorCommand, OperatorReply};
use parking_lot::Mutex;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::SyncSender;
use std::time::{Duration, Instant};

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

/// What stops the boat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    EStop(Scope),
    Disarm,
}

impl Stop {
    /// The stop that a command to this boat is, if it is one.
    pub(super) fn of(command: &OperatorCommand) -> Option<Stop> {
        match command {
            OperatorCommand::EStop => Some(Stop::EStop(Scope::Boat)),
            OperatorCommand::Disarm => Some(Stop::Disarm),
            _ => None,
        }
    }
}

/// Stops that came and that the loop has not carried out. They wait behind nothing, and nothing can displace them.
#[derive(Default)]
struct Stops {
    // Flags and no queue: no flood fills them.
    boat: AtomicBool,
    fleet: AtomicBool,
    disarm: AtomicBool,
    /// How many have come.
    count: AtomicU64,
    /// The boat's state, and how many stops had been carried out then.
    state: Watched<(u64, String)>,
}

impl Stops {
    fn of(&self, stop: Stop) -> &AtomicBool {
        match stop {
            Stop::EStop(Scope::Boat) => &self.boat,
            Stop::EStop(Scope::Fleet) => &self.fleet,
            Stop::Disarm => &self.disarm,
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
    /// A stop. Gives the count of those that have come.
    pub(super) fn stop(&self, stop: Stop) -> u64 {
        // Sequentially consistent, as everything about stops: the flag is seen wherever the
        // count is.
        let is_first = !self.stops.of(stop).swap(true, Ordering::SeqCst);
        // It is counted once it can be seen.
        let count = self.stops.count.fetch_add(1, Ordering::SeqCst) + 1;
        // Of many only the first wakes the loop: they cannot fill the inbox.
        if is_first {
            self.wake();
        }
        count
    }

    /// Whether an E-stop waits to be carried out.
    pub(super) fn has_e_stop(&self) -> bool {
        [Scope::Boat, Scope::Fleet].iter().any(|scope| self.stops.of(Stop::EStop(*scope)).load(Ordering::SeqCst))
    }

    /// The boat's state after so many stops; none if the loop does not come to them within `limit`.
    pub(super) fn state_after(&self, count: u64, limit: Duration) -> Option<String> {
        self.stops.state.wait(limit, |(carried_out, _)| *carried_out >= count);
        self.stops.state.visit(|(carried_out, state)| (*carried_out >= count).then(|| state.clone()))
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

    /// Takes the stop that is to be carried out, if there is one.
    pub(super) fn take_stop(&self, stop: Stop) -> bool {
        self.stops.of(stop).swap(false, Ordering::SeqCst)
    }

    /// How many stops have come.
    pub(super) fn stop_count(&self) -> u64 {
        self.stops.count.load(Ordering::SeqCst)
    }

    /// The boat is in this state, and so many stops were carried out before.
    pub(super) fn show_state(&self, stop_count: u64, state: String) {
        self.stops.state.visit(|shown| *shown = (stop_count, state));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn a_full_inbox_takes_stops_all_the_same_and_stops_do_not_fill_it() {
        let (input, output) = loop_input();
        let [boat, fleet] = [Scope::Boat, Scope::Fleet].map(Stop::EStop);
        (0..2 * CALLS_MAX).for_each(|_| assert!(input.stop(fleet) > 0));
        assert!(matches!(output.calls.take(Duration::ZERO), Some(Call::Look)) && output.calls.take_now().is_none());
        assert!(output.take_stop(fleet) && !output.take_stop(fleet));
        (0..2 * CALLS_MAX).for_each(|_| input.calls.put(Call::Release));
        assert!(!input.has_e_stop());
        input.stop(boat);
        assert!(input.has_e_stop() && output.take_stop(boat) && !output.take_stop(fleet));
        input.stop(Stop::Disarm);
        assert!(output.take_stop(Stop::Disarm) && !output.take_stop(Stop::Disarm));
        assert!(output.calls.take_now().is_some(), "the loop is awake");
    }

    #[test]
    fn the_state_is_that_after_the_stop() {
        let (input, output) = loop_input();
        output.show_state(output.stop_count(), "armed".to_owned());
        assert_eq!(input.state_after(0, Duration::ZERO).as_deref(), Some("armed"));
        let count = input.stop(Stop::Disarm);
        assert_eq!(input.state_after(count, Duration::from_millis(1)), None);
        output.show_state(output.stop_count(), "safed".to_owned());
        assert_eq!(input.state_after(count, Duration::ZERO).as_deref(), Some("safed"));
    }
}
