//! The gateway's core: sentences, orders and wishes in; sentences, navigation and events out.
//!
//! No socket and no clock in here: [`Bridge::take`] is told what came and when, and puts into an [`Outbox`] what follows.
//! The same inputs at the same times give the same outputs, byte for byte: that is how a recording is replayed.

mod control;
mod exchange;
mod status;
mod upload;
mod voice;

use crate::estimate::Estimator;
use crate::geodesy::LocalFrame;
use crate::geofence::{BowWatch, GeofenceWatch};
use crate::nmea::{Command, Framer, Mode, ParseError, Sentence, TimeOfDay};
use crate::set_point::{SetPointMapper, Setting};
use crate::supervisor::{Action, Conditions, Control, Reach, Refusal, State, Step, Supervisor, Task, Wish};
pub use exchange::{Event, FleetCommand, Input, NavOut, Outbox, Plan};

use control::ControlLog;
use game::external::{FailsafeReport, Mission, OperatorCommand};
use game::frame::Ned;
use game::gateway::Gateway;
use game::{Order, SimTime};
use std::collections::BTreeMap;
use upload::{Next, Upload};

/// Two new orders are sent at least this far apart.
const GAP_MIN_S: f64 = 0.045;
/// Where the other boats are counts for this long.
const OTHERS_AGE_MAX_S: f64 = 2.0;
/// From this thrust on a boat's position must change, per cent.
const PUSH_PCT: f64 = 20.0;
/// A boat that is told a task and does not show it is told again after this time.
const TASK_AGAIN_S: f64 = 1.0;
/// How often navigation that cannot be relied on is told.
const LOST_NAV_EVERY_S: f64 = 0.25;
/// A step of the receiver's time of day against our clock that is worth a word, s.
const CLOCK_STEP_S: f64 = 2.0;
/// Trips and names of unknown sentences that are remembered.
const TRIPS_MAX: usize = 32;
const UNKNOWN_MAX: usize = 64;

/// An order, when it came, and the time of the picture that it answers.
#[derive(Clone, Copy, Debug)]
struct Standing {
    order: Order,
    given: SimTime,
    came: SimTime,
}

/// How often what happened.
#[derive(Clone, Debug, Default)]
struct Tally {
    unknown: BTreeMap<String, u64>,
    unreadable: u64,
    orders: u64,
    bad_orders: u64,
    old_orders: u64,
    sent: u64,
}

/// The core of a gateway.
pub struct Bridge {
    plan: Plan,
    framer: Framer,
    estimator: Estimator,
    control: ControlLog,
    fence: GeofenceWatch,
    bow: BowWatch,
    seat: SetPointMapper,
    supervisor: Supervisor,
    link_up: bool,
    order: Option<Standing>,
    /// Whether the order has not been sent yet.
    order_is_news: bool,
    /// When an order was last sent for the first time.
    order_sent: SimTime,
    others: (SimTime, Vec<Ned>),
    volts: Option<f64>,
    low_since: Option<SimTime>,
    boat_error: String,
    /// The receiver's time of day, and when it came.
    clock: Option<(SimTime, TimeOfDay)>,
    upload: Option<Upload>,
    /// What was sent last, and when.
    last_sent: Option<(SimTime, Command)>,
    /// Whether the boat may be moving by what it was sent.
    under_way: bool,
    /// What was true at the last step.
    seen: Conditions,
    nav_is_news: bool,
    /// When navigation was told last, and whether as valid.
    nav_told: (SimTime, bool),
    standby_ignored: bool,
    trips: Vec<FailsafeReport>,
    tally: Tally,
}

impl Bridge {
    /// A bridge at the beginning: no link, safed.
    #[must_use]
    pub fn new(plan: Plan) -> Bridge {
        let Gateway { nav, compass, limits, control, geofence, halt, battery, .. } = plan.gateway.clone();
        let frame = LocalFrame::new(plan.field.plan.datum);
        let estimator = Estimator::new(frame, nav, (compass, plan.declination_rad), limits.speed_max_m_s);
        Bridge {
            framer: Framer::new(),
            seat: SetPointMapper::new(&plan.gateway, estimator.compass_to_true_rad()),
            estimator,
            control: ControlLog::new(control),
            fence: GeofenceWatch::new(&plan.field, geofence),
            bow: BowWatch::new(halt, plan.length_m),
            supervisor: Supervisor::new(plan.arms_itself, battery.action),
            plan,
            link_up: false,
            order: None,
            order_is_news: false,
            order_sent: SimTime::LONG_AGO,
            others: (SimTime::LONG_AGO, vec![]),
            volts: None,
            low_since: None,
            boat_error: String::new(),
            clock: None,
            upload: None,
            last_sent: None,
            under_way: false,
            seen: Conditions::NOTHING,
            nav_is_news: false,
            nav_told: (SimTime::LONG_AGO, false),
            standby_ignored: false,
            trips: Vec::new(),
            tally: Tally::default(),
        }
    }

    /// Where the supervisor stands.
    #[must_use]
    pub fn state(&self) -> State {
        self.supervisor.state()
    }

    /// Takes in what came, and does what is due.
    pub fn take(&mut self, now: SimTime, input: &Input, out: &mut Outbox) {
        let mut wish = None;
        match input {
            Input::LinkUp => self.greet(),
            Input::LinkDown => self.link_up = false,
            Input::Bytes(bytes) => self.read(now, bytes, out),
            Input::Moored => self.order = None,
            Input::Order(order, given) => self.take_order(now, *order, *given),
            Input::BadOrder => self.tally.bad_orders += 1,
            Input::Others(places) => self.others = (now, places.clone()),
            Input::Operator(OperatorCommand::Mission(mission)) => wish = self.take_mission(now, mission, out),
            Input::Operator(command) => wish = wish_of(command),
            Input::Fleet(FleetCommand::EStop) => wish = Some(Wish::EStop(Reach::Fleet)),
            Input::Fleet(FleetCommand::Release) => wish = Some(Wish::Release(Reach::Fleet)),
            Input::Tick => {}
        }
        if wish.is_some() && !matches!(input, Input::Operator(OperatorCommand::Mission(_))) {
            self.break_off_upload(out);
        }
        self.advance(now, wish, out);
        self.tell_nav(now, out);
    }

    /// When it wants to be called again at the latest.
    #[must_use]
    pub fn due(&self, now: SimTime) -> SimTime {
        let period = self.period();
        let coming = |at: SimTime| if at > now { at } else { now + period };
        let regular = self.last_sent.as_ref().map_or(now + period, |(at, _)| coming(*at + period));
        let news =
            if self.order_is_news { coming(self.order_sent + SimTime::from_s(GAP_MIN_S)) } else { SimTime::NEVER };
        let upload = self.upload.as_ref().map_or(SimTime::NEVER, |upload| coming(upload.due()));
        regular.min(news).min(upload)
    }

    fn period(&self) -> SimTime {
        SimTime::from_s(1.0 / self.plan.gateway.rate_hz)
    }

    /// Whether the boat should hear something now.
    fn is_due(&self, now: SimTime) -> bool {
        let fresh = self.order_is_news && self.supervisor.state() == State::Armed;
        // A new order does not wait for what was only said again.
        let regular = self.last_sent.as_ref().is_none_or(|(at, _)| now >= *at + self.period());
        regular || (fresh && now >= self.order_sent + SimTime::from_s(GAP_MIN_S))
    }

    /// What to send before everything ends: thrust zero, then standby.
    #[must_use]
    pub fn last_words(&self) -> Vec<u8> {
        let mut words = Vec::new();
        if self.upload.is_some() {
            words.push(voice::end_of_download());
        }
        words.extend([voice::of_setting(Setting::ZERO), voice::standby()]);
        voice::bytes_of(&words)
    }

    /// A link that is new: nothing is known of the boat at its end, and its first word is standby.
    fn greet(&mut self) {
        self.link_up = true;
        // What came of a sentence before the cut must not be completed by what comes after it.
        self.framer.push(b"\r\n", &mut |_| {});
        self.estimator.forget();
        self.control.forget();
        (self.volts, self.low_since, self.clock) = (None, None, None);
        self.upload = None;
        self.last_sent = None;
        self.under_way = true;
    }

    fn read(&mut self, now: SimTime, bytes: &[u8], out: &mut Outbox) {
        let mut framer = std::mem::take(&mut self.framer);
        framer.push(bytes, &mut |body| match Sentence::parse(body) {
            Ok(sentence) => self.heed(now, &sentence, out),
            Err(ParseError::Unknown { address }) => {
                let room = self.tally.unknown.len() < UNKNOWN_MAX;
                let name =
                    if room || self.tally.unknown.contains_key(&address) { address } else { "others".to_owned() };
                *self.tally.unknown.entry(name).or_default() += 1;
            }
            Err(_) => self.tally.unreadable += 1,
        });
        self.framer = framer;
    }

    fn heed(&mut self, now: SimTime, sentence: &Sentence, out: &mut Outbox) {
        self.nav_is_news |= self.estimator.take(now, sentence);
        match sentence {
            Sentence::ControlState(state) => self.control.take(now, state),
            Sentence::Battery(battery) => {
                if let Some(volts) = battery.volts {
                    self.volts = Some(volts);
                    let low = volts < self.plan.gateway.battery.volts_min;
                    self.low_since = low.then(|| self.low_since.unwrap_or(now));
                }
            }
            Sentence::BoatError(error) if error.code != self.boat_error => {
                self.boat_error.clone_from(&error.code);
                if error.code != "N" {
                    out.events.push(Event::Warning(format!("the boat reports error {:?}", error.code)));
                }
            }
            Sentence::Gga(gga) => self.watch_clock(now, gga.time, out),
            _ => {}
        }
    }

    /// Says so when the receiver's time of day goes another way than our clock.
    fn watch_clock(&mut self, now: SimTime, time: Option<TimeOfDay>, out: &mut Outbox) {
        let Some(time) = time else { return };
        if let Some((at, before)) = self.clock.replace((now, time)) {
            let step_s = time.since_s(before.later(now - at));
            if step_s.abs() > CLOCK_STEP_S {
                out.events.push(Event::Warning(format!("the receiver's clock stepped by {step_s:.1} s")));
            }
        }
    }

    fn take_order(&mut self, now: SimTime, order: Order, given: SimTime) {
        let Ok(order) = order.check() else {
            self.tally.bad_orders += 1;
            return;
        };
        // Before the first picture nobody can have thought.
        let newer = given > self.order.map_or(SimTime::ZERO, |standing| standing.given);
        if newer {
            self.tally.orders += 1;
            self.order_is_news = true;
            self.order = Some(Standing { order, given, came: now });
        } else if order == Order::Hold {
            // The sim takes an order back when its mind is lost. That makes nothing fresh.
            self.order = self.order.map(|standing| Standing { order, ..standing });
            self.order_is_news = true;
        } else if self.order.is_some_and(|standing| given < standing.given) {
            self.tally.old_orders += 1;
        }
    }

    /// Begins to send a mission, or says why not.
    fn take_mission(&mut self, now: SimTime, mission: &Mission, out: &mut Outbox) -> Option<Wish> {
        let unfit = self.conditions(now).unfit();
        let begun = match self.supervisor.state() {
            State::EStopped => Err(self.e_stop_in_force()),
            _ if !unfit.is_empty() => Err(Refusal::NotReady(unfit).to_string()),
            _ if !self.is_within_fence(mission) => Err("a place of it is outside of the fence".to_owned()),
            _ => Upload::new(mission, self.plan.gateway.upload_gap_s, now),
        };
        match begun {
            Ok(upload) => {
                self.upload = Some(upload);
                Some(Wish::Disarm)
            }
            Err(reason) => {
                out.refused = Some(reason);
                None
            }
        }
    }

    fn is_within_fence(&self, mission: &Mission) -> bool {
        let places = std::iter::once(&mission.erp).chain(&mission.waypoints);
        // What is no place at all the upload refuses, in words.
        let spots = places.filter(|[lat_deg, lon_deg]| lat_deg.abs() <= 90.0 && lon_deg.abs() <= 180.0);
        spots.map(|[lat_deg, lon_deg]| self.estimator.place(*lat_deg, *lon_deg)).all(|place| self.fence.holds(place))
    }

    fn e_stop_in_force(&self) -> String {
        format!("an E-stop of {} is in force: release it first", self.supervisor.stopped_by())
    }

    /// One step of the supervisor, and what it has to say to the boat.
    fn advance(&mut self, now: SimTime, wish: Option<Wish>, out: &mut Outbox) {
        let conditions = self.conditions(now);
        let Step { action, refusal, before } = self.supervisor.step(&conditions, wish);
        let still_stopped = matches!(wish, Some(Wish::Release(_))) && self.supervisor.state() == State::EStopped;
        match refusal {
            Some(Refusal::EStopped) => out.refused = Some(self.e_stop_in_force()),
            Some(refusal) => out.refused = Some(refusal.to_string()),
            None if still_stopped => out.refused = Some(self.e_stop_in_force()),
            None => {}
        }
        if let Some(before) = before {
            self.note_change(now, before, out);
        }
        let changed = std::mem::replace(&mut self.seen, conditions).blocked != conditions.blocked;
        if self.supervisor.state() == State::Armed && changed {
            out.events.push(Event::Blocked(conditions.blocked));
        }
        let urgent = before.is_some() || wish.is_some() || self.last_sent.is_none() || changed;
        if !self.link_up {
            self.upload = None;
        } else if self.upload.is_some() && action == Action::Standby && !(urgent && self.under_way) {
            self.go_on_with_upload(now, out);
        } else if urgent || self.is_due(now) {
            self.speak(now, action, out);
        }
        self.watch_standby(now, action, out);
    }

    fn note_change(&mut self, now: SimTime, before: State, out: &mut Outbox) {
        let state = self.supervisor.state();
        out.events.push(Event::State { from: before.to_string(), to: state.to_string() });
        if let State::Failsafe(cause) = state {
            self.trips.push(FailsafeReport { at_s: now.as_s(), cause: cause.to_string() });
            let surplus = self.trips.len().saturating_sub(TRIPS_MAX);
            self.trips.drain(..surplus);
        }
        if state != State::Armed {
            self.seat.rest();
        }
    }

    /// A mission that is on its way is not sent on.
    fn break_off_upload(&mut self, out: &mut Outbox) {
        if self.upload.take().is_some() && self.link_up {
            out.bytes.extend(voice::bytes_of(&[voice::end_of_download()]));
        }
    }

    /// Sends the boat what the action comes to.
    fn speak(&mut self, now: SimTime, action: Action, out: &mut Outbox) {
        let command = match action {
            Action::Standby => voice::standby(),
            Action::Zero => voice::of_setting(Setting::ZERO),
            Action::Task(task) => {
                // Telling it again would begin it anew.
                let shows = self.control.mode() == Some(voice::of_task(task).mode);
                let told = self.last_sent.as_ref().is_some_and(|(at, last)| {
                    last.mode == voice::of_task(task).mode && (shows || (now - *at).as_s() < TASK_AGAIN_S)
                });
                if told {
                    return;
                }
                voice::of_task(task)
            }
            Action::Follow => match self.follow(now) {
                Some(setting) => voice::of_setting(setting),
                None => return,
            },
        };
        // Whatever comes after our own settings, thrust goes to zero first.
        let is_ours = matches!(action, Action::Follow | Action::Zero);
        if !is_ours && std::mem::replace(&mut self.under_way, false) {
            out.bytes.extend(voice::bytes_of(&[voice::of_setting(Setting::ZERO)]));
        }
        self.under_way |= action == Action::Follow;
        out.bytes.extend(voice::bytes_of(std::slice::from_ref(&command)));
        out.carries_order = action == Action::Follow && self.order_is_news;
        if out.carries_order {
            (self.order_is_news, self.order_sent) = (false, now);
        }
        self.control.note_sent(now, command.mode);
        self.tally.sent += 1;
        self.last_sent = Some((now, command));
    }

    /// What the standing order comes to.
    fn follow(&mut self, now: SimTime) -> Option<Setting> {
        let (nav, _) = self.estimator.nav(now)?;
        let setting = self.seat.setting(now, self.order?.order, &nav);
        let pushes = match setting {
            Setting::Thrust { thrust_pct, .. } => thrust_pct.abs() >= PUSH_PCT,
            Setting::Speed { speed_m_s, .. } => speed_m_s > 0.5,
        };
        if pushes {
            self.estimator.note_push(now);
        }
        Some(setting)
    }

    fn go_on_with_upload(&mut self, now: SimTime, out: &mut Outbox) {
        let next = self.upload.as_mut().map(|upload| upload.next(now));
        match next {
            Some(Next::Line(line)) => {
                line.write(&mut out.bytes);
                self.tally.sent += 1;
                self.last_sent = Some((now, voice::end_of_download()));
            }
            Some(Next::Done) => {
                self.upload = None;
                self.advance(now, Some(Wish::Delegate(Task::Mission)), out);
            }
            Some(Next::Wait) | None => {}
        }
    }

    /// Says so, once, when a boat shows that it drives on though it is told standby.
    fn watch_standby(&mut self, now: SimTime, action: Action, out: &mut Outbox) {
        let driven = |mode: &Mode| matches!(mode, Mode::Thruster | Mode::Speed | Mode::Heading);
        // With somebody else's hands on it, that is as it should be.
        let ours = matches!(self.control.control(now), Control::Granted | Control::Disobeys(_));
        let ignored = action == Action::Standby && ours && self.control.astray(now).as_ref().is_some_and(driven);
        if ignored && !self.standby_ignored {
            out.events.push(Event::Warning("the boat is told standby and shows that it is driven".to_owned()));
        }
        self.standby_ignored = ignored;
    }

    fn tell_nav(&mut self, now: SimTime, out: &mut Outbox) {
        let Some((nav, age_s)) = self.estimator.nav(now) else { return };
        let news = std::mem::take(&mut self.nav_is_news);
        let valid = self.link_up && self.estimator.fault(now).is_none();
        let (told_at, told_valid) = self.nav_told;
        let overdue = !valid && (now - told_at).as_s() >= LOST_NAV_EVERY_S;
        if (news && valid) || valid != told_valid || overdue {
            self.nav_told = (now, valid);
            out.nav = Some(NavOut { nav, valid, age_s });
        }
    }

    fn conditions(&mut self, now: SimTime) -> Conditions {
        let nav_fault = self.estimator.fault(now);
        let nav = self.estimator.nav(now).map(|(nav, _)| nav);
        let inside = nav.is_some_and(|nav| self.fence.is_inside(now, nav.at(), self.estimator.velocity_m_s()));
        let (seen_at, others) = &self.others;
        let known: &[Ned] = if (now - *seen_at).as_s() <= OTHERS_AGE_MAX_S { others } else { &[] };
        let blocked = nav.is_some_and(|nav| self.bow.is_blocked(now, nav.at(), (nav.psi_rad, nav.surge_m_s), known));
        let battery = &self.plan.gateway.battery;
        let low_s = self.low_since.map_or(0.0, |since| (now - since).as_s());
        let ttl_s = self.plan.gateway.order_ttl_s;
        Conditions {
            link: self.link_up,
            control: self.control.control(now),
            nav: nav_fault,
            inside,
            battery_low: self.low_since.is_some() && low_s >= battery.debounce_s,
            blocked,
            order_fresh: self.order.is_some_and(|standing| (now - standing.came).as_s() <= ttl_s),
        }
    }
}

fn wish_of(command: &OperatorCommand) -> Option<Wish> {
    match command {
        OperatorCommand::Arm => Some(Wish::Arm),
        OperatorCommand::Disarm => Some(Wish::Disarm),
        OperatorCommand::EStop => Some(Wish::EStop(Reach::Boat)),
        OperatorCommand::Release => Some(Wish::Release(Reach::Boat)),
        OperatorCommand::StationKeep => Some(Wish::Delegate(Task::StationKeep)),
        OperatorCommand::GoToErp => Some(Wish::Delegate(Task::GoToErp)),
        OperatorCommand::Status | OperatorCommand::Mission(_) => None,
    }
}
