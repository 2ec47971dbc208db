//! Chooses the thread that runs: exactly one at a time. A thread yields when it waits; when all are
//! waiting, the next event happens.

use crate::event::{Event, nanos};
use crate::state::{Node, State, Status, Thread};
use crate::verdict::Verdict;
use parking_lot::Mutex;
use std::any::Any;
use std::cell::{Cell, RefCell};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// The number of the thread that runs the whole simulation; it only waits for the end.
const MAIN: usize = usize::MAX;

thread_local! {
    /// The simulation and node of this thread, if any.
    static CURRENT: RefCell<Option<Current>> = const { RefCell::new(None) };
    /// Whether this thread is in a callback of an event.
    static IN_CALLBACK: Cell<bool> = const { Cell::new(false) };
}

/// A thread of a node in a simulation.
#[derive(Clone)]
pub(crate) struct Current {
    pub(crate) world: Arc<World>,
    pub(crate) node: usize,
    thread: usize,
}

/// The panic payload that unwinds the threads of a killed node.
struct Killed;

/// One simulation.
pub(crate) struct World {
    start: Instant,
    /// Virtual time, ns; changed only while the state is locked.
    now_ns: AtomicU64,
    running: AtomicUsize,
    pub(crate) state: Mutex<State>,
    main: thread::Thread,
}

/// The simulation of this thread.
pub(crate) fn current() -> Option<Current> {
    CURRENT.with_borrow(Clone::clone)
}

/// Whether this thread belongs to a simulation.
pub(crate) fn is_inside() -> bool {
    CURRENT.with_borrow(Option::is_some)
}

/// Whether this thread is in a callback of an event, where it must not wait.
pub(crate) fn is_in_callback() -> bool {
    IN_CALLBACK.get()
}

/// The current virtual time, inside a simulation.
pub(crate) fn now() -> Option<Instant> {
    CURRENT.with_borrow(|current| current.as_ref().map(|current| current.world.now()))
}

/// A random number derived from the seed, inside a simulation.
pub(crate) fn random_number() -> Option<u64> {
    CURRENT.with_borrow(|current| {
        current
            .as_ref()
            .map(|current| current.world.state.lock().stream.bits())
    })
}

/// Wakes the threads that wait for a change at this address.
pub(crate) fn wake(address: usize) {
    CURRENT.with_borrow(|current| {
        if let Some(current) = current {
            current.world.state.lock().wake(address);
        }
    });
}

/// Waits until something at this address changes, or until `deadline` (`None`: no limit). Returns
/// whether time is left. Does not wait in an unwinding thread.
pub(crate) fn wait_until(address: usize, deadline: Option<Instant>) -> bool {
    let Some(current) = current() else {
        return false;
    };
    let world = &current.world;
    if thread::panicking() {
        return false;
    }
    // In zenoh, a waiting callback blocks all links. Here it panics, so that every test detects the
    // mistake.
    assert!(!is_in_callback(), "callbacks must not wait");
    let deadline_ns = deadline.map(|deadline| world.ns_at(deadline));
    world
        .state
        .lock()
        .block(current.thread, address, deadline_ns);
    world.pass_on(current.thread);
    if world.state.lock().threads[current.thread].is_killed {
        // A killed node unwinds, which releases its locks and sockets. `panic` would print a report
        // for each node; `resume_unwind` does not.
        resume_unwind(Box::new(Killed));
    }
    deadline.is_none_or(|deadline| world.now() < deadline)
}

impl World {
    pub(crate) fn new(start: Instant, state: State) -> Arc<World> {
        let now_ns = AtomicU64::new(0);
        let running = AtomicUsize::new(MAIN);
        let state = Mutex::new(state);
        Arc::new(World {
            start,
            now_ns,
            running,
            state,
            main: thread::current(),
        })
    }

    pub(crate) fn now(&self) -> Instant {
        self.start + Duration::from_nanos(self.now_ns.load(Ordering::Relaxed))
    }

    /// Reads or changes the state, then makes the calls that this causes.
    pub(crate) fn visit<R>(&self, visit: impl FnOnce(&mut State) -> R) -> R {
        let mut state = self.state.lock();
        let result = visit(&mut state);
        let calls = std::mem::take(&mut state.calls);
        drop(state);
        calls.into_iter().for_each(|call| call());
        result
    }

    fn ns_at(&self, moment: Instant) -> u64 {
        nanos(moment.saturating_duration_since(self.start))
    }

    /// Adds a thread to a node; it runs when scheduled.
    pub(crate) fn spawn(self: &Arc<World>, node: usize, body: Box<dyn FnOnce() + Send>) -> usize {
        let mut state = self.state.lock();
        let thread = state.threads.len();
        let current = Current {
            world: Arc::clone(self),
            node,
            thread,
        };
        let handle = thread::spawn(move || current.run(body));
        state.threads.push(Thread {
            node,
            handle: Some(handle),
            status: Status::Ready,
            is_killed: false,
            waits: 0,
        });
        thread
    }

    /// Lets other threads run until this one is scheduled again.
    fn pass_on(self: &Arc<World>, me: usize) {
        let next = self.next();
        if next == me {
            return;
        }
        self.hand_to(next);
        self.await_turn(me);
    }

    fn hand_to(&self, next: usize) {
        let handle = match next {
            MAIN => self.main.clone(),
            next => {
                let state = self.state.lock();
                let handle = state.threads[next].handle.as_ref();
                handle
                    .expect("a thread that runs has not been joined")
                    .thread()
                    .clone()
            }
        };
        self.running.store(next, Ordering::Release);
        handle.unpark();
    }

    fn await_turn(&self, me: usize) {
        while self.running.load(Ordering::Acquire) != me {
            // Loop, because `park` may return spuriously.
            thread::park();
        }
    }

    /// Handles events until a thread is ready, and returns that thread.
    fn next(self: &Arc<World>) -> usize {
        loop {
            let mut state = self.state.lock();
            if let Some(thread) = state.draw_ready() {
                return thread;
            }
            if state.is_over() {
                return MAIN;
            }
            state.step(self);
            self.now_ns.store(state.now_ns, Ordering::Relaxed);
            let calls = std::mem::take(&mut state.calls);
            let to_drop = std::mem::take(&mut state.to_drop);
            drop(state);
            // Dropping these declarations may send a message, which would deadlock while the state
            // is locked.
            drop(to_drop);
            IN_CALLBACK.set(true);
            calls.into_iter().for_each(|call| call());
            IN_CALLBACK.set(false);
        }
    }

    /// Runs until no thread is left.
    pub(crate) fn run(self: &Arc<World>) {
        self.pass_on(MAIN);
        let handles: Vec<_> = self
            .state
            .lock()
            .threads
            .iter_mut()
            .filter_map(|thread| thread.handle.take())
            .collect();
        for handle in handles {
            handle.join().unwrap_or_default();
        }
        let to_drop = std::mem::take(&mut self.state.lock().to_drop);
        drop(to_drop);
    }
}

impl Current {
    /// Runs a thread of a node from start to end.
    fn run(self, body: Box<dyn FnOnce() + Send>) {
        let world = Arc::clone(&self.world);
        let node = self.node;
        let thread = self.thread;
        CURRENT.set(Some(self));
        world.await_turn(thread);
        let is_killed = world.state.lock().threads[thread].is_killed;
        let ended = if is_killed {
            Ok(())
        } else {
            catch_unwind(AssertUnwindSafe(body))
        };
        let panic = ended
            .err()
            .filter(|payload| !payload.is::<Killed>())
            .map(|payload| text_of(&*payload));
        world.state.lock().thread_ended(thread, node, panic);
        let next = world.next();
        CURRENT.set(None);
        world.hand_to(next);
    }
}

fn text_of(payload: &(dyn Any + Send)) -> String {
    let text = payload
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned());
    text.or_else(|| payload.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "it panicked".to_owned())
}

impl State {
    /// Handles the next event.
    pub(crate) fn step(&mut self, world: &Arc<World>) {
        let Some(((at_ns, _), event)) = self.events.pop_first() else {
            return self.give_up(Verdict::Deadlock(self.waiting()));
        };
        if at_ns > self.limit_ns {
            return self.give_up(Verdict::OutOfTime(self.waiting()));
        }
        self.now_ns = at_ns;
        match event {
            Event::Wake { thread, wait } => {
                if matches!(self.threads[thread].status, Status::Waits { wait: now, .. } if now == wait)
                {
                    self.threads[thread].status = Status::Ready;
                }
            }
            Event::Start { node } => self.start(world, node),
            Event::Fault(fault) => self.begin_fault(fault),
            Event::CutEnd { node } => {
                self.nodes[node].cuts -= 1;
                self.recover(node);
            }
            Event::SuspensionEnd { node } => {
                self.nodes[node].suspensions -= 1;
                self.recover(node);
            }
            Event::Arrive { link, up, arrival } => self.arrive(link, up, arrival),
            Event::LeaseOver {
                link,
                at_hub,
                since_ns,
            } => self.lease_over(link, at_hub, since_ns),
            Event::Reconnect { session } => self.reconnect(session),
            Event::Local { session, local } => self.take_local(session, &local),
        }
    }

    /// The names of the nodes that are still running.
    fn waiting(&self) -> Vec<String> {
        let is_there = |thread: &&Thread| thread.status != Status::Done;
        self.threads
            .iter()
            .filter(is_there)
            .map(|thread| self.nodes[thread.node].name.clone())
            .collect()
    }

    /// Ends the simulation: kills every node and clears all events.
    fn give_up(&mut self, verdict: Verdict) {
        self.verdict = verdict;
        // Kill all nodes instead of leaving them waiting, so that their threads end and the test
        // can report what they were waiting for.
        self.events.clear();
        self.starts_due = 0;
        (0..self.nodes.len()).for_each(|node| self.nodes[node].starts_again = None);
        (0..self.nodes.len()).for_each(|node| self.kill(node));
    }

    fn start(&mut self, world: &Arc<World>, node: usize) {
        self.starts_due -= 1;
        self.note("starts", node, "", &[]);
        let started = &mut self.nodes[node];
        started.is_running = true;
        let body = Arc::clone(&started.body);
        let world = Arc::clone(world);
        self.calls.push(Box::new(move || {
            let thread = world.spawn(node, Box::new(move || body()));
            world.state.lock().nodes[node].main_thread = Some(thread);
        }));
    }

    /// Draws the next thread from the ready ones.
    fn draw_ready(&mut self) -> Option<usize> {
        let is_ready = |thread: &Thread, nodes: &[Node]| {
            thread.status == Status::Ready
                && (thread.is_killed || !nodes[thread.node].is_suspended())
        };
        let nodes = &self.nodes;
        let mut ready = std::mem::take(&mut self.ready);
        ready.clear();
        ready.extend((0..self.threads.len()).filter(|i| is_ready(&self.threads[*i], nodes)));
        let drawn = match ready.as_slice() {
            [] => None,
            [one] => Some(*one),
            // The choice is random: a real system does not guarantee any order either, and a
            // different seed exposes a game that depends on one.
            several => Some(several[self.stream.below(several.len() as u64) as usize]),
        };
        self.ready = ready;
        drawn
    }

    fn wake(&mut self, address: usize) {
        for thread in &mut self.threads {
            if matches!(thread.status, Status::Waits { address: at, .. } if at == address) {
                thread.status = Status::Ready;
            }
        }
    }

    fn block(&mut self, thread: usize, address: usize, deadline_ns: Option<u64>) {
        let waits = &mut self.threads[thread].waits;
        *waits += 1;
        let wait = *waits;
        self.threads[thread].status = Status::Waits { address, wait };
        if let Some(at_ns) = deadline_ns {
            self.at(at_ns, Event::Wake { thread, wait });
        }
    }
}
