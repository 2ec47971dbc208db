//! What happens in a simulation, in the order of virtual time.

use super::scheduler::{Call, World};
use super::state::{State, Status, Thread};
use super::{Fault, Verdict};
use std::cmp::Ordering;
use std::sync::Arc;
use std::time::Duration;

/// Something that happens at its time.
#[derive(Clone, Debug)]
pub(super) enum Event {
    /// A thread that waits has waited long enough.
    Wake {
        thread: usize,
        wait: u64,
    },
    /// A node is started, for the first time or again.
    Start {
        node: usize,
    },
    Fault(Fault),
    /// The end of a fault.
    FaultEnd {
        node: usize,
        what: FaultEnd,
    },
    /// What has travelled long enough arrives at one end of a link.
    Arrive {
        link: usize,
        up: bool,
        arrival: u64,
    },
    /// An end of a link has heard nothing for the lease, if the link is still as it was then.
    LeaseOver {
        link: usize,
        at_hub: bool,
        since_ns: u64,
    },
    /// A leaf without a link tries to connect.
    Reconnect {
        session: usize,
    },
    /// A session hears what it published itself, or what was there before it asked.
    Local {
        session: usize,
        local: super::routing::Local,
    },
}

/// What has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FaultEnd {
    Cut,
    Suspension,
}

/// An event in the queue. Of several at one moment the one that was put in first comes first.
pub(super) struct Queued {
    pub(super) at_ns: u64,
    pub(super) order: u64,
    pub(super) event: Event,
}

impl PartialEq for Queued {
    fn eq(&self, other: &Queued) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Queued {}

impl PartialOrd for Queued {
    fn partial_cmp(&self, other: &Queued) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Queued {
    fn cmp(&self, other: &Queued) -> Ordering {
        // The earliest is the greatest: the queue is a max-heap.
        // The order of insertion decides among events of one moment: a heap by time alone would
        // be free to take either, and the same seed would give two traces.
        (other.at_ns, other.order).cmp(&(self.at_ns, self.order))
    }
}

impl State {
    /// Puts an event into the queue.
    pub(super) fn at(&mut self, at_ns: u64, event: Event) {
        self.order += 1;
        // A deadline that has passed already must not turn the clock back.
        self.events.push(Queued { at_ns: at_ns.max(self.now_ns), order: self.order, event });
    }

    pub(super) fn after(&mut self, wait: Duration, event: Event) {
        self.at(self.now_ns.saturating_add(nanos(wait)), event);
    }

    /// The next event happens; gives what is to be called.
    pub(super) fn step(&mut self, world: &Arc<World>) -> Vec<Call> {
        let Some(queued) = self.events.pop() else {
            self.give_up(Verdict::Deadlock(self.waiting()));
            return vec![];
        };
        if queued.at_ns > self.limit_ns {
            self.give_up(Verdict::OutOfTime(self.waiting()));
            return vec![];
        }
        self.now_ns = queued.at_ns;
        match queued.event {
            Event::Wake { thread, wait } => {
                if matches!(self.threads[thread].status, Status::Waits { wait: now, .. } if now == wait) {
                    self.threads[thread].status = Status::Ready;
                }
                vec![]
            }
            Event::Start { node } => self.start(world, node),
            Event::Fault(fault) => self.begin_fault(fault),
            Event::FaultEnd { node, what } => self.end_fault(node, what),
            Event::Arrive { link, up, arrival } => self.arrive(link, up, arrival),
            Event::LeaseOver { link, at_hub, since_ns } => self.lease_over(link, at_hub, since_ns),
            Event::Reconnect { session } => self.reconnect(session),
            Event::Local { session, local } => self.take_local(session, &local),
        }
    }

    /// Which nodes still run.
    fn waiting(&self) -> Vec<String> {
        let is_there = |thread: &&Thread| thread.status != Status::Done;
        self.threads.iter().filter(is_there).map(|thread| self.nodes[thread.node].name.clone()).collect()
    }

    /// Ends the simulation: every node is killed, and nothing happens any more.
    fn give_up(&mut self, verdict: Verdict) {
        self.verdict = verdict;
        // All nodes are killed in place of left waiting, so that their threads end and the test
        // can tell what they waited for.
        self.events.clear();
        self.starts_due = 0;
        (0..self.nodes.len()).for_each(|node| self.nodes[node].starts_again = None);
        (0..self.nodes.len()).for_each(|node| self.kill(node));
    }

    fn start(&mut self, world: &Arc<World>, node: usize) -> Vec<Call> {
        self.starts_due -= 1;
        self.note("starts", node, "", &[]);
        let started = &mut self.nodes[node];
        started.is_running = true;
        let (body, world) = (Arc::clone(&started.body), Arc::clone(world));
        vec![Box::new(move || {
            let thread = world.spawn(node, Box::new(move || body()));
            world.state.lock().nodes[node].main_thread = Some(thread);
        })]
    }
}

/// A time in ns; what is longer than five centuries is as long.
pub(super) fn nanos(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}
