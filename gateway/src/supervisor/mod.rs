//! When a boat may be driven, and when it is stopped: a pure state machine.
//!
//! ```text
//!                    arm [ready]                       any condition fails
//!        ┌────────┐ ────────────▶ ┌─────────┐ ───────────────────────────▶ ┌───────────────┐
//!   ●──▶ │ Safed  │               │  Armed  │                              │ Failsafe(why) │
//!        └────────┘ ◀──────────── └─────────┘ ◀─────────────────────────── └───────────────┘
//!          ▲ ▲  │      disarm          │                arm [ready]           │         ▲
//!          │ │  │                      │ delegate [fit]                       │ disarm  │ a condition of
//!          │ │  └──────────────────────┼──────────────────────────────────────┼──▶ Safed│ delegation fails
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
//! *Ready* is: link up, control granted, navigation sound, inside the geofence, battery not low, order fresh. *Fit* is the
//! same without an order. Only in `Armed` does anything that moves the boat come from us, and only while it is ready in
//! this very step and no other boat is in the way. After a failsafe the boat stops, or its own controller takes over if the gateway's
//! file says so for that cause and nothing that this needs has failed. There is no clock in here: [`Conditions`] say what is fresh, sound or
//! granted now, so that a test can try every state with every input.

mod cause;

pub use cause::{Cause, NavFault};

use crate::config::{FailsafeAction, FailsafeActions};
use crate::thrust_check::ThrustFault;
use messages::external::BoatMode;
use thiserror::Error;

/// What is true now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Whether bytes can reach the boat.
    pub link: bool,
    /// For how long the gateway itself did not run until now, s, if its guard may have stopped the boat meanwhile.
    pub hung_s: Option<f64>,
    /// Who commands the boat, by its own report.
    pub control: Control,
    /// What is wrong with navigation.
    pub nav: Option<NavFault>,
    /// What the boat does not do though it is ordered to.
    pub thrust: Option<ThrustFault>,
    /// Whether the boat has a recovery point that we uploaded, and that is inside of the geofence.
    pub recovery_point: bool,
    /// Whether the boat is inside the geofence and can stop there.
    pub inside: bool,
    /// Whether the battery is low.
    pub battery_low: bool,
    /// Whether another real boat is in the way.
    pub blocked: bool,
    /// Whether there is a sound order that is not older than its time to live.
    pub order_fresh: bool,
}

impl Conditions {
    /// Before anything was received.
    pub const UNKNOWN: Conditions = Conditions {
        link: false,
        hung_s: None,
        control: Control::Unknown,
        nav: Some(NavFault::NoFix),
        thrust: None,
        recovery_point: false,
        inside: false,
        battery_low: false,
        blocked: false,
        order_fresh: false,
    };
}

/// Who commands the boat, by its own report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// We do.
    Granted,
    /// It has not reported so lately.
    Unknown,
    /// Another operator: PSEAD's number.
    Other(u8),
    /// We do, and it reports another mode than the one it was sent.
    Disobeys(char),
    /// We do, and it reports thrust of a command that others have followed since.
    Deaf,
    /// We do, and it reports a command that we have not sent.
    Foreign,
}

/// What an operator requests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OperatorRequest {
    /// Follow orders.
    Arm,
    /// Stop following them.
    Disarm,
    /// Stop, and stay stopped: this boat, or the whole fleet.
    EStop(Scope),
    /// The E-stop is over.
    Release(Scope),
    /// The boat's own controller takes over with a task.
    Delegate(Task),
}

/// What an E-stop is for. One is released without the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// This boat.
    Boat,
    /// All boats.
    Fleet,
}

/// What the boat's own controller does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Task {
    /// Keeps its station.
    StationKeep,
    /// Goes to its emergency recovery point.
    GoToErp,
    /// Sails the mission that was uploaded.
    Mission,
    /// Is in another mode.
    Mode(BoatMode),
}

/// The state of the supervisor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum State {
    /// Standby, waiting to be armed.
    Safed,
    /// Following orders.
    Armed,
    /// A failsafe, until it is armed anew.
    Failsafe {
        /// Why.
        cause: Cause,
        /// What the boat's own controller does meanwhile; with nothing, standby.
        task: Option<Task>,
    },
    /// The boat's own controller takes over with a task.
    Delegated(Task),
    /// Standby until the E-stop is released.
    EStopped,
}

/// What the boat is sent now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Standby; after thrust, thrust zero before it.
    Standby,
    /// Thrust zero.
    Zero,
    /// What the order says.
    Follow,
    /// A task for its own controller.
    Task(Task),
}

/// Why a request is refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Refusal {
    /// These things are missing.
    #[error("missing: {}", .0.iter().map(|cause| cause.missing()).collect::<Vec<_>>().join("; "))]
    NotReady(Vec<Cause>),
    /// An E-stop is in force.
    #[error("an E-stop is in force")]
    EStopped,
}

/// The result of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// What the boat is sent.
    pub action: Action,
    /// Why the request was refused.
    pub refusal: Option<Refusal>,
    /// The state before, if it changed.
    pub before: Option<State>,
}

/// The state machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Supervisor {
    state: State,
    /// E-stops in force: of the boat, of the fleet.
    stops: [bool; 2],
    /// Whether to arm by itself as soon as everything is there, once.
    arms_itself: bool,
    actions: FailsafeActions,
}

impl Supervisor {
    /// A safed supervisor. With `arms_itself` it arms when it is ready for the first time, unless an operator requests
    /// anything before; after whatever stops it then, it has to be armed by request.
    #[must_use]
    pub fn new(arms_itself: bool, actions: FailsafeActions) -> Supervisor {
        Supervisor { state: State::Safed, stops: [false; 2], arms_itself, actions }
    }

    /// The state.
    #[must_use]
    pub fn state(&self) -> State {
        self.state
    }

    /// Which E-stops are in force, in words.
    #[must_use]
    pub fn stopped_by(&self) -> &'static str {
        match self.stops {
            [true, true] => "this boat and of the fleet",
            [true, false] => "this boat",
            [false, true] => "the fleet",
            [false, false] => "nobody",
        }
    }

    /// Makes one step.
    pub fn step(&mut self, now: &Conditions, request: Option<OperatorRequest>) -> Step {
        let before = self.state;
        let refusal = request.and_then(|request| self.take_request(now, request));
        if self.arms_itself && self.state == State::Safed && now.missing().is_empty() {
            self.state = State::Armed;
        }
        // After the request: an arming that is granted and fails in the same step ends in the
        // failsafe, with its cause.
        self.check_failsafes(now);
        // Arming by itself is used up by the first change of state.
        self.arms_itself &= self.state == State::Safed && request.is_none();
        let changed = (self.state != before).then_some(before);
        Step { action: self.action(now), refusal, before: changed }
    }

    fn take_request(&mut self, now: &Conditions, request: OperatorRequest) -> Option<Refusal> {
        match request {
            OperatorRequest::EStop(scope) => self.stops[scope as usize] = true,
            OperatorRequest::Release(scope) => self.stops[scope as usize] = false,
            OperatorRequest::Arm | OperatorRequest::Delegate(_) if self.is_stopped() => return Some(Refusal::EStopped),
            OperatorRequest::Arm => return self.enter(State::Armed, now.missing()),
            OperatorRequest::Delegate(task) => return self.enter(State::Delegated(task), now.unfit(task)),
            OperatorRequest::Disarm => self.state = State::Safed,
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
            // Released, it is safed and not what it was before: somebody has to arm it.
            State::EStopped => State::Safed,
            State::Armed => now.failsafe().map_or(State::Armed, |cause| self.failsafe(now, cause)),
            State::Delegated(task) => now.unfit_failsafe(task).map_or(self.state, |cause| self.failsafe(now, cause)),
            State::Failsafe { cause, task: Some(task) } => self.watch_task(now, cause, task),
            State::Safed | State::Failsafe { task: None, .. } => self.state,
        };
    }

    /// The failsafe of this cause, with what the boat does after it, if it still can.
    fn failsafe(&self, now: &Conditions, cause: Cause) -> State {
        let task = self.task_after(cause).filter(|task| now.hindrance(*task).is_none());
        State::Failsafe { cause, task }
    }

    /// A task after a failsafe goes on until the boat cannot do it, or something graver happens.
    fn watch_task(&self, now: &Conditions, cause: Cause, task: Task) -> State {
        if let Some(cause) = now.hindrance(task) {
            return State::Failsafe { cause, task: None };
        }
        // Of two causes the geofence decides before the battery: a boat that leaves its water
        // endangers others, one that runs empty only itself.
        let graver = now.causes().find(|other| other.gravity() > cause.gravity());
        graver.map_or(self.state, |graver| self.failsafe(now, graver))
    }

    /// What the boat does after a failsafe of this cause.
    fn task_after(&self, cause: Cause) -> Option<Task> {
        let action = match cause {
            Cause::OrderStale => self.actions.order_stale,
            Cause::Geofence => self.actions.geofence,
            Cause::BatteryLow => self.actions.battery_low,
            Cause::Hung(_) => self.actions.hung,
            // It hears nothing or obeys nobody, does not know where it is or points, or is not moved by its thrusters.
            _ => FailsafeAction::Standby,
        };
        match action {
            FailsafeAction::Standby => None,
            // For four causes only. With an action for each, somebody would let a boat keep
            // station on a lost fix.
            FailsafeAction::StationKeep => Some(Task::StationKeep),
            FailsafeAction::GoToErp => Some(Task::GoToErp),
        }
    }

    fn action(&self, now: &Conditions) -> Action {
        match self.state {
            // Thrust zero in mode T and not standby: it goes on by itself when the box is
            // clear.
            State::Armed if now.blocked => Action::Zero,
            State::Armed => Action::Follow,
            State::Delegated(task) => Action::Task(task),
            State::Failsafe { task: Some(task), .. } => Action::Task(task),
            State::Safed | State::Failsafe { task: None, .. } | State::EStopped => Action::Standby,
        }
    }
}

impl Conditions {
    /// What speaks against driving the boat, the gravest first.
    fn causes(&self) -> impl Iterator<Item = Cause> {
        let control = match self.control {
            Control::Granted => None,
            Control::Unknown => Some(Cause::ControlUnknown),
            Control::Other(operator) => Some(Cause::TakenOver(operator)),
            Control::Disobeys(mode) => Some(Cause::Disobeyed(mode)),
            Control::Deaf => Some(Cause::Deaf),
            Control::Foreign => Some(Cause::ForeignOrders),
        };
        let link = (!self.link).then_some(Cause::LinkLost);
        // Without navigation nobody knows.
        let geofence = (!self.inside && self.nav.is_none()).then_some(Cause::Geofence);
        let battery = self.battery_low.then_some(Cause::BatteryLow);
        let order = (!self.order_fresh).then_some(Cause::OrderStale);
        let hung = self.hung_s.map(Cause::Hung);
        let (nav, thrust) = (self.nav.map(Cause::Nav), self.thrust.map(Cause::Thrust));
        // The order in which they are shown to operators: what makes the others meaningless
        // comes first.
        [link, hung, control, nav, thrust, geofence, battery, order].into_iter().flatten()
    }

    /// The failsafe of an armed boat.
    #[must_use]
    pub fn failsafe(&self) -> Option<Cause> {
        self.causes().next()
    }

    /// The same for a delegated boat, which needs no order, and for some tasks more.
    fn unfit_failsafe(&self, task: Task) -> Option<Cause> {
        self.causes().find(|cause| *cause != Cause::OrderStale).or(self.missing_for(task))
    }

    /// What makes a task impossible after a failsafe, whatever caused that.
    fn hindrance(&self, task: Task) -> Option<Cause> {
        self.causes().find(|cause| !cause.leaves_control()).or(self.missing_for(task))
    }

    /// What a task needs beside what all of them do.
    fn missing_for(&self, task: Task) -> Option<Cause> {
        (task == Task::GoToErp && !self.recovery_point).then_some(Cause::NoRecoveryPoint)
    }

    /// Everything that is missing for arming.
    #[must_use]
    pub fn missing(&self) -> Vec<Cause> {
        // The mode of a boat that is not commanded means nothing.
        self.causes().filter(|cause| !matches!(cause, Cause::Disobeyed(_) | Cause::Deaf)).collect()
    }

    /// Everything that is missing for delegating a task to the boat's own controller.
    #[must_use]
    pub fn unfit(&self, task: Task) -> Vec<Cause> {
        let general = self.missing().into_iter().filter(|cause| *cause != Cause::OrderStale);
        general.chain(self.missing_for(task)).collect()
    }
}

#[cfg(test)]
mod tests;
