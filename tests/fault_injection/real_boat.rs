//! The real boat of a game, in a separate node, and the wire to its gateway. An oracle checks every
//! sentence on the wire, and panics at a forbidden one.

use crate::boat::{Boat, STEP_S, emulated};
use crate::oracle::Oracle;
use bus::{Watched, clock};
use gateway::emulator::{self, Emulator, FrontSeat, Port};
use parking_lot::Mutex;
use primitives::SimTime;
use primitives::frame::{LatLon, Ned};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Interval between the boat's steps.
const MOVES: Duration = Duration::from_millis(50);
/// Telemetry is sent at every second step.
const TELEMETRY: u64 = 2;
/// Time without a command after which the boat stops by itself, s.
const WATCHDOG_S: f64 = 2.0;
/// Magnetic declination of its waters, east positive, rad.
pub(crate) const DECLINATION_RAD: f64 = -0.218;
/// Maximum number of unread bytes for the gateway; further ones are lost.
const UNREAD_MAX: usize = 1 << 16;
/// An order that waits for the gateway's loop is at most this much older than the oracle assumes
/// (s); an older one is not used.
pub(crate) const WAITED_S: f64 = 0.55;

/// The wire between a boat and its gateway.
pub(crate) struct Wire {
    state: Watched<State>,
    /// The newest order that reached the gateway: when it was made, and when it arrived.
    order: Mutex<(SimTime, SimTime)>,
    /// Whether corruption in transit may change the time of an order.
    is_forged: bool,
}

/// The state of the wire and of the oracle.
pub(crate) struct State {
    start: Option<Instant>,
    /// Number of links that gateways have opened on this wire: only the newest is served.
    pub(crate) links: u64,
    pub(crate) is_connected: bool,
    pub(crate) is_whole: bool,
    to_boat: Vec<u8>,
    pub(crate) from_boat: Vec<u8>,
    pub(crate) oracle: Oracle,
    /// Number of requests to arm that may still take effect.
    pub(crate) arms_left: u32,
    is_armed: bool,
    /// From this time on, no sentence may drive the boat, because of a stop.
    pub(crate) must_rest: Option<Instant>,
    /// When the page's E-stop was last pressed.
    pub(crate) page_stopped: Option<Instant>,
    /// Whether a release of all boats is in progress.
    pub(crate) is_releasing: bool,
}

impl Wire {
    pub(crate) fn new(is_forged: bool) -> Wire {
        let oracle = Oracle {
            waited_s: WAITED_S,
            link_up: true,
            ..Oracle::default()
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
        Wire {
            state: Watched::new(state),
            order: Mutex::new((SimTime::LONG_AGO, SimTime::LONG_AGO)),
            is_forged,
        }
    }

    /// Reads or changes the state, with the time since first use of the wire, which is the boat's
    /// start.
    pub(crate) fn visit<R>(&self, visit: impl FnOnce(&mut State, SimTime) -> R) -> R {
        self.state.visit(|state| {
            let start = *state.start.get_or_insert_with(clock::now);
            visit(state, SimTime::from_s(clock::since(start).as_secs_f64()))
        })
    }

    pub(crate) fn wait(&self, limit: Duration, holds: impl FnMut(&State) -> bool) -> bool {
        self.state.wait(limit, holds)
    }

    /// Transmits a gateway's sentences to the boat.
    pub(crate) fn carry(&self, bytes: &[u8]) {
        self.visit(|state, now| {
            // A killed process sends nothing more.
            if !state.is_connected || std::thread::panicking() {
                return;
            }
            state.oracle.ordered = Some(self.order.lock().1);
            let before = state.oracle.driving;
            state.oracle.judge(now, bytes);
            let drives = state.oracle.driving > before;
            let must_rest = state.must_rest.is_some_and(|since| clock::now() >= since);
            assert!(
                !drives || !must_rest,
                "at {now}: {:?} although the boat has been stopped",
                state.oracle.last
            );
            if state.is_whole {
                state.to_boat.extend_from_slice(bytes);
            }
        });
    }

    /// Records the arrival of an order at the gateway. May be called where the network must not be
    /// used.
    pub(crate) fn note_order(&self, given: SimTime, at: Duration) {
        let mut order = self.order.lock();
        // After joining again, a boat accepts the order in force even if it already had it.
        if given >= order.0 || self.is_forged {
            *order = (given, SimTime::from_s(at.as_secs_f64()));
        }
    }

    /// Records the start of a gateway: it must not drive the boat before it is armed.
    pub(crate) fn note_start(&self) {
        self.visit(|state, _| {
            state.is_armed = false;
            state.update_armed();
        });
    }

    /// Records a state change of the gateway.
    pub(crate) fn note_state(&self, from: &str, to: &str) {
        self.visit(|state, now| {
            if to == "armed" {
                assert!(state.arms_left > 0, "at {now}: armed without a request");
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

/// Runs the boat with the commands that it receives until `stop` is set; `cuts` are the periods in
/// which the wire is cut.
pub(crate) fn sail(wire: &Wire, datum: LatLon, cuts: &[(Duration, Duration)], stop: &AtomicBool) {
    let plan = emulated(datum, DECLINATION_RAD);
    let mut emulator = Emulator::new(emulator::Plan {
        watchdog_s: Some(WATCHDOG_S),
        ..plan
    });
    let mut boat = Boat {
        at: Ned::from_xy(60.0, 40.0),
        ..Boat::default()
    };
    let start = clock::now();
    let mut moves = 0_u64;
    let mut steps = 0_u64;
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
