//! Everything that changes in a simulation.

use super::call::Call;
use super::conditions::Conditions;
use super::declared::Declared;
use super::event::{Event, Queued, nanos};
use super::fault::{Fault, FaultEnd};
use super::link_state::Link;
use super::published::Published;
use super::query::PendingQuery;
use super::verdict::{NodeEnd, Verdict};
use primitives::stream::Stream;
use std::collections::{BTreeMap, BinaryHeap};
use std::hash::{DefaultHasher, Hash};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

/// A process: what it does, and how it is.
pub(super) struct Node {
    pub(super) name: String,
    pub(super) body: Arc<dyn Fn() + Send + Sync>,
    pub(super) is_running: bool,
    pub(super) is_suspended: bool,
    pub(super) is_cut: bool,
    /// How many cuts and suspensions are in force: they may overlap.
    pub(super) cuts: u32,
    pub(super) suspensions: u32,
    pub(super) main_thread: Option<usize>,
    /// A node that was killed starts again after this.
    pub(super) starts_again: Option<Duration>,
}

/// A thread of a node.
pub(super) struct Thread {
    pub(super) node: usize,
    pub(super) handle: Option<JoinHandle<()>>,
    pub(super) status: Status,
    /// Unwinds as soon as it goes on.
    pub(super) is_killed: bool,
    /// How often it has waited.
    pub(super) waits: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Status {
    /// It can go on, or does.
    Ready,
    /// It waits for a change at this address.
    Waits {
        address: usize,
        wait: u64,
    },
    Done,
}

/// A session of a node.
pub(super) struct SessionState {
    pub(super) node: usize,
    pub(super) is_open: bool,
    /// Where a hub listens; where a leaf connects.
    pub(super) endpoints: Vec<String>,
    /// The link of a leaf, while it has one.
    pub(super) link: Option<usize>,
    pub(super) is_hub: bool,
    pub(super) declared: BTreeMap<u64, Declared>,
}

/// What an observer of the wire is told.
pub(super) type OnPublish = Box<dyn FnMut(Published<'_>) + Send>;

/// Everything that changes in a simulation.
pub(super) struct State {
    pub(super) conditions: Conditions,
    pub(super) stream: Stream,
    pub(super) now_ns: u64,
    pub(super) limit_ns: u64,
    pub(super) order: u64,
    pub(super) events: BinaryHeap<Queued>,
    pub(super) starts_due: usize,
    pub(super) nodes: Vec<Node>,
    pub(super) threads: Vec<Thread>,
    /// Kept to save allocations.
    pub(super) ready: Vec<usize>,
    pub(super) sessions: Vec<SessionState>,
    pub(super) links: Vec<Link>,
    pub(super) queries: BTreeMap<u64, PendingQuery>,
    /// To be dropped when the state is not locked: what callbacks hold may use the network when it goes.
    pub(super) to_drop: Vec<Declared>,
    /// The last number that was given to a declaration or a query.
    pub(super) number: u64,
    pub(super) on_publish: Option<OnPublish>,
    pub(super) on_take: Option<OnPublish>,
    pub(super) verdict: Verdict,
    pub(super) ends: Vec<NodeEnd>,
    pub(super) hash: DefaultHasher,
    /// What happened, line by line, where that is wanted.
    pub(super) lines: Option<Vec<String>>,
}

impl State {
    pub(super) fn is_over(&self) -> bool {
        self.starts_due == 0 && self.threads.iter().all(|thread| thread.status == Status::Done)
    }

    /// Takes something down in the trace.
    pub(super) fn note(&mut self, what: &str, node: usize, key: &str, bytes: &[u8]) {
        // The bytes too: a game that took another course shows in the first message that
        // differs, not only at its end.
        (self.now_ns, what, node, key, bytes).hash(&mut self.hash);
        if let Some(lines) = &mut self.lines {
            let at_s = self.now_ns as f64 * 1e-9;
            lines.push(format!("{at_s:12.6} {:8} {what} {key} {}", self.nodes[node].name, bytes.len()));
        }
    }

    /// Puts an event into the queue.
    pub(super) fn at(&mut self, at_ns: u64, event: Event) {
        self.order += 1;
        // A deadline that has passed already must not turn the clock back.
        self.events.push(Queued { at_ns: at_ns.max(self.now_ns), order: self.order, event });
    }

    pub(super) fn after(&mut self, wait: Duration, event: Event) {
        self.at(self.now_ns.saturating_add(nanos(wait)), event);
    }

    /// A time between nothing and `most`.
    pub(super) fn draw(&mut self, most: Duration) -> Duration {
        most.mul_f64(self.stream.unit())
    }

    /// A fault begins.
    pub(super) fn begin_fault(&mut self, fault: Fault) -> Vec<Call> {
        match fault {
            Fault::Cut { node, time } => {
                self.note("is cut off", node, "", &[]);
                self.nodes[node].cuts += 1;
                // Drawn faults overlap: a node is well again when the last one is over.
                if self.nodes[node].cuts == 1 {
                    self.nodes[node].is_cut = true;
                    self.begin_silence(node);
                }
                self.after(time, Event::FaultEnd { node, what: FaultEnd::Cut });
            }
            Fault::Suspend { node, time } => {
                self.note("is suspended", node, "", &[]);
                self.nodes[node].suspensions += 1;
                if self.nodes[node].suspensions == 1 {
                    self.nodes[node].is_suspended = true;
                    self.begin_silence(node);
                }
                self.after(time, Event::FaultEnd { node, what: FaultEnd::Suspension });
            }
            Fault::Kill { node, restart } => {
                if self.nodes[node].is_running {
                    self.note("is killed", node, "", &[]);
                    self.nodes[node].starts_again = restart;
                    self.kill(node);
                }
            }
        }
        vec![]
    }

    /// A fault ends.
    pub(super) fn end_fault(&mut self, node: usize, what: FaultEnd) -> Vec<Call> {
        let node_state = &mut self.nodes[node];
        match what {
            FaultEnd::Cut => node_state.cuts -= 1,
            FaultEnd::Suspension => node_state.suspensions -= 1,
        }
        (node_state.is_cut, node_state.is_suspended) = (node_state.cuts > 0, node_state.suspensions > 0);
        self.note("is well again", node, "", &[]);
        self.end_silence(node);
        vec![]
    }

    /// Kills a node: its threads unwind as soon as they go on, its links close.
    pub(super) fn kill(&mut self, node: usize) {
        self.nodes[node].is_running = false;
        for thread in &mut self.threads {
            if thread.node == node && thread.status != Status::Done {
                (thread.status, thread.is_killed) = (Status::Ready, true);
            }
        }
        let own = |session: &SessionState| session.node == node && session.is_open;
        let sessions: Vec<usize> = (0..self.sessions.len()).filter(|i| own(&self.sessions[*i])).collect();
        sessions.into_iter().for_each(|session| self.close(session));
    }

    /// A thread has come to its end; with that of its first thread the node does.
    pub(super) fn thread_ended(&mut self, thread: usize, node: usize, panic: Option<String>) {
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
        self.ends.push(NodeEnd { node: self.nodes[node].name.clone(), at, was_killed });
        self.nodes[node].main_thread = None;
        self.kill(node);
        if let Some(wait) = self.nodes[node].starts_again.take() {
            self.starts_due += 1;
            self.after(wait, Event::Start { node });
        }
    }
}
