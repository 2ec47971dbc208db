//! An emulated Surveyor: commands in, telemetry out, without sockets or clocks; an emulated
//! ArduPilot boat, in `ardupilot`; and ArduPilot's own firmware, in `sitl`.
//!
//! The emulated Surveyor is as strict and as tolerant as a real one is known to be: it sends
//! telemetry even in standby, follows only the operator in control, and reads commands of four to
//! six fields. By default, it has no watchdog, and follows the last command forever.

mod ardupilot;
mod autopilot;
mod battery;
mod front_seat;
mod sensed;
mod sitl;
mod telemetry;

pub use ardupilot::{ArduPilot, SYSTEM};
pub use front_seat::FrontSeat;
pub use sitl::{Servos, Sitl};
pub use telemetry::Extra;

use crate::geodesy::LocalFrame;
use crate::nmea::{
    Command, Date, Framer, M_S_PER_KN, Mode, Operator, Sentence, TimeOfDay, date_and_time,
};
use autopilot::Autopilot;
use battery::{Battery, Pack};
use messages::Order;
use messages::picture::OwnBoat;
use primitives::SimTime;
use primitives::frame::LatLon;
use sensed::Sensed;

/// Settings of an emulated boat, constant except for its clock.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The origin of the field.
    pub datum: LatLon,
    /// Declination, east positive, rad.
    pub declination_rad: f64,
    /// Time without a command after which the boat goes to standby, s; `None` means never.
    pub watchdog_s: Option<f64>,
    /// Whether the boat ignores non-integer set-points and keeps the previous one, as one known
    /// simulator of the boat does.
    pub integers: bool,
    /// Sentences in addition to a Surveyor's.
    pub extra: Vec<Extra>,
    /// Date and time of day at time zero.
    pub began: (Date, TimeOfDay),
    /// Initial charge of the battery, as a fraction; `None` means full, without drain.
    pub charge: Option<f64>,
}

/// The port on which bytes arrive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    /// The primary operator: shore.
    Primary,
    /// The secondary operator: the back seat.
    Secondary,
}

/// The front seat of an emulated boat.
pub struct Emulator {
    plan: Plan,
    frame: LocalFrame,
    /// The framers, by port.
    framers: [Framer; 2],
    /// The operator in control.
    operator: Operator,
    /// The last command followed, and when.
    command: Command,
    commanded_at: SimTime,
    /// Thrust and difference in force in mode T, per cent.
    thrust_pct: f64,
    difference_pct: f64,
    autopilot: Autopilot,
    sensed: Sensed,
    battery: Battery,
    remark: Option<String>,
    /// The numbers of commands followed, and of commands ignored because another operator was in
    /// control.
    followed: u64,
    ignored: u64,
}

impl Emulator {
    /// A boat in standby; the back seat has control.
    pub fn new(plan: Plan) -> Emulator {
        Emulator {
            frame: LocalFrame::new(plan.datum),
            battery: Battery::new(Pack::SURVEYOR, plan.charge),
            plan,
            framers: [Framer::new(), Framer::new()],
            operator: Operator::Secondary,
            command: Command::default(),
            commanded_at: SimTime::ZERO,
            thrust_pct: 0.0,
            difference_pct: 0.0,
            autopilot: Autopilot::default(),
            sensed: Sensed::default(),
            remark: None,
            followed: 0,
            ignored: 0,
        }
    }

    /// Gives control to the given operator; the boat goes to standby.
    pub fn give_control(&mut self, now: SimTime, operator: Operator) {
        if self.operator != operator {
            self.operator = operator;
            self.follow_command(now, Command::default());
        }
    }

    /// Makes the battery report this voltage from now on, V.
    pub fn set_volts(&mut self, volts: f64) {
        self.battery.shown_v = Some(volts);
    }

    /// The thruster order that follows from the command.
    fn commanded(&mut self) -> Order {
        let Some(own) = &self.sensed.own else {
            return Order::Hold;
        };
        let heading = |command: &Command| {
            command
                .heading_deg
                .map(|deg| deg.to_radians() + self.plan.declination_rad)
        };
        match self.command.mode {
            Mode::Thruster => autopilot::thrust(self.thrust_pct, self.difference_pct),
            Mode::Heading => autopilot::steer(
                heading(&self.command),
                self.command.thrust.map(autopilot::speed_of_thrust),
            ),
            Mode::Speed => autopilot::steer(
                heading(&self.command),
                self.command.thrust.map(|speed_kn| speed_kn * M_S_PER_KN),
            ),
            Mode::StationKeep => self.autopilot.keep(own.nav.pose()),
            Mode::GoToErp => self.autopilot.go_to_erp(own.nav.pose()),
            Mode::Waypoint => self.autopilot.sail(own.nav.pose()),
            _ => Order::Hold,
        }
    }

    /// Appends one burst of telemetry.
    pub fn telemetry(&self, now: SimTime, out: &mut Vec<u8>) {
        telemetry::burst(self, now, out);
    }

    /// The last command.
    pub fn command(&self) -> &Command {
        &self.command
    }

    /// The numbers of commands followed, and of commands ignored because another operator was in
    /// control.
    pub fn counters(&self) -> (u64, u64) {
        (self.followed, self.ignored)
    }

    fn apply(&mut self, now: SimTime, port: Port, sentence: Sentence) {
        if port == Port::Primary {
            self.take_primary(now, &sentence);
        }
        let in_control = match port {
            Port::Primary => self.operator == Operator::Primary,
            Port::Secondary => self.operator == Operator::Secondary,
        };
        match sentence {
            // Count and ignore it silently, so that a back seat notices only if it checks which
            // operator is in control.
            Sentence::Command(_) if !in_control => self.ignored += 1,
            Sentence::Command(command) => {
                self.followed += 1;
                self.follow_command(now, command);
            }
            Sentence::MissionSettings(settings) if in_control => {
                self.autopilot.take_throttle(settings.throttle_pct)
            }
            Sentence::Waypoint(waypoint) if in_control => {
                self.autopilot
                    .take_waypoint(waypoint.index, self.frame.ned(waypoint.at));
            }
            _ => {}
        }
    }

    /// The primary operator takes control with any command. The word `OP2_ON` gives control to the
    /// secondary operator, `OP2_OFF` takes it away. Both words are our own: those of the real
    /// console are not public.
    fn take_primary(&mut self, now: SimTime, sentence: &Sentence) {
        let Sentence::Command(command) = sentence else {
            return;
        };
        let operator = if command.words == "OP2_ON" {
            Operator::Secondary
        } else {
            Operator::Primary
        };
        self.give_control(now, operator);
    }

    fn follow_command(&mut self, now: SimTime, command: Command) {
        self.commanded_at = now;
        match command.mode {
            Mode::Thruster => {
                let whole = |value: &f64| !self.plan.integers || value.fract() == 0.0;
                let of = |given: Option<f64>, before: f64| {
                    given.filter(whole).unwrap_or(before).clamp(-100.0, 100.0)
                };
                (self.thrust_pct, self.difference_pct) = (
                    of(command.thrust, self.thrust_pct),
                    of(command.difference, self.difference_pct),
                );
            }
            Mode::FileDownload => {
                let lines = command.heading_deg.unwrap_or(0.0);
                if lines > 0.0 {
                    self.autopilot.begin_download(lines);
                } else {
                    self.remark = self.autopilot.end_download();
                }
            }
            mode => {
                // A different mode ends mode T: its thrust must not return with a later command
                // that leaves a field empty.
                (self.thrust_pct, self.difference_pct) = (0.0, 0.0);
                // A command with the same mode continues the current task.
                if let (true, Some(own)) = (mode != self.command.mode, &self.sensed.own) {
                    self.autopilot.begin(own.nav.at());
                }
            }
        }
        self.command = command;
    }
}

impl FrontSeat for Emulator {
    fn set_clock(&mut self, now: SimTime, utc_ns: u64) {
        let (date, time) = date_and_time(utc_ns);
        self.plan.began = (date, time.later(SimTime::ZERO - now));
    }

    fn receive(&mut self, now: SimTime, port: Port, bytes: &[u8]) {
        // Move the framer out while it is in use: sentences change the rest of the emulator.
        let mut framer = std::mem::take(&mut self.framers[port as usize]);
        framer.push(bytes, &mut |body| {
            // Unknown sentences are ignored.
            if let Ok(sentence) = Sentence::parse(body) {
                self.apply(now, port, sentence);
            }
        });
        self.framers[port as usize] = framer;
    }

    fn take_remark(&mut self) -> Option<String> {
        self.remark.take()
    }

    fn operator(&self) -> Option<Operator> {
        Some(self.operator)
    }

    fn observe(&mut self, now: SimTime, own: &OwnBoat) {
        self.sensed.observe(now, own);
    }

    fn order(&mut self, now: SimTime) -> Order {
        let watchdog = self.plan.watchdog_s.map(SimTime::from_s);
        let silent = watchdog.is_some_and(|limit| now - self.commanded_at > limit);
        // The watchdog runs only if the settings enable it. It is not published whether Surveyors
        // have one, and a gateway that is safe without a watchdog is also safe with one.
        if silent && self.command.mode != Mode::Standby {
            self.command = Command::default();
        }
        let order = self.commanded();
        self.battery.carry_out(now, order)
    }

    fn telemetry(&mut self, now: SimTime, out: &mut Vec<u8>) {
        telemetry::burst(self, now, out);
    }
}
