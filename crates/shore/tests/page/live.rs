//! A game on the network, shown on pages; with a test sim, over the real network.

use super::client::{Client, get};
use super::source::{frame, own_boat, report, scenario, seq_of};
use super::{open_viewer, visit};
use bus::token::{self, Checked, Guard};
use bus::{Bus, Declaration, Net, Priority, Publisher, Token, Watched};
use messages::external::{GatewayStatus, OperatorReply};
use messages::helm::{HelmQuestion, HelmReport};
use messages::picture::Picture;
use messages::run_state::{Phase, RunState};
use messages::topic::{self, GameName};
use messages::water::{PlaneWave, Water};
use messages::{Control, ControlReply, EventRecord, GameInfo, Message, PolicyProposal, Stamp};
use primitives::{SimTime, TeamId, VehicleId, codec};
use rules::event::{Event, Logged};
use scenario::Scenario;
use scenario::outcome::EventOutcome;
use serde_json::json;
use shore::page::live::LiveView;
use shore::page::{Page, View};
use std::io::{BufRead, BufReader, Write};
use std::net::TcpListener;
use std::net::TcpStream;
use std::sync::Arc;
use std::time::Duration;

const LIMIT: Duration = Duration::from_secs(30);
const BLUE_ONE: VehicleId = VehicleId(0);

/// A sim that simulates nothing and publishes what a test requests.
pub(crate) struct Sim {
    pub(crate) bus: Bus,
    pub(crate) port: u16,
    frames: Publisher,
    run: Publisher,
    pictures: Publisher,
    scenario: Scenario,
    events: Arc<Watched<Vec<EventOutcome>>>,
    pub(crate) controls: Arc<Watched<Vec<Control>>>,
    proposals: Arc<Watched<Vec<PolicyProposal>>>,
    _standing: Vec<Declaration>,
}

fn json<T: serde::Serialize>(value: &T) -> Vec<u8> {
    serde_json::to_vec(value).expect("the value is JSON")
}

impl Sim {
    fn open(port: u16, name: &str, scenario: Scenario) -> Sim {
        Sim::paced(port, name, scenario, "1x")
    }

    fn paced(port: u16, name: &str, scenario: Scenario, pace: &str) -> Sim {
        let net = Net {
            listen: vec![format!("tcp/127.0.0.1:{port}")],
            token: token(),
            ..Net::default()
        };
        let game = GameName::new(name).expect("a valid name");
        let bus = Bus::hub(&net, &game, &scenario).expect("the port is free");
        let publisher = |key: String| {
            bus.publisher(key, Priority::Normal)
                .expect("the bus is open")
        };
        let frames = publisher(topic::frame(&game));
        let run = publisher(topic::run(&game));
        let pictures = publisher(topic::picture(&game, &scenario, TeamId(0)));
        let events = Arc::new(Watched::new(vec![]));
        let controls = Arc::new(Watched::new(vec![]));
        let proposals = Arc::new(Watched::new(vec![]));
        let info = GameInfo {
            version: primitives::VERSION.to_owned(),
            pace: pace.to_owned(),
            scenario: scenario.clone(),
        };
        let wave = PlaneWave {
            amplitude_m: 0.25,
            ..PlaneWave::default()
        };
        let fixed = |key: String, answer: Vec<u8>| {
            bus.answer(key, move |question| question.answer(answer.clone()))
                .expect("the bus is open")
        };
        let sent = Arc::clone(&events);
        let [heard, asked] = [Arc::clone(&controls), Arc::clone(&controls)];
        let proposed = Arc::clone(&proposals);
        let standing = vec![
            fixed(topic::scenario(&game), json(&info)),
            fixed(topic::water(&game), json(&Water { waves: vec![wave] })),
            bus.answer(topic::events(&game), move |question| {
                question.answer(sent.visit(|events| json(events)))
            })
            .expect("the bus is open"),
            bus.answer(topic::helm(&game, &scenario, BLUE_ONE), |question| {
                let asked: HelmQuestion =
                    serde_json::from_slice(question.payload()).expect("a question");
                let mode = format!("functions:{}", asked.functions);
                question.answer(json(&Some(HelmReport {
                    mode,
                    ..report(BLUE_ONE)
                })));
            })
            .expect("the bus is open"),
            bus.subscribe(topic::control(&game), move |bytes| {
                heard.visit(|all| all.push(serde_json::from_slice(bytes).expect("a control")));
            })
            .expect("the bus is open"),
            bus.answer(topic::control(&game), move |query| {
                let Checked::Granted(control) =
                    Guard::default().check(query.key(), query.payload(), |_| true)
                else {
                    panic!("a control")
                };
                asked.visit(|all| all.push(control));
                query.answer(token::answer(&ControlReply::Ok(())));
            })
            .expect("the bus is open"),
            bus.subscribe(topic::matching(&game, "policy/*"), move |bytes| {
                proposed.visit(|all| all.push(codec::decode(bytes).expect("a proposal")));
            })
            .expect("the bus is open"),
            bus.show_alive(topic::alive(&game, &bus.id()))
                .expect("the bus is open"),
        ];
        Sim {
            bus,
            port,
            frames,
            run,
            pictures,
            scenario,
            events,
            controls,
            proposals,
            _standing: standing,
        }
    }

    fn show(&self, seq: u64, events: &[Logged]) {
        let mut frame = frame(&self.scenario, seq);
        frame.events = events
            .iter()
            .map(|logged| EventRecord::from(*logged))
            .collect();
        self.frames.send(&frame).expect("the bus is open");
    }

    fn tell_run(&self, phase: Phase) {
        let run = RunState {
            phase,
            now_s: 7.0,
            pace: "1x".to_owned(),
            rate: 1.0,
            ..RunState::default()
        };
        self.run.send_json(json(&run)).expect("the bus is open");
    }

    /// Waits until the page's server subscribes to frames.
    fn wait_for_subscribers(&self) {
        wait_until("the page subscribes", || {
            self.frames.is_heard() && self.run.is_heard()
        });
    }

    pub(crate) fn close(self) {
        self.bus.close();
    }
}

/// Waits until a condition holds.
pub(crate) fn wait_until(what: &str, is_so: impl Fn() -> bool) {
    let never = Watched::new(());
    let waits = || !never.wait(Duration::from_millis(10), |()| false);
    assert!((0..3000).any(|_| waits() && is_so()), "never: {what}");
}

fn port() -> u16 {
    bus::free_port(false).expect("a free port")
}

fn live(port: u16, game: Option<&str>) -> Arc<dyn View> {
    let net = Net {
        connect: vec![format!("tcp/127.0.0.1:{port}")],
        token: token(),
        ..Net::default()
    };
    let game = game.map(|name| GameName::new(name).expect("a valid name"));
    let show = LiveView::open(net.into(), game, Box::new(|_| ()), |_| {
        Err("no missions here".to_owned())
    });
    Arc::new(show.expect("a thread"))
}

/// The game's token.
pub(crate) fn token() -> Option<Token> {
    Some("5c".repeat(32).parse().expect("64 digits"))
}

/// A game, a server, and a page in it that has received the greeting.
pub(crate) fn meet(file: &str) -> (Sim, Page, Client) {
    let port = port();
    let sim = Sim::open(port, "pond", scenario(file));
    let (page, mut client) = visit(live(port, None));
    let hello = client.text();
    assert_eq!(
        (&hello["kind"], &hello["mode"], &hello["game"]),
        (&json!("hello"), &json!("live"), &json!("pond"))
    );
    sim.wait_for_subscribers();
    (sim, page, client)
}

fn tagged(tick: u64) -> Logged {
    Logged {
        tick,
        at: SimTime(50_000_000 * tick as i64),
        event: Event::Untagged(BLUE_ONE),
    }
}

#[test]
fn a_page_sees_frames_their_past_and_how_the_run_stands() {
    let (sim, page, mut client) = meet("pav01_vs_pav01.toml");
    sim.tell_run(Phase::Paused);
    client.until("state", |state| {
        state["phase"] == "paused" && state["now_s"] == 7.0 && state["can_speed"] == true
    });
    // One by one: in a burst some would be dropped, perhaps the last.
    for seq in 0..=100 {
        sim.show(seq, &[]);
        let shown = std::iter::from_fn(|| {
            let frame = client.frame();
            client.ack();
            Some(frame)
        })
        .find(|frame| seq_of(frame) == seq);
        assert_eq!(shown.expect("the newest frame arrives")[0], 1);
    }
    // A new page receives the past frames first.
    let mut newcomer = open_viewer(&page);
    assert_eq!(newcomer.text()["chart"]["waves"][0]["amplitude_m"], 0.25);
    let past: Vec<u64> = (0..20)
        .map(|_| newcomer.frame())
        .inspect(|f| assert_eq!(f[0], 2))
        .map(|f| seq_of(&f))
        .collect();
    assert_eq!(past, (0..20).map(|step| step * 5).collect::<Vec<u64>>());
    let now = newcomer.frame();
    assert_eq!((now[0], seq_of(&now)), (1, 100));
    sim.close();
}

#[test]
fn events_come_with_frames_and_missed_ones_are_asked_for() {
    let (sim, _page, mut client) = meet("pav01_vs_pav01.toml");
    client.until("events", |events| events["reset"] == true);
    let outcome = |tick| EventOutcome::new(&sim.scenario, &tagged(tick));
    sim.events
        .visit(|events| *events = vec![outcome(2), outcome(4)]);
    sim.show(1, &[tagged(2)]);
    client.until("events", |events| events["events"][0]["tick"] == 2);
    // The frame between them is lost, along with its event.
    sim.show(3, &[]);
    let news = client.until("events", |events| {
        events["events"]
            .as_array()
            .is_some_and(|all| !all.is_empty())
    });
    let last = news["events"]
        .as_array()
        .and_then(|all| all.last())
        .expect("an event");
    assert_eq!(
        (&last["tick"], &last["text"]),
        (&json!(4), &json!("blue_one is untagged and back in play"))
    );
    sim.close();
}

#[test]
fn what_pages_ask_of_a_game_reaches_it_if_they_have_rights() {
    let (sim, page, mut client) = meet("pav01_vs_pav01.toml");
    for (ask, want) in [
        (r#"{"do":"control","what":"e_stop"}"#, Control::EStop),
        (r#"{"do":"control","what":"go_on"}"#, Control::GoOn),
        (r#"{"do":"speed","factor":4}"#, Control::Speed(Some(4.0))),
        (
            r#"{"do":"speed","factor":1000}"#,
            Control::Speed(Some(1000.0)),
        ),
    ] {
        client.send(ask);
        assert!(
            sim.controls.wait(LIMIT, |all| all.last() == Some(&want)),
            "{ask}"
        );
    }
    for (ask, why) in [
        (r#"{"do":"speed","factor":0}"#, "expected 0.01 to 1000"),
        (r#"{"do":"speed","factor":1001}"#, "expected 0.01 to 1000"),
        (
            r#"{"do":"speed","factor":null}"#,
            "only a game in lockstep can",
        ),
        (r#"{"do":"seek","t_s":0}"#, "cannot be rewound"),
        (r#"{"do":"step","by":1}"#, "cannot be rewound"),
    ] {
        client.send(ask);
        client.is_refused(why);
    }
    drop(page);
    let locked = super::page(live(sim.port, Some("pond")), Some("secret"), &[]);
    let mut observer = open_viewer(&locked);
    assert_eq!(observer.text()["rights"], false);
    observer.send(r#"{"do":"control","what":"stop"}"#);
    assert_eq!(observer.until("refused", |_| true)["what"], "control");
    let mut master =
        Client::connect(locked.address, "/ws?token=secret", &[]).expect("everyone may watch");
    master.send(r#"{"do":"control","what":"halt"}"#);
    assert!(
        sim.controls
            .wait(LIMIT, |all| all.last() == Some(&Control::Halt))
    );
    sim.controls
        .visit(|all| assert!(!all.contains(&Control::Stop)));
    sim.close();
}

#[test]
fn idle_connections_keep_no_page_out_and_its_e_stop_goes_through() {
    let port = port();
    let sim = Sim::open(port, "pond", scenario("pav01_vs_pav01.toml"));
    let page = super::page(live(port, None), None, &[]);
    let idle: Vec<TcpStream> = (0..300)
        .map(|_| TcpStream::connect(page.address).expect("the server listens"))
        .collect();
    // A browser fetches the page and its files before it opens the WebSocket.
    let (status, _) = get(page.address, "/", &page.address.to_string());
    assert_eq!(status, 200);
    let mut client = open_viewer(&page);
    assert_eq!(client.text()["kind"], "hello");
    sim.wait_for_subscribers();
    client.send(r#"{"do":"control","what":"e_stop"}"#);
    assert!(
        sim.controls
            .wait(LIMIT, |all| all.last() == Some(&Control::EStop))
    );
    drop(idle);
    sim.close();
}

#[test]
fn a_game_in_lockstep_goes_as_fast_as_can_be_if_asked() {
    let port = port();
    let sim = Sim::paced(port, "pond", scenario("pav01_vs_pav01.toml"), "lockstep");
    let (_page, mut client) = visit(live(port, None));
    client.until("hello", |_| true);
    sim.wait_for_subscribers();
    client.send(r#"{"do":"speed","factor":null}"#);
    assert!(
        sim.controls
            .wait(LIMIT, |all| all.last() == Some(&Control::Speed(None)))
    );
    sim.close();
}

#[test]
fn one_page_at_a_time_steers_a_boat_that_can_be_steered() {
    let (sim, page, mut one) = meet("person_2v2.toml");
    let mut other = open_viewer(&page);
    sim.show(5, &[]);
    one.frame();
    let steer = r#"{"do":"drive","vehicle":"blue_one","course_deg":-90,"speed_m_s":99}"#;
    one.send(steer);
    one.until("drive", |drive| {
        drive["vehicle"] == "blue_one" && drive["by"] == "you"
    });
    other.until("drive", |drive| drive["by"] == "other");
    assert!(sim.proposals.wait(LIMIT, |all| !all.is_empty()));
    let proposal = sim.proposals.visit(|all| all[0]);
    let stamp = Stamp {
        version: PolicyProposal::VERSION,
        ..frame(&sim.scenario, 5).stamp
    };
    assert_eq!((proposal.stamp, proposal.vehicle), (stamp, BLUE_ONE));
    assert!((proposal.course_rad - 270.0_f64.to_radians()).abs() < 1e-12);
    assert_eq!(
        proposal.speed_m_s,
        sim.scenario.boat_of(BLUE_ONE).speed_max_m_s()
    );
    other.send(steer);
    assert_eq!(other.until("refused", |_| true)["what"], "drive");
    other.send(r#"{"do":"drive","vehicle":"blue_two","course_deg":0,"speed_m_s":1}"#);
    other.is_refused("does not accept an external policy");
    one.send(r#"{"do":"let_go","vehicle":"blue_one"}"#);
    other.until("drive", |drive| drive["by"].is_null());
    other.send(steer);
    other.until("drive", |drive| drive["by"] == "you");
    one.until("drive", |drive| drive["by"] == "other");
    // After two seconds of silence, the page has lost the lock.
    one.until("drive", |drive| drive["by"].is_null());
    one.send(steer);
    other.until("drive", |drive| drive["by"] == "other");
    drop(one);
    other.until("drive", |drive| drive["by"].is_null());
    sim.close();
}

#[test]
fn a_selected_boat_tells_what_its_helm_thinks_and_where_it_believes_to_be() {
    let (sim, page, mut client) = meet("pav01_vs_pav01.toml");
    let mut other = open_viewer(&page);
    assert!(!sim.pictures.is_heard(), "no page has selected a boat yet");
    client.send(r#"{"do":"select","vehicle":"blue_one","functions":true}"#);
    other.send(r#"{"do":"select","vehicle":"red_one","functions":false}"#);
    let helm = client.until("helm", |helm| helm["report"]["mode"] == "functions:true");
    assert_eq!(
        (&helm["computed"], &helm["agrees"]),
        (&json!(false), &json!(null))
    );
    let none = other.until("helm", |_| true);
    assert_eq!(
        (&none["report"], &none["reason"]),
        (&json!(null), &json!("no agent is running red_one now"))
    );
    wait_until("its team's picture is needed", || sim.pictures.is_heard());
    let stamp = Stamp {
        valid_ns: SimTime::from_s(2.0),
        seq: 20,
        version: Picture::VERSION,
    };
    let picture = Picture {
        stamp,
        own: vec![own_boat(BLUE_ONE)],
        ..Picture::default()
    };
    sim.pictures.send(&picture).expect("the bus is open");
    let estimate = client.until("estimate", |_| true);
    assert_eq!(
        (&estimate["vehicle"], &estimate["x"], &estimate["at_s"]),
        (&json!("blue_one"), &json!(4.0), &json!(2.0))
    );
    client.send(r#"{"do":"select","vehicle":null}"#);
    // The other page selects a red boat, so blue's picture is no longer needed.
    wait_until("no page has it selected any more", || {
        !sim.pictures.is_heard()
    });
    sim.close();
}

#[test]
fn gateways_tell_and_real_boats_keep_their_pace() {
    let (sim, _page, mut client) = meet("mixed_2v2.toml");
    let external = sim
        .scenario
        .vehicles
        .iter()
        .find(|v| v.source == scenario::Source::External);
    let name = external.expect("a real boat").name.clone();
    let game = GameName::new("pond").expect("a valid name");
    let gateway = sim
        .bus
        .publisher(topic::status(&game, &name), Priority::Normal)
        .expect("the bus is open");
    let status = GatewayStatus {
        vehicle: name.clone(),
        state: "armed".to_owned(),
        ..GatewayStatus::default()
    };
    gateway.send_json(json(&status)).expect("the bus is open");
    let sent = client.until("status", |_| true);
    assert_eq!(
        (&sent["vehicle"], &sent["status"]["state"]),
        (&json!(name), &json!("armed"))
    );
    client.send(r#"{"do":"speed","factor":4}"#);
    client.until("refused", |refused| refused["what"] == "speed");
    client.until("state", |state| state["can_speed"] == false);
    sim.close();
}

#[test]
fn an_e_stop_also_goes_straight_to_gateways_during_and_after_a_game() {
    let (sim, _page, mut client) = meet("mixed_2v2.toml");
    let gateway = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let control = Some(gateway.local_addr().expect("bound").to_string());
    let externals: Vec<String> = sim
        .scenario
        .externals()
        .map(|at| sim.scenario.vehicles[at.index()].name.clone())
        .collect();
    for (vehicle, control) in externals
        .iter()
        .zip([control, Some("localhost:99999".to_owned())])
    {
        let game = GameName::new("pond").expect("a valid name");
        let publisher = sim
            .bus
            .publisher(topic::status(&game, vehicle), Priority::Normal)
            .expect("the bus is open");
        let status = GatewayStatus {
            vehicle: vehicle.clone(),
            control,
            ..GatewayStatus::default()
        };
        publisher.send_json(json(&status)).expect("the bus is open");
        client.until("status", |status| status["vehicle"] == vehicle.as_str());
    }
    let is_stopped = |client: &mut Client| {
        client.send(r#"{"do":"control","what":"e_stop"}"#);
        let (stream, _) = gateway.accept().expect("the page connects");
        // Meanwhile the gateway's status is queried.
        let mut lines = BufReader::new(&stream)
            .lines()
            .map(|line| line.expect("a request"));
        assert!(lines.any(|line| line == "{\"body\":{\"fleet\":\"e_stop\"}}"));
        let reply = OperatorReply {
            refused: None,
            status: GatewayStatus::default(),
        };
        (&stream)
            .write_all(&[token::answer(&reply), b"\n".to_vec()].concat())
            .expect("the page reads the reply");
    };
    is_stopped(&mut client);
    assert!(
        sim.controls
            .wait(LIMIT, |all| all.last() == Some(&Control::EStop)),
        "the game receives the E-stop too"
    );
    // Other requests wait their turn.
    for _ in 0..200 {
        client.send(r#"{"do":"control","what":"pause"}"#);
    }
    is_stopped(&mut client);
    sim.close();
    client.until("state", |state| state["phase"] == "gone");
    is_stopped(&mut client);
    client.send(r#"{"do":"control","what":"halt"}"#);
    client.until("refused", |refused| {
        refused["what"] == "control" && refused["reason"] == "the game is no longer running"
    });
}

#[test]
fn a_game_that_ends_is_removed_and_the_next_is_a_new_one() {
    let port = port();
    let (_page, mut client) = visit(live(port, None));
    client.until("preparing", |preparing| preparing["failed"] == true);
    let first = Sim::open(port, "pond", scenario("pav01_vs_pav01.toml"));
    assert_eq!(client.until("hello", |_| true)["game"], "pond");
    first.wait_for_subscribers();
    first.show(9, &[]);
    client.until("state", |state| state["phase"] == "playing");
    first.close();
    client.until("state", |state| state["phase"] == "gone");
    client.send(r#"{"do":"control","what":"stop"}"#);
    client.until("refused", |_| true);
    let second = Sim::open(port, "lake", scenario("pav01_vs_pav01.toml"));
    assert_eq!(client.until("hello", |_| true)["game"], "lake");
    client.until("events", |events| events["reset"] == true);
    client.until("state", |state| state["phase"] == "waiting");
    second.controls.visit(|all| {
        assert_eq!(
            all.len(),
            0,
            "the second game received a command for the first"
        )
    });
    second.close();
}

#[test]
fn noise_on_the_network_is_ignored() {
    let (sim, _page, mut client) = meet("pav01_vs_pav01.toml");
    for noise in [&b""[..], b"ahoy", &[0, 1, 0, 0], &[0; 64], &[255; 200]] {
        sim.frames
            .send_raw(noise.to_vec())
            .expect("the bus is open");
        sim.run.send_raw(noise.to_vec()).expect("the bus is open");
    }
    let mut odd = frame(&sim.scenario, 1);
    odd.stamp.valid_ns = SimTime(i64::MIN);
    sim.frames.send(&odd).expect("the bus is open");
    odd = frame(&sim.scenario, 1);
    odd.events = vec![EventRecord {
        tick: 1,
        at_ns: SimTime(1),
        kind: 8,
        subject: 900,
        object: 901,
    }];
    sim.frames.send(&odd).expect("the bus is open");
    sim.show(2, &[tagged(1)]);
    let events = client.until("events", |events| {
        events["events"]
            .as_array()
            .is_some_and(|all| !all.is_empty())
    });
    assert_eq!(events["events"][0]["event"], "untagged");
    sim.close();
}
