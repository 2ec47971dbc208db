//! The game's token keeps strangers out, but anyone may stop boats.

use crate::intruder::Intruder;
use crate::support::{FOUR, Sim, stderr, token};
use bus::token::TOKEN_VARIABLE;
use bus::{Bus, BusError, Net, Token};
use messages::{Control, JoinReply, JoinRequest, Role, topic};
use serde_json::{Value, json};
use std::time::Duration;

/// A session of our own program, with this token or without one.
pub(crate) fn session(sim: &Sim, token: Option<Token>) -> Bus {
    Bus::leaf(&Net {
        connect: vec![sim.endpoint.clone()],
        token,
        ..Net::default()
    })
    .expect("the port is open")
}

fn join(sim: &Sim, token: Option<Token>, role: Role) -> Result<JoinReply, BusError> {
    let bus = session(sim, token);
    let vehicles = vec!["red_two".to_owned()];
    let key = topic::join(&sim.name(), &sim.info(&bus).scenario, role, &vehicles);
    let request = JoinRequest {
        version: primitives::VERSION.to_owned(),
        role,
        node: bus.id(),
        vehicles,
    };
    Ok(bus
        .request(&key, &request, Duration::from_secs(10))?
        .expect("the sim answers"))
}

#[test]
fn nobody_can_join_or_control_without_the_token() {
    let sim = Sim::start("patient", &["--join-s", "600"]);
    for role in [Role::Agent, Role::Gateway] {
        assert!(
            matches!(join(&sim, None, role), Err(BusError::NeedsToken)),
            "{role}"
        );
        assert!(
            matches!(
                join(&sim, Some(Token::random()), role),
                Err(BusError::WrongToken)
            ),
            "{role}"
        );
    }
    for control in [
        Control::Stop,
        Control::Pause,
        Control::Release,
        Control::GoOn,
        Control::Reset(1),
        Control::Speed(Some(0.01)),
    ] {
        let controlled = |token| bus::control(&session(&sim, token), &sim.name(), control);
        assert!(
            matches!(controlled(None), Err(BusError::NeedsToken)),
            "{control:?}"
        );
        assert!(
            matches!(controlled(Some(Token::random())), Err(BusError::WrongToken)),
            "{control:?}"
        );
    }
    assert!(matches!(
        join(&sim, Some(token()), Role::Agent),
        Ok(JoinReply::Granted { .. })
    ));
    let refused = sim
        .squall(&["agent", "--vehicle", "red_one"])
        .env(TOKEN_VARIABLE, Token::random().hex())
        .output();
    let refused = stderr(&refused.expect("the program starts"));
    assert!(refused.contains("wrong token for this game"), "{refused}");
    sim.stop();
}

#[test]
fn what_was_seen_once_cannot_be_used_again() {
    let sim = Sim::start("long", &["--pace", "20x"]);
    let _agents = sim.agent(&FOUR);
    sim.wait_for_kind("started");
    let intruder = Intruder::at(&sim);
    // The complete exchange of a node that knows the token, carried out by hand.
    let request = |body: Value| serde_json::to_vec(&body).expect("JSON");
    let answers = intruder.ask("control", request(json!({ "body": "pause" })));
    let challenge: Value = serde_json::from_slice(&answers[0]).expect("JSON");
    assert!(challenge["challenge"].is_string(), "{challenge}");
    bus::control(
        &session(&sim, Some(token())),
        &sim.name(),
        Control::Speed(Some(5.0)),
    )
    .expect("it may");
    // The same challenge with an invented proof, a missing challenge and an invalid challenge;
    // below, requests without a proof, as in the earlier protocol.
    for forged in [
        json!({ "body": "pause", "proof": { "challenge": challenge["challenge"], "mac": "00".repeat(32) } }),
        json!({ "body": "pause", "proof": { "challenge": "", "mac": "" } }),
        json!({ "body": "stop", "proof": { "challenge": "x".repeat(10_000), "mac": "ff" } }),
    ] {
        let answers = intruder.ask("control", request(forged));
        assert!(
            serde_json::from_slice::<Value>(&answers[0]).expect("JSON")["challenge"].is_string()
        );
    }
    for control in ["\"stop\"", "\"pause\"", "\"release\"", "{\"speed\":0.01}"] {
        intruder.publish("control", control);
    }
    sim.play_on(5.0);
    sim.stop();
}

#[test]
fn anyone_may_stop_the_boats_but_releasing_them_needs_the_token() {
    let sim = Sim::start("long", &["--pace", "20x"]);
    let _agents = sim.agent(&FOUR);
    sim.wait_for_kind("started");
    let intruder = Intruder::at(&sim);
    intruder.publish("control", "\"e_stop\"");
    sim.wait_for_event("e_stopped", Value::Null);
    intruder.publish("control", "\"release\"");
    intruder.publish("released", "true");
    assert!(bus::control(&session(&sim, None), &sim.name(), Control::Release).is_err());
    bus::control(&session(&sim, Some(token())), &sim.name(), Control::Release).expect("it may");
    let released = sim.wait_for_event("released", Value::Null);
    assert_eq!(released["kind"], "event");
    sim.stop();
}
