//! The test rig: a boat with simple dynamics, its emulated ArduPilot, and the gateway. The test
//! controls time.

use crate::boat::{Boat, STEP_S};
use gateway::bridge::{Bridge, Event, Input, Output, Plan, Preflight, Site};
use gateway::emulator::{ArduPilot, FrontSeat};
use gateway::geodesy::LocalFrame;
use gateway::mavlink::dialect::MavMessage;
use gateway::mavlink::{Framer, RoverMode, Writer};
use messages::Order;
use messages::external::OperatorCommand;
use primitives::SimTime;
use primitives::frame::{LatLon, Ned};
use std::path::Path;

const TELEMETRY_STEPS: u64 = 10;

pub(crate) struct Rig {
    pub(crate) now: SimTime,
    steps: u64,
    pub(crate) boat: Boat,
    pub(crate) ardupilot: ArduPilot,
    pub(crate) bridge: Bridge,
    /// The agent's order, ten times a second.
    pub(crate) order: Option<Order>,
    /// Whether bytes pass to the boat and from it.
    pub(crate) open: (bool, bool),
    /// Changes or drops each message, to the boat and from it.
    pub(crate) alter: fn(MavMessage) -> Option<MavMessage>,
    /// A second gateway for the same boat.
    pub(crate) second: Option<Bridge>,
    pub(crate) events: Vec<Event>,
    /// Messages sent to the boat, without the routine ones.
    pub(crate) sent: Vec<(SimTime, MavMessage)>,
    sent_framer: Framer,
    pub(crate) refused: Option<String>,
    pub(crate) remarks: Vec<String>,
}

pub(crate) fn plan() -> Plan {
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
    let game = scenario::load(&scenarios.join("games/pav01_vs_pav01.toml"))
        .unwrap_or_else(|e| panic!("{e}"));
    let gateway =
        scenario::load_file::<gateway::config::Gateway>(&scenarios.join("gateways/blueboat.toml"));
    Plan {
        vehicle: "blue_one".to_owned(),
        gateway: gateway.unwrap_or_else(|e| panic!("{e}")),
        // A declination so large that any use of it would be noticed.
        site: Some(Site {
            length_m: 1.2,
            field: game.field,
            declination_rad: (-40.0_f64).to_radians(),
            coasting: None,
        }),
        arms_itself: false,
        dry_run: false,
        preflight: Preflight::NotRequired,
    }
}

/// The origin of the field.
pub(crate) fn datum() -> LatLon {
    plan().site.expect("the rig has one").field.plan.datum
}

/// The latitude and longitude of a place on the field, 1e-7 degrees.
pub(crate) fn e7(place: Ned) -> (i32, i32) {
    let at = LocalFrame::new(datum()).lat_lon(place);
    (
        (1e7 * at.lat_deg).round() as i32,
        (1e7 * at.lon_deg).round() as i32,
    )
}

/// The frame in which this component sends a message.
pub(crate) fn frame(system: u8, component: u8, message: &MavMessage) -> Vec<u8> {
    let mut bytes = vec![];
    Writer::new(system, component).write(message, &mut bytes);
    bytes
}

impl Rig {
    pub(crate) fn of(plan: Plan) -> Rig {
        let mut rig = Rig {
            now: SimTime::ZERO,
            steps: 0,
            boat: Boat {
                at: Ned::from_xy(60.0, 40.0),
                ..Boat::default()
            },
            ardupilot: ArduPilot::new(datum(), Some(1.0)),
            bridge: Bridge::new(plan),
            order: None,
            open: (true, true),
            alter: Some,
            second: None,
            events: vec![],
            sent: vec![],
            sent_framer: Framer::new(),
            refused: None,
            remarks: vec![],
        };
        rig.ardupilot
            .set_clock(SimTime::ZERO, 1_795_000_000_000_000_000);
        rig.give(&Input::LinkUp);
        rig
    }

    pub(crate) fn new() -> Rig {
        Rig::of(plan())
    }

    /// A boat that has been driving east at 1.5 m/s for ten seconds.
    pub(crate) fn under_way() -> Rig {
        Rig::new().gets_under_way()
    }

    pub(crate) fn gets_under_way(mut self) -> Rig {
        self.order = Some(Order::Steer {
            heading_rad: std::f64::consts::FRAC_PI_2,
            speed_m_s: 1.5,
        });
        self.run(2.0);
        self.operator(OperatorCommand::Arm);
        assert_eq!(
            (self.refused.take(), self.state().as_str()),
            (None, "armed")
        );
        self.run(9.0);
        assert!(
            self.boat.speed_m_s > 1.2 && self.state() == "armed",
            "{:?} {:?}",
            self.boat,
            self.events
        );
        self
    }

    pub(crate) fn state(&self) -> String {
        self.bridge.state().to_string()
    }

    pub(crate) fn mode(&self) -> (RoverMode, bool) {
        self.ardupilot.mode()
    }

    pub(crate) fn operator(&mut self, command: OperatorCommand) {
        self.give(&Input::Operator(command));
    }

    pub(crate) fn give(&mut self, input: &Input) {
        let mut out = Output::default();
        self.bridge.process(self.now, input, &mut out);
        self.events.extend(out.events);
        self.refused = out.refused.or(self.refused.take());
        let now = self.now;
        let sent = &mut self.sent;
        self.sent_framer.push(&out.bytes, &mut |received| {
            sent.push((now, received.message))
        });
        if self.open.0 && !out.bytes.is_empty() {
            self.ardupilot.receive(self.now, &self.altered(&out.bytes));
            let mut answers = Vec::new();
            self.ardupilot.answers(&mut answers);
            if self.open.1 && !answers.is_empty() {
                self.give(&Input::Bytes(self.altered(&answers)));
            }
        }
    }

    /// Passes an input to the second gateway, whose output the boat also receives.
    pub(crate) fn put_second(&mut self, input: &Input) {
        let Some(second) = &mut self.second else {
            return;
        };
        let mut out = Output::default();
        second.process(self.now, input, &mut out);
        assert_eq!(out.refused, None);
        self.ardupilot.receive(self.now, &out.bytes);
    }

    fn altered(&self, bytes: &[u8]) -> Vec<u8> {
        let mut altered = Vec::new();
        Framer::new().push(bytes, &mut |received| {
            let mut writer = Writer::new(received.system, received.component);
            (self.alter)(received.message)
                .iter()
                .for_each(|message| writer.write(message, &mut altered));
        });
        altered
    }

    pub(crate) fn run(&mut self, seconds: f64) {
        (0..(seconds / STEP_S).round() as u64).for_each(|_| self.step());
    }

    /// Runs until `is_so`, at most `limit_s`; returns the elapsed seconds.
    pub(crate) fn run_until(&mut self, limit_s: f64, is_so: impl Fn(&Rig) -> bool) -> f64 {
        let start = self.now;
        while !is_so(self) {
            let passed_s = (self.now - start).as_s();
            assert!(
                passed_s < limit_s,
                "not so: {}, {:?}, {:?}",
                self.state(),
                self.mode(),
                self.events
            );
            self.step();
        }
        (self.now - start).as_s()
    }

    fn step(&mut self) {
        self.steps += 1;
        self.now = SimTime::from_s(STEP_S * self.steps as f64);
        let order = self.ardupilot.order(self.now);
        self.boat.step(order);
        if self.steps.is_multiple_of(TELEMETRY_STEPS) {
            self.ardupilot
                .observe(self.now, &self.boat.measured(self.now, self.boat.at));
            let mut bytes = Vec::new();
            self.ardupilot.telemetry(self.now, &mut bytes);
            if self.open.1 && !bytes.is_empty() {
                let bytes = self.altered(&bytes);
                self.put_second(&Input::Bytes(bytes.clone()));
                self.give(&Input::Bytes(bytes));
            }
            if let Some(order) = self.order {
                self.give(&Input::Order(order, self.now));
            }
        }
        self.give(&Input::Tick);
        self.put_second(&Input::Tick);
        self.remarks.extend(self.ardupilot.take_remark());
    }
}
