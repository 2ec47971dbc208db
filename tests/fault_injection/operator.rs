//! A person ashore who arms the real boat, stops it and releases it, and sees whether all of that is done.

use crate::plan::{Plan, SIM};
use crate::play::{WAIT, net};
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

/// When the operator's node begins.
pub(crate) const BEGINS: Duration = Duration::from_millis(300);
/// From an E-stop to the wire, where nothing is wrong, beside the time on the network.
pub(crate) const PROMISED: Duration = Duration::from_millis(200);
/// How long nodes need, after whatever befell them, to be as they were: the lease of the network and joining again.
pub(crate) const RECOVERS: Duration = Duration::from_secs(25);
/// For this long a page says again that it wants an E-stop, and a little longer.
const SAID_AGAIN: Duration = Duration::from_secs(3);
/// A game whose sim sends no orders any more is over within this time.
const ENDS: Duration = Duration::from_secs(2);
/// The last gateway ends this long after the game: until then it is judged.
const STAYS: Duration = Duration::from_secs(3);

/// What a person at a terminal does.
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
    /// Whether it has ever had orders: before the game has begun there are none.
    has_had_orders: bool,
    /// Requests to arm that nobody answered: they may get there yet.
    unanswered: u32,
}

/// Ends the gateway and its boat, however the operator's node ends.
struct EndsGateway<'a>(&'a AtomicBool);

impl Drop for EndsGateway<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Acts until the game is over, then ends the gateway and its boat.
pub(crate) fn operate(plan: &Plan, wire: &Wire, vehicle: &str, over: &Arc<Watched<bool>>, stop: &AtomicBool) {
    let _ends_gateway = EndsGateway(stop);
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

    /// Whether nothing is wrong with anybody who is needed for an answer, and was not for some time before.
    fn is_undisturbed(&self) -> bool {
        self.are_undisturbed(&[SIM, self.plan.gateway(), self.plan.operator()])
    }

    fn are_undisturbed(&self, nodes: &[usize]) -> bool {
        let now = clock::since(self.began) + BEGINS;
        self.plan.is_calm() && !self.is_over() && !self.plan.is_disturbed(nodes, now.saturating_sub(RECOVERS), now)
    }

    fn ask(&mut self, command: &OperatorCommand) -> Option<OperatorReply> {
        let key = topic::operate(&self.game, &self.vehicle);
        // Who is cut off has no answer either.
        let reply: Option<OperatorReply> = self.bus.request_node(&key, command, ANSWER).ok().flatten();
        let must_answer = self.has_answered && self.is_undisturbed();
        assert!(reply.is_some() || !must_answer, "the gateway does not answer {command:?}");
        self.has_answered |= reply.is_some();
        let is_forged = reply.as_ref().is_some_and(|reply| reply.status.state == stranger::FORGED);
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
        let is_stopped = reply.as_ref().is_some_and(|reply| reply.status.state.contains("e-stopped"));
        match reply {
            Some(reply) if has_no_orders(&reply) => self.check_orders_come(),
            reply => self.has_had_orders |= reply.is_some(),
        }
        self.wire.visit(|state, _| {
            state.arms_left = state.arms_left.min(self.unanswered);
            state.update_armed();
        });
        // Somebody has stopped everything on the page.
        if is_stopped {
            self.release_all();
        }
    }

    /// A gateway that lost its game and had time to join again has orders, or the game is just ending.
    fn check_orders_come(&mut self) {
        // Without its agent, there are none either.
        let nodes: Vec<usize> = (SIM..=self.plan.operator()).collect();
        let was_undisturbed = self.has_had_orders && self.are_undisturbed(&nodes);
        clock::rest(ENDS);
        let reply = self.ask(&OperatorCommand::Status);
        let must_have = was_undisturbed && self.are_undisturbed(&nodes);
        assert!(
            !must_have || !reply.is_some_and(|reply| has_no_orders(&reply)),
            "no orders come, though nothing is wrong"
        );
    }

    /// Stops everything by way of the sim, for a while.
    fn stop_all(&mut self, stream: &mut Stream) {
        let (asked, was_undisturbed) = (clock::now(), self.is_undisturbed());
        if bus::control(&self.bus, &self.game, Control::EStop).is_ok() {
            let on_its_way = self.plan.on_its_way();
            let since = if was_undisturbed && self.is_undisturbed() {
                asked + PROMISED + on_its_way
            } else {
                // A gateway that is cut off goes by its last order until that has expired.
                clock::now() + Duration::from_secs_f64(1.0 + WAITED_S) + on_its_way
            };
            self.rest(stream, since);
        }
        self.release_all();
    }

    /// Ends an E-stop of all, whoever asked for it.
    fn release_all(&mut self) {
        self.note_release(true);
        // Somebody who is not answered does not know whether it was done.
        while !self.is_over() {
            let was_undisturbed = self.is_undisturbed();
            let is_released = bus::control(&self.bus, &self.game, Control::Release).is_ok();
            clock::rest(Duration::from_millis(300));
            let state = self.ask(&OperatorCommand::Status).map(|reply| reply.status.state);
            let is_stopped = state.as_deref().is_none_or(|state| state.contains("e-stopped"));
            if is_released && !is_stopped {
                break;
            }
            let by_page = self.wire.visit(|state, _| state.page_stopped);
            let is_late = was_undisturbed
                && self.has_answered
                && self.is_undisturbed()
                && by_page.is_none_or(|at| clock::since(at) > SAID_AGAIN);
            assert!(!is_late, "an E-stop of all that was released is in force: {is_released}, {state:?}");
        }
        self.note_release(false);
    }

    fn note_release(&self, begins: bool) {
        self.wire.visit(|state, _| (state.is_releasing, state.must_rest) = (begins, None));
    }

    /// Stops the boat by its gateway, for a while.
    fn stop_boat(&mut self, stream: &mut Stream) {
        if self.ask(&OperatorCommand::EStop).is_some() {
            self.rest(stream, clock::now());
        }
        self.wire.visit(|state, _| state.must_rest = None);
        while !self.is_over() {
            if self.ask(&OperatorCommand::Release).is_some_and(|reply| reply.refused.is_none()) {
                break;
            }
            clock::rest(Duration::from_millis(300));
        }
    }

    /// The boat must rest from `since` on, for a while.
    fn rest(&self, stream: &mut Stream, since: Instant) {
        self.wire.visit(|state, _| state.must_rest = Some(since));
        clock::rest(Duration::from_millis(500 + stream.below(2500)));
    }
}

fn has_no_orders(reply: &OperatorReply) -> bool {
    reply.status.missing.iter().any(|missing| missing == "a fresh order")
}
