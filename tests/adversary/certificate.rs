//! A game with keys: a node with missing or wrong keys can do nothing; a node with valid keys can
//! do only what its role allows.

use crate::crowd::{FEW_FILES, MANY_FILES, is_withstood, squall_with_files};
use crate::disturbed_game::DisturbedGame;
use crate::intruder::{Intruder, Target, config};
use crate::support::{FOUR, Process, Sim, free_endpoint, squall, temporary, wait_until};
use bus::keys::{Bundle, Identity, make};
use bus::token::TOKEN_VARIABLE;
use bus::{Bus, BusError, Net};
use messages::Control;
use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tempfile::TempDir;

const DAY: Duration = Duration::from_secs(24 * 3600);

/// Keys for all roles, with a sim on this machine.
fn keys(valid: Duration) -> TempDir {
    bus::restart_for_keys().expect("the tests start again");
    let folder = temporary();
    let named = [
        "sim",
        "team-blue",
        "team-red",
        "gateway-red_one",
        "observer",
        "operator",
    ];
    let identities: Vec<Identity> = named
        .iter()
        .map(|name| name.parse().expect("an identity"))
        .collect();
    make(folder.path(), &identities, &["127.0.0.1".to_owned()], valid).expect("keys");
    folder
}

/// Starts a sim with keys, which needs no token.
fn sim(keys: &TempDir, scenario: &str, args: &[&str]) -> Sim {
    sim_by(squall(&[]), keys, scenario, args)
}

/// Starts a sim with keys, using this program.
fn sim_by(mut program: Command, keys: &TempDir, scenario: &str, args: &[&str]) -> Sim {
    program.env_remove(TOKEN_VARIABLE);
    let endpoint = free_endpoint();
    let folder = keys.path().join("sim").display().to_string();
    Sim::start_with(
        program,
        scenario,
        &[&["--listen", &endpoint, "--keys", &folder], args].concat(),
    )
}

fn agent(endpoint: &str, sim: &Sim, keys: &Path, vehicles: &[&str]) -> Process {
    let args = [
        "agent",
        "--connect",
        endpoint,
        "--game",
        &sim.game,
        "--wait-s",
        "10",
        "--vehicle",
    ];
    let mut command = squall(&[&args[..], vehicles].concat());
    command
        .env_remove(TOKEN_VARIABLE)
        .arg("--keys")
        .arg(keys)
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    Process::start(command)
}

/// Starts an agent for the boats of each team.
fn agents(sim: &Sim, keys: &TempDir) -> Vec<Process> {
    let team = |name: &str, vehicles| agent(&sim.endpoint, sim, &keys.path().join(name), vehicles);
    vec![team("team-blue", &FOUR[..2]), team("team-red", &FOUR[2..])]
}

/// Opens a session of our own program with these keys.
fn node(sim: &Sim, keys: &TempDir, name: &str) -> Result<Bus, BusError> {
    let bundle = Arc::new(Bundle::load(&keys.path().join(name)).expect("good keys"));
    Bus::leaf(&Net {
        connect: vec![sim.endpoint.clone()],
        keys: Some(bundle),
        ..Net::default()
    })
}

/// zenoh's TLS settings: the trusted authority and the node's own certificate.
fn tls(trusted: &Path, shown: Option<&Path>) -> Value {
    let mut tls = json!({ "root_ca_certificate": trusted.join("authority.pem"), "verify_name_on_connect": false });
    for side in ["connect", "listen"] {
        if let Some(shown) = shown {
            tls["enable_mtls"] = json!(true);
            tls[format!("{side}_certificate")] = json!(shown.join("certificate.pem"));
            tls[format!("{side}_private_key")] = json!(shown.join("key.pem"));
        }
    }
    tls
}

/// An intruder that holds valid keys of this role.
fn traitor(sim: &Sim, keys: &TempDir, name: &str) -> Intruder {
    let folder = keys.path().join(name);
    Target::of(sim)
        .open_with("client", &tls(&folder, Some(&folder)))
        .expect("its keys are valid")
}

/// A request to join with these vehicles, without a proof.
fn join_request(role: &str, vehicles: &Value) -> Vec<u8> {
    let body =
        json!({ "version": primitives::VERSION, "role": role, "node": "x", "vehicles": vehicles });
    json!({ "body": body }).to_string().into_bytes()
}

#[test]
fn a_client_without_a_certificate_gets_no_session() {
    let own = keys(DAY);
    let foreign = keys(DAY);
    let sim = sim(&own, "patient", &["--join-s", "600"]);
    let target = Target::of(&sim);
    let [trusted, forged] = [&own, &foreign].map(|keys| keys.path().join("operator"));
    assert!(
        target
            .open_with("client", &tls(&trusted, Some(&trusted)))
            .is_some(),
        "good keys"
    );
    for mode in ["client", "router"] {
        assert!(
            target.open_with(mode, &tls(&trusted, None)).is_none(),
            "no certificate"
        );
        assert!(
            target
                .open_with(mode, &tls(&trusted, Some(&forged)))
                .is_none(),
            "of another authority"
        );
        // The sim's own certificate is valid for serving only.
        assert!(
            target
                .open_with(mode, &tls(&trusted, Some(&own.path().join("sim"))))
                .is_none(),
            "the sim's"
        );
        let plain = Target {
            endpoint: target.endpoint.replace("tls/", "tcp/"),
            ..target.clone()
        };
        assert!(plain.open(mode).is_none(), "without TLS");
    }
    let refused = agent(
        &sim.endpoint,
        &sim,
        &foreign.path().join("team-blue"),
        &FOUR[..1],
    )
    .refusal();
    assert!(refused.contains("different authority"), "{refused}");
    let elsewhere = sim.endpoint.replace("127.0.0.1", "localhost");
    let refused = agent(&elsewhere, &sim, &own.path().join("team-blue"), &FOUR[..1]).refusal();
    assert!(refused.contains("--host localhost"), "{refused}");
    sim.stop();
}

#[test]
fn who_crowds_the_port_keeps_nobody_with_keys_out_and_disturbs_nobody() {
    crowds_with_keys_are_withstood(MANY_FILES);
}

#[test]
fn who_crowds_a_port_with_few_files_keeps_nobody_with_keys_out() {
    crowds_with_keys_are_withstood(FEW_FILES);
}

fn crowds_with_keys_are_withstood(files: usize) {
    let own = keys(DAY);
    let sim = sim_by(squall_with_files(files), &own, "long", &["--pace", "20x"]);
    let agents = agents(&sim, &own);
    let operator = node(&sim, &own, "operator").expect("good keys");
    is_withstood(sim, agents, files, &operator, &|sim| {
        node(sim, &own, "observer").is_ok()
    });
}

/// Existing links are kept: no node is disconnected in the middle of a game.
#[test]
fn an_expired_certificate_is_rejected_but_open_links_continue() {
    let valid = Duration::from_secs(20);
    let start = Instant::now();
    let own = keys(valid);
    let folder = own.path().join("team-blue");
    let sim = sim(&own, "patient", &[]);
    let _agents = agents(&sim, &own);
    sim.wait_for_kind("started");
    let late = Target::of(&sim);
    assert!(
        late.open_with("client", &tls(&folder, Some(&folder)))
            .is_some(),
        "they are still valid"
    );
    std::thread::sleep((valid + Duration::from_secs(1)).saturating_sub(start.elapsed()));
    assert!(
        late.open_with("client", &tls(&folder, Some(&folder)))
            .is_none(),
        "they have expired"
    );
    let refused = agent(&sim.endpoint, &sim, &folder, &FOUR[..1]).refusal();
    assert!(refused.contains("expired"), "{refused}");
    sim.newest_progress();
    sim.play_on(5.0);
    sim.stop();
}

#[test]
fn a_red_agent_learns_nothing_about_blue_and_changes_nothing() {
    let own = keys(DAY);
    let served = sim(&own, "pav01_600s", &["--speed", "2"]);
    let playing = agents(&served, &own);
    served.wait_for_kind("started");
    let operator = node(&served, &own, "operator").expect("good keys");
    let red = traitor(&served, &own, "team-red");
    // Forge from a second session: a session receives its own publications.
    let forger = traitor(&served, &own, "team-red");
    let mut game = DisturbedGame {
        sim: served,
        agents: playing,
        operator: Some(operator),
    };
    let secret = [
        "picture/blue",
        "say/blue",
        "policy/blue_one",
        "frame",
        "order/**",
        "**",
    ]
    .map(|word| red.listen(word));
    let open = red.listen("picture/red");
    let forged = [
        "join/agent/blue",
        "scenario",
        "helm/blue_one",
        "operate/blue_one",
    ]
    .map(|topic| forger.answer(topic));
    let words = [
        "order/blue/x",
        "order/x",
        "say/blue",
        "policy/blue_one",
        "picture/blue",
        "frame",
        "run",
        "nav/blue_one",
    ];
    for _ in 0..200 {
        words.iter().for_each(|word| forger.publish(word, "forged"));
    }
    wait_until("its own pictures arrive", || open.keys().len() > 20);
    let not_its_own = |key: &String| *key != red.topic("picture/red");
    assert_eq!(
        secret
            .iter()
            .flat_map(|heard| heard.keys())
            .find(not_its_own),
        None
    );
    for (place, vehicles) in [
        ("join/agent/blue", json!(["blue_one"])),
        ("join/agent", json!(["blue_one", "red_one"])),
    ] {
        assert_eq!(
            red.ask(place, join_request("agent", &vehicles)).len(),
            0,
            "{place}"
        );
    }
    // The node may join, but not with these boats.
    for vehicles in [
        json!(["blue_one"]),
        json!(["red_one", "blue_one"]),
        json!([]),
    ] {
        let answer = red.ask("join/agent/red", join_request("agent", &vehicles));
        let answer: Value = serde_json::from_slice(&answer[0]).expect("JSON");
        assert!(
            answer["answer"]["Refused"].is_object(),
            "{vehicles}: {answer}"
        );
    }
    for topic in [
        "control",
        "events",
        "water",
        "helm/blue_one",
        "operate/blue_one",
    ] {
        assert_eq!(
            red.ask(topic, json!({ "body": "stop" }).to_string().into_bytes())
                .len(),
            0,
            "{topic}"
        );
    }
    game.check();
    drop(forged);
    game.ends_as_if_undisturbed();
}

#[test]
fn an_observer_can_stop_boats_but_controls_nothing() {
    let own = keys(DAY);
    let sim = sim(&own, "long", &["--pace", "20x"]);
    let _agents = agents(&sim, &own);
    sim.wait_for_kind("started");
    let observer = node(&sim, &own, "observer").expect("good keys");
    let traitor = traitor(&sim, &own, "observer");
    for control in ["pause", "stop", "release", "go_on", "step"] {
        let payload = json!({ "body": control }).to_string();
        assert_eq!(
            traitor.ask("control", payload.clone().into_bytes()).len(),
            0,
            "{control}"
        );
        traitor.publish("control", json!(control).to_string());
    }
    let refused = bus::control(&observer, &sim.name(), Control::Stop);
    assert!(
        matches!(refused, Err(BusError::NotAllowed { .. })),
        "{refused:?}"
    );
    sim.newest_progress();
    sim.play_on(5.0);
    bus::control(&observer, &sim.name(), Control::EStop).expect("it may");
    sim.wait_for_event("e_stopped", Value::Null);
    assert!(bus::control(&observer, &sim.name(), Control::Release).is_err());
    let operator = node(&sim, &own, "operator").expect("good keys");
    bus::control(&operator, &sim.name(), Control::Release).expect("it may");
    sim.wait_for_event("released", Value::Null);
    sim.stop();
}

#[test]
fn an_agents_certificate_cannot_serve_a_game() {
    let own = keys(DAY);
    let sim = sim(&own, "patient", &["--join-s", "600"]);
    let blue = own.path().join("team-blue");
    let endpoint = free_endpoint();
    let served = endpoint.replace("tcp/", "tls/");
    let config = config(&[
        ("mode", "\"router\""),
        ("listen/endpoints", &format!("[{served:?}]")),
        ("transport/link/tls", &tls(&blue, Some(&blue)).to_string()),
    ]);
    let session = zenoh::Wait::wait(zenoh::open(config)).expect("the port is free");
    let shown = zenoh::Wait::wait(
        session
            .liveliness()
            .declare_token(Target::of(&sim).topic("alive/sim/fake")),
    );
    let refused = agent(&endpoint, &sim, &own.path().join("team-red"), &FOUR[2..]).refusal();
    assert!(
        refused.contains("rejects the sim's certificate"),
        "{refused}"
    );
    drop(shown);
    sim.stop();
}

#[test]
fn a_gateway_can_report_only_for_its_own_boat() {
    let own = keys(DAY);
    let sim = sim(
        &own,
        "mixed_60s",
        &["--pace", "realtime", "--join-s", "600"],
    );
    let red_one = traitor(&sim, &own, "gateway-red_one");
    let request = |vehicle: &str| join_request("gateway", &json!([vehicle]));
    assert_eq!(
        red_one
            .ask("join/gateway/blue_one", request("blue_one"))
            .len(),
        0
    );
    assert_eq!(red_one.ask("join/gateway", request("blue_one")).len(), 0);
    let answer = |vehicle: &str| -> Value {
        let answer = red_one.ask("join/gateway/red_one", request(vehicle));
        serde_json::from_slice(&answer[0]).expect("JSON")
    };
    assert!(answer("blue_one")["answer"]["Refused"].is_object());
    assert!(answer("red_one")["answer"]["Granted"].is_object());
    // Only a boat's own gateway can answer for it, whatever keys others hold. The gateway receives
    // no orders for other boats.
    let others = ["team-blue", "observer", "operator"].map(|name| traitor(&sim, &own, name));
    let _forged: Vec<_> = others
        .iter()
        .chain([&red_one])
        .map(|other| other.answer("operate/blue_one"))
        .collect();
    // A session receives its own publications, so listen with a second one.
    let listener = traitor(&sim, &own, "gateway-red_one");
    let orders = ["external/blue_one", "**"].map(|word| listener.listen(word));
    let operator = traitor(&sim, &own, "operator");
    assert_eq!(operator.ask("operate/blue_one", "{}").len(), 0);
    let heard =
        ["status/blue_one", "status/red_one", "report/**"].map(|word| operator.listen(word));
    for _ in 0..50 {
        for word in [
            "status/blue_one",
            "nav/blue_one",
            "link/blue_one",
            "report/status/blue_one",
            "status/red_one",
        ] {
            red_one.publish(word, "forged");
        }
    }
    assert_eq!(heard.iter().flat_map(|heard| heard.keys()).next(), None);
    assert_eq!(orders.iter().flat_map(|heard| heard.keys()).next(), None);
    sim.stop();
}
