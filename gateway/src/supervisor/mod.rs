//! Decides when a boat may be driven and when it is stopped: a pure state machine.
//!
//! ```text
//!                    arm [ready]                       any condition fails
//!        ┌────────┐ ────────────▶ ┌─────────┐ ───────────────────────────▶ ┌───────────────┐
//!   ●──▶ │Disarmed│               │  Armed  │                              │ Failsafe(why) │
//!        └────────┘ ◀──────────── └─────────┘ ◀─────────────────────────── └───────────────┘
//!          ▲ ▲  │      disarm          │                arm [ready]           │         ▲
//!          │ │  │                      │ delegate [fit]                       │ disarm  │ a condition of
//!          │ │  └──────────────────────┼──────────────────────────────────────┼▶Disarmed│ delegation fails
//!          │ │   delegate [fit]        ▼                                      │         │
//!          │ │                 ┌───────────────┐ ─────────────────────────────┼─────────┘
//!          │ └──────────────── │ Delegated(to) │ ◀────────────────────────────┘ delegate [fit]
//!          │       disarm      └───────────────┘
//!          │ release (of the boat and of the fleet)
//!     ┌──────────┐
//!     │ EStopped │ ◀── e-stop, from every state
//!     └──────────┘
//! ```
//!
//! *Ready* means: link up, loop not hung, control granted, navigation reliable, thrust effective,
//! inside the geofence, battery not low, order fresh. *Fit* is the same without the order. We send
//! set-points that move the boat only in `Armed`, and only if it is ready in that same step and no
//! other boat is in the way. After a failsafe the boat stops, unless the gateway file assigns a
//! task of the boat's own controller to that cause and nothing that the task needs has failed. The
//! state machine has no clock: `Conditions` state what is fresh, reliable or granted now, so that a
//! test can try every state with every input.

mod cause;

pub use cause::{Cause, ControlFault, NavFault};

use crate::config::{FailsafeAction, FailsafeActions};
use crate::thrust_check::ThrustFault;
use messages::external::BoatMode;
use thiserror::Error;

/// The current conditions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Conditions {
    /// Whether bytes can reach the boat.
    pub(crate) link: bool,
    /// Length of the gap (s), if the gateway was not running until now and its guard may have
    /// stopped the boat.
    pub(crate) hung_s: Option<f64>,
    /// Why this gateway does not have sole control of the boat, if it does not.
    pub(crate) control: Option<ControlFault>,
    /// The navigation fault, if any.
    pub(crate) nav: Option<NavFault>,
    /// The boat's failure to respond to its orders, if any.
    pub(crate) thrust: Option<ThrustFault>,
    /// Whether the boat has a recovery point that we uploaded and that is inside the geofence.
    pub(crate) recovery_point: bool,
    /// Whether the boat is inside the geofence and can stop there.
    pub(crate) inside: bool,
    /// Whether the battery is low.
    pub(crate) battery_low: bool,
    /// Whether another real boat is in the box around the bow.
    pub(crate) blocked: bool,
    /// Whether there is a valid order within its time to live.
    pub(crate) order_fresh: bool,
    /// Whether a boat that stopped for lack of a fresh order may rearm itself.
    pub(crate) may_rearm: bool,
}

impl Conditions {
    /// The conditions before anything has been received.
    pub(crate) const UNKNOWN: Conditions = Conditions {
        link: false,
        hung_s: None,
        control: Some(ControlFault::Unknown),
        nav: Some(NavFault::NoFix),
        thrust: None,
        recovery_point: false,
        inside: false,
        battery_low: false,
        blocked: false,
        order_fresh: false,
        may_rearm: false,
    };
}

/// A request by an operator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum OperatorRequest {
    /// Follow orders.
    Arm,
    /// Stop following orders.
    Disarm,
    /// Stop, and stay stopped: this boat or the whole fleet.
    EStop(Scope),
    /// End the E-stop.
    Release(Scope),
    /// Hand the boat to its own controller with this task.
    Delegate(Task),
}

/// The scope of an E-stop. Each scope is released separately.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scope {
    /// This boat alone.
    Boat,
    /// The whole fleet.
    Fleet,
}

/// A task of the boat's own controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Task {
    /// Keep station.
    StationKeep,
    /// Go to the emergency recovery point.
    GoToErp,
    /// Run the uploaded mission.
    Mission,
    /// Run another mode of the boat's own controller.
    Mode(BoatMode),
}

/// The state of the supervisor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum State {
    /// Standby; waiting to be armed.
    Disarmed,
    /// Following orders from agents.
    Armed,
    /// Stopped by a failsafe until it is armed again.
    Failsafe {
        /// Why it was stopped.
        cause: Cause,
        /// The task of the boat's own controller meanwhile; `None` means standby.
        task: Option<Task>,
    },
    /// The boat's own controller runs this task.
    Delegated(Task),
    /// Standby until the E-stop is released.
    EStopped,
}

/// The action to send the boat now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Action {
    /// Standby, preceded by zero thrust if there was thrust.
    Standby,
    /// Zero thrust.
    Zero,
    /// The order's set-point.
    Follow,
    /// A task for the boat's own controller.
    Task(Task),
}

/// The reason for refusing a request.
#[derive(Clone, Debug, PartialEq, Error)]
pub(crate) enum Refusal {
    /// The boat lacks these conditions.
    #[error("missing: {}", .0.iter().map(|cause| cause.missing()).collect::<Vec<_>>().join("; "))]
    NotReady(Vec<Cause>),
    /// An E-stop for these boats is in force.
    #[error("an E-stop of {0} is in force: release it first")]
    EStopped(&'static str),
}

/// The result of one step.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Step {
    /// What to send the boat.
    pub(crate) action: Action,
    /// Why the request was refused, if it was.
    pub(crate) refusal: Option<Refusal>,
    /// The previous state, if it changed.
    pub(crate) before: Option<State>,
}

/// The state machine.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Supervisor {
    state: State,
    /// E-stops in force: boat, fleet.
    stops: [bool; 2],
    /// Whether the boat arms itself once, as soon as it is ready.
    arms_itself: bool,
    actions: FailsafeActions,
}

impl Supervisor {
    /// A disarmed supervisor. With `arms_itself`, it arms when first ready, unless an operator
    /// makes a request first. After any later stop, it arms only on request, unless
    /// [`Conditions::may_rearm`] is set.
    pub(crate) fn new(arms_itself: bool, actions: FailsafeActions) -> Supervisor {
        Supervisor {
            state: State::Disarmed,
            stops: [false; 2],
            arms_itself,
            actions,
        }
    }

    /// The current state.
    pub(crate) fn state(&self) -> State {
        self.state
    }

    /// The scopes of the E-stops in force, as text for operators.
    pub(crate) fn stopped_by(&self) -> &'static str {
        match self.stops {
            [true, true] => "this boat and of the fleet",
            [true, false] => "this boat",
            [false, true] => "the fleet",
            [false, false] => "nobody",
        }
    }

    /// Advances the state machine by one step.
    pub(crate) fn step(&mut self, now: &Conditions, request: Option<OperatorRequest>) -> Step {
        let before = self.state;
        let refusal = request.and_then(|request| self.take_request(now, request));
        let arms_itself = match self.state {
            State::Disarmed => self.arms_itself,
            State::Failsafe {
                cause: Cause::OrderStale,
                ..
            } => now.may_rearm,
            _ => false,
        };
        if arms_itself && now.missing().is_empty() {
            self.state = State::Armed;
        }
        // Check after handling the request: if arming is granted and fails in the same step, the
        // state becomes a failsafe with its cause.
        self.check_failsafes(now);
        // Any change of state, and any request, ends self-arming.
        self.arms_itself &= self.state == State::Disarmed && request.is_none();
        let changed = (self.state != before).then_some(before);
        Step {
            action: self.action(now),
            refusal,
            before: changed,
        }
    }

    fn take_request(&mut self, now: &Conditions, request: OperatorRequest) -> Option<Refusal> {
        match request {
            OperatorRequest::EStop(scope) => self.stops[scope as usize] = true,
            OperatorRequest::Release(scope) => self.stops[scope as usize] = false,
            OperatorRequest::Arm | OperatorRequest::Delegate(_) if self.is_stopped() => {
                return Some(Refusal::EStopped(self.stopped_by()));
            }
            OperatorRequest::Arm => return self.enter(State::Armed, now.missing()),
            OperatorRequest::Delegate(task) => {
                return self.enter(State::Delegated(task), now.unfit(task));
            }
            OperatorRequest::Disarm => self.state = State::Disarmed,
        }
        None
    }

    fn enter(&mut self, state: State, missing: Vec<Cause>) -> Option<Refusal> {
        if missing.is_empty() {
            self.state = state;
            return None;
        }
        Some(Refusal::NotReady(missing))
    }

    fn is_stopped(&self) -> bool {
        self.stops.contains(&true)
    }

    /// Leaves states that the conditions do not allow.
    fn check_failsafes(&mut self, now: &Conditions) {
        self.state = match self.state {
            _ if self.is_stopped() => State::EStopped,
            // After release, the boat is disarmed, whatever its state before: an operator must arm
            // it.
            State::EStopped => State::Disarmed,
            State::Armed => now
                .causes()
                .next()
                .map_or(State::Armed, |cause| self.failsafe(now, cause)),
            State::Delegated(task) => now
                .unfit_failsafe(task)
                .map_or(self.state, |cause| self.failsafe(now, cause)),
            State::Failsafe {
                cause,
                task: Some(task),
            } => self.watch_task(now, cause, task),
            State::Disarmed | State::Failsafe { task: None, .. } => self.state,
        };
    }

    /// The failsafe for this cause, with the configured task if the boat can still execute it.
    fn failsafe(&self, now: &Conditions, cause: Cause) -> State {
        let task = self
            .task_after(cause)
            .filter(|task| now.hindrance(*task).is_none());
        State::Failsafe { cause, task }
    }

    /// Continues a task after a failsafe until the boat cannot execute it or a more severe cause
    /// occurs.
    fn watch_task(&self, now: &Conditions, cause: Cause, task: Task) -> State {
        if let Some(cause) = now.hindrance(task) {
            return State::Failsafe { cause, task: None };
        }
        // The geofence takes precedence over the battery: a boat that leaves its area endangers
        // others; a boat with an empty battery endangers only itself.
        let graver = now.causes().find(|other| other.gravity() > cause.gravity());
        graver.map_or(self.state, |graver| self.failsafe(now, graver))
    }

    /// The configured task after a failsafe for this cause.
    fn task_after(&self, cause: Cause) -> Option<Task> {
        let action = match cause {
            Cause::OrderStale => self.actions.order_stale,
            Cause::Geofence => self.actions.geofence,
            Cause::BatteryLow => self.actions.battery_low,
            Cause::Hung(_) => self.actions.hung,
            // The boat has no link, is controlled by someone else, has lost its position or
            // heading, or does not respond to thrust.
            _ => FailsafeAction::Standby,
        };
        match action {
            FailsafeAction::Standby => None,
            FailsafeAction::StationKeep => Some(Task::StationKeep),
            FailsafeAction::GoToErp => Some(Task::GoToErp),
        }
    }

    fn action(&self, now: &Conditions) -> Action {
        match self.state {
            // Zero thrust in mode T rather than standby: the boat continues by itself when the box
            // is clear.
            State::Armed if now.blocked => Action::Zero,
            State::Armed => Action::Follow,
            State::Delegated(task) => Action::Task(task),
            State::Failsafe {
                task: Some(task), ..
            } => Action::Task(task),
            State::Disarmed | State::Failsafe { task: None, .. } | State::EStopped => {
                Action::Standby
            }
        }
    }
}

impl Conditions {
    /// Reasons not to drive the boat, most severe first.
    fn causes(&self) -> impl Iterator<Item = Cause> {
        let link = (!self.link).then_some(Cause::LinkLost);
        // Without navigation, this is unknown.
        let geofence = (!self.inside && self.nav.is_none()).then_some(Cause::Geofence);
        let battery = self.battery_low.then_some(Cause::BatteryLow);
        let order = (!self.order_fresh).then_some(Cause::OrderStale);
        let hung = self.hung_s.map(Cause::Hung);
        let control = self.control.map(Cause::Control);
        let nav = self.nav.map(Cause::Nav);
        let thrust = self.thrust.map(Cause::Thrust);
        // In the order shown to operators: a cause that makes others meaningless comes first.
        [link, hung, control, nav, thrust, geofence, battery, order]
            .into_iter()
            .flatten()
    }

    /// The failsafe cause of a delegated boat: it needs no order, but some tasks have other
    /// conditions.
    fn unfit_failsafe(&self, task: Task) -> Option<Cause> {
        self.causes()
            .find(|cause| *cause != Cause::OrderStale)
            .or(self.missing_for(task))
    }

    /// The condition that makes a task impossible after a failsafe, if any.
    fn hindrance(&self, task: Task) -> Option<Cause> {
        self.causes()
            .find(|cause| !cause.leaves_control())
            .or(self.missing_for(task))
    }

    /// The condition that this task lacks beyond the common ones, if any.
    fn missing_for(&self, task: Task) -> Option<Cause> {
        (task == Task::GoToErp && !self.recovery_point).then_some(Cause::NoRecoveryPoint)
    }

    /// All conditions that are missing for arming.
    pub(crate) fn missing(&self) -> Vec<Cause> {
        // While we do not command the boat, the mode that it reports means nothing.
        let is_reported = |cause: &Cause| {
            matches!(
                cause,
                Cause::Control(ControlFault::Disobeyed(_) | ControlFault::Deaf)
            )
        };
        self.causes().filter(|cause| !is_reported(cause)).collect()
    }

    /// All conditions that are missing for delegating this task to the boat's own controller.
    pub(crate) fn unfit(&self, task: Task) -> Vec<Cause> {
        let general = self
            .missing()
            .into_iter()
            .filter(|cause| *cause != Cause::OrderStale);
        general.chain(self.missing_for(task)).collect()
    }
}

#[cfg(test)]
mod tests;
