//! The referee's booth: the contest, the roster, and the lines to agents and observers.

use super::clock;
use super::roster::{Accepted, Refused, Roster, Timing};
use super::{News, NodeError, Pace, Settings};
use crate::contest::Contest;
use bus::{Bus, Delivery, Inbox, Publisher, Question, Standing, inbox};
use game::codec::{self, DecodeError};
use game::message::{Control, JoinReply, JoinRequest, Notice, Orders, Stamp};
use game::topic::{self, Part};
use game::{SimTime, TeamId, VehicleId};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Calls that may wait to be looked at.
const INBOX: usize = 8192;
/// How often progress is told.
const NEWS_EVERY: Duration = Duration::from_millis(100);
/// How long the last words may take to reach everybody.
const GOOD_BYE: Duration = Duration::from_secs(2);

/// What comes in from the network.
enum Call {
    Orders(Vec<u8>),
    Join(Question),
    Scenario(Question),
    Gone(String),
    Control(Vec<u8>),
}

/// Everything a served game needs.
pub(super) struct Booth {
    pub(super) contest: Contest,
    pub(super) roster: Roster,
    inbox: Inbox<Call>,
    bus: Bus,
    pictures: Vec<Publisher>,
    frames: Publisher,
    /// Answers the question what the game is.
    notice: Vec<u8>,
    stop: Arc<AtomicBool>,
    refused: Refused,
    /// When the orders in force were given, by vehicle: time of the picture they answer.
    pub(super) ordered_at: Vec<SimTime>,
    /// When each vehicle's mind was last heard.
    heard: Vec<Instant>,
    last_news: (Instant, SimTime),
    _standing: Vec<Standing>,
}

impl Booth {
    /// Opens the hub and the door.
    pub(super) fn open(contest: Contest, settings: &Settings, timing: Timing) -> Result<Booth, NodeError> {
        let bus = Bus::hub(&settings.net)?;
        let (outlet, inbox) = inbox(INBOX);
        let game = &settings.game;
        let scenario = contest.scenario();
        let on = |call: fn(Vec<u8>) -> Call| {
            let outlet = outlet.clone();
            move |bytes: &[u8]| outlet.put(call(bytes.to_vec()))
        };
        let asked = |call: fn(Question) -> Call| {
            let outlet = outlet.clone();
            move |question| outlet.put(call(question))
        };
        let gone = outlet.clone();
        let watch = move |key: &str, alive: bool| {
            if let (Some((_, Part::Agent, agent)), false) = (topic::parse_alive(key), alive) {
                gone.put(Call::Gone(agent));
            }
        };
        let standing = vec![
            bus.subscribe(topic::all_orders(game), on(Call::Orders))?,
            bus.subscribe(topic::control(game), on(Call::Control))?,
            bus.watch_alive(topic::all_alive(game, Part::Agent), watch)?,
            bus.answer(topic::scenario(game), asked(Call::Scenario))?,
            bus.answer(topic::join(game), asked(Call::Join))?,
            bus.show_alive(topic::alive(game, Part::Sim, &bus.id()))?,
        ];
        let delivery = if settings.pace == Pace::Lockstep { Delivery::Wait } else { Delivery::Drop };
        let teams = (0..scenario.teams.len()).map(|team| topic::picture(game, scenario, TeamId(team as u8)));
        let pictures: Result<Vec<Publisher>, _> = teams.map(|key| bus.publisher(key, delivery)).collect();
        let notice =
            Notice { version: game::VERSION.to_owned(), pace: settings.pace.to_string(), scenario: scenario.clone() };
        Ok(Booth {
            roster: Roster::new(scenario, timing),
            inbox,
            pictures: pictures?,
            frames: bus.publisher(topic::frame(game), Delivery::Drop)?,
            notice: serde_json::to_vec(&notice).expect("a scenario is JSON"),
            stop: Arc::clone(&settings.stop),
            refused: Refused::default(),
            ordered_at: vec![SimTime::ZERO; scenario.vehicles.len()],
            heard: vec![clock::now(); scenario.vehicles.len()],
            last_news: (clock::now(), SimTime::ZERO),
            _standing: standing,
            bus,
            contest,
        })
    }

    /// Keeps the door open until every vehicle has a mind, or the limit has passed: those without are lost then.
    pub(super) fn wait_for_minds(&mut self, limit: Duration, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
        let start = clock::now();
        let mut told = usize::MAX;
        loop {
            let missing = self.roster.mindless();
            if missing.len() != told {
                told = missing.len();
                let scenario = self.contest.scenario();
                let name = |v: &VehicleId| scenario.vehicles[v.index()].name.as_str();
                tell(News::Waiting { missing: missing.iter().map(name).collect() });
            }
            if missing.is_empty() || self.is_stopped() {
                break;
            }
            if clock::since(start) >= limit {
                missing.into_iter().for_each(|vehicle| self.contest.lose_mind(vehicle));
                break;
            }
            self.listen(Duration::from_millis(100));
        }
        self.last_news = (clock::now(), SimTime::ZERO);
        self.heard.fill(clock::now());
        Ok(())
    }

    /// Sends observers the truth, if there are any.
    pub(super) fn show(&mut self) -> Result<(), NodeError> {
        if !self.frames.is_heard() {
            return Ok(());
        }
        let frame = self.contest.frame();
        Ok(self.frames.send(&frame)?)
    }

    /// Sends every team the picture of the open decision. Sending it twice does no harm.
    pub(super) fn ask(&mut self) -> Result<(), NodeError> {
        for (picture, line) in self.contest.pictures().iter().zip(&self.pictures) {
            line.send(picture)?;
        }
        Ok(())
    }

    /// Takes in what comes, waiting up to `limit` for the first of it.
    pub(super) fn listen(&mut self, limit: Duration) {
        let mut next = self.inbox.take(limit);
        while let Some(call) = next {
            match call {
                Call::Orders(bytes) => self.take_orders(&bytes),
                Call::Join(question) => self.let_in(question),
                Call::Scenario(question) => question.answer(self.notice.clone()),
                Call::Gone(agent) => {
                    let vehicles = self.roster.gone(&agent);
                    vehicles.into_iter().for_each(|vehicle| self.contest.lose_mind(vehicle));
                }
                Call::Control(bytes) => self.obey(&bytes),
            }
            next = self.inbox.take_now();
        }
    }

    /// Gives up on minds that have not answered the open tick.
    pub(super) fn give_up(&mut self, tick: u64) {
        let vehicles = self.roster.give_up(tick);
        vehicles.into_iter().for_each(|vehicle| self.contest.lose_mind(vehicle));
    }

    /// Gives up on minds that have not been heard for this long.
    pub(super) fn lose_silent(&mut self, patience: Duration) {
        for i in 0..self.heard.len() {
            if clock::since(self.heard[i]) > patience {
                let vehicles = self.roster.lose_minder_of(VehicleId::at(i));
                vehicles.into_iter().for_each(|vehicle| self.contest.lose_mind(vehicle));
            }
        }
    }

    /// Whether the game is to end early.
    pub(super) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Everything that was refused so far.
    pub(super) fn refused(&self) -> Refused {
        let Refused { garbage, version, .. } = self.refused;
        Refused { garbage, version, flood: self.inbox.dropped(), ..self.roster.refused }
    }

    /// Tells progress, if it is time again.
    pub(super) fn tell_progress(&mut self, tell: &mut dyn FnMut(News<'_>)) {
        let (then, then_sim) = self.last_news;
        let passed = clock::since(then);
        if passed < NEWS_EVERY {
            return;
        }
        let rate = (self.contest.now() - then_sim).as_s() / passed.as_secs_f64();
        self.last_news = (clock::now(), self.contest.now());
        tell(News::Progress { contest: &self.contest, rate, refused: self.refused() });
    }

    /// Tells everybody that it is over, and waits a little for the agents to leave.
    pub(super) fn say_good_bye(&mut self) -> Result<(), NodeError> {
        for (picture, line) in self.contest.pictures().to_vec().into_iter().zip(&self.pictures) {
            line.send(&game::Picture { over: true, ..picture })?;
        }
        let frame = game::message::Frame { over: true, ..self.contest.frame() };
        self.frames.send(&frame)?;
        let start = clock::now();
        while self.roster.present() > 0 && clock::since(start) < GOOD_BYE {
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
        let Accepted { orders, back } = self.roster.take(&message, self.contest.decision());
        back.into_iter().for_each(|vehicle| self.contest.regain_mind(vehicle));
        let Stamp { valid_ns, .. } = message.stamp;
        // An order cannot be fresher than the newest picture.
        let given = valid_ns.min(self.contest.now());
        for (vehicle, order) in orders {
            self.contest.order(vehicle, order);
            self.ordered_at[vehicle.index()] = given;
            self.heard[vehicle.index()] = clock::now();
        }
    }

    fn let_in(&mut self, question: Question) {
        let reply = match serde_json::from_slice::<JoinRequest>(&question.payload) {
            Ok(request) => self.roster.join(&request, new_ticket()),
            Err(e) => JoinReply::Refused { reason: format!("the request is not understood: {e}") },
        };
        if let JoinReply::Granted { vehicles, .. } = &reply {
            for vehicle in vehicles {
                self.contest.hold(*vehicle);
                self.contest.regain_mind(*vehicle);
                self.heard[vehicle.index()] = clock::now();
            }
        }
        question.answer(serde_json::to_vec(&reply).expect("a reply is JSON"));
    }

    fn obey(&mut self, bytes: &[u8]) {
        match serde_json::from_slice(bytes) {
            Ok(Control::Stop) => self.stop.store(true, Ordering::Relaxed),
            Err(_) => self.refused.garbage += 1,
        }
    }
}

/// A number nobody can guess: the standard library's hasher is keyed by the operating system's randomness.
fn new_ticket() -> u64 {
    RandomState::new().build_hasher().finish()
}
