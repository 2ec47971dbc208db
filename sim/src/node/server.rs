//! The referee's server: the contest, who is who in it, and the lines to agents, gateways and observers.

use super::agents::{Accepted, Agents, Refused, Timing};
use super::clock;
use super::gateways::Gateways;
use super::observers::{self, RecordedTopic};
use super::pacing::Pacing;
use super::recorder::{RecordedMessage, Recorder};
use super::subscriptions::{self, Incoming};
use super::{News, NodeError, Pace, Settings};
use crate::contest::Contest;
use bus::{Bus, Declaration, Delivery, Inbox, Publisher, Query, inbox};
use game::codec::{self, DecodeError};
use game::external::{ExternalOrder, NavReport};
use game::message::{Control, GameInfo, JoinReply, JoinRequest, Message, Orders, Stamp, VehicleOrder};
use game::run_state::{Phase, RunState};
use game::topic::{self, Part};
use game::{Order, Picture, SimTime, TeamId, VehicleId};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Calls that may wait to be looked at.
const INBOX: usize = 8192;
/// How often progress is told.
const NEWS_EVERY: Duration = Duration::from_millis(100);
/// How often the state of the run is written down, where nothing is news.
const WRITE_EVERY: Duration = Duration::from_secs(1);
/// How long the last words may take to reach everybody.
const GOOD_BYE: Duration = Duration::from_secs(2);

/// Everything a served game needs.
pub(super) struct GameServer<'w> {
    pub(super) contest: Contest,
    pub(super) pacing: Pacing,
    recorder: &'w mut dyn Recorder,
    /// Whether the recorder writes down what it is shown.
    is_recorded: bool,
    pub(super) agents: Agents,
    gateways: Gateways,
    inbox: Inbox<Incoming>,
    bus: Bus,
    pictures: Vec<Publisher>,
    /// The decision whose pictures were sent last.
    asked: Option<u64>,
    frames: Publisher,
    run: Publisher,
    /// Whether somebody asked for something since the state of the run was told.
    is_news: bool,
    /// When that was written down last.
    written: Instant,
    pub(super) overruns: u64,
    /// Topics that are heard only to be written down.
    recorded_topics: Vec<RecordedTopic>,
    /// What each real boat is to do.
    helms: Vec<(VehicleId, Publisher)>,
    /// Answers the question what the game is.
    notice: Vec<u8>,
    stop: Arc<AtomicBool>,
    refused: Refused,
    /// When the orders in force were given, by vehicle: time of the picture they answer.
    pub(super) ordered_at: Vec<SimTime>,
    /// When each vehicle's mind was last heard.
    heard: Vec<Instant>,
    last_news: (Instant, SimTime),
    /// When the open decision was opened, once the game runs.
    opened: Option<Instant>,
    pace: Pace,
    _standing: Vec<Declaration>,
}

impl<'w> GameServer<'w> {
    /// Opens the hub and the door.
    pub(super) fn open(
        mut contest: Contest,
        settings: &Settings,
        recorder: &'w mut dyn Recorder,
    ) -> Result<GameServer<'w>, NodeError> {
        let bus = Bus::hub(&settings.net)?;
        let (inbox_sender, inbox) = inbox(INBOX);
        let game = &settings.game;
        let is_recorded = recorder.state().is_some();
        if is_recorded {
            contest.keep_inputs();
        }
        let scenario = contest.scenario();
        let recorded_topics = if is_recorded { observers::recorded_topics(scenario) } else { vec![] };
        let standing = subscriptions::open(&bus, game, &inbox_sender, &recorded_topics)?;
        let is_lockstep = settings.pace == Pace::Lockstep;
        let timing = if is_lockstep { Timing::Lockstep } else { Timing::Realtime };
        let speed = if let Pace::Realtime { factor } = settings.pace { Some(factor) } else { settings.speed };
        let delivery = if is_lockstep { Delivery::Wait } else { Delivery::Drop };
        let teams = (0..scenario.teams.len()).map(|team| topic::picture(game, scenario, TeamId(team as u8)));
        let pictures: Result<Vec<Publisher>, _> = teams.map(|key| bus.publisher(key, delivery)).collect();
        // A gateway that does not keep up must not stop the game, and gets the next order soon.
        let helm = |v| Ok((v, bus.publisher(topic::external_order(game, scenario, v), Delivery::Drop)?));
        let helms: Vec<_> = scenario.externals().map(helm).collect::<Result<_, NodeError>>()?;
        let is_real = !helms.is_empty();
        let notice =
            GameInfo { version: game::VERSION.to_owned(), pace: settings.pace.to_string(), scenario: scenario.clone() };
        Ok(GameServer {
            agents: Agents::new(scenario, timing),
            gateways: Gateways::new(scenario),
            inbox,
            pictures: pictures?,
            asked: None,
            helms,
            frames: bus.publisher(topic::frame(game), Delivery::Drop)?,
            run: bus.publisher(topic::run(game), Delivery::Drop)?,
            is_news: false,
            written: clock::now(),
            overruns: 0,
            recorded_topics,
            pacing: Pacing::new(speed, is_lockstep, is_real),
            recorder,
            is_recorded,
            notice: serde_json::to_vec(&notice).expect("a scenario is JSON"),
            stop: Arc::clone(&settings.stop),
            refused: Refused::default(),
            ordered_at: vec![SimTime::ZERO; scenario.vehicles.len()],
            heard: vec![clock::now(); scenario.vehicles.len()],
            last_news: (clock::now(), SimTime::ZERO),
            opened: None,
            pace: settings.pace,
            _standing: standing,
            bus,
            contest,
        })
    }

    /// Keeps the door open until every vehicle has a mind and every real boat has been heard of, or the limit has passed:
    /// those without are lost then.
    pub(super) fn wait_for_everybody(
        &mut self,
        limit: Duration,
        tell: &mut dyn FnMut(News<'_>),
    ) -> Result<(), NodeError> {
        let start = clock::now();
        let mut told = (usize::MAX, usize::MAX);
        loop {
            let (mindless, unheard) = (self.agents.mindless(), self.unheard());
            if (mindless.len(), unheard.len()) != told {
                told = (mindless.len(), unheard.len());
                let scenario = self.contest.scenario();
                let [minds, gateways] = [&mindless, &unheard]
                    .map(|list| list.iter().map(|v| scenario.vehicles[v.index()].name.as_str()).collect());
                tell(News::Waiting { minds, gateways });
                self.is_news = true;
            }
            self.tell_run(Phase::Waiting, 0.0)?;
            if told == (0, 0) || self.is_stopped() {
                break;
            }
            if clock::since(start) >= limit {
                self.lose_agents(mindless);
                break;
            }
            self.listen(Duration::from_millis(100));
        }
        self.last_news = (clock::now(), SimTime::ZERO);
        self.heard.fill(clock::now());
        Ok(())
    }

    /// The real boats that have not been heard of, or whose gateway is gone again.
    fn unheard(&self) -> Vec<VehicleId> {
        let is_missing = |(v, is_moored): &(VehicleId, bool)| !is_moored || !self.contest.is_heard(*v);
        self.gateways.externals().filter(is_missing).map(|(vehicle, _)| vehicle).collect()
    }

    /// Shows the recorder how it stands, and what led to it.
    pub(super) fn record(&mut self) {
        self.recorder.turn(&mut self.contest);
    }

    /// Sends observers the truth, if there are any.
    pub(super) fn show(&mut self) -> Result<(), NodeError> {
        if !self.frames.is_heard() {
            return Ok(());
        }
        let frame = self.contest.frame();
        Ok(self.frames.send(&frame)?)
    }

    /// Sends every team the picture of the open decision, and every real boat its order. Sending them twice does no harm.
    pub(super) fn ask(&mut self) -> Result<(), NodeError> {
        self.opened = Some(clock::now());
        let is_again = self.asked.replace(self.contest.decision()) == Some(self.contest.decision());
        let pictures: Vec<Vec<u8>> = self.contest.pictures().iter().map(codec::encode).collect();
        for (i, bytes) in pictures.into_iter().enumerate() {
            if self.is_recorded && !is_again {
                let topic = format!("picture/{}", self.contest.scenario().teams[i].name);
                self.write_down(topic, Some(Picture::SCHEMA), bytes.clone());
            }
            self.pictures[i].send_encoded::<Picture>(bytes)?;
        }
        (0..self.helms.len()).try_for_each(|i| self.pass_on(self.helms[i].0))
    }

    /// Sends a real boat the order in force for it; holding, where that is older than it may grow. For simulated boats
    /// there is nothing to send.
    fn pass_on(&mut self, vehicle: VehicleId) -> Result<(), NodeError> {
        let Some(helm) = self.helms.iter().position(|(boat, _)| *boat == vehicle) else { return Ok(()) };
        let age_s = (self.contest.now() - self.ordered_at[vehicle.index()]).as_s();
        let is_old = age_s > self.contest.scenario().order_ttl_s;
        let holds = is_old || self.pacing.is_held();
        self.send_order(helm, if holds { Order::Hold } else { self.contest.obeyed(vehicle) })
    }

    fn send_order(&mut self, helm: usize, order: Order) -> Result<(), NodeError> {
        let (vehicle, helm) = &self.helms[helm];
        let vehicle = *vehicle;
        if !helm.is_heard() {
            return Ok(());
        }
        let (valid_ns, seq) = (self.contest.now(), self.contest.decision());
        let stamp = Stamp { valid_ns, seq, version: ExternalOrder::VERSION };
        let given_ns = self.ordered_at[vehicle.index()];
        let order = ExternalOrder { stamp, given_ns, order: VehicleOrder::new(vehicle, order) };
        helm.send(&order)?;
        if self.is_recorded {
            let topic = format!("external/{}", self.contest.scenario().vehicles[vehicle.index()].name);
            self.write_down(topic, Some(ExternalOrder::SCHEMA), codec::encode(&order));
        }
        Ok(())
    }

    /// Takes in what comes, waiting up to `limit` for the first of it.
    pub(super) fn listen(&mut self, limit: Duration) {
        let mut next = self.inbox.take(limit);
        while let Some(call) = next {
            match call {
                Incoming::Orders(bytes) => self.take_orders(&bytes),
                Incoming::Nav(bytes) => self.take_nav(&bytes),
                Incoming::Join(question) => self.let_in(question),
                Incoming::Moor(question) => self.moor(question),
                Incoming::Scenario(question) => question.answer(self.notice.clone()),
                Incoming::Events(question) => question.answer(observers::story(&self.contest)),
                Incoming::Water(question) => question.answer(observers::water_json(&self.contest)),
                Incoming::RecordedMessage(i, bytes) => {
                    let RecordedTopic { topic, schema, is_sound } = &self.recorded_topics[i];
                    if is_sound(&bytes) {
                        self.write_down(topic.clone(), *schema, bytes);
                    } else {
                        self.refused.garbage += 1;
                    }
                }
                Incoming::Gone(Part::Gateway, gateway) => self.gateways.gone(&gateway),
                Incoming::Gone(_, agent) => {
                    let vehicles = self.agents.gone(&agent);
                    self.lose_agents(vehicles);
                }
                Incoming::Control(bytes) => self.obey(&bytes),
            }
            next = self.inbox.take_now();
        }
    }

    /// Gives up on minds that have not answered the open tick.
    pub(super) fn give_up(&mut self, tick: u64) {
        let vehicles = self.agents.give_up(tick);
        self.lose_agents(vehicles);
    }

    /// Gives up on minds that have not been heard for this long.
    pub(super) fn lose_silent(&mut self, patience: Duration) {
        for i in 0..self.heard.len() {
            if clock::since(self.heard[i]) > patience {
                let vehicles = self.agents.lose_agent_of(VehicleId::at(i));
                self.lose_agents(vehicles);
            }
        }
    }

    /// These vehicles have no mind any more; real boats are told so at once.
    fn lose_agents(&mut self, vehicles: Vec<VehicleId>) {
        for vehicle in vehicles {
            self.contest.lose_agent(vehicle);
            self.pass_on_now(vehicle);
        }
    }

    /// Whether the game is to end early.
    pub(super) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Everything that was refused so far.
    pub(super) fn refused(&self) -> Refused {
        let flood = Refused { flood: self.inbox.dropped(), ..Refused::default() };
        self.refused + self.agents.refused + self.gateways.refused + flood
    }

    /// Tells progress, if it is time again.
    pub(super) fn tell_progress(&mut self, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
        let (then, then_sim) = self.last_news;
        let passed = clock::since(then);
        if passed < NEWS_EVERY && !self.is_news {
            return Ok(());
        }
        let rate = (self.contest.now() - then_sim).as_s() / passed.as_secs_f64().max(1e-3);
        self.last_news = (clock::now(), self.contest.now());
        tell(News::Progress { contest: &self.contest, rate, refused: self.refused() });
        self.tell_run(if self.pacing.is_paused() { Phase::Paused } else { Phase::Playing }, rate)
    }

    /// Tells observers how the run stands, if there are any.
    fn tell_run(&mut self, phase: Phase, rate: f64) -> Result<(), NodeError> {
        let is_news = std::mem::take(&mut self.is_news);
        let is_due = self.is_recorded && (is_news || clock::since(self.written) >= WRITE_EVERY);
        if !self.run.is_heard() && !is_due {
            return Ok(());
        }
        let scenario = self.contest.scenario();
        let names = |list: Vec<VehicleId>| list.iter().map(|v| scenario.vehicles[v.index()].name.clone()).collect();
        let is_waiting = phase == Phase::Waiting;
        let state = RunState {
            phase,
            now_s: self.contest.now().as_s(),
            pace: self.pace.to_string(),
            speed: self.pacing.speed(),
            rate,
            minds: if is_waiting { names(self.agents.mindless()) } else { vec![] },
            gateways: if is_waiting { names(self.unheard()) } else { vec![] },
            refused: self.refused().total(),
            overruns: self.overruns,
            recording: self.recorder.state(),
        };
        let json = serde_json::to_vec(&state).expect("a state is JSON");
        self.run.send_json(json.clone())?;
        if is_due {
            self.written = clock::now();
            self.write_down("run", None, json);
        }
        Ok(())
    }

    /// Shows the recorder something that goes over the network.
    fn write_down(&mut self, topic: impl Into<String>, schema: Option<&'static str>, bytes: Vec<u8>) {
        self.recorder.heard(RecordedMessage { topic: topic.into(), schema, bytes, at: self.contest.now() });
    }

    /// Tells everybody that it is over, and waits a little for the agents to leave.
    pub(super) fn say_good_bye(&mut self) -> Result<(), NodeError> {
        for (picture, line) in self.contest.pictures().to_vec().into_iter().zip(&self.pictures) {
            line.send(&game::Picture { over: true, ..picture })?;
        }
        let frame = game::message::Frame { over: true, ..self.contest.frame() };
        self.frames.send(&frame)?;
        // Real boats hold from now on, also where the game is cut short.
        (0..self.helms.len()).try_for_each(|helm| self.send_order(helm, Order::Hold))?;
        self.is_news = true;
        self.tell_run(Phase::Over, 0.0)?;
        let start = clock::now();
        while self.agents.present() > 0 && clock::since(start) < GOOD_BYE {
            self.listen(Duration::from_millis(20));
        }
        self._standing.clear();
        self.bus.close();
        Ok(())
    }

    fn take_orders(&mut self, bytes: &[u8]) {
        let message: Orders = match codec::decode(bytes) {
            Ok(message) => message,
            Err(DecodeError::Version { .. }) => return self.refused.version += 1,
            Err(_) => return self.refused.garbage += 1,
        };
        let Accepted { orders, back } = self.agents.take(&message, self.contest.decision());
        back.into_iter().for_each(|vehicle| self.contest.regain_agent(vehicle));
        let Stamp { valid_ns, .. } = message.stamp;
        // An order cannot be fresher than the newest picture.
        let given = valid_ns.min(self.contest.now());
        for (vehicle, order) in orders {
            self.contest.order(vehicle, order);
            self.ordered_at[vehicle.index()] = given;
            self.heard[vehicle.index()] = clock::now();
            self.pass_on_now(vehicle);
        }
    }

    /// Sends a real boat its order between two decisions. That the session is closed shows at the next of them.
    fn pass_on_now(&mut self, vehicle: VehicleId) {
        self.pass_on(vehicle).unwrap_or_default();
    }

    fn take_nav(&mut self, bytes: &[u8]) {
        let report: NavReport = match codec::decode(bytes) {
            Ok(report) => report,
            Err(DecodeError::Version { .. }) => return self.refused.version += 1,
            Err(_) => return self.refused.garbage += 1,
        };
        if self.is_recorded
            && let Some(vehicle) = self.contest.scenario().vehicles.get(report.vehicle.index())
        {
            let topic = format!("nav/{}", vehicle.name);
            self.write_down(topic, Some(NavReport::SCHEMA), bytes.to_vec());
        }
        let Some(sighted) = self.gateways.take(&report, self.moment()) else { return };
        let taken = self.contest.report(sighted.vehicle, sighted.nav, sighted.fix_at, sighted.valid);
        self.refused.bad_number += u64::from(taken.is_err());
    }

    /// Simulated time by the clock: the open decision's, and what has passed since it was opened. Only fixes are told the
    /// time by it: a fix would seem up to a decision older than it is otherwise.
    fn moment(&self) -> SimTime {
        let factor = if self.pace == Pace::Lockstep { 0.0 } else { self.pacing.speed().unwrap_or(0.0) };
        let passed = self.opened.map_or(0.0, |opened| clock::since(opened).as_secs_f64() * factor);
        self.contest.now() + SimTime::from_s(passed).min(self.contest.scenario().decision())
    }

    fn moor(&mut self, question: Query) {
        let reply = match serde_json::from_slice::<JoinRequest>(&question.payload) {
            Ok(request) => self.gateways.moor(&request, new_ticket()),
            Err(e) => JoinReply::Refused { reason: format!("the request is not understood: {e}") },
        };
        question.answer(serde_json::to_vec(&reply).expect("a reply is JSON"));
    }

    fn let_in(&mut self, question: Query) {
        let reply = match serde_json::from_slice::<JoinRequest>(&question.payload) {
            Ok(request) => self.agents.join(&request, new_ticket()),
            Err(e) => JoinReply::Refused { reason: format!("the request is not understood: {e}") },
        };
        if let JoinReply::Granted { vehicles, .. } = &reply {
            for vehicle in vehicles {
                self.contest.hold(*vehicle);
                self.contest.regain_agent(*vehicle);
                self.heard[vehicle.index()] = clock::now();
            }
        }
        question.answer(serde_json::to_vec(&reply).expect("a reply is JSON"));
    }

    fn obey(&mut self, bytes: &[u8]) {
        let Ok(control) = serde_json::from_slice(bytes) else { return self.refused.garbage += 1 };
        match control {
            Control::Stop => self.stop.store(true, Ordering::Relaxed),
            Control::EStop => self.contest.e_stop(true),
            Control::Release => self.contest.e_stop(false),
            Control::Halt => self.contest.halt(true),
            Control::GoOn => self.contest.halt(false),
            pacing => self.refused.out_of_place += u64::from(!self.pacing.obey(pacing)),
        }
        self.is_news = true;
        // An object, since all JSON in a recording is.
        let json = serde_json::json!({"control": control}).to_string();
        self.write_down("control", None, json.into_bytes());
        (0..self.helms.len()).for_each(|i| self.pass_on_now(self.helms[i].0));
    }

    /// Whether the game stands still, paused by somebody: then minds and boats are kept, and who calls is heard.
    pub(super) fn stand_still(&mut self, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
        /// Minds that hear nothing for too long leave.
        const SEND_AGAIN: Duration = Duration::from_secs(1);
        if !self.pacing.is_held() {
            return Ok(());
        }
        let mut sent = clock::now();
        while self.pacing.is_held() && !self.is_stopped() {
            self.listen(Duration::from_millis(50));
            self.tell_progress(tell)?;
            if clock::since(sent) >= SEND_AGAIN {
                self.ask()?;
                sent = clock::now();
            }
        }
        // Whoever was silent meanwhile had nothing to answer.
        self.heard.fill(clock::now());
        Ok(())
    }
}

/// A number nobody can guess: the standard library's hasher is keyed by the operating system's randomness.
fn new_ticket() -> u64 {
    RandomState::new().build_hasher().finish()
}
