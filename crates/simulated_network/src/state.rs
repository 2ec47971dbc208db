//! The mutable state of a simulation.

use crate::conditions::{Conditions, Fault};
use crate::declared::{Call, Declared, PendingQuery};
use crate::event::{Event, nanos};
use crate::packet::Link;
use crate::verdict::{NodeEnd, Published, Verdict};
use primitives::stream::Stream;
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

/// A process: its code and its state.
pub(crate) struct Node {
    pub(crate) name: String,
    pub(crate) body: Arc<dyn Fn() + Send + Sync>,
    pub(crate) is_running: bool,
    /// The number of cuts and suspensions in force; they may overlap.
    pub(crate) cuts: u32,
    pub(crate) suspensions: u32,
    pub(crate) main_thread: Option<usize>,
    /// The time after which a killed node restarts.
    pub(crate) starts_again: Option<Duration>,
}

impl Node {
    pub(crate) fn is_cut(&self) -> bool {
        self.cuts > 0
    }

    pub(crate) fn is_suspended(&self) -> bool {
        self.suspensions > 0
    }
}

/// A thread of a node.
pub(crate) struct Thread {
    pub(crate) node: usize,
    pub(crate) handle: Option<JoinHandle<()>>,
    pub(crate) status: Status,
    /// Whether the thread will unwind when it continues.
    pub(crate) is_killed: bool,
    /// Number of times that the thread has waited.
    pub(crate) waits: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Status {
    /// Running or ready to run.
    Ready,
    /// Waiting for a change at this address.
    Waits {
        address: usize,
        wait: u64,
    },
    Done,
}

/// A session of a node.
pub(crate) struct SessionState {
    pub(crate) node: usize,
    pub(crate) is_open: bool,
    /// Where a hub listens, or where a leaf connects.
    pub(crate) endpoints: Vec<String>,
    /// The current link of a leaf.
    pub(crate) link: Option<usize>,
    pub(crate) is_hub: bool,
    pub(crate) declared: BTreeMap<u64, Declared>,
}

/// A callback for an observer of the network's messages.
pub(crate) type OnPublish = Box<dyn FnMut(Published<'_>) + Send>;

/// The mutable state of a simulation.
pub(crate) struct State {
    pub(crate) conditions: Conditions,
    pub(crate) stream: Stream,
    pub(crate) now_ns: u64,
    pub(crate) limit_ns: u64,
    /// The number of the last event scheduled.
    pub(crate) order: u64,
    /// Ordered by time and number: by time alone, one seed could give two different traces.
    pub(crate) events: BTreeMap<(u64, u64), Event>,
    pub(crate) starts_due: usize,
    pub(crate) nodes: Vec<Node>,
    pub(crate) threads: Vec<Thread>,
    /// Reused to save allocations.
    pub(crate) ready: Vec<usize>,
    pub(crate) sessions: Vec<SessionState>,
    pub(crate) links: Vec<Link>,
    pub(crate) queries: BTreeMap<u64, PendingQuery>,
    /// Callbacks that are due, to be called while the state is unlocked.
    pub(crate) calls: Vec<Call>,
    /// To be dropped while the state is unlocked: dropping data held by callbacks may use the
    /// network.
    pub(crate) to_drop: Vec<Declared>,
    /// The last number given to a declaration or a query.
    pub(crate) number: u64,
    pub(crate) on_publish: Option<OnPublish>,
    pub(crate) on_take: Option<OnPublish>,
    pub(crate) verdict: Verdict,
    pub(crate) ends: Vec<NodeEnd>,
    pub(crate) hash: DefaultHasher,
    /// All events, one per line, if requested.
    pub(crate) lines: Option<Vec<String>>,
}

impl State {
    pub(crate) fn is_over(&self) -> bool {
        self.starts_due == 0
            && self
                .threads
                .iter()
                .all(|thread| thread.status == Status::Done)
    }

    /// Adds an event to the trace.
    pub(crate) fn note(&mut self, what: &str, node: usize, key: &str, bytes: &[u8]) {
        // Includes the bytes, so that a divergence shows in the first message that differs, not
        // only at the end of the game.
        (self.now_ns, what, node, key, bytes).hash(&mut self.hash);
        if let Some(lines) = &mut self.lines {
            let at_s = self.now_ns as f64 * 1e-9;
            lines.push(format!(
                "{at_s:12.6} {:8} {what} {key} {}",
                self.nodes[node].name,
                bytes.len()
            ));
        }
    }

    /// Schedules an event.
    pub(crate) fn at(&mut self, at_ns: u64, event: Event) {
        self.order += 1;
        // A deadline that has already passed must not turn the clock back.
        self.events
            .insert((at_ns.max(self.now_ns), self.order), event);
    }

    pub(crate) fn after(&mut self, wait: Duration, event: Event) {
        self.at(self.now_ns.saturating_add(nanos(wait)), event);
    }

    /// A random time from zero to `most`.
    pub(crate) fn draw(&mut self, most: Duration) -> Duration {
        most.mul_f64(self.stream.unit())
    }

    /// Starts a fault.
    pub(crate) fn begin_fault(&mut self, fault: Fault) {
        match fault {
            Fault::Cut { node, time } => {
                self.note("is cut off", node, "", &[]);
                self.nodes[node].cuts += 1;
                // Random faults overlap: a node recovers when the last one ends.
                if self.nodes[node].cuts == 1 {
                    self.begin_silence(node);
                }
                self.after(time, Event::CutEnd { node });
            }
            Fault::Suspend { node, time } => {
                self.note("is suspended", node, "", &[]);
                self.nodes[node].suspensions += 1;
                if self.nodes[node].suspensions == 1 {
                    self.begin_silence(node);
                }
                self.after(time, Event::SuspensionEnd { node });
            }
            Fault::Kill { node, restart } => {
                if self.nodes[node].is_running {
                    self.note("is killed", node, "", &[]);
                    self.nodes[node].starts_again = restart;
                    self.kill(node);
                }
            }
        }
    }

    /// Ends the effects of a fault.
    pub(crate) fn recover(&mut self, node: usize) {
        self.note("recovers", node, "", &[]);
        self.end_silence(node);
    }

    /// Kills a node: its threads unwind when they continue, and its links close.
    pub(crate) fn kill(&mut self, node: usize) {
        self.nodes[node].is_running = false;
        for thread in &mut self.threads {
            if thread.node == node && thread.status != Status::Done {
                (thread.status, thread.is_killed) = (Status::Ready, true);
            }
        }
        let own = |session: &SessionState| session.node == node && session.is_open;
        let sessions: Vec<usize> = (0..self.sessions.len())
            .filter(|i| own(&self.sessions[*i]))
            .collect();
        sessions.into_iter().for_each(|session| self.close(session));
    }

    /// Records the end of a thread. A node ends with its main thread.
    pub(crate) fn thread_ended(&mut self, thread: usize, node: usize, panic: Option<String>) {
        self.threads[thread].status = Status::Done;
        if let Some(panic) = panic {
            self.verdict = Verdict::Panic(format!("{}: {panic}", self.nodes[node].name));
        }
        if self.nodes[node].main_thread != Some(thread) {
            return;
        }
        let was_killed = self.threads[thread].is_killed;
        self.note("ends", node, "", &[]);
        let at = Duration::from_nanos(self.now_ns);
        self.ends.push(NodeEnd {
            node: self.nodes[node].name.clone(),
            at,
            was_killed,
        });
        self.nodes[node].main_thread = None;
        self.kill(node);
        if let Some(wait) = self.nodes[node].starts_again.take() {
            self.starts_due += 1;
            self.after(wait, Event::Start { node });
        }
    }
}
