//! Gateways of real boats in a gale, on the simulated sea in memory, much faster than real time: no
//! false alarms, and every fault of a compass, of thrusters or of the boat's command receiver is
//! detected in time.
//!
//! `SQUALL_HOURS=24 cargo test --locked --release --workspace --test gale -- --nocapture` simulates
//! a day with four boats; the default is half an hour.

#![expect(clippy::print_stdout, reason = "prints measurements when run by hand")]

use gateway::bridge::{Bridge, Event, Input, Output, Plan, Site};
use gateway::emulator::{self, Emulator, FrontSeat, Port};
use gateway::nmea::{Date, TimeOfDay};
use messages::Order;
use messages::external::OperatorCommand;
use messages::picture::OwnBoat;
use primitives::angle::wrap_pi;
use primitives::frame::{Ned, Rotation, body_from_ned};
use primitives::stream::Stream;
use primitives::{SimTime, VehicleId};
use scenario::{Overrides, load_file, load_with};
use sim::World;
use std::collections::BTreeMap;
use std::path::Path;

/// Duration of a voyage with its own boats and sea, s: longer ones would empty the batteries.
const VOYAGE_S: f64 = 1200.0;
/// Distance between the boats' areas, m.
const APART_M: f64 = 500.0;
/// Maximum distance of a boat from the middle of its area, m.
const REACH_M: f64 = 80.0;
const BOATS: usize = 4;

/// A fault of a boat from a given time on.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    /// The compass reads too low by this angle, rad.
    CompassOff(f64),
    /// The compass reading never changes.
    CompassFrozen,
    /// The port thruster gives no thrust.
    PortLost,
    BothLost,
}

/// A boat, its front seat and its gateway.
struct Boat {
    emulator: Emulator,
    bridge: Bridge,
    /// The current order, and when it ends.
    order: Order,
    until: SimTime,
    toward: Option<(Ned, f64)>,
    home: Ned,
    at: Ned,
    stream: Stream,
    /// The time and cause of each failsafe.
    failsafes: Vec<(SimTime, String)>,
    arm_at: SimTime,
}

/// Four boats of the same kind with individual differences, in a gale.
struct Voyage {
    world: World,
    /// Ticks between two sensor readings.
    ticks: u32,
    boats: Vec<Boat>,
    fault: (SimTime, Fault),
}

impl Boat {
    fn new(i: usize, seed: u64, plan: Plan) -> Boat {
        let site = plan.site.as_ref().expect("there is one");
        let front_seat = emulator::Plan {
            datum: site.field.plan.datum,
            declination_rad: site.declination_rad,
            watchdog_s: None,
            integers: false,
            extra: vec![],
            charge: None,
            began: (
                Date {
                    year: 2026,
                    month: 11,
                    day: 20,
                },
                TimeOfDay(0),
            ),
        };
        let mut boat = Boat {
            emulator: Emulator::new(front_seat),
            bridge: Bridge::new(plan),
            order: Order::Hold,
            until: SimTime::ZERO,
            toward: None,
            home: Ned::from_xy(APART_M * i as f64, 0.0),
            at: Ned::default(),
            stream: Stream::new(seed, &format!("test/{i}")),
            failsafes: vec![],
            arm_at: SimTime::from_s(2.0),
        };
        boat.give(SimTime::ZERO, &Input::LinkUp);
        boat
    }

    fn give(&mut self, now: SimTime, input: &Input) {
        let mut out = Output::default();
        self.bridge.process(now, input, &mut out);
        self.emulator.receive(now, Port::Secondary, &out.bytes);
        for event in out.events {
            if let Event::State { to, .. } = event
                && let Some(cause) = to.strip_prefix("failsafe: ")
            {
                self.failsafes.push((now, cause.to_owned()));
                self.arm_at = now + SimTime::from_s(3.0);
            }
        }
        if let Some(nav) = out.nav {
            self.at = nav.nav.at();
        }
    }

    /// The agent: legs between places in its area, holds, and direct thrust.
    fn decide(&mut self, now: SimTime) {
        if now >= self.until {
            let stream = &mut self.stream;
            self.until = now + SimTime::from_s(stream.between(5.0, 60.0));
            let place = Ned {
                north: stream.between(-REACH_M, REACH_M),
                east: stream.between(-REACH_M, REACH_M),
            };
            let speed_m_s = stream.between(0.5, 2.5);
            self.toward = None;
            match stream.below(10) {
                0 => self.order = Order::Hold,
                1 => {
                    let port = stream.between(-0.5, 0.9);
                    let starboard = stream.between(-0.5, 0.9);
                    self.order = Order::Thrust { port, starboard };
                    self.until = now + SimTime::from_s(10.0);
                }
                _ => self.toward = Some((self.home + place, speed_m_s)),
            }
        }
        if let Some((place, speed_m_s)) = self.toward {
            if self.at.distance(place) < 5.0 {
                self.until = now;
            }
            self.order = Order::Steer {
                heading_rad: self.at.bearing_rad(place),
                speed_m_s,
            };
        }
        self.give(now, &Input::Order(self.order, now));
    }
}

impl Voyage {
    fn new(seed: u64, sea: &str, gateway: &str, fault: (f64, Fault)) -> Voyage {
        let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
        let overrides = Overrides {
            sea: Some(scenarios.join("seas").join(sea)),
            ..Overrides::default()
        };
        let game = load_with(&scenarios.join("games/surveyor_2v2.toml"), &overrides)
            .unwrap_or_else(|e| panic!("{e}"));
        let mut world = World::of_game(&game, seed).expect("boats fit in");
        for i in 0..BOATS {
            let mut pose = world.state().boats[i].pose;
            pose.at = Ned::from_xy(APART_M * i as f64, 0.0);
            world.set_under_way(VehicleId::at(i), pose, sim::hull::Planar::default());
        }
        let mut gateway =
            load_file::<gateway::config::Gateway>(&scenarios.join("gateways").join(gateway))
                .unwrap_or_else(|e| panic!("{e}"));
        gateway.geofence.margin_m = 10_000.0;
        let site = Site {
            field: game.field.clone(),
            length_m: 1.83,
            declination_rad: -0.2,
            coasting: None,
        };
        let plan = Plan {
            site: Some(site),
            ..Plan::new("boat", gateway)
        };
        let boats = (0..BOATS)
            .map(|i| Boat::new(i, seed, plan.clone()))
            .collect();
        Voyage {
            world,
            ticks: game.ticks_per_decision,
            boats,
            fault: (SimTime::from_s(fault.0), fault.1),
        }
    }

    /// Advances to the next sensor reading.
    fn step(&mut self) {
        let now = self.world.state().now;
        let fault = if now >= self.fault.0 {
            self.fault.1
        } else {
            Fault::None
        };
        let mut orders = vec![];
        for (i, boat) in self.boats.iter_mut().enumerate() {
            boat.emulator
                .observe(now, &own_boat(&self.world, VehicleId::at(i), fault));
            let mut bytes = vec![];
            boat.emulator.telemetry(now, &mut bytes);
            boat.give(now, &Input::Bytes(bytes));
            if now >= boat.arm_at {
                boat.arm_at = SimTime::NEVER;
                boat.give(now, &Input::Operator(OperatorCommand::Arm));
                if boat.bridge.state() != gateway::supervisor::State::Armed {
                    boat.arm_at = now + SimTime::from_s(1.0);
                }
            }
            boat.decide(now);
            boat.give(now, &Input::Tick);
            orders.push(effective(boat.emulator.order(now), fault));
        }
        for _ in 0..self.ticks {
            self.world.step(&orders);
        }
        self.world.read_sensors();
    }

    fn sail(&mut self, seconds: f64) {
        let end = self.world.state().now + SimTime::from_s(seconds);
        while self.world.state().now < end {
            self.step();
        }
    }
}

/// A boat's sensor readings, as its front seat receives them.
fn own_boat(world: &World, vehicle: VehicleId, fault: Fault) -> OwnBoat {
    let reading = world.reading(vehicle).expect("the boat has sensors");
    let mut nav = reading.nav;
    let shown_rad = match fault {
        Fault::CompassOff(off_rad) => wrap_pi(nav.psi_rad - off_rad),
        Fault::CompassFrozen => 1.0,
        _ => nav.psi_rad,
    };
    if shown_rad != nav.psi_rad {
        // Velocity over the ground along the boat's axes: the receiver does not depend on the
        // compass.
        let velocity = nav.velocity_m_s();
        nav.psi_rad = shown_rad;
        let body = body_from_ned(Rotation::from_heading(nav.psi_rad), velocity);
        (nav.surge_m_s, nav.sway_m_s) = (body.ahead, body.starboard);
    }
    OwnBoat {
        fix_ns: reading.fix_at,
        imu: reading.imu.into(),
        ..OwnBoat::new(vehicle, nav)
    }
}

/// The part of an order that the thrusters carry out.
fn effective(order: Order, fault: Fault) -> Order {
    match (order, fault) {
        (Order::Thrust { starboard, .. }, Fault::PortLost) => Order::Thrust {
            port: 0.0,
            starboard,
        },
        (_, Fault::BothLost) => Order::Hold,
        (order, _) => order,
    }
}

/// Whether a failsafe is legitimate: reported by the receiver itself.
fn is_of_receiver(cause: &str) -> bool {
    [
        "the fix has quality",
        "the last fix is",
        "the position jumped",
    ]
    .iter()
    .any(|words| cause.contains(words))
}

fn hours() -> f64 {
    std::env::var("SQUALL_HOURS").map_or(0.5, |text| text.parse().expect("a number of hours"))
}

#[test]
fn a_gale_triggers_no_false_failsafe() {
    let mut causes: BTreeMap<String, u32> = BTreeMap::new();
    let mut alarms = vec![];
    let voyages = (hours() * 3600.0 / VOYAGE_S).ceil() as u64;
    for seed in 0..voyages {
        let sea = ["gale.toml", "bay_gale.toml"][(seed % 2) as usize];
        let gateway =
            ["surveyor.toml", "surveyor.toml", "surveyor_speed.toml"][(seed % 3) as usize];
        let mut voyage = Voyage::new(seed, sea, gateway, (0.0, Fault::None));
        voyage.sail(VOYAGE_S);
        for (i, boat) in voyage.boats.iter().enumerate() {
            for (at, cause) in &boat.failsafes {
                *causes
                    .entry(
                        cause
                            .split(|c: char| c.is_ascii_digit())
                            .next()
                            .unwrap_or("")
                            .to_owned(),
                    )
                    .or_default() += 1;
                if !is_of_receiver(cause) {
                    alarms.push(format!(
                        "seed {seed}, {sea}, {gateway}, boat {i} at {:.1} s: {cause}",
                        at.as_s()
                    ));
                }
            }
        }
    }
    println!("{voyages} voyages of {VOYAGE_S} s with {BOATS} boats; failsafes: {causes:#?}");
    assert!(
        alarms.is_empty(),
        "{} false alarms:\n{}",
        alarms.len(),
        alarms.join("\n")
    );
}

#[test]
fn each_fault_is_detected_within_its_deadline_even_in_a_gale() {
    for (fault, words, limit_s) in [
        (Fault::CompassOff(0.52), "the compass is off", 240.0),
        (Fault::CompassOff(-0.52), "the compass is off", 240.0),
        (Fault::CompassFrozen, "", 240.0),
        (Fault::PortLost, "the thrusters", 600.0),
        (Fault::BothLost, "the thrusters", 600.0),
    ] {
        let mut late = vec![];
        let mut times = vec![];
        for seed in 0..3 {
            let mut voyage = Voyage::new(seed, "gale.toml", "surveyor.toml", (300.0, fault));
            voyage.sail(300.0 + limit_s);
            for (i, boat) in voyage.boats.iter().enumerate() {
                let found = boat
                    .failsafes
                    .iter()
                    .find(|(at, cause)| at.as_s() >= 300.0 && cause.contains(words));
                match found {
                    Some((at, _)) => times.push(at.as_s() - 300.0),
                    None => late.push(format!("seed {seed}, boat {i}: {:?}", boat.failsafes)),
                }
            }
        }
        times.sort_by(f64::total_cmp);
        println!("{fault:?}: {times:.0?}");
        assert!(
            late.is_empty(),
            "{fault:?} is not found:\n{}",
            late.join("\n")
        );
    }
}
