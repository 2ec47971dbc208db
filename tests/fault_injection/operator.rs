//! An operator ashore who arms the real boat, stops it and releases it, and checks that each
//! command takes effect.

use crate::plan::{Plan, SIM};
use crate::play::{AtExit, WAIT, net};
use crate::real_boat::{WAITED_S, Wire};
use crate::stranger;
use bus::game_search::GameSearch;
use bus::{ANSWER, Bus, Watched, clock};
use messages::Control;
use messages::external::{OperatorCommand, OperatorReply};
use messages::topic::{self, GameName};
use primitives::stream::Stream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// When the operator's node starts.
pub(crate) const BEGINS: Duration = Duration::from_millis(300);
/// Time limit from an E-stop to the wire without faults, excluding transport.
pub(crate) const PROMISED: Duration = Duration::from_millis(200);
/// Recovery time of nodes after any fault: the network's lease plus joining again.
pub(crate) const RECOVERS: Duration = Duration::from_secs(25);
/// How long a page repeats its E-stop request, with a margin.
const SAID_AGAIN: Duration = Duration::from_secs(3);
/// Time within which a game ends once its sim sends no more orders.
const ENDS: Duration = Duration::from_secs(2);
/// Time after the game at which the last gateway exits; until then it is checked.
const STAYS: Duration = Duration::from_secs(3);

/// An operator at a terminal.
pub(crate) struct Operator<'a> {
    plan: &'a Plan,
    wire: &'a Wire,
    bus: Bus,
    game: GameName,
    vehicle: String,
    over: &'a Watched<bool>,
    began: Instant,
    /// Whether the gateway has ever answered.
    has_answered: bool,
    /// Whether the gateway has ever had orders: before the game begins there are none.
    has_had_orders: bool,
    /// Unanswered requests to arm, which may still arrive.
    unanswered: u32,
}

/// Acts as operator until the game is over, then stops the gateway and its boat.
pub(crate) fn operate(
    plan: &Plan,
    wire: &Wire,
    vehicle: &str,
    over: &Arc<Watched<bool>>,
    stop: &AtomicBool,
) {
    let _ends_gateway = AtExit(|| stop.store(true, Ordering::Relaxed));
    let began = clock::now();
    let search_stop = AtomicBool::new(false);
    let found = GameSearch::new(WAIT, &search_stop).game(&mut |_| {}, &net(false).into(), None);
    if let Ok((bus, game, _)) = found {
        let vehicle = vehicle.to_owned();
        let operator = Operator {
            plan,
            wire,
            bus,
            game,
            vehicle,
            over,
            began,
            has_answered: false,
            has_had_orders: false,
            unanswered: 0,
        };
        operator.act();
    }
    over.wait(Duration::MAX, |over| *over);
    clock::rest(STAYS);
}

impl Operator<'_> {
    fn act(mut self) {
        let stream = &mut Stream::new(self.plan.seed, "operator");
        while !self.is_over() {
            match stream.below(6) {
                0 => self.stop_all(stream),
                1 => self.stop_boat(stream),
                _ => self.arm(),
            }
            clock::rest(Duration::from_millis(200 + stream.below(800)));
        }
        self.bus.close();
    }

    fn is_over(&self) -> bool {
        self.over.visit(|over| *over)
    }

    /// Whether all nodes needed for an answer are free of faults, and have been so for the recovery
    /// time.
    fn is_undisturbed(&self) -> bool {
        self.are_undisturbed(&[SIM, self.plan.gateway(), self.plan.operator()])
    }

    fn are_undisturbed(&self, nodes: &[usize]) -> bool {
        let now = clock::since(self.began) + BEGINS;
        self.plan.is_calm()
            && !self.is_over()
            && !self
                .plan
                .is_disturbed(nodes, now.saturating_sub(RECOVERS), now)
    }

    fn ask(&mut self, command: &OperatorCommand) -> Option<OperatorReply> {
        let key = topic::operate(&self.game, &self.vehicle);
        // A node that is cut off gets no answer either.
        let reply: Option<OperatorReply> =
            self.bus.request_node(&key, command, ANSWER).ok().flatten();
        let must_answer = self.has_answered && self.is_undisturbed();
        assert!(
            reply.is_some() || !must_answer,
            "the gateway does not answer {command:?}"
        );
        self.has_answered |= reply.is_some();
        let is_forged = reply
            .as_ref()
            .is_some_and(|reply| reply.status.state == stranger::FORGED);
        assert!(!is_forged, "a stranger's answer counts");
        reply
    }

    fn arm(&mut self) {
        self.wire.visit(|state, _| {
            state.arms_left += 1;
            state.update_armed();
        });
        let reply = self.ask(&OperatorCommand::Arm);
        self.unanswered += u32::from(reply.is_none());
        let is_stopped = reply
            .as_ref()
            .is_some_and(|reply| reply.status.state.contains("e-stopped"));
        match reply {
            Some(reply) if has_no_orders(&reply) => self.check_orders_come(),
            reply => self.has_had_orders |= reply.is_some(),
        }
        self.wire.visit(|state, _| {
            state.arms_left = state.arms_left.min(self.unanswered);
            state.update_armed();
        });
        // All boats have been stopped from the page.
        if is_stopped {
            self.release_all();
        }
    }

    /// Checks that a gateway that has had time to join again has orders, unless the game is just
    /// ending.
    fn check_orders_come(&mut self) {
        // Without its agent, the boat has no orders either.
        let nodes: Vec<usize> = (SIM..=self.plan.operator()).collect();
        let was_undisturbed = self.has_had_orders && self.are_undisturbed(&nodes);
        clock::rest(ENDS);
        let reply = self.ask(&OperatorCommand::Status);
        let must_have = was_undisturbed && self.are_undisturbed(&nodes);
        assert!(
            !must_have || !reply.is_some_and(|reply| has_no_orders(&reply)),
            "no orders arrive, although nothing is wrong"
        );
    }

    /// Stops all boats through the sim, for a while.
    fn stop_all(&mut self, stream: &mut Stream) {
        let asked = clock::now();
        let was_undisturbed = self.is_undisturbed();
        if bus::control(&self.bus, &self.game, Control::EStop).is_ok() {
            let on_its_way = self.plan.on_its_way();
            let since = if was_undisturbed && self.is_undisturbed() {
                asked + PROMISED + on_its_way
            } else {
                // A gateway that is cut off follows its last order until that expires.
                clock::now() + Duration::from_secs_f64(1.0 + WAITED_S) + on_its_way
            };
            self.rest(stream, since);
        }
        self.release_all();
    }

    /// Ends an E-stop of all boats, regardless of who requested it.
    fn release_all(&mut self) {
        self.note_release(true);
        // Without an answer, the operator does not know whether the release took effect.
        while !self.is_over() {
            let was_undisturbed = self.is_undisturbed();
            let is_released = bus::control(&self.bus, &self.game, Control::Release).is_ok();
            clock::rest(Duration::from_millis(300));
            let state = self
                .ask(&OperatorCommand::Status)
                .map(|reply| reply.status.state);
            let is_stopped = state
                .as_deref()
                .is_none_or(|state| state.contains("e-stopped"));
            if is_released && !is_stopped {
                break;
            }
            let by_page = self.wire.visit(|state, _| state.page_stopped);
            let is_late = was_undisturbed
                && self.has_answered
                && self.is_undisturbed()
                && by_page.is_none_or(|at| clock::since(at) > SAID_AGAIN);
            assert!(
                !is_late,
                "an E-stop of all boats is in force after its release: {is_released}, {state:?}"
            );
        }
        self.note_release(false);
    }

    fn note_release(&self, begins: bool) {
        self.wire
            .visit(|state, _| (state.is_releasing, state.must_rest) = (begins, None));
    }

    /// Stops the boat through its gateway, for a while.
    fn stop_boat(&mut self, stream: &mut Stream) {
        if self.ask(&OperatorCommand::EStop).is_some() {
            self.rest(stream, clock::now());
        }
        self.wire.visit(|state, _| state.must_rest = None);
        while !self.is_over() {
            if self
                .ask(&OperatorCommand::Release)
                .is_some_and(|reply| reply.refused.is_none())
            {
                break;
            }
            clock::rest(Duration::from_millis(300));
        }
    }

    /// Requires the boat to rest from `since` on, for a while.
    fn rest(&self, stream: &mut Stream, since: Instant) {
        self.wire.visit(|state, _| state.must_rest = Some(since));
        clock::rest(Duration::from_millis(500 + stream.below(2500)));
    }
}

fn has_no_orders(reply: &OperatorReply) -> bool {
    reply
        .status
        .missing
        .iter()
        .any(|missing| missing == "a fresh order")
}
