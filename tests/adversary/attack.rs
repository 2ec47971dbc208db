//! Attacks on resources of a game's machine: memory, descriptors, tables, and the time of other
//! nodes.

use crate::crowd::{FEW_FILES, MANY_FILES, is_withstood, squall_with_files};
use crate::disturbed_game::DisturbedGame;
use crate::intruder::{Intruder, Target, config};
use crate::support::{FOUR, LIMIT, Process, Sim, free_endpoint, wait_until};
use messages::Control;
use serde_json::Value;
use std::any::Any;
use std::io::Read;
use std::net::TcpListener;
use std::time::{Duration, Instant};
use zenoh::Wait;

/// Upper limit of the sim's memory under any attack, kB; undisturbed it uses 25 MB.
const MEMORY_MAX_KB: u64 = 400_000;

/// A named attack; it lasts until its return value is dropped.
pub(crate) type Attack = (&'static str, fn(&Target) -> Box<dyn Any>);

pub(crate) const ATTACKS: [Attack; 9] = [
    (
        "messages of 64 MB, and many messages of an accepted size",
        big_messages,
    ),
    ("a million keys", many_keys),
    ("nested JSON", nested_json),
    ("long keys", long_keys),
    (
        "thousands of declarations of one session",
        many_declarations,
    ),
    ("a node that passes for a router", router),
    ("connections that send nothing", silent_connections),
    (
        "connections that stop half-way through the handshake",
        half_handshakes,
    ),
    ("as many sessions as the hub accepts", sessions),
];

/// Topics that anyone may publish on, and topics that only the sim receives.
const PUBLISHED: [&str; 6] = [
    "control",
    "order/x",
    "say/blue",
    "policy/blue_one",
    "nav/blue_one",
    "status/blue_one",
];
const ASKED: [&str; 5] = ["control", "join/agent/blue", "scenario", "events", "water"];

fn big_messages(target: &Target) -> Box<dyn Any> {
    let intruder = Intruder::of(target);
    for topic in PUBLISHED {
        intruder.publish(topic, vec![b'['; 64 << 20]);
        for _ in 0..100 {
            intruder.publish(topic, vec![b'['; 1 << 20]);
        }
    }
    for topic in ASKED {
        intruder.ask_in_vain(topic, vec![b'['; 64 << 20]);
        (0..100).for_each(|_| intruder.ask_in_vain(topic, vec![b'['; 1 << 20]));
    }
    Box::new(intruder)
}

fn many_keys(target: &Target) -> Box<dyn Any> {
    let intruder = Intruder::of(target);
    for i in 0..250_000 {
        for topic in ["order", "say", "policy", "status"] {
            intruder.publish(&format!("{topic}/x{i}"), "x");
        }
    }
    Box::new(intruder)
}

fn nested_json(target: &Target) -> Box<dyn Any> {
    let intruder = Intruder::of(target);
    for nested in [
        "[",
        "{\"body\":",
        "{\"body\":{\"vehicles\":[[",
        "{\"answer\":",
    ] {
        let payload = nested.repeat(60_000 / nested.len());
        for _ in 0..200 {
            PUBLISHED
                .iter()
                .for_each(|topic| intruder.publish(topic, payload.as_bytes().to_vec()));
            ASKED
                .iter()
                .for_each(|topic| intruder.ask_in_vain(topic, payload.as_bytes().to_vec()));
        }
    }
    Box::new(intruder)
}

/// Keys of up to 80 kB, more than zenoh can send at once: the hub receives them in two parts and
/// must forward the whole.
fn long_keys(target: &Target) -> Box<dyn Any> {
    let intruder = Intruder::of(target);
    let listener = Intruder::of(target);
    let mut kept: Vec<Box<dyn Any>> = Vec::new();
    for topic in [
        "say",
        "policy",
        "status",
        "order",
        "helm",
        "operate",
        "join",
        "alive/agent",
    ] {
        for pattern in ["*", "*/*", "**"].map(|rest| listener.topic(&format!("{topic}/{rest}"))) {
            kept.push(Box::new(listener.listen_anywhere(&pattern)));
            kept.push(Box::new(
                listener
                    .session
                    .declare_queryable(pattern.clone())
                    .callback(drop)
                    .wait()
                    .ok(),
            ));
            let liveliness = listener.session.liveliness();
            kept.push(Box::new(
                liveliness
                    .declare_subscriber(pattern)
                    .callback(drop)
                    .wait()
                    .ok(),
            ));
        }
        // From here on the hub refers to this key by a number.
        let known = intruder.topic(&format!("{topic}/{}", "k".repeat(40_000)));
        kept.push(Box::new(
            intruder
                .session
                .declare_subscriber(known)
                .callback(drop)
                .wait()
                .ok(),
        ));
    }
    // Another thread sends the declarations.
    std::thread::sleep(Duration::from_millis(500));
    for topic in [
        "say", "policy", "status", "order", "helm", "operate", "join",
    ] {
        for rest in [10, 25_000, 40_000] {
            let key = format!("{topic}/{}/{}", "k".repeat(40_000), "l".repeat(rest));
            intruder.publish(&key, "x");
            intruder.ask_in_vain(&key, "{}");
        }
        let key = format!("{topic}/{}", "m".repeat(65_000));
        kept.push(Box::new(
            intruder
                .session
                .declare_subscriber(intruder.topic(&key))
                .callback(drop)
                .wait()
                .ok(),
        ));
        kept.push(Box::new(
            intruder
                .session
                .liveliness()
                .declare_token(intruder.topic(&key))
                .wait()
                .ok(),
        ));
    }
    kept.push(Box::new((intruder, listener)));
    Box::new(kept)
}

fn many_declarations(target: &Target) -> Box<dyn Any> {
    let intruder = Intruder::of(target);
    let session = &intruder.session;
    let mut kept: Vec<Box<dyn Any>> = Vec::new();
    for i in 0..500 {
        for topic in ["say", "picture", "policy", "alive/agent"] {
            let key = intruder.topic(&format!("{topic}/x{i}"));
            kept.push(Box::new(
                session
                    .declare_subscriber(key.clone())
                    .callback(drop)
                    .wait()
                    .ok(),
            ));
            kept.push(Box::new(
                session.liveliness().declare_token(key).wait().ok(),
            ));
        }
        let helm = intruder.topic(&format!("helm/x{i}"));
        kept.push(Box::new(
            session.declare_queryable(helm).callback(drop).wait().ok(),
        ));
        // Duplicate subscriptions are allowed.
        kept.push(Box::new(
            session
                .declare_subscriber(intruder.topic("frame"))
                .callback(drop)
                .wait()
                .ok(),
        ));
    }
    // Drop this session last: it keeps the others open.
    kept.push(Box::new(intruder));
    Box::new(kept)
}

/// A router receives declarations that clients must request, and may speak for other nodes.
fn router(target: &Target) -> Box<dyn Any> {
    let intruder = target.open("router").expect("the port is open");
    let answers = [
        "scenario", "join/**", "join", "events", "water", "control", "**",
    ]
    .map(|topic| intruder.answer(topic));
    let token = intruder
        .session
        .liveliness()
        .declare_token(intruder.topic("alive/sim/zz"))
        .wait()
        .ok();
    let heard = ["**", "order/*", "nav/*"].map(|topic| intruder.listen(topic));
    for topic in [
        "frame",
        "picture/blue",
        "picture/red",
        "picture/*",
        "**",
        "run",
        "released",
        "external/blue_one",
    ] {
        (0..100).for_each(|_| intruder.publish(topic, "forged"));
    }
    Box::new((answers, token, heard, intruder))
}

fn silent_connections(target: &Target) -> Box<dyn Any> {
    Box::new(target.connections(&[], 1500))
}

fn half_handshakes(target: &Target) -> Box<dyn Any> {
    Box::new(target.connections(&first_words(), 1500))
}

/// The first message of a session, as sent to a listener that does not answer.
fn first_words() -> Vec<u8> {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let endpoint = format!("tcp/{}", listener.local_addr().expect("bound"));
    let config = config(&[
        ("mode", "\"client\""),
        ("connect/endpoints", &format!("[{endpoint:?}]")),
        ("connect/timeout_ms", "1000"),
        ("connect/exit_on_failure", "true"),
    ]);
    let session = std::thread::spawn(move || drop(zenoh::open(config).wait()));
    let (mut stream, _) = listener.accept().expect("it connects");
    let mut bytes = vec![0; 4096];
    let count = stream.read(&mut bytes).expect("it speaks");
    drop((stream, listener));
    session.join().expect("it gives up");
    bytes.truncate(count);
    bytes
}

fn sessions(target: &Target) -> Box<dyn Any> {
    wait_until("there is room again", || target.open("client").is_some());
    let all: Vec<Intruder> = (0..1200).map_while(|_| target.open("client")).collect();
    assert!((100..1100).contains(&all.len()), "{} sessions", all.len());
    Box::new(all)
}

/// A value of `/proc/…/status`, kB; `None` on systems without that file.
fn status_kb(process: &Process, name: &str) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{}/status", process.0.id())).ok()?;
    status.lines().find_map(|line| {
        line.strip_prefix(name)?
            .split_whitespace()
            .nth(1)?
            .parse()
            .ok()
    })
}

#[test]
fn no_attack_changes_the_game_or_exhausts_memory() {
    let mut game = DisturbedGame::start();
    for (what, attack) in ATTACKS {
        let start = Instant::now();
        let kept = attack(&Target::of(&game.sim));
        game.check();
        drop(kept);
        let memory = status_kb(&game.sim.process, "VmHWM");
        eprintln!(
            "{what}: {:.1?}, at most {} kB so far",
            start.elapsed(),
            memory.unwrap_or_default()
        );
        assert!(memory.unwrap_or_default() < MEMORY_MAX_KB, "{what}");
    }
    game.ends_as_if_undisturbed();
}

#[test]
fn an_e_stop_gets_through_every_attack() {
    let (sim, _agents) = Sim::start_with_agents("long", &["--pace", "20x"]);
    // The operator connects before the attack.
    let operator = sim.bus();
    for (what, attack) in ATTACKS {
        let kept = attack(&Target::of(&sim));
        sim.newest_progress();
        let asked = Instant::now();
        bus::control(&operator, &sim.name(), Control::EStop).expect("it is published");
        sim.wait_for_event("e_stopped", Value::Null);
        let took = asked.elapsed();
        eprintln!("{what}: boats are stopped after {took:.1?}");
        assert!(took < Duration::from_secs(1), "{what}: {took:?}");
        drop(kept);
        wait_until("it is released", || {
            bus::control(&operator, &sim.name(), Control::Release).is_ok()
        });
        sim.wait_for_event("released", Value::Null);
    }
    sim.stop();
}

#[test]
fn crowding_the_port_keeps_no_client_out_and_does_not_disturb_the_game() {
    crowds_are_withstood(MANY_FILES);
}

#[test]
fn crowding_a_port_with_few_files_keeps_no_client_out() {
    crowds_are_withstood(FEW_FILES);
}

fn crowds_are_withstood(files: usize) {
    let endpoint = free_endpoint();
    let sim = Sim::start_with(
        squall_with_files(files),
        "long",
        &["--listen", &endpoint, "--pace", "20x"],
    );
    let agents = FOUR.map(|name| sim.agent(&[name]));
    let operator = sim.bus();
    is_withstood(sim, agents.into(), files, &operator, &|sim| {
        Target::of(sim).open("client").is_some()
    });
}

/// When the port is full, connected nodes continue and new ones join once there is room.
#[test]
fn who_waits_for_room_gets_in_when_there_is_some() {
    let sim = Sim::start("patient", &["--join-s", "600"]);
    let target = Target::of(&sim);
    let all: Vec<Intruder> = (0..1200).map_while(|_| target.open("client")).collect();
    let mut agents: Vec<Process> = FOUR.iter().map(|name| sim.agent(&[name])).collect();
    std::thread::sleep(Duration::from_secs(2));
    drop(all);
    let start = Instant::now();
    sim.wait_for_kind("started");
    assert!(start.elapsed() < LIMIT / 2, "{:?}", start.elapsed());
    sim.play_on(1.0);
    sim.stop();
    agents
        .iter_mut()
        .for_each(|agent| assert!(agent.wait().success()));
}
