//! The desk of a gateway: what comes in from the boat, the sim and people goes to the core, what it says goes out.

use super::clock::Clock;
use super::latency::Latency;
use super::logbook::Logbook;
use super::{News, NodeError};
use crate::bridge::{Bridge, FleetCommand, Input, NavOut, Outbox};
use crate::link::{Link, LinkEvent};
use bus::{Inbox, Publisher, Query, clock};
use game::codec;
use game::external::{ExternalOrder, GatewayStatus, LinkBytes, NavReport, OperatorCommand, OperatorReply};
use game::frame::Ned;
use game::message::{Frame, Message, Stamp};
use game::{Order, SimTime, VehicleId};
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// What comes in.
pub(super) enum Call {
    Link(LinkEvent),
    /// An order lies in the latest_order.
    Order,
    Frame(Vec<u8>),
    Operate(Query),
    EStop,
    Release,
    Joined(u64, Vec<VehicleId>),
    SimGone,
    Remark(String),
}

/// The newest order, and when it came. However many come, only the newest waits.
pub(super) type LatestOrder = Arc<Mutex<Option<(ExternalOrder, Instant)>>>;

/// How often the status is told, and shown.
const STATUS_EVERY: Duration = Duration::from_millis(500);
/// How long last words may take.
const LAST_WORDS: Duration = Duration::from_millis(500);
/// Sentences with orders whose writing is waited for.
const WRITING_MAX: usize = 64;
/// A remark that is made again within this time is not repeated.
const REMARK_AGAIN: Duration = Duration::from_secs(10);

/// What the desk works with.
pub(super) struct GatewayLoop {
    pub(super) bridge: Bridge,
    pub(super) link: Link,
    pub(super) clock: Clock,
    pub(super) inbox: Inbox<Call>,
    pub(super) latest_order: LatestOrder,
    /// Set as soon as an E-stop for all boats comes in: it must not wait, nor be dropped, behind anything else.
    pub(super) e_stop: Arc<AtomicBool>,
    pub(super) nav: Publisher,
    pub(super) status: Publisher,
    /// Every byte of the link, for recorders.
    pub(super) wire: Publisher,
    pub(super) vehicle: VehicleId,
    /// The other real boats.
    pub(super) others: Vec<VehicleId>,
    pub(super) logbook: Option<Logbook>,
    pub(super) counters: Counters,
}

/// What the desk keeps track of.
pub(super) struct Counters {
    ticket: Option<u64>,
    /// Time of the game, as heard last.
    game_now: SimTime,
    reports: u64,
    wired: u64,
    link: String,
    tag: u64,
    /// Sentences with orders on their way: tag, and when the order came.
    writing: VecDeque<(u64, Instant)>,
    /// When the order that is not sent yet came.
    order_came: Option<Instant>,
    sentence_to_topic: Latency,
    order_to_sentence: Latency,
    status_at: Instant,
    remarked: (Instant, String),
}

impl Counters {
    pub(super) fn new() -> Counters {
        let now = clock::now();
        Counters {
            ticket: None,
            game_now: SimTime::ZERO,
            reports: 0,
            wired: 0,
            link: "not connected yet".to_owned(),
            tag: 0,
            writing: VecDeque::new(),
            order_came: None,
            sentence_to_topic: Latency::new(),
            order_to_sentence: Latency::new(),
            status_at: now,
            remarked: (now, String::new()),
        }
    }
}

impl GatewayLoop {
    /// Works until it is told to stop.
    pub(super) fn work(&mut self, stop: &AtomicBool, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
        while !stop.load(Ordering::Relaxed) {
            if self.e_stop.swap(false, Ordering::Relaxed) {
                self.turn(Input::Fleet(FleetCommand::EStop), None, tell)?;
            }
            let due = self.bridge.due(self.clock.now());
            match self.inbox.take(self.clock.until(due)) {
                Some(call) => self.take(call, tell)?,
                None => self.turn(Input::Tick, None, tell)?,
            }
            if clock::now() >= self.counters.status_at {
                self.counters.status_at = clock::now() + STATUS_EVERY;
                let status = self.full_status();
                self.status.send_json(serde_json::to_vec(&status).expect("a status is JSON"))?;
                tell(News::Status(&status));
            }
        }
        Ok(())
    }

    /// How everything is.
    pub(super) fn full_status(&self) -> GatewayStatus {
        let mut status = self.bridge.status(self.clock.now());
        if status.link != "up" {
            status.link.clone_from(&self.counters.link);
        }
        status.latency_us =
            [self.counters.sentence_to_topic.summary_us(), self.counters.order_to_sentence.summary_us()];
        let lost = self.logbook.as_ref().map_or(0, Logbook::lost);
        let more = [("nav reports", self.counters.reports), ("displaced writes", self.link.displaced())];
        let rest = [("calls dropped", self.inbox.dropped()), ("turns not recorded", lost)];
        status.counts.extend(more.into_iter().chain(rest).map(|(name, count)| (name.to_owned(), count)));
        status
    }

    fn take(&mut self, call: Call, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
        match call {
            Call::Link(event) => self.take_link(event, tell),
            Call::Order => self.take_order(tell),
            Call::Frame(bytes) => self.take_frame(&bytes, tell),
            Call::Operate(question) => self.operate(question, tell),
            Call::Release => self.turn(Input::Fleet(FleetCommand::Release), None, tell),
            // It only wakes the desk.
            Call::EStop => Ok(()),
            Call::Joined(ticket, vehicles) if vehicles == [self.vehicle] => {
                self.counters.ticket = Some(ticket);
                self.remark("joined: the sim takes reports of the boat", tell);
                self.turn(Input::Moored, None, tell)
            }
            Call::Joined(..) => {
                Err(NodeError::Refused("the sim let another boat in than the one that asked".to_owned()))
            }
            Call::SimGone => {
                self.counters.ticket = None;
                self.remark("the sim is gone: waiting for the next", tell);
                Ok(())
            }
            Call::Remark(text) => {
                self.remark(&text, tell);
                Ok(())
            }
        }
    }

    fn take_link(&mut self, event: LinkEvent, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
        match event {
            LinkEvent::Up { name, .. } => {
                self.remark(&format!("connected to {name}"), tell);
                self.turn(Input::LinkUp, None, tell)
            }
            LinkEvent::Bytes { at, bytes, .. } => self.turn(Input::Bytes(bytes), Some(at), tell),
            LinkEvent::Down { reason, .. } => {
                self.counters.link.clone_from(&reason);
                self.remark(&format!("the link is down: {reason}"), tell);
                self.turn(Input::LinkDown, None, tell)
            }
            LinkEvent::Failed { reason, again } => {
                self.counters.link = reason.clone();
                self.remark(&format!("{reason}: trying again in {:.1} s", again.as_secs_f64()), tell);
                Ok(())
            }
            LinkEvent::Written { tag, at } => {
                while let Some((sent, came)) = self.counters.writing.pop_front_if(|(sent, _)| *sent <= tag) {
                    if sent == tag {
                        self.counters.order_to_sentence.note(came, at);
                    }
                }
                Ok(())
            }
        }
    }

    fn take_order(&mut self, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
        let taken = self.latest_order.lock().unwrap_or_else(PoisonError::into_inner).take();
        let Some((message, came)) = taken else { return Ok(()) };
        self.counters.game_now = message.stamp.valid_ns;
        if message.order.vehicle != self.vehicle {
            return self.turn(Input::BadOrder, None, tell);
        }
        let sound = message.order.order().and_then(|order: Order| order.check().ok());
        match sound {
            Some(order) => {
                self.counters.order_came = Some(came);
                self.turn(Input::Order(order, message.given_ns), None, tell)
            }
            None => self.turn(Input::BadOrder, None, tell),
        }
    }

    fn take_frame(&mut self, bytes: &[u8], tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
        let Ok(frame) = codec::decode::<Frame>(bytes) else { return Ok(()) };
        let place = |vehicle: &VehicleId| frame.vehicles.get(vehicle.index()).map(|truth| truth.nav.at());
        let others: Vec<Ned> = self.others.iter().filter_map(place).collect();
        self.turn(Input::Others(others), None, tell)
    }

    fn operate(&mut self, question: Query, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
        let refused = match serde_json::from_slice::<OperatorCommand>(&question.payload) {
            Ok(OperatorCommand::Status) => None,
            Ok(command) => {
                self.remark(&format!("somebody asks: {command:?}"), tell);
                self.turn_of(Input::Operator(command), None, tell)?
            }
            Err(e) => Some(format!("the question is not understood: {e}")),
        };
        if let Some(reason) = &refused {
            self.remark(&format!("refused: {reason}"), tell);
        }
        let reply = OperatorReply { refused, status: self.full_status() };
        question.answer(serde_json::to_vec(&reply).expect("a reply is JSON"));
        Ok(())
    }

    fn turn(&mut self, input: Input, read: Option<Instant>, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
        self.turn_of(input, read, tell).map(drop)
    }

    /// One turn of the core; gives why a wish was refused. `read` is when bytes came off the link.
    fn turn_of(
        &mut self,
        input: Input,
        read: Option<Instant>,
        tell: &mut dyn FnMut(News<'_>),
    ) -> Result<Option<String>, NodeError> {
        let now = self.clock.now();
        let mut out = Outbox::default();
        self.bridge.take(now, &input, &mut out);
        // The boat comes first.
        if !out.bytes.is_empty() {
            self.counters.tag += 1;
            if let (true, Some(came)) = (out.carries_order, self.counters.order_came.take()) {
                self.counters.writing.push_back((self.counters.tag, came));
                let surplus = self.counters.writing.len().saturating_sub(WRITING_MAX);
                self.counters.writing.drain(..surplus);
            }
            self.link.send(out.bytes.clone(), self.counters.tag);
        }
        if let Some(nav) = &out.nav {
            self.report(nav)?;
            if let Some(read) = read {
                self.counters.sentence_to_topic.note(read, clock::now());
            }
        }
        for event in &out.events {
            tell(News::Event { at_s: now.as_s(), event });
        }
        if self.wire.is_heard() {
            if let Input::Bytes(bytes) = &input {
                self.tell_wire(false, bytes)?;
            }
            self.tell_wire(true, &out.bytes)?;
        }
        if let Some(logbook) = &self.logbook {
            logbook.turn(now, input, &out);
        }
        Ok(out.refused)
    }

    /// Tells what went over the link, if anything.
    fn tell_wire(&mut self, outward: bool, data: &[u8]) -> Result<(), NodeError> {
        if data.is_empty() {
            return Ok(());
        }
        let stamp = Stamp { valid_ns: self.counters.game_now, seq: self.counters.wired, version: LinkBytes::VERSION };
        self.counters.wired += 1;
        Ok(self.wire.send(&LinkBytes { stamp, vehicle: self.vehicle, outward, data: data.to_vec() })?)
    }

    fn report(&mut self, out: &NavOut) -> Result<(), NodeError> {
        let Some(ticket) = self.counters.ticket else { return Ok(()) };
        self.counters.reports += 1;
        let stamp = Stamp { valid_ns: self.counters.game_now, seq: self.counters.reports, version: NavReport::VERSION };
        let age_ns = SimTime::from_s(out.age_s).0;
        let report = NavReport { stamp, ticket, vehicle: self.vehicle, valid: out.valid, age_ns, nav: out.nav };
        Ok(self.nav.send(&report)?)
    }

    /// Says something, unless it was said just now.
    fn remark(&mut self, text: &str, tell: &mut dyn FnMut(News<'_>)) {
        let now = clock::now();
        let (at, last) = &self.counters.remarked;
        if last == text && now.saturating_duration_since(*at) < REMARK_AGAIN {
            return;
        }
        self.counters.remarked = (now, text.to_owned());
        if let Some(logbook) = &self.logbook {
            logbook.remark(self.clock.now(), text);
        }
        tell(News::Remark { at_s: self.clock.now().as_s(), text });
    }
}

impl Drop for GatewayLoop {
    /// However a gateway ends, but by the plug: the boat is told to stop, three times, before the link goes.
    fn drop(&mut self) {
        let words = self.bridge.last_words().repeat(3);
        self.link.send_and_wait(&words, LAST_WORDS);
    }
}
