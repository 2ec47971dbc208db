//! zenoh's access control prevents forgery by intruders; data open to all arrives intact.

use crate::disturbed_game::all_stay;
use crate::intruder::Intruder;
use crate::support::{LIMIT, Sim};
use bus::Latest;
use messages::run_state::{Phase, RunState};
use messages::{Frame, Message, Picture, Stamp, topic};
use primitives::{TeamId, codec};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use zenoh::Wait;

/// Long enough for a message to arrive many times over.
const A_WHILE: Duration = Duration::from_secs(2);

#[test]
fn forged_messages_of_the_sim_reach_nobody() {
    let (sim, mut agents) = Sim::start_with_agents("patient", &[]);
    let observer = sim.bus();
    let name = sim.name();
    let scenario = sim.info(&observer).scenario;
    let forged = Arc::new(AtomicUsize::new(0));
    let count = |is_forged: fn(&[u8]) -> bool| {
        let forged = Arc::clone(&forged);
        move |bytes: &[u8]| {
            forged.fetch_add(usize::from(is_forged(bytes)), Ordering::Relaxed);
        }
    };
    let heard = [
        observer.subscribe(
            topic::frame(&name),
            count(|bytes| codec::decode::<Frame>(bytes).is_ok_and(|f| f.over)),
        ),
        observer.subscribe(
            topic::picture(&name, &scenario, TeamId(0)),
            count(|bytes| codec::decode::<Picture>(bytes).is_ok_and(|picture| picture.over)),
        ),
        observer.subscribe(
            topic::run(&name),
            count(|bytes| {
                serde_json::from_slice::<RunState>(bytes).is_ok_and(|run| run.phase == Phase::Over)
            }),
        ),
    ];
    heard.iter().for_each(|declared| assert!(declared.is_ok()));

    let intruder = Intruder::at(&sim);
    let frame = Frame {
        over: true,
        stamp: Stamp {
            version: Frame::VERSION,
            ..Stamp::default()
        },
        ..Frame::default()
    };
    let picture = |seq| {
        let stamp = Stamp {
            version: Picture::VERSION,
            seq,
            ..Stamp::default()
        };
        codec::encode(&Picture {
            over: true,
            stamp,
            ..Picture::default()
        })
    };
    let run = serde_json::to_vec(&RunState {
        phase: Phase::Over,
        ..RunState::default()
    })
    .expect("JSON");
    for seq in 0..500 {
        // Use the exact key, and wildcard expressions that match it.
        for key in ["frame", "*"] {
            intruder.publish(key, codec::encode(&frame));
        }
        for key in ["picture/blue", "picture/red", "picture/*", "*/*", "**"] {
            intruder.publish(key, picture(seq));
        }
        intruder.publish("run", run.clone());
    }
    intruder.session.put("**", picture(9)).wait().expect("open");
    // A node that had believed the forgery would have left by now.
    sim.play_on(1.0);
    std::thread::sleep(A_WHILE);
    all_stay(&mut agents);
    assert_eq!(forged.load(Ordering::Relaxed), 0);
    let report = sim.stop();
    assert_eq!(report["agents_lost"].as_u64().unwrap_or_default(), 0);
}

#[test]
fn that_there_is_a_game_is_open_to_all_and_who_watches_hears_it() {
    let (sim, _agents) = Sim::start_with_agents("patient", &[]);
    let observer = sim.bus();
    let frames = Arc::new(Latest::new(1));
    let latest = Arc::clone(&frames);
    let heard = observer.subscribe(topic::frame(&sim.name()), move |bytes| {
        latest.put(0, codec::decode::<Frame>(bytes).expect("a frame"));
    });
    assert!(heard.is_ok());
    let frame = frames.take(LIMIT).pop().flatten().expect("a frame");
    assert_eq!(frame.vehicles.len(), 4);
    let keys = observer
        .who_is_alive(&topic::everyone_alive(), bus::ANSWER)
        .expect("a session");
    let games: Vec<_> = keys
        .iter()
        .filter_map(|key| topic::parse_alive(key))
        .map(|(game, _)| game)
        .collect();
    assert_eq!(games, [sim.name()], "{keys:?}");
    sim.stop();
}

/// An answer has the priority of its query, and most of zenoh's queues have room for 128 kB.
#[test]
fn a_query_at_the_default_priority_gets_the_whole_scenario_of_a_learned_strategy() {
    let sim = Sim::start("patient", &["--blue", "learned", "--join-s", "600"]);
    let asker = Intruder::at(&sim);
    for _ in 0..5 {
        let answers = asker.ask("scenario", "");
        assert_eq!(answers.len(), 1, "it gets no answer");
        assert!(answers[0].len() > 150_000, "{} bytes", answers[0].len());
    }
    sim.stop();
}
