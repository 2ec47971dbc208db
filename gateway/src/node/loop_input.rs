//! Inputs from other threads that wake the gateway loop.

use super::error::NodeError;
use super::game_finder::FoundGame;
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

/// Maximum number of calls queued for the loop.
const CALLS_MAX: usize = 4096;
/// Maximum length of each queue of operator requests: one for the hub, one for the control port.
const REQUESTS_MAX: usize = 64;

/// An event that wakes the loop.
pub(super) enum Call {
    Link(LinkEvent),
    /// `latest_order` holds a new order.
    Order,
    /// A stop or a request is waiting; the loop reads these before calls.
    Look,
    Release,
    Joined(Joined),
    /// The game has ended.
    Over,
    SimGone,
    /// No game has been found yet, for this reason.
    Looking(String),
    Remark(String),
}

/// A request at the control port, and the channel for its reply.
pub(super) type PortRequest = (GatewayCommand, SyncSender<OperatorReply>);

/// The sending end, used by other threads.
#[derive(Clone)]
pub(super) struct LoopInput {
    pub(super) calls: InboxSender<Call>,
    /// The latest order and its arrival time. Each new order replaces the previous one.
    pub(super) latest_order: Arc<Mutex<Option<(ExternalOrder, Instant)>>>,
    stops: Arc<Stops>,
    found: Arc<Mutex<Option<Result<FoundGame, NodeError>>>>,
    queries: InboxSender<Query>,
    port_requests: InboxSender<PortRequest>,
}

/// The receiving end, used by the loop.
pub(super) struct LoopOutput {
    pub(super) calls: Inbox<Call>,
    pub(super) queries: Inbox<Query>,
    pub(super) port_requests: Inbox<PortRequest>,
    /// The sending end.
    pub(super) back: LoopInput,
}

/// The kinds of stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    EStop(Scope),
    Disarm,
}

impl Stop {
    /// The stop requested by a command to this boat, if any.
    pub(super) fn of(command: &OperatorCommand) -> Option<Stop> {
        match command {
            OperatorCommand::EStop => Some(Stop::EStop(Scope::Boat)),
            OperatorCommand::Disarm => Some(Stop::Disarm),
            _ => None,
        }
    }
}

/// Stops received but not yet executed. Nothing is queued ahead of them or can displace them.
#[derive(Default)]
struct Stops {
    // Flags rather than a queue, which could be flooded.
    boat: AtomicBool,
    fleet: AtomicBool,
    disarm: AtomicBool,
    /// The number of stops received.
    count: AtomicU64,
    /// The boat's state, and the number of stops executed before it.
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

/// Creates both ends.
pub(super) fn loop_input() -> (LoopInput, LoopOutput) {
    let (calls, calls_out) = inbox(CALLS_MAX);
    let (queries, queries_out) = inbox(REQUESTS_MAX);
    let (port_requests, port_requests_out) = inbox(REQUESTS_MAX);
    let (latest_order, stops, found) = Default::default();
    let input = LoopInput {
        calls,
        latest_order,
        stops,
        found,
        queries,
        port_requests,
    };
    let back = input.clone();
    (
        input,
        LoopOutput {
            calls: calls_out,
            queries: queries_out,
            port_requests: port_requests_out,
            back,
        },
    )
}

impl LoopInput {
    /// Adds a stop. Returns the number of stops received.
    pub(super) fn stop(&self, stop: Stop) -> u64 {
        // Sequentially consistent, like all accesses to stops: a thread that sees the count also
        // sees the flag.
        let is_first = !self.stops.of(stop).swap(true, Ordering::SeqCst);
        // Count the stop once it is visible.
        let count = self.stops.count.fetch_add(1, Ordering::SeqCst) + 1;
        // Only the first of several pending stops wakes the loop, so stops cannot fill the inbox.
        if is_first {
            self.wake();
        }
        count
    }

    /// Whether an E-stop is waiting.
    pub(super) fn has_e_stop(&self) -> bool {
        [Scope::Boat, Scope::Fleet]
            .iter()
            .any(|scope| self.stops.of(Stop::EStop(*scope)).load(Ordering::SeqCst))
    }

    /// The boat's state after this many stops; `None` if the loop does not execute them within
    /// `limit`.
    pub(super) fn state_after(&self, count: u64, limit: Duration) -> Option<String> {
        self.stops
            .state
            .wait(limit, |(carried_out, _)| *carried_out >= count);
        self.stops
            .state
            .visit(|(carried_out, state)| (*carried_out >= count).then(|| state.clone()))
    }

    /// Sets the game, or the reason why none was found. Like a stop, it cannot be displaced.
    pub(super) fn found(&self, found: Result<FoundGame, NodeError>) {
        *self.found.lock() = Some(found);
        self.wake();
    }

    /// Adds an operator's query.
    pub(super) fn query(&self, query: Query) {
        self.queries.put(query);
        self.wake();
    }

    /// Adds a request from the control port.
    pub(super) fn request(&self, request: PortRequest) {
        self.port_requests.put(request);
        self.wake();
    }

    /// Wakes the loop. If the inbox is full, the call may be dropped: the loop then has calls to
    /// read anyway, and checks everything else before each of them.
    fn wake(&self) {
        self.calls.put(Call::Look);
    }
}

impl LoopOutput {
    /// Takes the result of the search for the game; later calls return `None`.
    pub(super) fn take_found(&self) -> Option<Result<FoundGame, NodeError>> {
        self.back.found.lock().take()
    }

    /// Takes a stop of this kind. Returns whether one was waiting.
    pub(super) fn take_stop(&self, stop: Stop) -> bool {
        self.back.stops.of(stop).swap(false, Ordering::SeqCst)
    }

    /// The number of stops received.
    pub(super) fn stop_count(&self) -> u64 {
        self.back.stops.count.load(Ordering::SeqCst)
    }

    /// Publishes the boat's state, and the number of stops executed before it.
    pub(super) fn show_state(&self, stop_count: u64, state: String) {
        self.back
            .stops
            .state
            .visit(|shown| *shown = (stop_count, state));
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
        assert!(
            matches!(output.calls.take(Duration::ZERO), Some(Call::Look))
                && output.calls.take_now().is_none()
        );
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
        assert_eq!(
            input.state_after(0, Duration::ZERO).as_deref(),
            Some("armed")
        );
        let count = input.stop(Stop::Disarm);
        assert_eq!(input.state_after(count, Duration::from_millis(1)), None);
        output.show_state(output.stop_count(), "disarmed".to_owned());
        assert_eq!(
            input.state_after(count, Duration::ZERO).as_deref(),
            Some("disarmed")
        );
    }
}
