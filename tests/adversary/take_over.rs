//! Control of a boat: several agents compete for it, unauthorised ones are refused, and a dead
//! agent leaves nothing usable.

use crate::disturbed_game::DisturbedGame;
use crate::intruder::Intruder;
use crate::support::{LIMIT, Sim, token, wait_until};
use crate::token::session;
use bus::{Bus, Priority, Token};
use messages::topic::{self, GameName};
use messages::{JoinReply, JoinRequest, Message, Order, Orders, Role, Stamp, VehicleOrder};
use primitives::{SimTime, TeamId, VehicleId, codec};
use scenario::Scenario;
use serde_json::json;
use std::time::Duration;
use zenoh::Wait;

/// The contested boat, and its number.
const BOAT: &str = "red_two";
const NUMBER: VehicleId = VehicleId(3);
const FULL_AHEAD: Order = Order::Thrust {
    port: 1.0,
    starboard: 1.0,
};

/// The reply to a request to join as the boat's agent; `None` if the token is refused.
fn join((game, scenario): (&GameName, &Scenario), bus: &Bus) -> Option<JoinReply> {
    let version = primitives::VERSION.to_owned();
    let vehicles = vec![BOAT.to_owned()];
    let request = JoinRequest {
        version,
        role: Role::Agent,
        node: bus.id(),
        vehicles,
    };
    let key = topic::join(game, scenario, Role::Agent, &request.vehicles);
    bus.request(&key, &request, Duration::from_secs(10)).ok()?
}

fn ticket(reply: Option<JoinReply>) -> Option<u64> {
    let Some(JoinReply::Granted {
        ticket, vehicles, ..
    }) = reply
    else {
        return None;
    };
    assert_eq!(vehicles, [NUMBER]);
    Some(ticket)
}

fn orders(ticket: u64, seq: u64, at: SimTime) -> Orders {
    let stamp = Stamp {
        valid_ns: at,
        seq,
        version: Orders::VERSION,
    };
    let all = (0..4).map(|i| VehicleOrder::new(VehicleId(i), FULL_AHEAD));
    Orders {
        stamp,
        ticket,
        orders: all.collect(),
    }
}

#[test]
fn of_many_that_race_for_a_boat_one_has_it_and_the_next_when_that_is_gone() {
    let sim = Sim::start("patient", &["--join-s", "600"]);
    // A third of the nodes have no token, and another third a wrong one.
    let token_of = |i: usize| {
        [Some(token()), None, Some(Token::random())]
            .into_iter()
            .nth(i % 3)
            .flatten()
    };
    let tokens = (0..12).map(token_of);
    let mut racers: Vec<Bus> = tokens.map(|token| session(&sim, token)).collect();
    let scenario = sim.info(&racers[0]).scenario;
    let name = sim.name();
    let at = (&name, &scenario);
    let mut seen = Vec::new();
    for _ in 0..4 {
        let mut winners = Vec::new();
        wait_until("an agent has it", || {
            let replies: Vec<Option<JoinReply>> = std::thread::scope(|scope| {
                let asking: Vec<_> = racers
                    .iter()
                    .map(|racer| scope.spawn(move || join(at, racer)))
                    .collect();
                asking
                    .into_iter()
                    .map(|asks| asks.join().expect("it asks"))
                    .collect()
            });
            winners = (0..)
                .zip(replies)
                .filter_map(|(i, reply)| Some((i, ticket(reply)?)))
                .collect();
            assert!(winners.len() <= 1, "{winners:?}");
            !winners.is_empty()
        });
        let (winner, ticket) = winners[0];
        assert_eq!(winner % 3, 0, "it has no token");
        assert!(!seen.contains(&ticket), "a ticket that another node had");
        seen.push(ticket);
        // A repeated request does not harm the boat's agent, whatever the others do.
        assert_eq!(
            join(at, &racers[(winner + 3) % 12]),
            Some(JoinReply::Busy {
                vehicle: BOAT.to_owned()
            })
        );
        racers[winner].close();
        racers[winner] = session(&sim, Some(token()));
    }
    sim.stop();
}

#[test]
fn the_ticket_of_the_dead_is_void_once_somebody_else_has_the_boat() {
    let sim = Sim::start("patient", &["--pace", "realtime", "--join-s", "600"]);
    let _others = ["blue_one", "blue_two", "red_one"].map(|name| sim.agent(&[name]));
    let first = session(&sim, Some(token()));
    let scenario = sim.info(&first).scenario;
    let old = ticket(join((&sim.name(), &scenario), &first)).expect("it is free");
    sim.wait_for_kind("started");
    first.close();
    sim.wait_for_event("agent_lost", BOAT);
    let second = session(&sim, Some(token()));
    ticket(join((&sim.name(), &scenario), &second)).expect("it is free again");
    sim.wait_for_event("agent_back", BOAT);
    // The thief holds the old ticket and the key of its orders.
    let thief = Intruder::at(&sim);
    let refused = || sim.newest_progress()["refused"].as_u64();
    let before = refused();
    for seq in 0..50 {
        thief.publish(
            &format!("order/{}", first.id()),
            codec::encode(&orders(old, seq, SimTime::ZERO)),
        );
        thief.publish(
            "order/thief",
            codec::encode(&orders(old, u64::MAX - seq, SimTime::from_s(1e6))),
        );
    }
    wait_until("they are refused", || {
        refused() >= before.map(|before| before + 100)
    });
    let done = sim.stop();
    assert_eq!(done["run"]["refused"]["ticket"], 100, "{}", done["run"]);
    let boat = &done["outcome"]["counts"]["boats"][BOAT];
    // The second agent never gave an order.
    assert!(boat["agents_lost"].as_u64() <= Some(2), "{boat}");
}

#[test]
fn nobody_without_a_ticket_can_take_over_a_steered_boat() {
    let mut game = DisturbedGame::start();
    let sim = &game.sim;
    let intruder = Intruder::at(sim);
    let stranger = session(sim, None);
    let info = sim.info(&stranger);
    let agents = session(sim, None);
    let proof = json!({ "challenge": "00".repeat(16), "mac": "ff".repeat(32) });
    for round in 0..20 {
        for name in info.scenario.vehicles.iter().map(|vehicle| &vehicle.name) {
            for role in [Role::Agent, Role::Gateway] {
                let request = json!({ "version": primitives::VERSION, "role": role, "node": agents.id(), "vehicles": [name] });
                let key = topic::join(
                    &sim.name(),
                    &info.scenario,
                    role,
                    std::slice::from_ref(name),
                );
                for payload in [
                    json!({ "body": request }),
                    json!({ "body": request, "proof": proof }),
                ] {
                    let answers = intruder.ask_at(&key, payload.to_string().into_bytes());
                    let answer =
                        String::from_utf8_lossy(answers.first().expect("an answer")).into_owned();
                    assert!(
                        answer.contains("challenge") && !answer.contains("Granted"),
                        "{answer}"
                    );
                }
            }
        }
        for ticket in [0, 1, round, u64::MAX - round] {
            for (seq, at) in [(0, 0.0), (round, 1.0), (u64::MAX, 1e9)] {
                intruder.publish(
                    "order/x",
                    codec::encode(&orders(ticket, seq, SimTime::from_s(at))),
                );
            }
        }
    }
    let publisher = stranger
        .publisher(
            topic::orders(&sim.name(), &info.scenario, &[TeamId(0)], &stranger.id()),
            Priority::Normal,
        )
        .expect("open");
    publisher.send(&orders(7, 7, SimTime::ZERO)).expect("open");
    game.check();
    let done = game.ends_as_if_undisturbed();
    assert_eq!(
        done["run"]["refused"]["ticket"],
        20 * 4 * 3 + 1,
        "{}",
        done["run"]
    );
}

#[test]
fn who_shows_the_sims_liveliness_token_and_takes_it_back_ends_nobody() {
    let mut game = DisturbedGame::start();
    let watcher = game.sim.bus();
    let shown = watcher
        .who_is_alive(&topic::all_alive(&game.sim.name()), LIMIT)
        .expect("a session");
    assert_eq!(shown.len(), 1, "{shown:?}");
    let intruder = Intruder::at(&game.sim);
    for _ in 0..100 {
        drop(
            intruder
                .session
                .liveliness()
                .declare_token(shown[0].clone())
                .wait(),
        );
    }
    game.check();
    game.ends_as_if_undisturbed();
}
