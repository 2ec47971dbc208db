//! The gateway's core: bytes, orders and operator commands in; bytes, navigation and events out.
//!
//! The core has no socket and no clock: [`Bridge::process`] gets an [`Input`] with its time and
//! fills an [`Output`]. The same inputs at the same times give the same outputs, byte for byte;
//! replay relies on this.

mod alarms;
mod battery;
mod clock_watch;
mod command_echo;
mod conditions;
mod control;
mod interface;
mod on_site;
mod operator_request;
mod rearm;
mod recovery_point;
mod status;
mod stop;

use crate::nmea::Mode;
use crate::protocol::{Command, Protocol, Report, UploadStep};
use crate::set_point::SetPoint;
use crate::supervisor::{
    Action, Conditions, ControlFault, OperatorRequest, Refusal, Scope, State, Step, Supervisor,
    Task,
};
pub use interface::{Event, Input, NavOut, Output, Plan, Preflight, Site};

use crate::config::{Gateway, SwitchWord};
use alarms::Alarms;
use battery::BatteryLog;
use clock_watch::ClockWatch;
use control::ControlLog;
use messages::Order;
use messages::external::{FailsafeReport, FleetCommand, Mission, OperatorCommand};
use on_site::OnSite;
use operator_request::request_from;
use primitives::SimTime;
use primitives::frame::Ned;
use rearm::Rearm;
use recovery_point::RecoveryPoint;
use status::Counters;
use std::collections::VecDeque;

/// Minimum interval between two new orders, s.
const GAP_MIN_S: f64 = 0.045;
/// Time (s) after which a task that the boat does not report is sent again.
const TASK_AGAIN_S: f64 = 1.0;
/// Interval between reports of invalid navigation, s.
const INVALID_NAV_EVERY_S: f64 = 0.25;
/// Maximum number of failsafes kept in the status.
const FAILSAFES_MAX: usize = 32;

/// The newest order, its time of arrival, and the time of the picture that it answers.
#[derive(Clone, Copy, Debug)]
struct CurrentOrder {
    order: Order,
    given: SimTime,
    came: SimTime,
}

/// The core of a gateway.
pub struct Bridge {
    plan: Plan,
    protocol: Protocol,
    control: ControlLog,
    /// `None` until a game defines the boat's site.
    on_site: Option<OnSite>,
    supervisor: Supervisor,
    link_up: bool,
    /// How long the gateway was not running before this input, s.
    hung_s: Option<f64>,
    order: Option<CurrentOrder>,
    /// Whether the order still has to be sent.
    order_is_new: bool,
    /// When a new order was last sent.
    order_sent: SimTime,
    others: (SimTime, Vec<Ned>),
    battery: BatteryLog,
    alarms: Alarms,
    clock: ClockWatch,
    recovery_point: RecoveryPoint,
    rearm: Rearm,
    /// The last command sent, and when.
    last_sent: Option<(SimTime, Command)>,
    /// Start-up words still to send.
    words: VecDeque<SwitchWord>,
    /// The last command that a dry run would have sent.
    would_send: Option<Command>,
    /// Whether the boat may be moving because of one of our commands.
    under_way: bool,
    /// The conditions of the last step.
    conditions: Conditions,
    nav_is_new: bool,
    /// When navigation was last reported, and whether it was valid.
    nav_reported: (SimTime, bool),
    standby_ignored: bool,
    failsafes: Vec<FailsafeReport>,
    counters: Counters,
}

impl Bridge {
    /// A disarmed bridge without a link.
    pub fn new(plan: Plan) -> Bridge {
        let Gateway {
            control,
            battery,
            currents,
            failsafe,
            ..
        } = &plan.gateway;
        Bridge {
            protocol: Protocol::new(&plan.gateway),
            control: ControlLog::new(*control),
            on_site: plan
                .site
                .as_ref()
                .map(|site| OnSite::new(&plan.gateway, site)),
            supervisor: Supervisor::new(
                plan.arms_itself && plan.preflight.missing().is_none(),
                *failsafe,
            ),
            battery: BatteryLog::new(*battery, SimTime::ZERO),
            alarms: Alarms::new(*currents),
            rearm: Rearm::new(failsafe.rearm_within_s),
            plan,
            link_up: false,
            hung_s: None,
            order: None,
            order_is_new: false,
            order_sent: SimTime::LONG_AGO,
            others: (SimTime::LONG_AGO, vec![]),
            clock: ClockWatch::default(),
            recovery_point: RecoveryPoint::default(),
            last_sent: None,
            words: VecDeque::new(),
            would_send: None,
            under_way: false,
            conditions: Conditions::UNKNOWN,
            nav_is_new: false,
            nav_reported: (SimTime::LONG_AGO, false),
            standby_ignored: false,
            failsafes: Vec::new(),
            counters: Counters::default(),
        }
    }

    /// The supervisor's state.
    pub fn state(&self) -> State {
        self.supervisor.state()
    }

    /// Processes one input and performs the actions that are due.
    pub fn process(&mut self, now: SimTime, input: &Input, out: &mut Output) {
        let mut request = None;
        self.hung_s = None;
        match input {
            Input::LinkUp => self.take_link_up(now),
            Input::LinkDown => self.link_up = false,
            Input::Bytes(bytes) => self.read(now, bytes, out),
            Input::Site(site) => self.on_site = Some(OnSite::new(&self.plan.gateway, site)),
            Input::Hung(seconds) => self.hung_s = Some(*seconds),
            // The previous sim's order may answer a picture from another game. The boat stops until
            // the new sim sends an order.
            Input::Joined => self.order = None,
            Input::Order(order, given) => self.take_order(now, *order, *given),
            Input::BadOrder => self.counters.bad_orders += 1,
            Input::OrderAhead => self.counters.orders_ahead += 1,
            Input::OldOrder => self.counters.old_orders += 1,
            Input::Others(places) => self.others = (now, places.clone()),
            Input::Operator(OperatorCommand::Mission(mission)) => {
                request = self.take_mission(now, mission, out)
            }
            Input::Operator(OperatorCommand::Arm) if self.plan.preflight.missing().is_some() => {
                out.refused = self
                    .plan
                    .preflight
                    .missing()
                    .map(|missing| format!("missing: {missing}"));
            }
            Input::Operator(OperatorCommand::Mode(mode)) => match self.request_mode(*mode) {
                Ok(asked) => request = Some(asked),
                Err(reason) => out.refused = Some(reason),
            },
            Input::Operator(command) => request = request_from(command),
            Input::Fleet(FleetCommand::EStop) => {
                request = Some(OperatorRequest::EStop(Scope::Fleet))
            }
            Input::Fleet(FleetCommand::Release) => {
                request = Some(OperatorRequest::Release(Scope::Fleet))
            }
            Input::Tick => {}
        }
        if request.is_some() && !matches!(input, Input::Operator(OperatorCommand::Mission(_))) {
            // Any other request ends an upload, above all an E-stop: a boat that waits for more
            // lines might read the next command as one.
            self.cancel_upload(now, out);
        }
        self.advance(now, request, out);
        if self.link_up {
            self.protocol.keep_up(now, &mut out.bytes);
        }
        self.report_nav(now, out);
    }

    /// The time by which the bridge must be called again.
    pub fn due(&self, now: SimTime) -> SimTime {
        let period = self.period();
        let coming = |at: SimTime| if at > now { at } else { now + period };
        let regular = self
            .last_sent
            .as_ref()
            .map_or(now + period, |(at, _)| coming(*at + period));
        let new_order = if self.order_is_new {
            coming(self.order_sent + SimTime::from_s(GAP_MIN_S))
        } else {
            SimTime::NEVER
        };
        regular
            .min(new_order)
            .min(self.protocol.due().map_or(SimTime::NEVER, coming))
    }

    fn period(&self) -> SimTime {
        SimTime::from_s(1.0 / self.plan.gateway.rate_hz)
    }

    /// Whether a command is due now.
    fn is_due(&self, now: SimTime) -> bool {
        let fresh = self.order_is_new && self.supervisor.state() == State::Armed;
        // A new order does not wait for the repetition period.
        let regular = self
            .last_sent
            .as_ref()
            .is_none_or(|(at, _)| now >= *at + self.period());
        regular || (fresh && now >= self.order_sent + SimTime::from_s(GAP_MIN_S))
    }

    /// Resets everything known about the boat for a new link, and sends standby first.
    fn take_link_up(&mut self, now: SimTime) {
        self.link_up = true;
        self.protocol.begin_link();
        self.on_site
            .iter_mut()
            .for_each(|site| site.estimator.forget());
        let Gateway {
            control,
            battery,
            currents,
            startup_words,
            ..
        } = &self.plan.gateway;
        self.control = ControlLog::new(*control);
        self.clock = ClockWatch::default();
        self.words = startup_words.clone().into();
        self.battery = BatteryLog::new(*battery, now);
        self.alarms = Alarms::new(*currents);
        self.recovery_point = RecoveryPoint::default();
        self.last_sent = None;
        // The boat may still follow its previous master's last command: send zero thrust first,
        // then standby.
        self.under_way = true;
    }

    fn read(&mut self, now: SimTime, bytes: &[u8], out: &mut Output) {
        let mut reports = Vec::new();
        self.protocol
            .read(now, bytes, &mut |report| reports.push(report));
        reports
            .into_iter()
            .for_each(|report| self.apply(now, report, out));
    }

    fn apply(&mut self, now: SimTime, report: Report, out: &mut Output) {
        self.nav_is_new |= self
            .on_site
            .as_mut()
            .is_some_and(|site| site.estimator.update(now, &report));
        match report {
            Report::Control(control) => {
                self.control.observe(now, &control);
                self.recovery_point
                    .observe(&control, self.protocol.is_uploading());
            }
            Report::Station(text) => out.events.push(Event::Warning(text)),
            Report::ForeignOrder => self.control.echo.note_foreign(now),
            Report::Power(power) => {
                self.battery.observe(now, &power);
                let command = self.last_sent.map(|(_, command)| command);
                self.alarms
                    .take_power(now, &power, command, &mut out.events);
            }
            Report::Tilt(tilt_deg) => self.alarms.take_tilt(now, tilt_deg, &mut out.events),
            Report::Error(error) => self.alarms.take_error(error, &mut out.events),
            Report::Notice(text) => self.alarms.take_notice(text, &mut out.events),
            Report::Clock(time) => {
                let step_s = self.clock.step_s(now, time).into_iter();
                let text = |step_s| format!("the receiver's clock stepped by {step_s:.1} s");
                out.events.extend(step_s.map(text).map(Event::Warning));
            }
            Report::Home(home) => self.recovery_point.take_home(home),
            Report::Fix(_) | Report::Velocity(_) | Report::Heading(_) => {}
        }
    }

    fn take_order(&mut self, now: SimTime, order: Order, given: SimTime) {
        let Ok(order) = order.check() else {
            self.counters.bad_orders += 1;
            return;
        };
        // An order is fresh if its picture is newer than that of the last order, not because it has
        // just arrived: a sim that keeps sending the same order must not keep a boat moving.
        let newer = given > self.order.map_or(SimTime::ZERO, |current| current.given);
        if newer {
            self.counters.orders += 1;
            self.order_is_new = true;
            self.order = Some(CurrentOrder {
                order,
                given,
                came: now,
            });
        } else if order == Order::Hold {
            // The sim replaces the order when it loses the agent. That does not make the order
            // fresh.
            self.order = self.order.map(|current| CurrentOrder { order, ..current });
            self.order_is_new = true;
        } else if self.order.is_some_and(|current| given < current.given) {
            self.counters.old_orders += 1;
        }
    }

    /// Starts the upload of a mission, or refuses it.
    fn take_mission(
        &mut self,
        now: SimTime,
        mission: &Mission,
        out: &mut Output,
    ) -> Option<OperatorRequest> {
        let unfit = self.conditions_at(now).unfit(Task::Mission);
        let outside = self
            .on_site
            .as_ref()
            .and_then(|site| site.outside(now, mission));
        let begun = match (self.supervisor.state(), outside) {
            (State::EStopped, _) => Err(self.e_stop_in_force()),
            _ if self.plan.dry_run => {
                Err("a dry run sends only standby, so it cannot upload a mission".to_owned())
            }
            _ if !unfit.is_empty() => Err(Refusal::NotReady(unfit).to_string()),
            (_, Some(outside)) => Err(outside),
            // The request becomes a disarm, so that the supervisor changes the state: the boat must
            // rest during the upload, which takes seconds.
            _ => self.protocol.begin_upload(now, mission),
        };
        match begun {
            Ok(()) => {
                // The boat forgets its previous recovery point during the upload.
                self.recovery_point = RecoveryPoint::Uploading(mission.erp, false);
                Some(OperatorRequest::Disarm)
            }
            Err(reason) => {
                out.refused = Some(reason);
                None
            }
        }
    }

    fn e_stop_in_force(&self) -> String {
        Refusal::EStopped(self.supervisor.stopped_by()).to_string()
    }

    /// Advances the supervisor by one step and sends the resulting command.
    fn advance(&mut self, now: SimTime, request: Option<OperatorRequest>, out: &mut Output) {
        let conditions = self.conditions_at(now);
        let Step {
            action,
            refusal,
            before,
        } = self.supervisor.step(&conditions, request);
        let still_stopped = matches!(request, Some(OperatorRequest::Release(_)))
            && self.supervisor.state() == State::EStopped;
        match refusal {
            Some(refusal) => out.refused = Some(refusal.to_string()),
            None if still_stopped => out.refused = Some(self.e_stop_in_force()),
            None => {}
        }
        if let Some(before) = before {
            self.note_change(now, before, out);
        }
        let changed =
            std::mem::replace(&mut self.conditions, conditions).blocked != conditions.blocked;
        if self.supervisor.state() == State::Armed && changed {
            out.events.push(Event::Blocked(conditions.blocked));
        }
        if matches!(
            conditions.control,
            Some(ControlFault::ForeignOrders | ControlFault::TakenOver(_))
        ) {
            self.recovery_point = RecoveryPoint::default();
        }
        // Send a change at once, without waiting for the next repetition: at 10 Hz a stop would be
        // delayed by up to 100 ms.
        let urgent = before.is_some() || request.is_some() || self.last_sent.is_none() || changed;
        if !self.link_up {
            self.protocol.abort_upload();
        } else if self.protocol.is_uploading()
            && action == Action::Standby
            && !(urgent && self.under_way)
        {
            self.continue_upload(now, out);
        } else if urgent || self.is_due(now) {
            self.send_action(now, action, out);
        }
        self.watch_standby(now, action, out);
        if self.link_up && self.battery.falls_silent(now) {
            let text = format!(
                "the boat has not reported its battery for {} s",
                battery::SILENCE_S
            );
            out.events.push(Event::Warning(text));
        }
    }

    fn note_change(&mut self, now: SimTime, before: State, out: &mut Output) {
        let state = self.supervisor.state();
        out.events.push(Event::State {
            from: before.to_string(),
            to: state.to_string(),
        });
        if let State::Failsafe { cause, .. } = state {
            self.rearm.failsafe_at = now;
            self.failsafes.push(FailsafeReport {
                at_s: now.as_s(),
                cause: cause.to_string(),
            });
            let surplus = self.failsafes.len().saturating_sub(FAILSAFES_MAX);
            self.failsafes.drain(..surplus);
        }
        if state != State::Armed {
            self.on_site
                .iter_mut()
                .for_each(|site| site.set_points.reset());
        }
    }

    /// Cancels the upload of a mission.
    fn cancel_upload(&mut self, now: SimTime, out: &mut Output) {
        if self.protocol.abort_upload() && self.link_up {
            self.recovery_point = RecoveryPoint::default();
            self.protocol
                .write(now, Command::EndOfUpload, &mut out.bytes);
        }
    }

    /// Sends the command for an action.
    fn send_action(&mut self, now: SimTime, action: Action, out: &mut Output) {
        let command = match action {
            Action::Standby => self.standby(),
            Action::Zero => Command::SetPoint(SetPoint::ZERO),
            Action::Task(task) => {
                let command = Command::Task(
                    self.on_site
                        .as_ref()
                        .map_or(task, |site| site.by_compass(task)),
                );
                let is_reported = self.control.mode() == Some(self.protocol.shown(command).mode);
                // The task would restart if sent again.
                if self.last_sent.as_ref().is_some_and(|(at, last)| {
                    *last == command && (is_reported || (now - *at).as_s() < TASK_AGAIN_S)
                }) {
                    return;
                }
                command
            }
            Action::Follow => match self.follow(now) {
                Some(set_point) => Command::SetPoint(set_point),
                None => return,
            },
        };
        let command = if self.plan.dry_run {
            self.would_send = Some(command);
            Command::Standby
        } else {
            command
        };
        // Set thrust to zero before any command that is not our own set-point. The manufacturer
        // does not say how a Surveyor treats its last thrust when it leaves mode T.
        let is_set_point = matches!(action, Action::Follow | Action::Zero);
        if !is_set_point && std::mem::replace(&mut self.under_way, false) && !self.plan.dry_run {
            self.protocol.write(now, Command::Zero, &mut out.bytes);
        }
        self.under_way |= action == Action::Follow;
        out.stops = matches!(action, Action::Standby | Action::Zero);
        self.protocol.write(now, command, &mut out.bytes);
        out.carries_order = action == Action::Follow && self.order_is_new;
        if out.carries_order {
            (self.order_is_new, self.order_sent) = (false, now);
        }
        self.note_sent(now, command);
    }

    fn note_sent(&mut self, now: SimTime, command: Command) {
        self.control.note_sent(now, self.protocol.shown(command));
        self.counters.sent += 1;
        self.last_sent = Some((now, command));
    }

    /// The set-point of the current order.
    fn follow(&mut self, now: SimTime) -> Option<SetPoint> {
        let site = self.on_site.as_mut()?;
        let (nav, _) = site.estimator.nav(now)?;
        let order = self.order?.order;
        let set_point = site.set_points.map(now, order, &nav);
        // In a dry run the boat receives no set-points, so it is not expected to follow them.
        if !self.plan.dry_run {
            let ordered = site.set_points.ordered(order, set_point);
            site.estimator.note_order(now, ordered);
            site.geofence
                .note_order(now, ordered.ahead_m_s, (nav.psi_rad, nav.velocity_m_s()));
        }
        Some(set_point)
    }

    fn continue_upload(&mut self, now: SimTime, out: &mut Output) {
        match self.protocol.continue_upload(now, &mut out.bytes) {
            UploadStep::Sent => self.note_sent(now, Command::EndOfUpload),
            UploadStep::Done => {
                self.advance(now, Some(OperatorRequest::Delegate(Task::Mission)), out)
            }
            UploadStep::Failed(reason) => {
                self.recovery_point = RecoveryPoint::default();
                out.events.push(Event::Warning(format!(
                    "the mission is not uploaded: {reason}"
                )));
            }
            UploadStep::Waiting => {}
        }
    }

    /// Warns once if a boat that is sent standby reports that it is being driven.
    fn watch_standby(&mut self, now: SimTime, action: Action, out: &mut Output) {
        // Under another operator's control this is correct.
        let ours = matches!(
            self.control.fault(now),
            None | Some(ControlFault::Disobeyed(_) | ControlFault::ForeignOrders)
        );
        let ignored = action == Action::Standby
            && ours
            && self
                .control
                .mode_mismatch(now)
                .is_some_and(Mode::is_set_point);
        if ignored && !self.standby_ignored {
            out.events.push(Event::Warning(
                "the boat is being sent standby but reports that it is being driven".to_owned(),
            ));
        }
        self.standby_ignored = ignored;
    }

    fn report_nav(&mut self, now: SimTime, out: &mut Output) {
        let Some(site) = &self.on_site else { return };
        let Some((nav, age_s)) = site.estimator.nav(now) else {
            return;
        };
        let is_new = std::mem::take(&mut self.nav_is_new);
        // Report invalid navigation too: the sim must learn at once that the position must not be
        // extrapolated, and operators see the boat's last position.
        let valid = self.link_up && site.estimator.fault(now).is_none();
        let (reported_at, reported_valid) = self.nav_reported;
        let overdue = !valid && (now - reported_at).as_s() >= INVALID_NAV_EVERY_S;
        if (is_new && valid) || valid != reported_valid || overdue {
            self.nav_reported = (now, valid);
            out.nav = Some(NavOut { nav, valid, age_s });
        }
    }
}
