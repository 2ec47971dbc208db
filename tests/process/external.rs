//! Real boats: a gateway in the test adds one, moves it as ordered, and falls silent.

use crate::support::{Sim, join, own, result_of, wait_until};
use bus::{Bus, Declaration, Priority, Publisher};
use messages::external::{ExternalOrder, NavReport};
use messages::picture::Nav;
use messages::topic::{self, GameName};
use messages::{JoinReply, JoinRequest, Message, Order, Role, Stamp};
use primitives::angle::rad_from_compass_deg;
use primitives::{VehicleId, codec};
use scenario::Scenario;
use std::sync::{Arc, Mutex};
use std::time::Instant;

pub(crate) const ME: VehicleId = VehicleId(0);
/// Simulated seconds per second.
pub(crate) const FACTOR: f64 = 4.0;

/// A gateway with a boat that follows commands immediately.
pub(crate) struct Gateway {
    bus: Bus,
    name: GameName,
    scenario: Scenario,
    _standing: Declaration,
    nav: Publisher,
    orders: Arc<Mutex<Vec<ExternalOrder>>>,
    ticket: u64,
    seq: u64,
    at: Nav,
    moved: Instant,
}

fn request(bus: &Bus, vehicle: &str) -> JoinRequest {
    let version = primitives::VERSION.to_owned();
    let vehicles = vec![vehicle.to_owned()];
    JoinRequest {
        version,
        role: Role::Gateway,
        node: bus.id(),
        vehicles,
    }
}

impl Gateway {
    pub(crate) fn joined(sim: &Sim) -> Gateway {
        let (bus, name, scenario) = sim.session();
        let orders = Arc::new(Mutex::new(Vec::new()));
        let inbox = Arc::clone(&orders);
        let take = move |bytes: &[u8]| {
            inbox
                .lock()
                .expect("whole")
                .push(codec::decode(bytes).expect("an order"))
        };
        let standing = bus
            .subscribe(topic::external_order(&name, &scenario, ME), take)
            .expect("the hub is up");
        let nav = bus
            .publisher(topic::nav(&name, &scenario, ME), Priority::Normal)
            .expect("the hub is up");
        let JoinReply::Granted {
            ticket, vehicles, ..
        } = join(&bus, (&name, &scenario), &request(&bus, "blue_one"))
        else {
            panic!("the boat is free")
        };
        assert_eq!(vehicles, [ME]);
        let at = Nav {
            north_m: 40.0,
            east_m: 52.0,
            psi_rad: rad_from_compass_deg(90.0),
            ..Nav::default()
        };
        Gateway {
            bus,
            name,
            scenario,
            _standing: standing,
            nav,
            orders,
            ticket,
            seq: 0,
            at,
            moved: Instant::now(),
        }
    }

    /// The reply to a different node that requests a boat.
    fn join(&self, other: &Bus, vehicle: &str) -> JoinReply {
        join(
            other,
            (&self.name, &self.scenario),
            &request(other, vehicle),
        )
    }

    fn newest(&self) -> Option<ExternalOrder> {
        self.orders.lock().expect("whole").last().cloned()
    }

    fn received(&self) -> usize {
        self.orders.lock().expect("whole").len()
    }

    fn is_held(&self) -> bool {
        self.newest()
            .is_some_and(|newest| newest.order.order() == Some(Order::Hold))
    }

    /// Follows the last order, and reports.
    pub(crate) fn sail(&mut self) {
        let passed_s = self.moved.elapsed().as_secs_f64() * FACTOR;
        self.moved = Instant::now();
        let order = self.newest().and_then(|newest| newest.order.order());
        self.at.surge_m_s = 0.0;
        if let Some(Order::Steer {
            heading_rad,
            speed_m_s,
        }) = order
        {
            (self.at.psi_rad, self.at.surge_m_s) = (heading_rad, speed_m_s);
        }
        let (sin, cos) = primitives::math::sin_cos(self.at.psi_rad);
        self.at.north_m += self.at.surge_m_s * passed_s * cos;
        self.at.east_m += self.at.surge_m_s * passed_s * sin;
        self.report(self.ticket);
    }

    fn report(&mut self, ticket: u64) {
        self.seq += 1;
        let stamp = Stamp {
            seq: self.seq,
            version: NavReport::VERSION,
            ..Stamp::default()
        };
        let report = NavReport {
            stamp,
            ticket,
            vehicle: ME,
            valid: true,
            age_ns: 0,
            nav: self.at,
        };
        self.nav.send(&report).expect("the hub is up");
    }

    /// Continues until a condition is true.
    fn sail_until(&mut self, what: &str, is_so: impl Fn(&Gateway) -> bool) {
        wait_until(what, || {
            is_so(self) || {
                self.sail();
                false
            }
        });
    }
}

#[test]
fn a_real_boat_has_one_gateway_and_holds_without_navigation_or_agent() {
    let sim = Sim::start("real_attacker", &["--pace", &format!("{FACTOR}x")]);
    let mut agent = sim.agent(&["blue_one"]);
    let _still = sim.agent(&["red_one"]);
    let waiting = sim
        .wait_for(|t| t["kind"] == "waiting" && t["agents"].as_array().is_some_and(Vec::is_empty));
    assert_eq!(waiting["gateways"][0], "blue_one", "{waiting}");

    let mut gateway = Gateway::joined(&sim);
    let other = sim.bus();
    let busy = JoinReply::Busy {
        vehicle: "blue_one".to_owned(),
    };
    assert_eq!(
        gateway.join(&other, "blue_one"),
        busy,
        "another gateway provides it"
    );
    let JoinReply::Refused { reason } = gateway.join(&other, "red_one") else {
        panic!("it is simulated")
    };
    assert!(reason.contains("red_one is simulated"), "{reason}");

    gateway.sail_until("its agent steers it towards the flag", |gateway| {
        gateway.at.east_m > 70.0
    });
    let orders = gateway.orders.lock().expect("whole").clone();
    assert!(
        orders
            .iter()
            .any(|order| order.given_ns > orders[0].given_ns),
        "its agent continues to decide"
    );
    assert!(
        orders
            .iter()
            .all(|order| order.order.vehicle == ME && order.given_ns <= order.stamp.valid_ns)
    );

    // The gateway stops reporting, then resumes.
    sim.wait_for_event("nav_lost", "blue_one");
    wait_until("a lost boat is sent a hold order", || gateway.is_held());
    gateway.sail_until("a boat that is back is driven again", |gateway| {
        !gateway.is_held()
    });
    sim.wait_for_event("nav_back", "blue_one");
    let before = gateway.newest().expect("an order").given_ns;
    gateway.sail_until("its agent continues", |gateway| {
        gateway
            .newest()
            .is_some_and(|newest| newest.given_ns > before)
    });

    // Its agent dies: the boat holds, and from now on gets no orders.
    agent.kill();
    gateway.sail_until("a boat without an agent holds", Gateway::is_held);
    sim.wait_for_event("agent_lost", "blue_one");
    let count = gateway.received();
    let given_ns = gateway.newest().expect("an order").given_ns;
    gateway.sail_until("it is sent the hold order again", |gateway| {
        gateway.received() > count + 3
    });
    assert!(
        gateway
            .newest()
            .is_some_and(|newest| newest.given_ns == given_ns)
            && gateway.is_held()
    );

    // Its gateway dies: a new one may join, and reports of the old one are refused.
    gateway.bus.close();
    wait_until("the boat is free again", || {
        gateway.join(&other, "blue_one") != busy
    });
    let nav = topic::nav(&gateway.name, &gateway.scenario, ME);
    gateway.nav = other
        .publisher(nav, Priority::Normal)
        .expect("the hub is up");
    gateway.report(gateway.ticket);
    sim.play_on(1.0);
    let report = sim.stop();
    assert!(
        report["run"]["refused"]["ticket"].as_u64() >= Some(1),
        "{}",
        report["run"]
    );
    assert_eq!(
        report["outcome"]["counts"]["boats"]["blue_one"]["agents_lost"],
        1
    );
}

#[test]
fn a_rehearsal_is_the_game_of_simulated_boats_in_one_process_and_across() {
    let mixed = own("mixed_30s");
    let simulated = own("pav01_30s");
    let want = result_of(&[&simulated, "--in-process"])["digest"].clone();
    assert!(want.is_string());
    assert_eq!(
        result_of(&[&mixed, "--rehearse", "--in-process"])["digest"],
        want
    );
    assert_eq!(
        result_of(&[&mixed, "--rehearse", "--agents-per-process", "4"])["digest"],
        want
    );
}
