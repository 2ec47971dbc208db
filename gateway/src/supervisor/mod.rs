//! When a boat may be driven, and when it is stopped: a pure state machine.
//!
//! ```text
//!                    arm [ready]                       any condition fails
//!        ┌────────┐ ────────────▶ ┌─────────┐ ───────────────────────────▶ ┌───────────────┐
//!   ●──▶ │ Safed  │               │  Armed  │                              │ Failsafe(why)  │
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
//! *Ready* is: link up, control granted, navigation sound, inside the fence, battery not low, order fresh. *Fit* is the
//! same without an order. Only in `Armed` does anything that moves the boat come from us, and only while it is ready in
//! this very step and nobody is in the way. There is no clock in here: what is fresh, sound or granted now is told by
//! [`Conditions`], so that every state can be tried with every input.

mod cause;

pub use cause::{Cause, Missing, NavFault};

use game::gateway::LowBattery;

/// What is true now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Whether bytes can reach the boat.
    pub link: bool,
    /// What the boat says about who commands it.
    pub control: Control,
    /// What is wrong with navigation.
    pub nav: Option<NavFault>,
    /// Whether the boat is inside the fence and can stop there.
    pub inside: bool,
    /// Whether the battery is low.
    pub battery_low: bool,
    /// Whether another real boat is in the way.
    pub blocked: bool,
    /// Whether there is a sound order that is young enough.
    pub order_fresh: bool,
}

impl Conditions {
    /// What is true before anything has come.
    pub const NOTHING: Conditions = Conditions {
        link: false,
        control: Control::Unknown,
        nav: Some(NavFault::NoFix),
        inside: false,
        battery_low: false,
        blocked: false,
        order_fresh: false,
    };
}

/// What the boat says about who commands it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// It listens to us.
    Granted,
    /// It has not said so lately.
    Unknown,
    /// Somebody else has it: PSEAD's number of the operator.
    Other(u8),
    /// It listens to us and shows another mode than the one it was sent.
    Disobeys(char),
}

/// What somebody wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Follow orders.
    Arm,
    /// Stop following them.
    Disarm,
    /// Stop, and stay stopped: this boat, or the whole fleet.
    EStop(Reach),
    /// The E-stop is over.
    Release(Reach),
    /// The boat sails by its own means.
    Delegate(Task),
}

/// Whom an E-stop is for. One is released without the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// This boat.
    Boat,
    /// All boats.
    Fleet,
}

/// What a boat does by its own means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// Keeps its station.
    StationKeep,
    /// Goes to its emergency recovery point.
    GoToErp,
    /// Sails the mission that it has taken up.
    Mission,
}

/// Where the machine stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum State {
    /// Standby, waiting to be armed.
    Safed,
    /// Following orders.
    Armed,
    /// Standby since something went wrong.
    Failsafe(Cause),
    /// The boat sails by its own means.
    Delegated(Task),
    /// Standby until the E-stop is released.
    EStopped,
}

/// What the boat is told now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Standby; after thrust, thrust zero before it.
    Standby,
    /// Thrust zero.
    Zero,
    /// What the order says.
    Follow,
    /// To sail by its own means.
    Task(Task),
}

/// Why a wish is not granted.
#[derive(Clone, Debug, PartialEq)]
pub enum Refusal {
    /// These things are missing.
    NotReady(Vec<Missing>),
    /// An E-stop is in force.
    EStopped,
}

/// What a step brought.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// What the boat is told.
    pub action: Action,
    /// Why the wish was not granted.
    pub refusal: Option<Refusal>,
    /// The state before, if it is another now.
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
    low_battery: LowBattery,
}

impl Supervisor {
    /// A machine that is safed. With `arms_itself` it arms when it is ready for the first time, unless anybody wishes
    /// anything before; after whatever stops it then, it has to be told.
    #[must_use]
    pub fn new(arms_itself: bool, low_battery: LowBattery) -> Supervisor {
        Supervisor { state: State::Safed, stops: [false; 2], arms_itself, low_battery }
    }

    /// Where it stands.
    #[must_use]
    pub fn state(&self) -> State {
        self.state
    }

    /// Whose E-stops are in force, in words.
    #[must_use]
    pub fn stopped_by(&self) -> &'static str {
        match self.stops {
            [true, true] => "this boat and of the fleet",
            [true, false] => "this boat",
            [false, true] => "the fleet",
            [false, false] => "nobody",
        }
    }

    /// Goes on by one step.
    pub fn step(&mut self, now: &Conditions, wish: Option<Wish>) -> Step {
        let before = self.state;
        let refusal = wish.and_then(|wish| self.heed(now, wish));
        if self.arms_itself && self.state == State::Safed && now.missing().is_empty() {
            self.state = State::Armed;
        }
        self.watch(now);
        // An arming is used up by the first time it leads anywhere.
        self.arms_itself &= self.state == State::Safed && wish.is_none();
        let changed = (self.state != before).then_some(before);
        Step { action: self.action(now), refusal, before: changed }
    }

    fn heed(&mut self, now: &Conditions, wish: Wish) -> Option<Refusal> {
        match wish {
            Wish::EStop(reach) => self.stops[reach as usize] = true,
            Wish::Release(reach) => self.stops[reach as usize] = false,
            Wish::Arm | Wish::Delegate(_) if self.is_stopped() => return Some(Refusal::EStopped),
            Wish::Arm => return self.enter(State::Armed, now.missing()),
            Wish::Delegate(task) => return self.enter(State::Delegated(task), now.unfit()),
            Wish::Disarm => self.state = State::Safed,
        }
        None
    }

    fn enter(&mut self, state: State, missing: Vec<Missing>) -> Option<Refusal> {
        if missing.is_empty() {
            self.state = state;
            return None;
        }
        Some(Refusal::NotReady(missing))
    }

    fn is_stopped(&self) -> bool {
        self.stops.contains(&true)
    }

    /// Leaves states that the conditions do not bear.
    fn watch(&mut self, now: &Conditions) {
        self.state = match self.state {
            _ if self.is_stopped() => State::EStopped,
            State::EStopped => State::Safed,
            State::Armed => match now.trip() {
                // A boat that is sound but for its battery may have somewhere to go by itself.
                Some(Cause::BatteryLow) => self.on_low_battery(),
                Some(cause) => State::Failsafe(cause),
                None => State::Armed,
            },
            State::Delegated(task) => match now.trip_of_fitness() {
                Some(Cause::BatteryLow) if self.low_battery_task() == Some(task) => self.state,
                Some(Cause::BatteryLow) => self.on_low_battery(),
                Some(cause) => State::Failsafe(cause),
                None => self.state,
            },
            State::Safed | State::Failsafe(_) => self.state,
        };
    }

    fn on_low_battery(&self) -> State {
        self.low_battery_task().map_or(State::Failsafe(Cause::BatteryLow), State::Delegated)
    }

    fn low_battery_task(&self) -> Option<Task> {
        match self.low_battery {
            LowBattery::Standby => None,
            LowBattery::StationKeep => Some(Task::StationKeep),
            LowBattery::GoToErp => Some(Task::GoToErp),
        }
    }

    fn action(&self, now: &Conditions) -> Action {
        match self.state {
            State::Armed if now.blocked => Action::Zero,
            State::Armed => Action::Follow,
            State::Delegated(task) => Action::Task(task),
            State::Safed | State::Failsafe(_) | State::EStopped => Action::Standby,
        }
    }
}

impl Conditions {
    /// Why an armed boat must be stopped, the gravest first.
    #[must_use]
    pub fn trip(&self) -> Option<Cause> {
        self.trip_of_fitness().or((!self.order_fresh).then_some(Cause::OrderStale))
    }

    /// The same without the order.
    fn trip_of_fitness(&self) -> Option<Cause> {
        let control = match self.control {
            Control::Granted => None,
            Control::Unknown => Some(Cause::ControlUnknown),
            Control::Other(operator) => Some(Cause::TakenOver(operator)),
            Control::Disobeys(mode) => Some(Cause::Disobeyed(mode)),
        };
        (!self.link)
            .then_some(Cause::LinkLost)
            .or(control)
            .or(self.nav.map(Cause::Nav))
            .or((!self.inside).then_some(Cause::Geofence))
            .or(self.battery_low.then_some(Cause::BatteryLow))
    }

    /// Everything that keeps a boat from being armed.
    #[must_use]
    pub fn missing(&self) -> Vec<Missing> {
        let mut missing = self.unfit();
        missing.extend((!self.order_fresh).then_some(Missing::Order));
        missing
    }

    /// Everything that keeps a boat from sailing by its own means.
    #[must_use]
    pub fn unfit(&self) -> Vec<Missing> {
        let control = match self.control {
            // What it shows while it is not commanded says nothing.
            Control::Granted | Control::Disobeys(_) => None,
            Control::Unknown | Control::Other(_) => Some(Missing::Control(self.control)),
        };
        let nav = self.nav.map(Missing::Nav);
        let fence = (!self.inside && self.nav.is_none()).then_some(Missing::Inside);
        let battery = self.battery_low.then_some(Missing::Battery);
        (!self.link)
            .then_some(Missing::Link)
            .into_iter()
            .chain(control)
            .chain(nav)
            .chain(fence)
            .chain(battery)
            .collect()
    }
}

#[cfg(test)]
mod tests;
