//! Operators of real boats: who may command one from a page, and that nothing delays a stop.

use super::client::{Client, get};
use super::live::{meet, token, wait_until};
use super::settings;
use bus::token::{self, Checked, Guard};
use bus::{Bus, Declaration, Net, Watched};
use messages::Control;
use messages::external::{GatewayStatus, OperatorCommand, OperatorReply};
use messages::topic::{self, GameName};
use serde_json::json;
use shore::page::{Background, Page};
use std::sync::Arc;
use std::time::Duration;

/// A real boat of the game, and a simulated one.
const BOAT: &str = "blue_one";
const SIMULATED: &str = "blue_two";

/// The commands that a gateway received.
type Told = Arc<Watched<Vec<OperatorCommand>>>;

/// A gateway that needs `takes` to arm, rejects a release, and cannot prove that it knows the
/// token.
fn gateway(bus: &Bus, takes: Duration) -> (Told, Declaration) {
    let told = Told::default();
    let noted = Arc::clone(&told);
    let key = topic::operate(&GameName::new("pond").expect("a valid name"), BOAT);
    let answer = move |question: bus::Query| {
        let Checked::Granted(command) =
            Guard::default().check(question.key(), question.payload(), |_| true)
        else {
            panic!("a command")
        };
        let refused =
            (command == OperatorCommand::Release).then(|| "an E-stop is in force".to_owned());
        if command == OperatorCommand::Arm {
            Watched::new(()).wait(takes, |()| false);
        }
        noted.visit(|all| all.push(command));
        let status = GatewayStatus {
            vehicle: BOAT.to_owned(),
            state: "armed".to_owned(),
            ..GatewayStatus::default()
        };
        question.answer(token::answer(&OperatorReply { refused, status }));
    };
    let standing = bus.answer(key, answer).expect("the bus is open");
    (told, standing)
}

fn operator(page: &Page) -> Client {
    let path = format!("/ws?token={}", page.operator_token);
    Client::connect(page.address, &path, &[]).expect("everyone may watch")
}

fn command(vehicle: &str, command: &str) -> String {
    json!({"do": "operate", "vehicle": vehicle, "command": command}).to_string()
}

#[test]
fn arming_needs_the_operators_token_and_disarming_only_the_right_to_stop() {
    let (sim, page, mut control) = meet("mixed_2v2.toml");
    let (told, standing) = gateway(&sim.bus, Duration::ZERO);
    let mut operator = operator(&page);
    operator.until("hello", |hello| {
        hello["rights"] == true && hello["operates"] == true
    });
    for word in ["arm", "release", "station_keep", "go_to_erp"] {
        control.send(&command(BOAT, word));
        control.is_refused("operator's token");
    }
    assert!(
        told.visit(|told| told.is_empty()),
        "no command reaches the gateway"
    );
    control.send(r#"{"do":"control","what":"release"}"#);
    control.until("refused", |refused| refused["what"] == "control");
    operator.send(r#"{"do":"control","what":"release"}"#);
    wait_until("an operator releases all boats", || {
        sim.controls.visit(|all| all == &[Control::Release])
    });
    control.send(&command(BOAT, "disarm"));
    control.until("operated", |reply| {
        *reply == json!({"kind": "operated", "vehicle": BOAT, "command": "disarm", "refused": null})
    });
    operator.send(&command(BOAT, "arm"));
    operator.until("operated", |reply| {
        reply["command"] == "arm" && reply["refused"].is_null()
    });
    control.until("status", |status| status["status"]["state"] == "armed");
    operator.send(&command(BOAT, "release"));
    operator.until("operated", |reply| {
        reply["refused"] == "an E-stop is in force"
    });
    for (vehicle, why) in [(SIMULATED, "is simulated"), ("nobody", "nobody")] {
        operator.send(&command(vehicle, "arm"));
        operator.until("refused", |refused| {
            refused["reason"]
                .as_str()
                .is_some_and(|reason| reason.contains(why))
        });
    }
    operator.send(&json!({"do": "mission", "vehicle": BOAT, "lines": ""}).to_string());
    operator.until("refused", |refused| refused["reason"] == "no missions here");
    let want = [
        OperatorCommand::Disarm,
        OperatorCommand::Arm,
        OperatorCommand::Release,
    ];
    assert_eq!(told.visit(|told| told.clone()), want);
    drop(standing);
    operator.send(&command(BOAT, "arm"));
    operator.until("operated", |reply| {
        reply["refused"]
            .as_str()
            .is_some_and(|why| why.contains("no gateway of blue_one"))
    });
    sim.close();
}

#[test]
fn no_flood_of_commands_delays_a_stop() {
    let (sim, page, mut control) = meet("mixed_2v2.toml");
    // The gateway has its own link, as in a separate process. Arming takes longer than a reply's
    // timeout.
    let net = Net {
        connect: vec![format!("tcp/127.0.0.1:{}", sim.port)],
        token: token(),
        ..Net::default()
    };
    let other = Bus::leaf(&net).expect("the sim is reachable");
    let (_, standing) = gateway(&other, Duration::from_secs(4));
    let mut operator = operator(&page);
    operator.until("hello", |_| true);
    (0..200).for_each(|_| operator.send(&command(BOAT, "arm")));
    operator.until("refused", |refused| {
        refused["reason"]
            .as_str()
            .is_some_and(|why| why.contains("has not answered"))
    });
    let begun = bus::clock::now();
    control.send(r#"{"do":"control","what":"e_stop"}"#);
    wait_until("the E-stop arrives", || {
        sim.controls
            .visit(|controls| controls.contains(&Control::EStop))
    });
    assert!(
        bus::clock::since(begun) < Duration::from_secs(2),
        "after {:?}",
        bus::clock::since(begun)
    );
    drop(standing);
    other.close();
    sim.close();
}

#[test]
fn what_is_drawn_below_the_field_is_served_and_null_without() {
    let dir = tempfile::tempdir().expect("a directory");
    let file = dir.path().join("site.geojson");
    std::fs::write(&file, r#"{"type":"Point","coordinates":[-73.9,41.3]}"#)
        .expect("the file can be written");
    let with = Background::read(&file).expect("the background is valid");
    for (background, want) in [
        (
            Some(with),
            r#"{"areas":[],"lines":[],"name":"site.geojson","points":[[-73.9,41.3,""]]}"#,
        ),
        (None, "null"),
    ] {
        let page = Page::open(shore::page::PageSettings {
            background,
            ..settings(None, &[])
        })
        .expect("a free port");
        let host = page.address.to_string();
        let (status, answer) = get(page.address, "/background.json", &host);
        assert_eq!(status, 200);
        assert!(answer.ends_with(want), "{answer}");
        assert_eq!(get(page.address, "/background-image", &host).0, 404);
    }
}
