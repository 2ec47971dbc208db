//! The game server: the contest, its members, and messages to agents, gateways and observers.

mod incoming;

use super::control_inbox::ControlInbox;
use super::membership::Membership;
use super::message_inbox::MessageInbox;
use super::observers::{self, RecordedTopic};
use super::pacing::Pacing;
use super::settings::{NodeError, Pace, Settings};
use super::subscriptions::{self, Inboxes, Question};
use super::throttle::Throttle;
use super::working_time::WorkingTime;
use crate::contest::Contest;
use crate::progress::{ProgressMessage, Reporter};
use crate::recorder::GameRecorder;
use bus::stop::HubStopPort;
use bus::token::Guard;
use bus::{Bus, Declaration, Delivery, Inbox, Priority, Publisher, Query, clock, inbox};
use messages::external::{ExternalOrder, Reported};
use messages::refusal::{Refusal, Refusals};
use messages::run_state::{Phase, RunState};
use messages::topic::{self, GameName};
use messages::{Frame, GameInfo, Message, Order, Picture, Role, Stamp, VehicleOrder};
use primitives::{SimTime, TeamId, VehicleId, codec};
use recording::Entry;
use rules::event::EventCursor;
use scenario::Scenario;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Maximum number of unanswered questions.
const QUESTIONS: usize = 64;
/// Period of progress reports.
const REPORT_EVERY: Duration = Duration::from_millis(100);
/// Interval at which an unchanged run state is recorded.
const RECORD_EVERY: Duration = Duration::from_secs(1);
/// Time limit for agents to leave when the game is over.
const SHUTDOWN: Duration = Duration::from_secs(2);
/// Time after which the end of the game is sent again to agents that have not left.
const SEND_END_AGAIN: Duration = Duration::from_millis(200);

pub(super) struct GameServer<'w> {
    pub(super) contest: Contest,
    /// The scenario before the values of a seed are drawn.
    scenario: &'w Scenario,
    /// The game that replaces this one after a reset.
    next: Option<Contest>,
    pub(super) pacing: Pacing,
    recorder: Option<&'w mut GameRecorder>,
    pub(super) agents: Membership,
    gateways: Membership,
    controls: Arc<ControlInbox<Query>>,
    questions: Inbox<(Question, Query)>,
    inbox: Arc<MessageInbox>,
    bus: Bus,
    pictures: Vec<Publisher>,
    /// Limits on the pictures sent, by team; only used in real time.
    throttles: Vec<Throttle>,
    /// Subscriptions to the bytes of boats' links, while they are recorded or observed.
    link_reports: BTreeMap<VehicleId, Declaration>,
    /// The decision whose pictures were sent last.
    asked: Option<u64>,
    frames: Publisher,
    /// Position in the events when the last frame was built.
    shown: EventCursor,
    /// The last frame built.
    frame: Option<Arc<Frame>>,
    run: Publisher,
    /// Publishes the release of an E-stop.
    released: Publisher,
    guard: Guard,
    game: GameName,
    /// Whether an operator request has arrived since the run state was last sent.
    is_news: bool,
    /// When the run state was last recorded.
    run_recorded: Instant,
    pub(super) overruns: u64,
    /// Topics subscribed to only for the recorder.
    recorded_topics: Vec<RecordedTopic>,
    /// Publishers of gateway reports for other nodes.
    reports: BTreeMap<(VehicleId, Reported), Publisher>,
    /// Publishers of commands, by real boat.
    external_orders: Vec<(VehicleId, Publisher)>,
    /// The reply to the query for the game's description.
    game_info: Vec<u8>,
    stop: Arc<AtomicBool>,
    refusals: Refusals,
    /// When each vehicle's agent was last heard from, in working time.
    heard: Vec<Duration>,
    pub(super) time: WorkingTime,
    pub(super) reporter: Reporter,
    last_report: (Instant, SimTime),
    /// When the open decision was opened, once the game runs.
    opened: Option<Instant>,
    pace: Pace,
    declarations: Vec<Declaration>,
    _stop_port: HubStopPort,
}

impl<'w> GameServer<'w> {
    /// Opens the hub, so that nodes can join.
    pub(super) fn open(
        mut contest: Contest,
        undrawn: &'w Scenario,
        settings: &Settings,
        recorder: Option<&'w mut GameRecorder>,
    ) -> Result<GameServer<'w>, NodeError> {
        // The hub needs the scenario, because its access rules list every topic by team and boat.
        let bus = Bus::hub(&settings.net, &settings.game, contest.scenario())?;
        let (questions_sender, questions) = inbox(QUESTIONS);
        let controls = Arc::new(ControlInbox::default());
        let messages = Arc::new(MessageInbox::default());
        let others = Arc::clone(&messages);
        let inboxes = Inboxes {
            controls: Arc::clone(&controls),
            questions: questions_sender,
            others,
        };
        let game = &settings.game;
        // Keeping a game's inputs takes memory, and only the recorder reads them.
        if recorder.is_some() {
            contest.keep_inputs();
        }
        let scenario = contest.scenario();
        let recorded_topics = if recorder.is_some() {
            observers::recorded_topics(scenario)
        } else {
            vec![]
        };
        let declarations = subscriptions::open(&bus, game, scenario, &inboxes, &recorded_topics)?;
        let is_lockstep = settings.pace == Pace::Lockstep;
        let speed = if let Pace::Realtime { factor } = settings.pace {
            Some(factor)
        } else {
            settings.speed
        };
        let delivery = Delivery::per_decision(is_lockstep);
        let teams = (0..scenario.teams.len())
            .map(|team| topic::picture(game, scenario, TeamId(team as u8)));
        let pictures = teams
            .map(|key| bus.publisher_with(key, Priority::Normal, delivery))
            .collect::<Result<_, _>>()?;
        // Commands to boats are urgent: they overtake all other waiting messages on a link.
        let urgent = |key| bus.publisher_with(key, Priority::Urgent, Delivery::Newest);
        let to_boat = |v| Ok((v, urgent(topic::external_order(game, scenario, v))?));
        let external_orders: Vec<_> = scenario
            .externals()
            .map(to_boat)
            .collect::<Result<_, NodeError>>()?;
        let reports = subscriptions::report_publishers(&bus, game, scenario)?;
        let real: Vec<String> = scenario
            .externals()
            .map(|v| scenario.vehicles[v.index()].name.clone())
            .collect();
        let stop_port = HubStopPort::open(&bus, &settings.net, game, &real)?;
        Ok(GameServer {
            scenario: undrawn,
            next: None,
            agents: Membership::new(scenario, Role::Agent),
            gateways: Membership::new(scenario, Role::Gateway),
            controls,
            questions,
            inbox: messages,
            time: WorkingTime::new(clock::now()),
            pictures,
            link_reports: BTreeMap::new(),
            throttles: scenario
                .teams
                .iter()
                .filter(|_| !is_lockstep)
                .map(|_| Throttle::new(clock::now()))
                .collect(),
            asked: None,
            external_orders,
            reports,
            frames: bus.publisher_with(topic::frame(game), Priority::Normal, delivery)?,
            shown: EventCursor::default(),
            frame: None,
            run: bus.publisher(topic::run(game), Priority::Normal)?,
            released: bus.publisher(topic::released(game), Priority::Urgent)?,
            guard: Guard::new(settings.net.token.clone()),
            game: game.clone(),
            is_news: false,
            run_recorded: clock::now(),
            overruns: 0,
            recorded_topics,
            pacing: Pacing::new(speed, is_lockstep, !real.is_empty()),
            recorder,
            game_info: game_info(scenario, settings.pace),
            stop: Arc::clone(&settings.stop),
            refusals: Refusals::default(),
            heard: vec![Duration::ZERO; scenario.vehicles.len()],
            reporter: Reporter::default(),
            last_report: (clock::now(), SimTime::ZERO),
            opened: None,
            pace: settings.pace,
            declarations,
            _stop_port: stop_port,
            bus,
            contest,
        })
    }

    /// If the game was reset, replaces it with the next one and returns true. All agents must then
    /// join again.
    pub(super) fn restart(&mut self) -> bool {
        let Some(next) = self.next.take() else {
            return false;
        };
        self.contest = next;
        self.agents = Membership::new(self.contest.scenario(), Role::Agent);
        self.game_info = game_info(self.contest.scenario(), self.pace);
        (self.frame, self.shown) = (None, EventCursor::default());
        self.reporter = Reporter::default();
        self.overruns = 0;
        true
    }

    /// Waits until every vehicle has an agent and every real boat has reported, up to the time
    /// limit. Then marks the agents that are still missing as lost.
    pub(super) fn wait_for_everybody(
        &mut self,
        limit: Duration,
        tell: &mut dyn FnMut(ProgressMessage),
    ) -> Result<(), NodeError> {
        let start = clock::now();
        let mut told = (usize::MAX, usize::MAX);
        loop {
            let vacant: Vec<VehicleId> = self.agents.vacant().collect();
            let silent: Vec<VehicleId> = self.silent_boats().collect();
            if (vacant.len(), silent.len()) != told {
                told = (vacant.len(), silent.len());
                let [agents, gateways] =
                    [&vacant, &silent].map(|vehicles| self.names_of(vehicles.iter().copied()));
                tell(ProgressMessage::Waiting { agents, gateways });
                self.is_news = true;
            }
            self.send_run(Phase::Waiting, 0.0)?;
            if self.asked.is_some() {
                // Agents of a game that was reset join again when they see its first picture.
                self.send_pictures()?;
                self.send_frame()?;
            }
            if told == (0, 0) || self.is_stopped() {
                break;
            }
            if clock::since(start) >= limit {
                self.lose_agents(vacant);
                break;
            }
            self.listen(Duration::from_millis(100));
        }
        self.last_report = (clock::now(), SimTime::ZERO);
        // The first agents have waited for the last, so their silence so far does not count.
        self.heard.fill(self.time.worked);
        Ok(())
    }

    /// The real boats that have not reported, or whose gateway has left.
    fn silent_boats(&self) -> impl Iterator<Item = VehicleId> {
        let is_vacant = |vehicle: VehicleId| self.gateways.vacant().any(|vacant| vacant == vehicle);
        let externals = self.contest.scenario().externals();
        externals.filter(move |vehicle| is_vacant(*vehicle) || !self.contest.has_position(*vehicle))
    }

    fn name_of(&self, vehicle: VehicleId) -> &str {
        &self.contest.scenario().vehicles[vehicle.index()].name
    }

    fn names_of(&self, vehicles: impl Iterator<Item = VehicleId>) -> Vec<String> {
        vehicles
            .map(|vehicle| self.name_of(vehicle).to_owned())
            .collect()
    }

    /// The frame of the open decision, built once for recording and observers.
    fn frame(&mut self) -> Arc<Frame> {
        let decision = self.contest.decision();
        let frame = self
            .frame
            .take()
            .filter(|frame| frame.stamp.seq == decision);
        let frame = frame.unwrap_or_else(|| Arc::new(self.contest.frame(&mut self.shown)));
        self.frame = Some(Arc::clone(&frame));
        frame
    }

    /// Records the open decision and its inputs.
    pub(super) fn record(&mut self) {
        if self.recorder.is_some() {
            let frame = self.frame();
            self.recorder
                .iter_mut()
                .for_each(|recorder| recorder.decision(&mut self.contest, Arc::clone(&frame)));
        }
    }

    /// Publishes the frame if there are observers.
    pub(super) fn send_frame(&mut self) -> Result<(), NodeError> {
        // Otherwise each lockstep decision would spend time encoding a frame that no one reads.
        if !self.frames.is_heard() {
            return Ok(());
        }
        let frame = self.frame();
        Ok(self.frames.send(&*frame)?)
    }

    /// Sends every team its picture of the open decision, and every real boat its order. Sending
    /// them twice is harmless.
    pub(super) fn send_pictures(&mut self) -> Result<(), NodeError> {
        // Reports of real boats arrive while a decision is open. The times of their fixes are
        // computed from this moment.
        self.opened = Some(clock::now());
        // Pictures are sent again until they are answered, but recorded once.
        let is_again = self.asked.replace(self.contest.decision()) == Some(self.contest.decision());
        let pictures: Vec<Vec<u8>> = self.contest.pictures().iter().map(codec::encode).collect();
        for (i, bytes) in pictures.into_iter().enumerate() {
            if self.recorder.is_some() && !is_again {
                let topic = format!("picture/{}", self.contest.scenario().teams[i].name);
                self.record_message(topic, Some(Picture::SCHEMA), bytes.clone());
            }
            if self
                .throttles
                .get_mut(i)
                .is_none_or(|throttle| throttle.admits(clock::now()))
            {
                self.pictures[i].send_encoded::<Picture>(bytes)?;
            }
        }
        (0..self.external_orders.len()).try_for_each(|i| self.pass_on(self.external_orders[i].0))
    }

    /// Sends a real boat its effective command, or hold while the game is paused. No effect on
    /// simulated boats.
    fn pass_on(&mut self, vehicle: VehicleId) -> Result<(), NodeError> {
        let Some(boat) = self
            .external_orders
            .iter()
            .position(|(boat, _)| *boat == vehicle)
        else {
            return Ok(());
        };
        // A paused game must not leave a real boat moving on its last order.
        let is_held = self.pacing.is_held();
        self.send_order(
            boat,
            if is_held {
                Order::Hold
            } else {
                self.contest.effective_command(vehicle)
            },
        )
    }

    fn send_order(&mut self, boat: usize, order: Order) -> Result<(), NodeError> {
        let (vehicle, publisher) = &self.external_orders[boat];
        let vehicle = *vehicle;
        if !publisher.is_heard() {
            return Ok(());
        }
        let valid_ns = self.contest.now();
        let seq = self.contest.decision();
        let stamp = Stamp {
            valid_ns,
            seq,
            version: ExternalOrder::VERSION,
        };
        // The gateway computes an order's age from the time of the answered picture, however often
        // the order is repeated.
        let given_ns = self.contest.given_at(vehicle);
        let order = ExternalOrder {
            stamp,
            given_ns,
            order: VehicleOrder::new(vehicle, order),
            others_m: self.contest.other_real_boats_m(vehicle),
        };
        let bytes = codec::encode(&order);
        publisher.send_encoded::<ExternalOrder>(bytes.clone())?;
        if self.recorder.is_some() {
            let topic = format!("external/{}", self.name_of(vehicle));
            self.record_message(topic, Some(ExternalOrder::SCHEMA), bytes);
        }
        Ok(())
    }

    /// Drops agents that have not answered the open decision.
    pub(super) fn give_up(&mut self, tick: u64) {
        let vehicles = self.agents.give_up(tick);
        self.lose_agents(vehicles);
    }

    /// Drops agents that have been silent for longer than the scenario allows.
    pub(super) fn lose_silent(&mut self) {
        // Measure in working time, not by the clock: agents must not be blamed for silence while
        // the sim was suspended.
        let patience = Duration::from_secs_f64(self.contest.scenario().patience_s);
        for i in 0..self.heard.len() {
            if self.time.worked.saturating_sub(self.heard[i]) > patience {
                let vehicles = self.agents.lose_holder_of(VehicleId::at(i));
                self.lose_agents(vehicles);
            }
        }
    }

    /// Marks the agents of these vehicles as lost. Real boats get their new orders at once.
    fn lose_agents(&mut self, vehicles: Vec<VehicleId>) {
        for vehicle in vehicles {
            self.contest.lose_agent(vehicle);
            self.pass_on_now(vehicle);
        }
    }

    /// Whether the game should end early, for good or for a restart.
    pub(super) fn is_stopped(&self) -> bool {
        self.next.is_some() || self.stop.load(Ordering::Relaxed)
    }

    /// All refusals so far.
    pub(super) fn refusals(&self) -> Refusals {
        let dropped = Refusals::from([(Refusal::Flood, self.questions.dropped())]);
        self.refusals + self.inbox.refusals() + self.controls.refusals() + dropped
    }

    pub(super) fn report_progress(
        &mut self,
        tell: &mut dyn FnMut(ProgressMessage),
    ) -> Result<(), NodeError> {
        let (then, then_sim) = self.last_report;
        let passed = clock::since(then);
        if passed < REPORT_EVERY && !self.is_news {
            return Ok(());
        }
        // The rate over zero time would be infinite, and the page could not plot it.
        let rate = (self.contest.now() - then_sim).as_s() / passed.as_secs_f64().max(1e-3);
        self.last_report = (clock::now(), self.contest.now());
        self.reporter
            .progress(&self.contest, (rate, self.refusals().total()), tell);
        self.send_run(
            if self.pacing.is_paused {
                Phase::Paused
            } else {
                Phase::Playing
            },
            rate,
        )
    }

    /// Subscribes to the bytes of a boat's link while they are recorded or observed. A gateway
    /// behind a slow link sends them only then, since they are most of its traffic.
    fn follow_links(&mut self) -> Result<(), NodeError> {
        let scenario = self.contest.scenario();
        for vehicle in scenario.externals() {
            let publisher = self.reports.get(&(vehicle, Reported::Link));
            let is_wanted = self.recorder.is_some() || publisher.is_some_and(Publisher::is_heard);
            if !is_wanted {
                self.link_reports.remove(&vehicle);
            } else if !self.link_reports.contains_key(&vehicle) {
                let what = (vehicle, Reported::Link);
                let inbox = Arc::clone(&self.inbox);
                let subscription =
                    subscriptions::subscribe_report(&self.bus, &self.game, scenario, what, inbox)?;
                self.link_reports.insert(vehicle, subscription);
            }
        }
        Ok(())
    }

    /// Publishes the run state if there are observers.
    fn send_run(&mut self, phase: Phase, rate: f64) -> Result<(), NodeError> {
        self.follow_links()?;
        let is_news = std::mem::take(&mut self.is_news);
        let is_due =
            self.recorder.is_some() && (is_news || clock::since(self.run_recorded) >= RECORD_EVERY);
        if !self.run.is_heard() && !is_due {
            return Ok(());
        }
        let is_waiting = phase == Phase::Waiting;
        let state = RunState {
            phase,
            now_s: self.contest.now().as_s(),
            pace: self.pace.to_string(),
            speed: self.pacing.speed,
            rate,
            minds: self.names_of(self.agents.vacant().filter(|_| is_waiting)),
            gateways: self.names_of(self.silent_boats().filter(|_| is_waiting)),
            refused: self.refusals().total(),
            overruns: self.overruns,
            recording: self.recorder.as_ref().map(|recorder| recorder.state()),
        };
        let json = serde_json::to_vec(&state).expect("a state is JSON");
        self.run.send_json(json.clone())?;
        if is_due {
            self.run_recorded = clock::now();
            self.record_message("run", None, json);
        }
        Ok(())
    }

    /// Passes a network message to the recorder.
    fn record_message(
        &mut self,
        topic: impl Into<String>,
        schema: Option<&'static str>,
        bytes: Vec<u8>,
    ) {
        if let Some(recorder) = &self.recorder {
            recorder.message(Entry::Message {
                topic: topic.into(),
                schema,
                bytes,
                at: self.contest.now(),
            });
        }
    }

    /// Sends the end of the game to all nodes and waits briefly for agents to leave.
    pub(super) fn shut_down(&mut self) -> Result<(), NodeError> {
        self.send_end()?;
        let frame = Frame {
            over: true,
            ..Frame::clone(&self.frame())
        };
        self.frames.send(&frame)?;
        // Real boats hold from now on, even if the game ends early.
        (0..self.external_orders.len()).try_for_each(|boat| self.send_order(boat, Order::Hold))?;
        self.is_news = true;
        self.send_run(Phase::Over, 0.0)?;
        let start = clock::now();
        let mut sent = start;
        // Any message may be lost. An agent that misses this one reports a lost sim; an agent that
        // leaves has received it. The wait is limited, because an agent may hang.
        while !self.agents.is_empty() && clock::since(start) < SHUTDOWN {
            self.listen(Duration::from_millis(20));
            if clock::since(sent) >= SEND_END_AGAIN {
                self.send_end()?;
                sent = clock::now();
            }
        }
        self.declarations.clear();
        self.bus.close();
        Ok(())
    }

    /// Sends all agents the last pictures.
    fn send_end(&mut self) -> Result<(), NodeError> {
        let pictures = self
            .contest
            .pictures()
            .to_vec()
            .into_iter()
            .zip(&self.pictures);
        for (picture, publisher) in pictures {
            publisher.send(&messages::Picture {
                over: true,
                ..picture
            })?;
        }
        Ok(())
    }

    /// Sends a real boat its order between two decisions. If the session has closed, the next
    /// decision returns the error.
    fn pass_on_now(&mut self, vehicle: VehicleId) {
        self.pass_on(vehicle).unwrap_or_default();
    }

    /// Waits while the game is paused: keeps agents and boats alive, and reads messages.
    pub(super) fn stay_paused(
        &mut self,
        tell: &mut dyn FnMut(ProgressMessage),
    ) -> Result<(), NodeError> {
        /// Interval at which messages are repeated: agents leave if they receive nothing for too
        /// long.
        const SEND_AGAIN: Duration = Duration::from_secs(1);
        let mut sent = clock::now();
        while self.pacing.is_held() && !self.is_stopped() {
            self.listen(Duration::from_millis(50));
            self.report_progress(tell)?;
            if clock::since(sent) >= SEND_AGAIN {
                self.send_pictures()?;
                sent = clock::now();
            }
        }
        // Agents had nothing to reply to meanwhile, so their silence does not count.
        self.heard.fill(self.time.worked);
        Ok(())
    }
}

/// The reply to the query for the game's description.
fn game_info(scenario: &Scenario, pace: Pace) -> Vec<u8> {
    let info = GameInfo {
        version: primitives::VERSION.to_owned(),
        pace: pace.to_string(),
        scenario: scenario.clone(),
    };
    serde_json::to_vec(&info).expect("a scenario is JSON")
}
