//! The gateway loop: passes inputs from the boat, the sim and operators to the core, and forwards
//! the core's outputs.

use super::clock::{Clock, Moment};
use super::control_port::ControlPort;
use super::error::NodeError;
use super::game_finder::FoundGame;
use super::guard::{Guarded, HEARTBEAT, HUNG};
use super::join::Join;
use super::latency::Latency;
use super::loop_input::{Call, LoopOutput, Stop};
use super::node_event::NodeEvent;
use super::settings::Settings;
use super::subscriptions::subscribe;
use crate::bridge::{Bridge, Event, Input, Output};
use crate::game_clock::{GameClock, OrderTime};
use crate::link::{BoatLink, LinkEvent};
use crate::record::StepEncoder;
use crate::supervisor::{Scope, State};
use bus::token::{self, Checked, Guard};
use bus::{Bus, Declaration, Delivery, Priority, Publisher, Query, clock};
use messages::external::{FleetCommand, GatewayCommand, OperatorCommand, OperatorReply, Reported};
use messages::{Order, topic};
use primitives::frame::Ned;
use primitives::{SimTime, VehicleId};
use recording::Recorder;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Interval between status reports.
const STATUS_EVERY: Duration = Duration::from_secs(1);
/// Maximum time for the shutdown message.
const SHUTDOWN_MAX: Duration = Duration::from_millis(500);
/// Maximum time that the loop waits, after an error, to reach the boat and send it standby.
const REACH_MAX: Duration = Duration::from_secs(2);
const NOT_REACHED: &str = "not connected yet";
/// Maximum number of order sentences awaiting completion.
const WRITING_MAX: usize = 64;
/// Maximum time that data may have waited for the loop. Data that waited longer is outdated: the
/// loop was suspended or got no processor time.
const WAITED_MAX: Duration = Duration::from_millis(500);
/// The reply to a request that a disarm has overtaken.
const DISARMED: &str = "the boat was disarmed in the meantime: repeat the request";
/// Time within which a recurring message is not logged again.
const REMARK_AGAIN: Duration = Duration::from_secs(10);

/// The loop of a gateway, with everything that it drives.
pub(super) struct GatewayLoop<'a> {
    pub(super) bridge: Bridge,
    pub(super) link: Box<dyn BoatLink>,
    pub(super) clock: Clock,
    pub(super) input: LoopOutput,
    pub(super) game_clock: GameClock,
    /// The game, once found.
    pub(super) in_game: Option<InGame>,
    pub(super) settings: &'a Settings,
    pub(super) guarded: Option<Guarded>,
    pub(super) recorder: Option<Recorder>,
    pub(super) encoder: StepEncoder,
    pub(super) counters: Counters,
    pub(super) notify: &'a mut dyn FnMut(NodeEvent<'_>),
    pub(super) guard: Guard,
    pub(super) port: Option<&'a ControlPort>,
}

/// The game that the gateway has joined.
pub(super) struct InGame {
    bus: Bus,
    pub(super) nav: Publisher,
    pub(super) status: Publisher,
    /// Every byte of the link, for recorders and observers.
    pub(super) link_bytes: Publisher,
    pub(super) vehicle: VehicleId,
    _join: Join,
    _subscriptions: Vec<Declaration>,
}

/// The state of the loop.
pub(super) struct Counters {
    pub(super) ticket: Option<u64>,
    /// Game time, as last received.
    pub(super) game_now: SimTime,
    pub(super) reports: u64,
    pub(super) link: String,
    tag: u64,
    /// Order sentences being sent: tag, and arrival time of the order.
    writing: VecDeque<(u64, Instant)>,
    /// Arrival time of the order to be sent.
    order_came: Option<Instant>,
    pub(super) sentence_to_topic: Latency,
    pub(super) order_to_sentence: Latency,
    status_at: Instant,
    /// When the machine last resumed from a suspension, or the gateway started.
    awake_since: Instant,
    remarked: (Instant, String),
    /// The fault of the recording, as last reported.
    pub(super) recording_fault: Option<String>,
}

impl Counters {
    pub(super) fn new() -> Counters {
        let now = clock::now();
        Counters {
            ticket: None,
            game_now: SimTime::ZERO,
            reports: 0,
            link: NOT_REACHED.to_owned(),
            tag: 0,
            writing: VecDeque::new(),
            order_came: None,
            sentence_to_topic: Latency::new(),
            order_to_sentence: Latency::new(),
            status_at: now,
            awake_since: now,
            remarked: (now, String::new()),
            recording_fault: None,
        }
    }
}

impl GatewayLoop<'_> {
    /// Runs until it is stopped.
    pub(super) fn run(&mut self, stop: &AtomicBool) -> Result<(), NodeError> {
        let mut beat_at = Moment::now();
        while !stop.load(Ordering::Relaxed) {
            beat_at = self.beat(beat_at)?;
            let stop_count = self.input.stop_count();
            self.take_requests()?;
            // Use the count from before the stops were taken, so that the published state covers at
            // least the stops up to this count.
            self.input
                .show_state(stop_count, self.bridge.state_in_words());
            let due = self.bridge.due(self.clock.now());
            let wait = self.clock.until(due);
            // Wait no longer than a heartbeat interval: the guard cannot distinguish a loop that is
            // waiting for a boat from one that hangs.
            let call = self.input.calls.take(if self.guarded.is_some() {
                wait.min(HEARTBEAT)
            } else {
                wait
            });
            // Record a suspension before handling input that arrived during it.
            beat_at = self.beat(beat_at)?;
            match call {
                Some(call) => self.handle_call(call)?,
                None => self.step(Input::Tick, None)?,
            }
            if clock::now() >= self.counters.status_at {
                self.counters.status_at = clock::now() + STATUS_EVERY;
                self.check_recording();
                let status = self.full_status();
                self.report_status(&status)?;
                (self.notify)(NodeEvent::Status(&status));
            }
        }
        Ok(())
    }

    /// If the first connection attempt is still in progress, waits until the boat has been reached
    /// and has received standby.
    pub(super) fn await_boat(&mut self) {
        let start = clock::now();
        while self.counters.link == NOT_REACHED && clock::since(start) < REACH_MAX {
            if let Some(Call::Link(event)) = self.input.calls.take(HEARTBEAT) {
                // An earlier error is already being reported.
                drop(self.take_link(event));
            }
        }
    }

    /// Sends the guard a heartbeat, and reports to the core any pause long enough for the guard to
    /// have stopped the boat. After a suspension of the machine, input from before it counts as
    /// outdated.
    fn beat(&mut self, last: Moment) -> Result<Moment, NodeError> {
        let now = Moment::now();
        let (gap, suspended) = last.gap(now);
        if let Some(suspended) = suspended {
            self.counters.awake_since = now.at;
            self.warn(&format!(
                "this machine was suspended for {:.1} s",
                suspended.as_secs_f64()
            ));
        }
        if let Some(guarded) = &self.guarded {
            // The stop message may change with the operator in control, or during an upload.
            guarded.stop_with(&self.bridge.guard_message());
        }
        if self.guarded.as_ref().is_some_and(|guarded| !guarded.beat()) {
            self.warn("the guard has died: if the gateway is killed, nothing stops the boat");
        }
        if gap >= HUNG && (self.guarded.is_some() || suspended.is_some()) {
            self.step(Input::Hung(gap.as_secs_f64()), None)?;
        }
        Ok(now)
    }

    /// Whether input that arrived at this moment is too old to use.
    fn is_too_old(&self, came: Instant) -> bool {
        clock::since(came) > WAITED_MAX || came < self.counters.awake_since
    }

    pub(super) fn warn(&mut self, text: &str) {
        self.log(&Event::Warning(text.to_owned()), text);
    }

    /// Handles all stops first, then at most one request from the control port and one from the
    /// hub.
    fn take_requests(&mut self) -> Result<(), NodeError> {
        if self.input.take_stop(Stop::EStop(Scope::Fleet)) {
            self.step(Input::Fleet(FleetCommand::EStop), None)?;
        }
        if self.input.take_stop(Stop::EStop(Scope::Boat)) {
            self.step(Input::Operator(OperatorCommand::EStop), None)?;
        }
        if self.input.take_stop(Stop::Disarm) {
            self.step(Input::Operator(OperatorCommand::Disarm), None)?;
            self.refuse_earlier()?;
        }
        if let Some(found) = self.input.take_found() {
            self.enter(found?)?;
        }
        if let Some((command, reply)) = self.input.port_requests.take_now() {
            let refused = match command {
                GatewayCommand::Boat { command, .. } => self.execute(command)?,
                GatewayCommand::Fleet(command) => self.step_core(Input::Fleet(command), None)?,
            };
            // The requester may have gone.
            drop(reply.try_send(OperatorReply {
                refused,
                status: self.full_status(),
            }));
        }
        match self.input.queries.take_now() {
            Some(query) => self.operate(query, None),
            None => Ok(()),
        }
    }

    /// Refuses requests from before a disarm that has overtaken them, since they must not rearm the
    /// boat.
    fn refuse_earlier(&mut self) -> Result<(), NodeError> {
        while let Some((command, reply)) = self.input.port_requests.take_now() {
            let refused = command.needs_token().then(|| DISARMED.to_owned());
            // The requester may have gone.
            drop(reply.try_send(OperatorReply {
                refused,
                status: self.full_status(),
            }));
        }
        while let Some(query) = self.input.queries.take_now() {
            self.operate(query, Some(DISARMED))?;
        }
        Ok(())
    }

    /// Enters the game that was found.
    fn enter(&mut self, found: FoundGame) -> Result<(), NodeError> {
        let FoundGame {
            bus,
            game,
            info,
            vehicle,
            factor,
            site,
        } = found;
        let scenario = &info.scenario;
        let name = &self.settings.plan.vehicle;
        let newest = |key| bus.publisher_with(key, Priority::Normal, Delivery::Newest);
        let in_game = InGame {
            nav: newest(topic::nav(&game, scenario, vehicle))?,
            status: newest(topic::report(&game, Reported::Status, name))?,
            link_bytes: newest(topic::report(&game, Reported::Link, name))?,
            vehicle,
            _subscriptions: subscribe(&bus, &game, &info, vehicle, &self.input.back)?,
            _join: Join::begin(
                &bus,
                &self.settings.place,
                (&game, scenario),
                name,
                self.input.back.calls.clone(),
            )?,
            bus,
        };
        // The link is already in use: only the parts that need a field start here.
        self.in_game = Some(in_game);
        self.clock.set_pace(factor);
        self.encoder.set_vehicle(vehicle);
        self.step(Input::Site(Box::new(site)), None)
    }

    fn vehicle(&self) -> Option<VehicleId> {
        self.in_game.as_ref().map(|in_game| in_game.vehicle)
    }

    fn handle_call(&mut self, call: Call) -> Result<(), NodeError> {
        match call {
            Call::Link(event) => self.take_link(event)?,
            Call::Order => self.take_order()?,
            Call::Release => self.step(Input::Fleet(FleetCommand::Release), None)?,
            // Otherwise every game would end in a failsafe. A task of the boat's own controller
            // continues, since it needs no game.
            Call::Over if self.bridge.state() == State::Armed => {
                self.remark("the game is over: disarming the boat");
                self.step(Input::Operator(OperatorCommand::Disarm), None)?;
            }
            Call::Over => {}
            // The stop or request has been read already.
            Call::Look => {}
            Call::Looking(reason) => (self.notify)(NodeEvent::Looking { reason: &reason }),
            Call::Joined(joined)
                if self
                    .vehicle()
                    .is_some_and(|vehicle| joined.vehicles == [vehicle]) =>
            {
                self.counters.ticket = Some(joined.ticket);
                self.counters.game_now = joined.now;
                self.game_clock
                    .join(self.clock.at(joined.asked), joined.now);
                if let Some(port) = self.port {
                    // In a game with keys, the port keeps its own token.
                    if let Some(known) = self.settings.place.token.get() {
                        port.token().set(Some(known));
                    }
                    (self.notify)(NodeEvent::ControlPort {
                        address: port.address,
                        token: port.token().get(),
                    });
                }
                self.remark("joined: the sim accepts the boat's reports");
                self.step(Input::Joined, None)?;
            }
            // The ticket belongs to a different boat, which our reports would move.
            Call::Joined(_) => {
                let reason = "the sim admitted a different boat from the one requested".to_owned();
                return Err(NodeError::Refused(reason));
            }
            Call::SimGone => {
                // Not an error: stale orders stop the boat, and the gateway joins the game's next
                // sim in the same way.
                self.counters.ticket = None;
                self.remark("lost the sim; waiting for the next one");
            }
            Call::Remark(text) => self.remark(&text),
        }
        Ok(())
    }

    fn take_link(&mut self, event: LinkEvent) -> Result<(), NodeError> {
        match event {
            LinkEvent::Up { name, .. } => {
                "up".clone_into(&mut self.counters.link);
                self.remark(&format!("connected to {name}"));
                self.step(Input::LinkUp, None)
            }
            // An old position would be mistaken for the boat's current one.
            LinkEvent::Bytes { at, .. } if self.is_too_old(at) => {
                self.remark("discarded data from the boat that had waited too long");
                self.step(Input::Tick, None)
            }
            LinkEvent::Bytes { at, bytes, .. } => self.step(Input::Bytes(bytes), Some(at)),
            LinkEvent::Down { reason, .. } => {
                self.counters.link.clone_from(&reason);
                self.remark(&format!("the link is down: {reason}"));
                self.step(Input::LinkDown, None)
            }
            LinkEvent::Failed { reason, retry_in } => {
                self.counters.link = reason.clone();
                self.remark(&format!(
                    "{reason}: trying again in {:.1} s",
                    retry_in.as_secs_f64()
                ));
                Ok(())
            }
            LinkEvent::Written { tag, at } => {
                while let Some((sent, came)) =
                    self.counters.writing.pop_front_if(|(sent, _)| *sent <= tag)
                {
                    if sent == tag {
                        self.counters.order_to_sentence.note(came, at);
                    }
                }
                Ok(())
            }
        }
    }

    fn take_order(&mut self) -> Result<(), NodeError> {
        // Use only the newest order: executing an older one first would delay it.
        let taken = self.input.back.latest_order.lock().take();
        let Some((message, came)) = taken else {
            return Ok(());
        };
        if self.is_too_old(came) {
            return self.step(Input::OldOrder, None);
        }
        match self.game_clock.check(self.clock.at(came), &message) {
            OrderTime::Ahead => return self.step(Input::OrderAhead, None),
            OrderTime::BeforeJoining => return self.step(Input::OldOrder, None),
            OrderTime::Plausible => {}
        }
        self.counters.game_now = message.stamp.valid_ns;
        if Some(message.order.vehicle) != self.vehicle() {
            return self.step(Input::BadOrder, None);
        }
        let others = message.others_m.as_chunks::<2>().0;
        if !others.is_empty() {
            let places = others.iter().map(|&[north, east]| Ned { north, east });
            self.step(Input::Others(places.collect()), None)?;
        }
        // Check the order here as well as in the sim: the core must receive only valid numbers,
        // whatever is published on the topic.
        let sound = message
            .order
            .order()
            .and_then(|order: Order| order.check().ok());
        match sound {
            Some(order) => {
                self.counters.order_came = Some(came);
                self.step(Input::Order(order, message.given_ns), None)
            }
            None => self.step(Input::BadOrder, None),
        }
    }

    /// Answers a query; if there is an objection, does nothing that requires the token.
    fn operate(&mut self, query: Query, objection: Option<&str>) -> Result<(), NodeError> {
        let token = self.settings.place.token.get();
        let refused =
            match self
                .guard
                .check(query.key(), query.payload(), OperatorCommand::needs_token)
            {
                Checked::Granted(command) if objection.is_some() && command.needs_token() => {
                    objection.map(str::to_owned)
                }
                Checked::Granted(command) => self.execute(command)?,
                Checked::Challenged(challenge) => {
                    query.answer_as(challenge, token.as_ref());
                    return Ok(());
                }
                Checked::Garbage(e) => Some(format!("cannot parse the command: {e}")),
            };
        let reply = OperatorReply {
            refused,
            status: self.full_status(),
        };
        query.answer_as(token::answer(&reply), token.as_ref());
        Ok(())
    }

    /// Executes a command; returns the reason if it is refused.
    fn execute(&mut self, command: OperatorCommand) -> Result<Option<String>, NodeError> {
        if command == OperatorCommand::Status {
            return Ok(None);
        }
        self.remark(&format!("operator command: {command}"));
        let refused = self.step_core(Input::Operator(command), None)?;
        if let Some(reason) = &refused {
            self.remark(&format!("refused: {reason}"));
        }
        Ok(refused)
    }

    fn step(&mut self, input: Input, read: Option<Instant>) -> Result<(), NodeError> {
        self.step_core(input, read).map(drop)
    }

    /// Runs one step of the core; returns the reason if a request was refused. `read` is when the
    /// bytes were read from the link.
    fn step_core(
        &mut self,
        input: Input,
        read: Option<Instant>,
    ) -> Result<Option<String>, NodeError> {
        let now = self.clock.now();
        let mut out = Output::default();
        self.bridge.process(now, &input, &mut out);
        if !out.bytes.is_empty() {
            self.counters.tag += 1;
            if let (true, Some(came)) = (out.carries_order, self.counters.order_came.take()) {
                self.counters.writing.push_back((self.counters.tag, came));
                let surplus = self.counters.writing.len().saturating_sub(WRITING_MAX);
                self.counters.writing.drain(..surplus);
            }
            // Send before publishing or recording anything, which may be slow.
            let send = if out.stops {
                BoatLink::send_stop
            } else {
                BoatLink::send
            };
            send(&*self.link, out.bytes.clone(), self.counters.tag);
        }
        if let Some(nav) = &out.nav {
            self.report(nav)?;
            if let Some(read) = read {
                self.counters.sentence_to_topic.note(read, clock::now());
            }
        }
        for event in &out.events {
            (self.notify)(NodeEvent::Event {
                at_s: now.as_s(),
                event,
            });
        }
        // Operators wait for this status: a stop is confirmed once the status shows it.
        if out
            .events
            .iter()
            .any(|event| matches!(event, Event::State { .. }))
        {
            self.report_status(&self.full_status())?;
        }
        self.record_step(now, &input, &out)?;
        Ok(out.refused)
    }

    /// Logs a message, unless it was logged recently.
    fn remark(&mut self, text: &str) {
        let now = clock::now();
        let (at, last) = &self.counters.remarked;
        if last == text && now.saturating_duration_since(*at) < REMARK_AGAIN {
            return;
        }
        self.counters.remarked = (now, text.to_owned());
        self.log(&Event::Remark(text.to_owned()), text);
    }

    /// Reports an event of the shell. The recording contains only its message, since a replay
    /// compares only events of the core.
    fn log(&mut self, event: &Event, text: &str) {
        let at = self.clock.now();
        (self.notify)(NodeEvent::Event {
            at_s: at.as_s(),
            event,
        });
        if let Some(recorder) = &self.recorder {
            recorder.record(StepEncoder::event(at, Event::Remark(text.to_owned())));
        }
    }
}

impl InGame {
    /// Leaves the game.
    pub(super) fn leave(self) {
        let InGame {
            bus,
            _join,
            _subscriptions,
            ..
        } = self;
        drop((_join, _subscriptions));
        bus.close();
    }
}

impl Drop for GatewayLoop<'_> {
    /// However a gateway ends, except by a kill or a power cut, it sends the boat the shutdown
    /// message three times before the link closes.
    fn drop(&mut self) {
        // Three times, because links lose messages.
        let message = self.bridge.shutdown_message().repeat(3);
        self.link.send_and_wait(&message, SHUTDOWN_MAX);
        // End the guard only after the message: until then, the guard must stop the boat if this
        // process hangs.
        self.guarded.iter().for_each(Guarded::end);
    }
}
