//! The test rig: a boat with simple dynamics, its emulated front seat, the gateway, and a link with injectable faults.

use crate::oracle::Oracle;
use game::external::OperatorCommand;
use game::frame::{LatLon, Ned, Rotation};
use game::picture::{Imu, Nav, OwnBoat};
use game::{Order, SimTime, VehicleId};
use gateway::bridge::{Bridge, Event, FleetCommand, Input, NavOut, Output, Plan};
use gateway::emulator::{self, Emulator, Port};
use gateway::nmea::{Date, Operator, Sentence, TimeOfDay};
use std::path::Path;

const STEP_S: f64 = 0.01;
const TELEMETRY_STEPS: u64 = 10;

/// A boat that takes up thrust with a lag.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Boat {
    pub(crate) at: Ned,
    pub(crate) psi_rad: f64,
    pub(crate) speed_m_s: f64,
    pub(crate) turn_rad_s: f64,
}

/// What the link does to bytes from the boat.
pub(crate) type Tamper = Box<dyn FnMut(SimTime, Vec<u8>) -> Vec<Vec<u8>>>;

pub(crate) struct Rig {
    pub(crate) now: SimTime,
    steps: u64,
    pub(crate) boat: Boat,
    pub(crate) emulator: Emulator,
    pub(crate) bridge: Bridge,
    pub(crate) oracle: Oracle,
    /// Whether bytes go through: to the boat, and from it.
    pub(crate) open: (bool, bool),
    pub(crate) tamper: Option<Tamper>,
    /// The agent's order, ten times a second; `None` without an agent.
    pub(crate) order: Option<Order>,
    /// An agent that hangs repeats the time of its last picture.
    pub(crate) hangs: bool,
    given: SimTime,
    pub(crate) others: Option<Vec<Ned>>,
    pub(crate) frozen: bool,
    pub(crate) offset: Ned,
    pub(crate) events: Vec<(SimTime, Event)>,
    pub(crate) navs: Vec<(SimTime, NavOut)>,
    pub(crate) sent: Vec<(SimTime, Vec<u8>)>,
    pub(crate) refused: Option<String>,
    /// All inputs of the gateway, and its outputs.
    pub(crate) turns: Vec<(SimTime, Input, Output)>,
}

/// The plan of a gateway with this file's settings, on the field of the first game.
pub(crate) fn plan(file: &str, arms_itself: bool) -> Plan {
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
    let game = game::scenario::load(&scenarios.join("games/pav01_vs_pav01.toml")).unwrap_or_else(|e| panic!("{e}"));
    let gateway = scenarios.join("gateways").join(file);
    Plan {
        vehicle: "blue_one".to_owned(),
        gateway: game::scenario::load_gateway(&gateway).unwrap_or_else(|e| panic!("{e}")),
        length_m: 1.83,
        field: game.field,
        declination_rad: (-12.5_f64).to_radians(),
        arms_itself,
    }
}

/// The plan of an emulated boat.
pub(crate) fn emulated(datum: LatLon, declination_rad: f64) -> emulator::Plan {
    emulator::Plan {
        datum,
        declination_rad,
        watchdog_s: None,
        integers: false,
        extra: vec![],
        began: (Date { year: 2026, month: 11, day: 20 }, TimeOfDay(54_302_000)),
    }
}

/// The sentence of a body.
pub(crate) fn with_checksum(body: &str) -> String {
    format!("${body}*{:02X}\r\n", body.bytes().fold(0, |a, b| a ^ b))
}

/// A link that changes sentences from the boat, with right checksums.
pub(crate) fn rewritten(mut change: impl FnMut(&str) -> String + 'static) -> Option<Tamper> {
    let mut line = move |line: &str| {
        let body = change(line);
        with_checksum(body.trim_start_matches('$').split('*').next().unwrap_or_default())
    };
    Some(Box::new(move |_, bytes| {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        vec![text.lines().map(&mut line).collect::<String>().into_bytes()]
    }))
}

/// The same for fixes alone.
pub(crate) fn refixed(change: fn(&str) -> String) -> Option<Tamper> {
    rewritten(move |line| if line.starts_with("$GPGGA") { change(line) } else { line.to_owned() })
}

pub(crate) fn steer(heading_deg: f64, speed_m_s: f64) -> Order {
    Order::Steer { heading_rad: heading_deg.to_radians(), speed_m_s }
}

impl Rig {
    pub(crate) fn new(file: &str, watchdog_s: Option<f64>) -> Rig {
        Rig::of(plan(file, false), watchdog_s)
    }

    pub(crate) fn of(plan: Plan, watchdog_s: Option<f64>) -> Rig {
        let emulator = emulator::Plan { watchdog_s, ..emulated(plan.field.plan.datum, plan.declination_rad) };
        let mut rig = Rig {
            now: SimTime::ZERO,
            steps: 0,
            boat: Boat { at: Ned::from_xy(60.0, 40.0), ..Boat::default() },
            emulator: Emulator::new(emulator),
            bridge: Bridge::new(plan),
            oracle: Oracle::new(),
            open: (true, true),
            tamper: None,
            order: None,
            hangs: false,
            given: SimTime::ZERO,
            others: None,
            frozen: false,
            offset: Ned::default(),
            events: vec![],
            navs: vec![],
            sent: vec![],
            refused: None,
            turns: vec![],
        };
        rig.link(true);
        rig
    }

    /// A rig in which the boat sails east at 1.5 m/s, ten seconds on.
    pub(crate) fn under_way(file: &str, watchdog_s: Option<f64>) -> Rig {
        let mut rig = Rig::new(file, watchdog_s);
        rig.order = Some(steer(90.0, 1.5));
        rig.run(1.0);
        rig.operate(OperatorCommand::Arm);
        assert_eq!((rig.state().as_str(), rig.refused.take()), ("armed", None));
        rig.run(9.0);
        assert!(rig.boat.speed_m_s > 1.2, "{:?}", rig.boat);
        rig
    }

    pub(crate) fn state(&self) -> String {
        self.bridge.state().to_string()
    }

    pub(crate) fn put(&mut self, input: &Input) {
        let mut out = Output::default();
        match input {
            Input::Order(order, given) if order.check().is_ok() && *given > self.given => {
                (self.oracle.ordered, self.given) = (self.now, *given);
            }
            Input::Fleet(command) => self.oracle.stopped = *command == FleetCommand::EStop,
            Input::Operator(OperatorCommand::EStop) => self.oracle.stopped = true,
            Input::Operator(OperatorCommand::Release) => self.oracle.stopped = false,
            Input::Operator(OperatorCommand::Arm) => self.oracle.armed = true,
            _ => {}
        }
        self.bridge.take(self.now, input, &mut out);
        self.turns.push((self.now, input.clone(), out.clone()));
        self.take_out(out);
    }

    fn take_out(&mut self, out: Output) {
        for event in out.events {
            // Whatever state it goes to from armed, it has to be armed anew.
            if matches!(&event, Event::State { from, .. } if from == "armed") {
                self.oracle.armed = false;
            }
            self.events.push((self.now, event));
        }
        self.navs.extend(out.nav.map(|nav| (self.now, nav)));
        self.refused = out.refused.or(self.refused.take());
        if !out.bytes.is_empty() {
            self.oracle.judge(self.now, &out.bytes);
            self.sent.push((self.now, out.bytes.clone()));
            if self.open.0 {
                self.emulator.take(self.now, Port::Secondary, &out.bytes);
            }
        }
    }

    pub(crate) fn operate(&mut self, command: OperatorCommand) {
        self.put(&Input::Operator(command));
    }

    pub(crate) fn link(&mut self, up: bool) {
        self.oracle.link_up = up;
        if up {
            (self.oracle.fixed, self.oracle.headed, self.oracle.granted) =
                (SimTime::LONG_AGO, SimTime::LONG_AGO, SimTime::LONG_AGO);
        }
        self.put(if up { &Input::LinkUp } else { &Input::LinkDown });
    }

    pub(crate) fn run(&mut self, seconds: f64) {
        for _ in 0..(seconds / STEP_S).round() as u64 {
            self.step();
        }
    }

    /// Runs until `is_so`, no longer than `limit_s`; returns after how many seconds.
    pub(crate) fn run_until(&mut self, limit_s: f64, mut is_so: impl FnMut(&Rig) -> bool) -> f64 {
        let start = self.now;
        while !is_so(self) {
            let passed_s = (self.now - start).as_s();
            assert!(
                passed_s < limit_s,
                "not so after {limit_s} s: {}, {:?}, {:?}",
                self.state(),
                self.boat,
                self.events
            );
            self.step();
        }
        (self.now - start).as_s()
    }

    fn step(&mut self) {
        self.steps += 1;
        self.now = SimTime::from_s(STEP_S * self.steps as f64);
        self.move_boat();
        if self.steps.is_multiple_of(TELEMETRY_STEPS) {
            self.send_telemetry();
            if let Some(order) = self.order {
                let given = if self.hangs { self.given } else { self.now };
                self.put(&Input::Order(order, given));
            }
            if let Some(others) = self.others.clone() {
                self.put(&Input::Others(others));
            }
        }
        self.put(&Input::Tick);
    }

    /// Thrust and speed with a lag of two seconds, difference and turn with one of half a second.
    fn move_boat(&mut self) {
        let (speed_m_s, turn_rad_s) = match self.emulator.order(self.now) {
            Order::Hold => (0.0, 0.0),
            Order::Thrust { port, starboard } => (1.6 * (port + starboard), 1.5 * (port - starboard)),
            Order::Steer { heading_rad, speed_m_s } => {
                let error_rad = game::angle::wrap_pi(heading_rad - self.boat.psi_rad);
                (speed_m_s, error_rad.clamp(-0.5, 0.5))
            }
        };
        let boat = &mut self.boat;
        boat.speed_m_s += (speed_m_s - boat.speed_m_s) * STEP_S / 2.0;
        boat.turn_rad_s += (turn_rad_s - boat.turn_rad_s) * STEP_S / 0.5;
        boat.psi_rad = game::angle::wrap_pi(boat.psi_rad + boat.turn_rad_s * STEP_S);
        boat.at = boat.at + Rotation::from_heading(boat.psi_rad).ahead().scaled(boat.speed_m_s * STEP_S);
    }

    /// The boat's sensors measure, and it sends telemetry.
    fn send_telemetry(&mut self) {
        let place = self.boat.at + self.offset;
        let nav = Nav {
            north_m: place.north,
            east_m: place.east,
            psi_rad: self.boat.psi_rad,
            surge_m_s: self.boat.speed_m_s,
            sway_m_s: 0.0,
            yaw_rate_rad_s: self.boat.turn_rad_s,
        };
        let imu = Imu { down_m_s2: -9.8, ..Imu::default() };
        let own = OwnBoat { fix_ns: self.now, imu, ..OwnBoat::new(VehicleId(0), nav) };
        if !self.frozen {
            self.emulator.observe(self.now, &own);
        }
        let mut bytes = vec![];
        self.emulator.telemetry(self.now, &mut bytes);
        let pieces = match &mut self.tamper {
            Some(tamper) => tamper(self.now, bytes),
            None => vec![bytes],
        };
        if self.open.1 && self.oracle.link_up {
            for piece in pieces {
                self.note(&piece);
                self.put(&Input::Bytes(piece));
            }
        }
    }

    /// What the oracle sees in bytes from the boat: whole sentences within one piece, by their text.
    fn note(&mut self, piece: &[u8]) {
        let text = String::from_utf8_lossy(piece);
        for line in text.split("\r\n").filter_map(|line| line.split('$').next_back()) {
            let Some((body, sum)) = line.split_once('*') else { continue };
            let xor = body.bytes().fold(0, |a, b| a ^ b);
            if u8::from_str_radix(sum, 16) != Ok(xor) {
                continue;
            }
            match Sentence::parse(body) {
                Ok(Sentence::Gga(gga)) if gga.quality > 0 && gga.at.is_some() => self.oracle.fixed = self.now,
                Ok(Sentence::Attitude(attitude)) if attitude.heading_deg.is_some() => self.oracle.headed = self.now,
                Ok(Sentence::ControlState(state)) => {
                    self.oracle.other_operator = state.operator != Some(Operator::Secondary);
                    if !self.oracle.other_operator {
                        self.oracle.granted = self.now;
                    }
                }
                _ => {}
            }
        }
    }

    /// The letter of the mode that the boat is in.
    pub(crate) fn mode(&self) -> char {
        self.emulator.command().mode.letter()
    }

    pub(crate) fn is_at_rest(&self) -> bool {
        self.boat.speed_m_s.abs() < 0.05
    }

    pub(crate) fn has_event(&self, words: &str) -> bool {
        self.events.iter().any(|(_, event)| format!("{event:?}").contains(words))
    }
}
