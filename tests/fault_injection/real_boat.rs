//! The real boat of a game, in a node of its own, and the wire between it and its gateway. An oracle judges every sentence on the
//! wire, and panics where one must not be sent.

use crate::boat::{Boat, STEP_S, emulated};
use crate::oracle::Oracle;
use bus::{Watched, clock};
use gateway::emulator::{self, Emulator, Port};
use parking_lot::Mutex;
use primitives::SimTime;
use primitives::frame::{LatLon, Ned};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How often the boat moves on.
const MOVES: Duration = Duration::from_millis(50);
/// Telemetry is sent at every second move.
const TELEMETRY: u64 = 2;
/// After this long without a command the boat stops by itself, s.
const WATCHDOG_S: f64 = 2.0;
/// Magnetic declination of its waters, east positive, rad.
pub(crate) const DECLINATION_RAD: f64 = -0.218;
/// What the gateway does not read is lost beyond this.
const UNREAD_MAX: usize = 1 << 16;
/// What may wait for the gateway's loop is that much older than the oracle knows, s; more is not used.
pub(crate) const WAITED_S: f64 = 0.55;

/// The wire between a boat and its gateway.
pub(crate) struct Wire {
    state: Watched<State>,
    /// The newest order that has reached the gateway: when it was made, and when it came.
    order: Mutex<(SimTime, SimTime)>,
    /// Whether damage on the way may give an order another time.
    is_forged: bool,
}

/// What is on it, and what the oracle knows.
pub(crate) struct State {
    start: Option<Instant>,
    /// Counts the links that gateways have opened over it: only the newest is served.
    pub(crate) links: u64,
    pub(crate) is_connected: bool,
    pub(crate) is_whole: bool,
    to_boat: Vec<u8>,
    pub(crate) from_boat: Vec<u8>,
    pub(crate) oracle: Oracle,
    /// How often somebody has asked the gateway to arm and it may still do so.
    pub(crate) arms_left: u32,
    is_armed: bool,
    /// From when on no sentence may drive the boat, since somebody has stopped it.
    pub(crate) must_rest: Option<Instant>,
    /// When the page's E-stop was last pressed.
    pub(crate) page_stopped: Option<Instant>,
    /// Whether somebody is about to end an E-stop of all.
    pub(crate) is_releasing: bool,
}

impl Wire {
    pub(crate) fn new(ttl_s: f64, is_forged: bool) -> Wire {
        let fresh = Oracle::new();
        let oracle = Oracle {
            ttl_s: ttl_s + WAITED_S,
            nav_age_max_s: fresh.nav_age_max_s + WAITED_S,
            control_age_max_s: fresh.control_age_max_s + WAITED_S,
            link_up: true,
            ..fresh
        };
        let state = State {
            start: None,
            links: 0,
            is_connected: false,
            is_whole: true,
            to_boat: vec![],
            from_boat: vec![],
            oracle,
            arms_left: 0,
            is_armed: false,
            must_rest: None,
            page_stopped: None,
            is_releasing: false,
        };
        Wire { state: Watched::new(state), order: Mutex::new((SimTime::LONG_AGO, SimTime::LONG_AGO)), is_forged }
    }

    /// Reads or changes what is known, with the time since the wire was first used: the boat does so at the beginning.
    pub(crate) fn visit<R>(&self, visit: impl FnOnce(&mut State, SimTime) -> R) -> R {
        self.state.visit(|state| {
            let start = *state.start.get_or_insert_with(clock::now);
            visit(state, SimTime::from_s(clock::since(start).as_secs_f64()))
        })
    }

    pub(crate) fn wait(&self, limit: Duration, holds: impl FnMut(&State) -> bool) -> bool {
        self.state.wait(limit, holds)
    }

    /// Carries a gateway's sentences to the boat.
    pub(crate) fn carry(&self, bytes: &[u8]) {
        self.visit(|state, now| {
            // A process that is killed sends nothing more.
            if !state.is_connected || std::thread::panicking() {
                return;
            }
            state.oracle.ordered = self.order.lock().1;
            let before = state.oracle.driving;
            state.oracle.judge(now, bytes);
            let drives = state.oracle.driving > before;
            let must_rest = state.must_rest.is_some_and(|since| clock::now() >= since);
            assert!(!drives || !must_rest, "at {now}: {:?} although somebody has stopped the boat", state.oracle.last);
            if state.is_whole {
                state.to_boat.extend_from_slice(bytes);
            }
        });
    }

    /// An order made at this time has reached the gateway. May be called where the network must not be used.
    pub(crate) fn note_order(&self, given: SimTime, at: Duration) {
        let mut order = self.order.lock();
        // A boat that has joined anew takes the order that is in force, however often it had it before.
        if given >= order.0 || self.is_forged {
            *order = (given, SimTime::from_s(at.as_secs_f64()));
        }
    }

    /// A gateway has begun: it drives nobody before it was armed.
    pub(crate) fn note_start(&self) {
        self.visit(|state, _| {
            state.is_armed = false;
            state.update_armed();
        });
    }

    /// The gateway went from one state to another.
    pub(crate) fn note_state(&self, from: &str, to: &str) {
        self.visit(|state, now| {
            if to == "armed" {
                assert!(state.arms_left > 0, "at {now}: armed, and nobody asked for it");
                state.arms_left -= 1;
            }
            state.is_armed = to == "armed" || (state.is_armed && from != "armed");
            state.update_armed();
        });
    }
}

impl State {
    pub(crate) fn update_armed(&mut self) {
        self.oracle.armed = self.is_armed || self.arms_left > 0;
    }
}

/// The boat: it sails by what it is sent, until `stop` is set. The wire is cut in these spans of time.
pub(crate) fn sail(wire: &Wire, datum: LatLon, cuts: &[(Duration, Duration)], stop: &AtomicBool) {
    let plan = emulated(datum, DECLINATION_RAD);
    let mut emulator = Emulator::new(emulator::Plan { watchdog_s: Some(WATCHDOG_S), ..plan });
    let mut boat = Boat { at: Ned::from_xy(60.0, 40.0), ..Boat::default() };
    let (start, mut moves, mut steps) = (clock::now(), 0_u64, 0_u64);
    wire.visit(|_, now| assert_eq!(now, SimTime::ZERO));
    while !stop.load(Ordering::Relaxed) {
        clock::rest(MOVES);
        moves += 1;
        let passed = clock::since(start);
        let now = SimTime::from_s(passed.as_secs_f64());
        let is_whole = !cuts.iter().any(|(from, to)| (*from..*to).contains(&passed));
        let bytes = wire.visit(|state, _| {
            state.is_whole = is_whole;
            std::mem::take(&mut state.to_boat)
        });
        emulator.receive(now, Port::Secondary, &bytes);
        let order = emulator.order(now);
        while (steps as f64) * STEP_S < passed.as_secs_f64() {
            boat.step(order);
            steps += 1;
        }
        if moves.is_multiple_of(TELEMETRY) {
            emulator.observe(now, &boat.measured(now, boat.at));
            let mut burst = vec![];
            emulator.telemetry(now, &mut burst);
            wire.visit(|state, _| {
                if state.is_whole && state.from_boat.len() < UNREAD_MAX {
                    state.from_boat.append(&mut burst);
                }
            });
        }
    }
}
