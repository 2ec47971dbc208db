//! A stranger between operators and gateways: it answers in place of the gateway, keeps proofs, and
//! forges the gateway's reports.

use crate::control_port::Rig;
use crate::intruder::Intruder;
use crate::support::{LIMIT, Sim, run, stderr, stdout, temporary, token, wait_until};
use crate::token::session;
use bus::{Bus, BusError};
use messages::external::{GatewayStatus, OperatorCommand, OperatorReply, Reported};
use messages::topic;
use parking_lot::Mutex;
use std::sync::Arc;
use std::time::Duration;
use zenoh::Wait;
use zenoh::qos::CongestionControl;
use zenoh::query::Query;

/// A delay longer than the validity of a proof.
const LATER: Duration = Duration::from_secs(2);

fn operate(
    bus: &Bus,
    sim: &Sim,
    command: &OperatorCommand,
) -> Result<Option<OperatorReply>, BusError> {
    bus.request_node(&topic::operate(&sim.name(), "blue_one"), command, LIMIT)
}

/// Answers on the topic of the boat's gateway, claiming to be complete, until dropped.
fn answer(
    intruder: &Intruder,
    take: impl Fn(Query) + Send + Sync + 'static,
) -> zenoh::query::Queryable<()> {
    let queryable = intruder
        .session
        .declare_queryable(intruder.topic("operate/blue_one"))
        .complete(true);
    queryable
        .callback(take)
        .wait()
        .expect("the session is open")
}

fn reply(query: &Query, json: &str) {
    drop(
        query
            .reply(query.key_expr().clone(), json.to_owned())
            .wait(),
    );
}

/// The stranger's answer in place of the gateway's: the boat is disarmed.
fn forged_reply() -> String {
    let status = GatewayStatus {
        vehicle: "blue_one".to_owned(),
        state: "disarmed".to_owned(),
        ..GatewayStatus::default()
    };
    let reply = serde_json::to_value(OperatorReply {
        refused: None,
        status,
    })
    .expect("JSON");
    serde_json::json!({ "answer": reply }).to_string()
}

#[test]
fn a_stranger_who_answers_operators_cannot_swallow_commands() {
    let rig = Rig::start(&[]);
    let operator = session(&rig.sim, Some(token()));
    let intruder = Intruder::at(&rig.sim);
    let forged = forged_reply();
    let asked = Arc::new(Mutex::new(Vec::<Query>::new()));
    let lies = answer(&intruder, move |query| {
        (0..3).for_each(|_| reply(&query, &forged))
    });
    // A second stranger keeps each query open, as if it were about to answer.
    let second = Intruder::at(&rig.sim);
    let kept = Arc::clone(&asked);
    let silence = answer(&second, move |query| kept.lock().push(query));
    for command in [
        OperatorCommand::EStop,
        OperatorCommand::Release,
        OperatorCommand::Disarm,
    ] {
        for _ in 0..6 {
            rig.arm();
            let reply =
                operate(&operator, &rig.sim, &command).expect("it is the gateway that answers");
            let reply = reply.expect("the gateway answers");
            let state = reply.status.state;
            let at_port = rig.tell(OperatorCommand::Status).status.state;
            assert!(
                at_port.starts_with(&state[..5]),
                "the reply says {state:?}, the gateway {at_port:?}"
            );
            let expected = if command == OperatorCommand::Release {
                "armed"
            } else {
                ""
            };
            assert_eq!(
                at_port == "armed",
                expected == "armed",
                "{command:?}: {at_port}"
            );
        }
    }
    assert!(!asked.lock().is_empty(), "the stranger was asked as well");
    // An operator who cannot distinguish the gateway from the stranger gets an error.
    assert!(matches!(
        operate(&session(&rig.sim, None), &rig.sim, &OperatorCommand::Status),
        Err(BusError::NeedsToken)
    ));
    drop((lies, silence));
}

#[test]
fn an_answer_without_the_token_is_no_answer() {
    let sim = Sim::start("real_attacker", &["--pace", "realtime", "--join-s", "600"]);
    let intruder = Intruder::at(&sim);
    let forged = forged_reply();
    let _lies = answer(&intruder, move |query| reply(&query, &forged));
    let refused = operate(
        &session(&sim, Some(token())),
        &sim,
        &OperatorCommand::Status,
    );
    assert!(
        matches!(refused, Err(BusError::Unsealed { .. })),
        "{refused:?}"
    );
    sim.stop();
}

#[test]
fn an_intercepted_proof_cannot_arm_a_boat_later() {
    let rig = Rig::start(&[]);
    let operator = session(&rig.sim, Some(token()));
    let intruder = Intruder::at(&rig.sim);
    let proofs = Arc::new(Mutex::new(Vec::new()));
    let kept = Arc::clone(&proofs);
    let _keeps = answer(&intruder, move |query| {
        let payload = query
            .payload()
            .map(|bytes| bytes.to_bytes().into_owned())
            .unwrap_or_default();
        if payload.windows(7).any(|word| word == b"\"proof\"") {
            kept.lock().push(payload);
        }
    });
    wait_until("the boat is armed", || {
        let reply = operate(&operator, &rig.sim, &OperatorCommand::Arm)
            .expect("it is the gateway that answers");
        // Before the gateway joins the game, there is no answer.
        reply.is_some_and(|reply| reply.refused.is_none())
    });
    rig.tell(OperatorCommand::Disarm);
    std::thread::sleep(LATER);
    let proofs = std::mem::take(&mut *proofs.lock());
    assert!(!proofs.is_empty(), "the stranger has heard proofs");
    for proof in proofs {
        let answers = intruder.ask("operate/blue_one", proof);
        assert!(
            answers
                .iter()
                .all(|answer| answer.starts_with(b"{\"challenge\"")),
            "{answers:?}"
        );
        assert_eq!(rig.tell(OperatorCommand::Status).status.state, "disarmed");
    }
}

#[test]
fn gateway_reports_cannot_be_forged() {
    let folder = temporary();
    let record = folder.path().join("game.mcap");
    let rig = Rig::start(&["--record", record.to_str().expect("UTF-8")]);
    let observer = session(&rig.sim, None);
    let told = Arc::new(Mutex::new(0));
    let forged = Arc::new(Mutex::new(0));
    let count = Arc::clone(&told);
    let count_forged = Arc::clone(&forged);
    let take = move |bytes: &[u8]| {
        let is_forged = bytes.windows(6).any(|word| word == b"FORGED");
        *(if is_forged { &count_forged } else { &count }).lock() += 1;
    };
    let take = Arc::new(take);
    let topics = [
        topic::status(&rig.sim.name(), "blue_one"),
        topic::link(&rig.sim.name(), "blue_one"),
    ];
    let _heard = topics.map(|key| {
        let take = Arc::clone(&take);
        observer
            .subscribe(key, move |bytes| take(bytes))
            .expect("the session is open")
    });
    let intruder = Intruder::at(&rig.sim);
    // A session receives its own publications, so listen with a second one.
    let listener = Intruder::at(&rig.sim);
    let tickets = ["report/**", "report/status/blue_one"].map(|word| listener.listen(word));
    let status = GatewayStatus {
        vehicle: "blue_one".to_owned(),
        state: "FORGED".to_owned(),
        ..GatewayStatus::default()
    };
    let status = serde_json::to_vec(&status).expect("JSON");
    for what in Reported::ALL {
        let key = intruder.topic(&format!("report/{what}/blue_one"));
        let publisher = intruder.session.declare_publisher(key);
        // zenoh would drop reports in the intruder's own session: before it knows of a subscriber,
        // and when its queue is full.
        let publisher = publisher.congestion_control(CongestionControl::Block);
        let publisher = publisher.wait().expect("the session is open");
        wait_until("the sim subscribes to reports", || {
            let status = publisher.matching_status().wait();
            status.is_ok_and(|status| status.matching())
        });
        for ticket in 0..200 {
            intruder.publish(&format!("{what}/blue_one"), status.clone());
            let report = Reported::with_ticket(ticket, &status);
            publisher.put(report).wait().expect("the session is open");
        }
    }
    intruder.publish("report/status/blue_one", b"1234567".to_vec());
    wait_until("true statuses are heard", || *told.lock() > 20);
    assert_eq!(*forged.lock(), 0);
    assert_eq!(
        tickets.iter().flat_map(|heard| heard.keys()).next(),
        None,
        "tickets are for the sim alone"
    );
    let report = rig.sim.stop();
    assert!(
        report["run"]["refused"]["ticket"]
            .as_u64()
            .unwrap_or_default()
            >= 400,
        "{}",
        report["run"]
    );
    let log = run(&[
        "log",
        record.to_str().expect("UTF-8"),
        "--csv",
        "status/blue_one",
    ]);
    assert!(
        log.status.success() && stdout(&log).contains("disarmed"),
        "{}",
        stderr(&log)
    );
    assert!(!stdout(&log).contains("FORGED"));
}
