//! Agents that send invalid data: the data is rejected with a counted reason, and does not affect
//! the game.

use crate::support::{FOUR, Sim, join};
use bus::{Bus, Latest, Priority, Publisher};
use messages::{
    JoinReply, JoinRequest, Message, Order, Orders, Picture, Role, Stamp, VehicleOrder, topic,
};
use primitives::{TeamId, VehicleId, codec};
use std::sync::Arc;
use std::time::Duration;

/// A session that has joined as a rogue agent.
struct Rogue {
    _bus: Bus,
    pictures: Arc<Latest<Picture>>,
    orders: Publisher,
    ticket: u64,
    _standing: bus::Declaration,
}

fn request(vehicles: &[&str]) -> JoinRequest {
    let vehicles = vehicles.iter().map(|name| (*name).to_owned()).collect();
    JoinRequest {
        version: primitives::VERSION.to_owned(),
        role: Role::Agent,
        node: "rogue".to_owned(),
        vehicles,
    }
}

impl Rogue {
    fn enter(sim: &Sim) -> Rogue {
        let (bus, game, scenario) = sim.session();
        let pictures = Arc::new(Latest::new(1));
        let slots = Arc::clone(&pictures);
        let key = topic::picture(&game, &scenario, TeamId(1));
        let standing = bus.subscribe(key, move |bytes| {
            slots.put(0, codec::decode(bytes).expect("a picture"))
        });
        let JoinReply::Granted { ticket, .. } =
            join(&bus, (&game, &scenario), &request(&["red_two"]))
        else {
            panic!("the boat is free")
        };
        let key = topic::orders(&game, &scenario, &[TeamId(1)], "rogue");
        let orders = bus.publisher(key, Priority::Normal).expect("a session");
        Rogue {
            _bus: bus,
            pictures,
            orders,
            ticket,
            _standing: standing.expect("a session"),
        }
    }

    /// Orders for the open tick.
    fn orders(&self, orders: Vec<VehicleOrder>) -> Orders {
        let picture = self
            .pictures
            .take(Duration::from_secs(20))
            .pop()
            .flatten()
            .expect("a picture");
        let stamp = Stamp {
            version: Orders::VERSION,
            ..picture.stamp
        };
        Orders {
            stamp,
            ticket: self.ticket,
            orders,
        }
    }

    fn good(&self) -> Orders {
        self.orders(vec![VehicleOrder::new(VehicleId(3), Order::Hold)])
    }
}

#[test]
fn every_agent_mistake_is_refused_counted_and_harmless() {
    let sim = Sim::start("patient", &[]);
    let _agents = sim.agent(&FOUR[..3]);
    let rogue = Rogue::enter(&sim);
    let send = |orders: &Orders| rogue.orders.send(orders).expect("a session");

    // Garbage, a newer version, a wrong ticket, a future tick: none of them counts as an answer.
    let good = rogue.good();
    rogue
        .orders
        .send_raw(b"\xff\x00garbage".to_vec())
        .expect("a session");
    rogue
        .orders
        .send_raw(codec::encode(&good)[..20].to_vec())
        .expect("a session");
    send(&Orders {
        stamp: Stamp {
            version: 99,
            ..good.stamp
        },
        ..good.clone()
    });
    send(&Orders {
        ticket: good.ticket ^ 1,
        ..good.clone()
    });
    send(&Orders {
        stamp: Stamp {
            seq: good.stamp.seq + 7,
            ..good.stamp
        },
        ..good.clone()
    });
    send(&good);
    // Orders for another agent's vehicle and not its own, and for a vehicle that does not exist.
    send(&rogue.orders(vec![VehicleOrder::new(
        VehicleId(0),
        Order::Thrust {
            port: 1.0,
            starboard: 1.0,
        },
    )]));
    send(&rogue.orders(vec![
        VehicleOrder::new(VehicleId(60000), Order::Hold),
        VehicleOrder::new(VehicleId(3), Order::Hold),
    ]));
    // Non-finite numbers.
    let nan = Order::Steer {
        heading_rad: f64::NAN,
        speed_m_s: f64::INFINITY,
    };
    send(&rogue.orders(vec![VehicleOrder::new(VehicleId(3), nan)]));
    let unknown = VehicleOrder {
        kind: 77,
        ..VehicleOrder::new(VehicleId(3), Order::Hold)
    };
    send(&rogue.orders(vec![unknown]));
    // Send valid orders for a while, then nothing: the others continue after the sim's patience.
    for _ in 0..20 {
        send(&rogue.good());
    }
    drop(rogue);
    let done = sim.stop();
    let refused = &done["run"]["refused"];
    for (reason, count) in [
        ("garbage", 2),
        ("version", 1),
        ("ticket", 1),
        ("wrong_tick", 1),
        ("not_yours", 2),
        ("bad_number", 2),
        ("missing", 1),
    ] {
        assert_eq!(refused[reason], count, "{reason} in {refused}");
    }
    assert!(
        done["outcome"]["ticks"].as_u64() >= Some(2 * 24),
        "the game continued"
    );
    assert!(
        done["outcome"]["events"]
            .as_array()
            .expect("a list")
            .iter()
            .all(|e| e["event"] != "quarantined")
    );
}

#[test]
fn another_version_is_refused_clearly() {
    let sim = Sim::start("long", &[]);
    let (bus, name, scenario) = sim.session();
    let other = JoinRequest {
        version: "9.9.9".to_owned(),
        ..request(&["blue_one"])
    };
    let JoinReply::Refused { reason } = join(&bus, (&name, &scenario), &other) else {
        panic!("another version is admitted")
    };
    assert!(
        reason.contains("9.9.9") && reason.contains(primitives::VERSION),
        "{reason}"
    );
    let key = topic::join(&name, &scenario, Role::Agent, &[]);
    let answer = bus
        .ask(&key, b"{]".to_vec(), Duration::from_secs(10))
        .expect("a session");
    let text = String::from_utf8_lossy(&answer.expect("an answer")).into_owned();
    assert!(text.contains("cannot parse the request"), "{text}");
    sim.stop();
}
