//! Setting up and running a simulation.

use crate::conditions::{Conditions, Fault};
use crate::event::{Event, nanos};
use crate::runtime::SimulatedRuntime;
use crate::scheduler::World;
use crate::state::{Node, State};
use crate::verdict::{NodeEnd, Published, Verdict};
use bus::clock;
use primitives::stream::Stream;
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hasher};
use std::sync::Arc;
use std::time::Duration;

/// The result of a simulation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Run {
    /// How it ended.
    pub verdict: Verdict,
    /// The virtual time it took.
    pub time: Duration,
    /// A hash over all events: it is the same for the same seed and nodes.
    pub trace: u64,
    /// All events, one per line, if requested.
    pub lines: Vec<String>,
    /// How the nodes ended, in order.
    pub ends: Vec<NodeEnd>,
}

/// A simulated network and its nodes.
pub struct SimulatedNetwork(Arc<World>);

impl SimulatedNetwork {
    /// A network whose random choices are all derived from `seed`.
    pub fn new(seed: u64, conditions: Conditions) -> SimulatedNetwork {
        bus::replace_runtime(&SimulatedRuntime);
        let state = State {
            conditions,
            // turmoil and madsim simulate tokio, whose sockets and tasks neither our nodes nor
            // zenoh use; shuttle has no time, but our protocols rely on timeouts. Hence our own
            // network, beneath the same `Bus`.
            stream: Stream::new(seed, "network"),
            now_ns: 0,
            limit_ns: 0,
            order: 0,
            events: BTreeMap::new(),
            starts_due: 0,
            nodes: vec![],
            threads: vec![],
            ready: vec![],
            sessions: vec![],
            links: vec![],
            queries: BTreeMap::new(),
            calls: vec![],
            to_drop: vec![],
            number: 0,
            on_publish: None,
            on_take: None,
            verdict: Verdict::Ended,
            ends: vec![],
            // Use fixed keys, unlike `RandomState`: this number is compared between two runs with
            // one seed.
            hash: DefaultHasher::new(),
            lines: None,
        };
        SimulatedNetwork(World::new(clock::now(), state))
    }

    /// Adds a node that runs `body` from this time on, and again after each restart. Returns its
    /// index.
    pub fn node(&self, at: Duration, name: &str, body: impl Fn() + Send + Sync + 'static) -> usize {
        let mut state = self.0.state.lock();
        let node = state.nodes.len();
        state.nodes.push(Node {
            name: name.to_owned(),
            body: Arc::new(body),
            is_running: false,
            cuts: 0,
            suspensions: 0,
            main_thread: None,
            starts_again: None,
        });
        state.starts_due += 1;
        state.at(nanos(at), Event::Start { node });
        node
    }

    /// Schedules a fault.
    pub fn fault(&self, at: Duration, fault: Fault) {
        self.0.state.lock().at(nanos(at), Event::Fault(fault));
    }

    /// Calls `see` with every message that the hub publishes or receives. `see` must not use the
    /// network.
    pub fn on_publish(&self, see: impl FnMut(Published<'_>) + Send + 'static) {
        self.0.state.lock().on_publish = Some(Box::new(see));
    }

    /// Calls `see` with every published message that reaches a leaf, and with the name of that
    /// leaf's node. `see` must not use the network.
    pub fn on_take(&self, see: impl FnMut(Published<'_>) + Send + 'static) {
        self.0.state.lock().on_take = Some(Box::new(see));
    }

    /// Records all events as lines.
    pub fn keep_lines(&self) {
        self.0.state.lock().lines = Some(vec![]);
    }

    /// Runs until all nodes have ended or virtual time reaches `limit`.
    pub fn run(self, limit: Duration) -> Run {
        self.0.state.lock().limit_ns = nanos(limit);
        self.0.run();
        let mut state = self.0.state.lock();
        Run {
            verdict: state.verdict.clone(),
            time: Duration::from_nanos(state.now_ns),
            trace: state.hash.finish(),
            lines: state.lines.take().unwrap_or_default(),
            ends: std::mem::take(&mut state.ends),
        }
    }
}
