//! The test rig: a boat with simple dynamics, its emulated front seat, the gateway, and a faulty
//! link.

use crate::boat::{Boat, STEP_S, emulated};
use crate::oracle::{Oracle, age_s};
use crate::tamper::Tamper;
use gateway::bridge::{Bridge, Event, Input, NavOut, Output, Plan, Site};
use gateway::emulator::{self, Emulator, FrontSeat, Port};
use gateway::nmea::with_checksum;
use messages::Order;
use messages::external::{FleetCommand, OperatorCommand};
use primitives::SimTime;
use primitives::frame::{LatLon, Ned};
use std::path::Path;

const TELEMETRY_STEPS: u64 = 10;

pub(crate) struct Rig {
    pub(crate) now: SimTime,
    steps: u64,
    pub(crate) boat: Boat,
    pub(crate) emulator: Emulator,
    /// The order for the boat's thrusters.
    pub(crate) boat_order: Order,
    pub(crate) bridge: Bridge,
    pub(crate) oracle: Oracle,
    /// Whether bytes pass to the boat, and whether they pass from it.
    pub(crate) open: (bool, bool),
    pub(crate) tamper: Option<Tamper>,
    /// The agent's order, ten times a second; `None` without an agent.
    pub(crate) order: Option<Order>,
    /// Whether the agent hangs and repeats the time of its last picture.
    pub(crate) hangs: bool,
    given: SimTime,
    pub(crate) others: Option<Vec<Ned>>,
    /// Whether the receiver measures nothing new.
    pub(crate) frozen: bool,
    /// The position that a stuck receiver keeps reporting as new.
    pub(crate) pinned: Option<Ned>,
    pub(crate) offset: Ned,
    pub(crate) events: Vec<(SimTime, Event)>,
    pub(crate) navs: Vec<(SimTime, NavOut)>,
    pub(crate) sent: Vec<(SimTime, Vec<u8>)>,
    /// Why the last command was refused, if it was.
    pub(crate) refused: Option<String>,
    /// The last log message of the emulated boat.
    pub(crate) remark: String,
    /// How long the last wait took, s.
    pub(crate) after_s: f64,
    /// The boat's position and the counts at the last mark.
    pub(crate) marked: (Ned, Vec<(String, u64)>),
    /// All inputs of the gateway with their outputs.
    pub(crate) turns: Vec<(SimTime, Input, Output)>,
}

/// The plan of a gateway with the settings of this file, on the field of the first game.
pub(crate) fn plan(file: &str) -> Plan {
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
    let game = scenario::load(&scenarios.join("games/pav01_vs_pav01.toml"))
        .unwrap_or_else(|e| panic!("{e}"));
    let gateway = scenario::load_file(&scenarios.join("gateways").join(file))
        .unwrap_or_else(|e| panic!("{e}"));
    let declination_rad = (-12.5_f64).to_radians();
    let site = Some(Site {
        length_m: 1.83,
        field: game.field,
        declination_rad,
        coasting: None,
    });
    Plan {
        site,
        ..Plan::new("blue_one", gateway)
    }
}

/// The origin of that field.
pub(crate) fn datum() -> LatLon {
    let site = plan("surveyor.toml").site;
    site.expect("the rig has one").field.plan.datum
}

impl Rig {
    /// A rig with this plan, whose emulated front seat is modified by `change`.
    pub(crate) fn of(plan: Plan, change: impl FnOnce(&mut emulator::Plan)) -> Rig {
        let Site {
            field,
            declination_rad,
            ..
        } = plan.site.as_ref().expect("the rig has one");
        let mut emulator = emulated(field.plan.datum, *declination_rad);
        change(&mut emulator);
        let rearm_within_s = plan.gateway.failsafe.rearm_within_s;
        let mut rig = Rig {
            now: SimTime::ZERO,
            steps: 0,
            boat: Boat {
                at: Ned::from_xy(60.0, 40.0),
                ..Boat::default()
            },
            emulator: Emulator::new(emulator),
            boat_order: Order::Hold,
            oracle: Oracle {
                armed: plan.arms_itself,
                rearm_within_s,
                ..Oracle::default()
            },
            bridge: Bridge::new(plan),
            open: (true, true),
            tamper: None,
            order: None,
            hangs: false,
            given: SimTime::ZERO,
            others: None,
            frozen: false,
            pinned: None,
            offset: Ned::default(),
            events: vec![],
            navs: vec![],
            sent: vec![],
            refused: None,
            remark: String::new(),
            after_s: 0.0,
            marked: (Ned::default(), vec![]),
            turns: vec![],
        };
        rig.link(true);
        rig
    }

    pub(crate) fn give(&mut self, input: &Input) {
        let mut out = Output::default();
        match input {
            Input::Order(order, given) if order.check().is_ok() && *given > self.given => {
                (self.oracle.ordered, self.given) = (Some(self.now), *given);
            }
            Input::Fleet(command) => self.oracle.stops[1] = *command == FleetCommand::EStop,
            Input::Operator(OperatorCommand::EStop) => self.oracle.stops[0] = true,
            Input::Operator(OperatorCommand::Release) => self.oracle.stops[0] = false,
            Input::Operator(OperatorCommand::Arm) => self.oracle.armed = true,
            _ => {}
        }
        if matches!(input, Input::Operator(_) | Input::Fleet(_)) {
            self.refused = None;
        }
        self.bridge.process(self.now, input, &mut out);
        self.turns.push((self.now, input.clone(), out.clone()));
        self.take_out(out);
    }

    fn take_out(&mut self, out: Output) {
        for event in out.events {
            // After any change from the armed state, the boat must be armed again.
            if let Event::State { from, to } = &event {
                let may_rearm = age_s(self.now, self.oracle.starved) <= self.oracle.rearm_within_s;
                self.oracle.armed &= from != "armed";
                self.oracle.armed |=
                    to == "armed" && from == "failsafe: no fresh order" && may_rearm;
                let is_starved = from == "armed" && to == "failsafe: no fresh order";
                self.oracle.starved = is_starved.then_some(self.now);
            }
            self.events.push((self.now, event));
        }
        self.navs.extend(out.nav.map(|nav| (self.now, nav)));
        self.refused = out.refused.or(self.refused.take());
        if !out.bytes.is_empty() {
            self.oracle.judge(self.now, &out.bytes);
            self.sent.push((self.now, out.bytes.clone()));
            if self.open.0 {
                self.emulator.receive(self.now, Port::Secondary, &out.bytes);
            }
        }
    }

    pub(crate) fn link(&mut self, up: bool) {
        if self.oracle.link_up == up {
            return;
        }
        self.oracle.link_up = up;
        if up {
            self.oracle.forget();
        }
        self.give(if up { &Input::LinkUp } else { &Input::LinkDown });
    }

    pub(crate) fn run(&mut self, seconds: f64) {
        for _ in 0..(seconds / STEP_S).round() as u64 {
            self.step();
        }
    }

    /// Runs until `is_so`, at most `limit_s`; returns the elapsed seconds.
    pub(crate) fn run_until(&mut self, limit_s: f64, mut is_so: impl FnMut(&Rig) -> bool) -> f64 {
        let start = self.now;
        while !is_so(self) {
            let passed_s = (self.now - start).as_s();
            assert!(
                passed_s < limit_s,
                "not so after {limit_s} s: {}, {:?}, {:?}",
                self.bridge.state(),
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
        self.boat_order = self.emulator.order(self.now);
        self.boat.step(self.boat_order);
        if self.steps.is_multiple_of(TELEMETRY_STEPS) {
            self.send_telemetry();
            if let Some(order) = self.order {
                let given = if self.hangs { self.given } else { self.now };
                self.give(&Input::Order(order, given));
            }
            if let Some(others) = self.others.clone() {
                self.give(&Input::Others(others));
            }
        }
        self.give(&Input::Tick);
        self.remark = self
            .emulator
            .take_remark()
            .unwrap_or_else(|| std::mem::take(&mut self.remark));
    }

    /// Measures the boat and sends telemetry.
    fn send_telemetry(&mut self) {
        let place = self.pinned.unwrap_or(self.boat.at + self.offset);
        let own = self.boat.measured(self.now, place);
        if !self.frozen {
            self.emulator.observe(self.now, &own);
        }
        let mut bytes = vec![];
        self.emulator.telemetry(self.now, &mut bytes);
        let pieces = match &mut self.tamper {
            Some(tamper) => tamper(bytes),
            None => vec![bytes],
        };
        if self.open.1 && self.oracle.link_up {
            for piece in pieces {
                self.oracle.note(self.now, &piece);
                self.give(&Input::Bytes(piece));
            }
        }
    }

    /// Delivers delayed telemetry in one packet.
    pub(crate) fn deliver_late(&mut self, bytes: usize) {
        let mut late = Vec::new();
        while late.len() < bytes {
            self.emulator.telemetry(self.now, &mut late);
        }
        self.give(&Input::Bytes(late));
    }

    /// Sends a sentence with this body from a back seat or an operator.
    pub(crate) fn send(&mut self, port: Port, body: &str) {
        self.emulator
            .receive(self.now, port, with_checksum(body).as_bytes());
        self.boat_order = self.emulator.order(self.now);
    }

    /// The gateway's counters, and how many commands the boat followed and ignored.
    pub(crate) fn counts(&self) -> Vec<(String, u64)> {
        let (followed, ignored) = self.emulator.counters();
        let boat = [
            ("followed".to_owned(), followed),
            ("ignored".to_owned(), ignored),
        ];
        self.bridge
            .status(self.now)
            .counts
            .into_iter()
            .chain(boat)
            .collect()
    }

    /// Restarts the counts of positions, sentences, reports and events.
    pub(crate) fn mark(&mut self) {
        self.marked = (self.boat.at, self.counts());
        (self.sent, self.navs, self.events) = (vec![], vec![], vec![]);
    }
}
