//! An impostor that offers the same game, at the sim's port and at one of its own.

use crate::disturbed_game::DisturbedGame;
use crate::intruder::{Heard, Intruder, Target, config};
use crate::support::{FOUR, LIMIT, Process, Sim, agent, free_endpoint, squall, token, wait_until};
use bus::{Patience, SimState, SimWatch};
use serde_json::{Value, json};
use std::sync::{Arc, Mutex};
use zenoh::{Session, Wait};

/// A zenoh router that poses as a game and records the requests.
struct FakeSim {
    _session: Session,
    asked: Arc<Mutex<Vec<String>>>,
    _standing: (
        Vec<zenoh::query::Queryable<()>>,
        zenoh::liveliness::LivelinessToken,
    ),
}

impl FakeSim {
    /// Imitates the true sim's game, and answers requests with its own challenge.
    fn open(endpoint: &str, true_sim: &Intruder) -> FakeSim {
        let config = config(&[
            ("mode", "\"router\""),
            ("listen/endpoints", &format!("[{endpoint:?}]")),
        ]);
        let session = zenoh::open(config).wait().expect("the port is free");
        let asked = Arc::new(Mutex::new(Vec::new()));
        let challenge = vec![
            json!({ "challenge": "00".repeat(16) })
                .to_string()
                .into_bytes(),
        ];
        let scenario = true_sim.ask("scenario", "");
        let answers = [
            ("scenario", scenario),
            ("join/agent/blue", challenge.clone()),
            ("control", challenge),
        ];
        let queryables = answers.map(|(rest, answer)| {
            let noted = Arc::clone(&asked);
            let key = true_sim.topic(rest);
            let queryable = session.declare_queryable(key).callback(move |query| {
                let payload = query
                    .payload()
                    .map(|bytes| bytes.to_bytes().into_owned())
                    .unwrap_or_default();
                noted
                    .lock()
                    .expect("no thread panics while holding it")
                    .push(String::from_utf8_lossy(&payload).into_owned());
                let key = query.key_expr().clone();
                drop(
                    query
                        .reply(key, answer.first().cloned().unwrap_or_default())
                        .wait(),
                );
            });
            queryable.wait().expect("the session is open")
        });
        let token = session
            .liveliness()
            .declare_token(true_sim.topic("alive/sim/fake"))
            .wait();
        let token = token.expect("the session is open");
        FakeSim {
            _session: session,
            asked,
            _standing: (queryables.into(), token),
        }
    }

    fn asked(&self) -> Vec<String> {
        self.asked
            .lock()
            .expect("no thread panics while holding it")
            .clone()
    }
}

/// Tries as a client and as a router, which receives declarations that clients must request.
#[test]
fn nobody_passes_for_the_sim_or_receives_orders_and_navigation() {
    let mut game = DisturbedGame::start();
    let target = Target::of(&game.sim);
    let observer = game.sim.bus();
    let watch =
        SimWatch::open(&observer, &game.sim.name(), Patience::of_player(LIMIT)).expect("a session");
    let intruders = ["client", "router"].map(|mode| target.open(mode).expect("the port is open"));
    let topics = [
        "scenario", "join", "join/**", "events", "water", "control", "*", "**",
    ];
    let answers: Vec<_> = intruders
        .iter()
        .flat_map(|intruder| topics.map(|topic| intruder.answer(topic)))
        .collect();
    // Declare tokens in addition to that of the sim.
    let tokens = intruders.each_ref().map(|intruder| {
        intruder
            .session
            .liveliness()
            .declare_token(intruder.topic("alive/sim/zz"))
            .wait()
            .expect("a session")
    });
    // A session receives its own publications, so another client listens too.
    let listener = Intruder::of(&target);
    let listen = |intruder: &Intruder| -> Vec<Heard> {
        ["**", "*/*", "order/*", "order/**", "nav/*"]
            .map(|topic| intruder.listen(topic))
            .into()
    };
    let mut heard = listen(&listener);
    let heard_by_router = listen(&intruders[1]);
    heard.push(listener.listen_anywhere("**"));
    let open = listener.listen("picture/blue");
    for _ in 0..200 {
        for topic in ["frame", "picture/blue", "picture/red", "run", "released"] {
            intruders
                .iter()
                .for_each(|intruder| intruder.publish(topic, "forged"));
        }
    }
    game.check();
    wait_until("what everyone may hear is heard", || open.keys().len() > 20);
    let asker = Intruder::of(&target);
    for topic in ["scenario", "events", "water", "join/agent/blue", "control"] {
        let answers = asker.ask(topic, json!({ "body": {} }).to_string().into_bytes());
        assert_eq!(answers.len(), 1, "{topic}");
        assert!(answers[0] != b"forged", "{topic}");
    }
    assert_eq!(watch.state(), SimState::Alive);
    // A message for one subscription of a session reaches all of its matching subscriptions.
    let is_open = |key: &String| key.starts_with(&target.topic("picture/"));
    assert_eq!(
        heard
            .iter()
            .flat_map(|heard| heard.keys())
            .find(|key| !is_open(key)),
        None
    );
    let is_secret = |key: &String| key.contains("/order/") || key.contains("/nav/");
    assert_eq!(
        heard_by_router
            .iter()
            .flat_map(|heard| heard.keys())
            .find(is_secret),
        None
    );
    drop((answers, tokens));
    game.ends_as_if_undisturbed();
}

/// Without keys an agent cannot verify the sim. It still discloses nothing.
#[test]
fn an_agent_lured_to_a_false_sim_reveals_nothing_that_opens_the_real_one() {
    let sim = Sim::start("patient", &["--join-s", "600"]);
    let intruder = Intruder::at(&sim);
    let endpoint = free_endpoint();
    let false_sim = FakeSim::open(&endpoint, &intruder);
    let mut led_astray = agent(&endpoint, &sim.game, &FOUR[..1]);
    let refused = led_astray.refusal();
    assert!(refused.contains("wrong token for this game"), "{refused}");
    let asked = false_sim.asked();
    assert!(
        asked.iter().any(|payload| payload.contains("mac")),
        "{asked:?}"
    );
    assert!(
        asked
            .iter()
            .all(|payload| !payload.contains(&token().hex())),
        "{asked:?}"
    );
    for payload in asked.iter().filter(|payload| payload.contains("mac")) {
        let answer = intruder.ask("join/agent/blue", payload.clone().into_bytes());
        let answer: Value = serde_json::from_slice(&answer[0]).expect("JSON");
        assert!(answer["challenge"].is_string(), "{answer}");
    }
    sim.stop();
}

#[test]
fn a_second_sim_with_the_same_name_disturbs_no_node() {
    let mut game = DisturbedGame::start();
    let name = game.sim.game.clone();
    let endpoint = free_endpoint();
    let second = Sim::start_with(
        squall(&[]),
        "patient",
        &["--game", &name, "--listen", &endpoint, "--join-s", "600"],
    );
    assert_eq!(second.game, name);
    game.check();
    // Each agent joined at the address given to it.
    let _agents: Vec<Process> = FOUR
        .iter()
        .map(|vehicle| second.agent(&[vehicle]))
        .collect();
    second.wait_for_kind("started");
    game.check();
    second.stop();
    game.check();
    game.ends_as_if_undisturbed();
}
