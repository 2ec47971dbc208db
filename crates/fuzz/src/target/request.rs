//! The control plane (JSON): requests with their proofs, replies, states, and this machine's
//! registry.

use super::{Target, check_shown, mutations};
use crate::played::{self, mixed, played};
use bus::token::{self, Checked, Guard, Token};
use bus::{Entry, GATEWAY_PORT_KEY, GatewayEntry};
use messages::external::{
    FleetCommand, GatewayCommand, GatewayStatus, Mission, OperatorCommand, OperatorReply,
};
use messages::helm::{HelmQuestion, HelmReport};
use messages::run_state::{RecordingState, RunState};
use messages::water::{PlaneWave, Water};
use messages::{Control, ControlReply, GameInfo, JoinReply, JoinRequest, Role};
use scenario::outcome::{EventOutcome, Outcome};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use sim::node::ProgressMessage;
use sim::node::membership::Membership;
use std::fmt::Debug;
use std::sync::LazyLock;

pub(super) const TARGET: Target = Target {
    name: "request",
    seeds,
    change: mutations,
    check,
    allocated_max: (1 << 20, 5000),
};

static TOKEN: LazyLock<Token> =
    LazyLock::new(|| "0123456789abcdef".repeat(4).parse().expect("64 digits"));
static MEMBERSHIPS: LazyLock<[Membership; 2]> =
    LazyLock::new(|| [Role::Agent, Role::Gateway].map(|role| Membership::new(&mixed(), role)));

fn seeds() -> Vec<Vec<u8>> {
    let game = played(played::scenario("attack_1v1"), 20);
    let mut runner = arena::runner_of(agent::minds_of(&game.scenario));
    runner.minds_mut().for_each(|(_, mind)| mind.show(true));
    runner.decide(game.decisions[9].frame.stamp, |vehicle| {
        Some(&game.decisions[9].pictures[vehicle.index()])
    });
    let mut seeds: Vec<Vec<u8>> = runner
        .minds()
        .map(|(_, mind)| bytes_of(&mind.report()))
        .collect();
    let boat = |command| GatewayCommand::boat("blue_one", command);
    let mission = Mission {
        throttle_pct: 50.0,
        erp: [41.35, -73.97],
        waypoints: vec![[41.36, -73.96]; 3],
    };
    let commands = [
        OperatorCommand::Status,
        OperatorCommand::EStop,
        OperatorCommand::Mission(mission),
    ]
    .map(boat);
    seeds.extend(
        commands
            .iter()
            .chain([&GatewayCommand::Fleet(FleetCommand::Release)])
            .flat_map(requests),
    );
    let controls = [
        Control::EStop,
        Control::Halt,
        Control::Speed(Some(4.0)),
        Control::Speed(None),
        Control::Reset(7),
        Control::Release,
    ];
    seeds.extend(controls.iter().flat_map(requests));
    let vehicles = vec!["blue_one".to_owned(), "blue_two".to_owned()];
    let version = primitives::VERSION.to_owned();
    let node = "a7".to_owned();
    seeds.extend(requests(&JoinRequest {
        version,
        role: Role::Agent,
        node,
        vehicles: vehicles.clone(),
    }));
    seeds.push(bytes_of(&JoinReply::Granted {
        ticket: 7,
        vehicles: vec![primitives::VehicleId(0)],
        now_ns: primitives::SimTime(5),
    }));
    seeds.push(bytes_of(&ControlReply::Err("no".to_owned())));
    seeds.push(br#"{"challenge":"0123456789abcdef0123456789abcdef"}"#.to_vec());
    let status = GatewayStatus {
        nav: Some(messages::picture::Nav::default()),
        nav_age_s: Some(0.5),
        mode: Some('T'),
        counts: vec![("sentences".to_owned(), 3)],
        latency_us: [Some([1.0, 2.0]), None],
        ..GatewayStatus::default()
    };
    seeds.push(token::answer(&OperatorReply {
        refused: None,
        status: status.clone(),
    }));
    let recording = Some(RecordingState {
        file: "a.mcap".to_owned(),
        bytes: 5,
        ..RecordingState::default()
    });
    seeds.extend([
        bytes_of(&status),
        bytes_of(&RunState {
            minds: vehicles,
            recording,
            ..RunState::default()
        }),
    ]);
    let waves = vec![
        PlaneWave {
            amplitude_m: 0.1,
            wavenumber_rad_m: 1.0,
            ..PlaneWave::default()
        };
        3
    ];
    seeds.extend([
        bytes_of(&Water { waves }),
        bytes_of(&game.ending.outcome),
        bytes_of(&game.ending.outcome.events),
    ]);
    seeds.push(bytes_of(&HelmQuestion::default()));
    let endpoint = "tcp/127.0.0.1:7447".to_owned();
    let control = "127.0.0.1:7001".parse().expect("an address");
    seeds.push(bytes_of(&Entry {
        game: "pav01".to_owned(),
        endpoint,
        pid: 1,
        token: Some(TOKEN.hex()),
        is_water: false,
    }));
    seeds.push(bytes_of(&GatewayEntry {
        vehicle: "blue_one".to_owned(),
        game: None,
        control,
        pid: 1,
        token: None,
    }));
    seeds.push(br#"{"kind":"waiting","agents":["blue_one"],"gateways":[]}"#.to_vec());
    seeds.push(bytes_of(&game.info()));
    seeds
}

fn bytes_of<T: Serialize>(value: &T) -> Vec<u8> {
    serde_json::to_vec(value).expect("JSON")
}

/// A request on its own, in its envelope, and with an invalid proof.
fn requests<T: Serialize>(body: &T) -> [Vec<u8>; 3] {
    let text = String::from_utf8(bytes_of(body)).expect("JSON");
    let proof = format!(
        r#"{{"challenge":"{}","mac":"{}"}}"#,
        "4f0c".repeat(8),
        "ab".repeat(32)
    );
    let first = format!(r#"{{"body":{text}}}"#);
    let second = format!(r#"{{"body":{text},"proof":{proof}}}"#);
    [text.into_bytes(), first.into_bytes(), second.into_bytes()]
}

fn check(bytes: &[u8]) {
    guarded(bytes);
    answered(bytes);
    if let Some(request) = read::<JoinRequest>(bytes) {
        for membership in MEMBERSHIPS.iter() {
            match membership.clone().join(&request, 7, primitives::SimTime(5)) {
                JoinReply::Granted { vehicles, .. } => {
                    assert_eq!(vehicles.len(), request.vehicles.len())
                }
                JoinReply::Refused { reason } => check_shown(&reason),
                JoinReply::Busy { vehicle } => panic!("no other node has {vehicle}"),
            }
        }
    }
    read::<JoinReply>(bytes);
    read::<Control>(bytes);
    read::<ControlReply>(bytes);
    read::<GatewayCommand>(bytes);
    read::<OperatorReply>(bytes);
    read::<GatewayStatus>(bytes);
    read::<RunState>(bytes);
    read::<HelmQuestion>(bytes);
    if let Some(report) = read::<Option<HelmReport>>(bytes).flatten() {
        if shore::page::is_sound(&report, report.vehicle, 4) {
            assert_eq!(
                report.sum(report.functions.iter()).len(),
                report.courses * report.speeds
            );
        }
    }
    for event in read::<Vec<EventOutcome>>(bytes).unwrap_or_default() {
        drop(event.sentence());
    }
    read::<Outcome>(bytes);
    read::<Water>(bytes);
    read::<Entry>(bytes);
    read::<GatewayEntry>(bytes);
    // Reports cannot be compared for equality, because they contain errors.
    drop(serde_json::from_slice::<ProgressMessage>(bytes));
    // The numbers are trusted, because a node that joins a game trusts its sim.
    if let Some(Err(error)) = read::<GameInfo>(bytes).map(|info| info.scenario.check_received()) {
        check_shown(&error);
    }
}

/// A decoded value must survive an encoding round trip.
fn read<T: Serialize + DeserializeOwned + PartialEq + Debug>(bytes: &[u8]) -> Option<T> {
    match serde_json::from_slice::<T>(bytes) {
        Ok(value) => {
            let written = bytes_of(&value);
            let again = serde_json::from_slice::<T>(&written)
                .unwrap_or_else(|e| panic!("cannot decode what was encoded: {e}"));
            assert_eq!(bytes_of(&again), written);
            Some(value)
        }
        Err(error) => {
            check_shown(&error);
            None
        }
    }
}

/// A request that needs the token is never granted without it.
fn guarded(bytes: &[u8]) {
    let guard = || Guard::new(Some(TOKEN.clone()));
    match guard().check(GATEWAY_PORT_KEY, bytes, GatewayCommand::needs_token) {
        Checked::Granted(command) => assert!(!command.needs_token(), "{command:?}"),
        Checked::Challenged(challenge) => assert!(challenge.starts_with(br#"{"challenge":""#)),
        Checked::Garbage(error) => check_shown(&error),
    }
    match guard().check("g/control", bytes, |control: &Control| !control.stops()) {
        Checked::Granted(control) => assert!(control.stops(), "{control:?}"),
        Checked::Challenged(_) => {}
        Checked::Garbage(error) => check_shown(&error),
    }
    let mut guard = guard();
    let mut join = |bytes: &[u8]| guard.check("g/join", bytes, |_: &JoinRequest| true);
    let mut checked = join(bytes);
    if let Checked::Challenged(challenge) = &checked
        && let Some(again) = with_challenge(bytes, challenge)
    {
        checked = join(&again);
    }
    assert!(!matches!(checked, Checked::Granted(_)), "{checked:?}");
}

/// The request with its own proof, valid or not, for the challenge in the reply.
fn with_challenge(request: &[u8], answer: &[u8]) -> Option<Vec<u8>> {
    let mut request: Value = serde_json::from_slice(request).ok()?;
    let answer: Value = serde_json::from_slice(answer).ok()?;
    let mac = request["proof"]["mac"]
        .as_str()
        .unwrap_or_default()
        .to_owned();
    request.as_object_mut()?.insert(
        "proof".to_owned(),
        json!({"challenge": answer["challenge"], "mac": mac}),
    );
    Some(request.to_string().into_bytes())
}

/// A client accepts any reply, retries a limited number of times, and never reveals the token.
fn answered(bytes: &[u8]) {
    // The client sends back any challenge.
    let is_known = String::from_utf8_lossy(bytes).contains(&TOKEN.hex());
    let mut asked = 0;
    let command = GatewayCommand::Fleet(FleetCommand::Release);
    let reply =
        token::request::<_, OperatorReply>(Some(&TOKEN), GATEWAY_PORT_KEY, &command, |request| {
            asked += 1;
            let request = String::from_utf8(request).expect("JSON");
            assert!(is_known || !request.contains(&TOKEN.hex()), "{request}");
            Ok(Some(bytes.to_vec()))
        });
    assert!(asked <= token::ATTEMPTS);
    if let Err(error) = reply {
        check_shown(&error);
    }
}
