//! A step of a simulation: the next event.

use crate::call::Call;
use crate::event::Event;
use crate::scheduler::World;
use crate::state::{State, Status, Thread};
use crate::verdict::Verdict;
use std::sync::Arc;

impl State {
    /// Handles the next event and returns the callbacks to call.
    pub(crate) fn step(&mut self, world: &Arc<World>) -> Vec<Call> {
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

    /// The names of the nodes that still run.
    fn waiting(&self) -> Vec<String> {
        let is_there = |thread: &&Thread| thread.status != Status::Done;
        self.threads.iter().filter(is_there).map(|thread| self.nodes[thread.node].name.clone()).collect()
    }

    /// Ends the simulation: kills every node and clears all events.
    fn give_up(&mut self, verdict: Verdict) {
        self.verdict = verdict;
        // Kills all nodes instead of leaving them waiting, so that their threads end and the test
        // can report what they waited for.
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
