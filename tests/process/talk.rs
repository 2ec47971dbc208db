//! Team messages from process to process: received exactly one decision later.

use crate::support::{LIMIT, Process, Sim, assert_a_game_each, scenarios, temporary, two_fleets, wait_until, write};
use game::helm::HelmReport;
use game::message::{GameInfo, Message, Say, Stamp, Word};
use game::topic::{self, GameName};
use game::{TeamId, VehicleId, codec};
use std::path::{Path, PathBuf};
use std::sync::mpsc::channel;
use std::time::Duration;

/// A game of three against three who steer by what their mates said.
fn talking_game(dir: &Path, duration_s: f64) -> PathBuf {
    let root = scenarios();
    let strategy = format!(
        r#"
base = "{root}/strategies/easy_attacker.toml"
about = "weaves by what mates say"
[variables]
beat = {{ initial = 0, shared = true }}
turn = {{ initial = false, shared = true }}
high = 0
[[rule]]
when = "time_s >= 0"
set = {{ beat = "beat > 40 ? 0 : beat + 1 + rank / 7 + mates(turn)", turn = "mates(turn) < 1 || beat > 30", high = "mates(beat > 20)" }}
[behaviour.weave]
kind = "constant_heading"
heading_deg = "high * 60 + beat"
weight = 40
"#
    );
    write(dir, "talker.toml", &strategy);
    let game = format!("duration_s = {duration_s}\npatience_s = 2\n{}", two_fleets(3, "talker.toml"));
    write(dir, "talking.toml", &game)
}

#[test]
fn boats_that_talk_play_the_same_game_across_processes_as_in_one() {
    let dir = temporary();
    assert_a_game_each(&talking_game(dir.path(), 200.0), &["1", "2", "3"]);
}

/// A variable of a boat, as its helm tells it.
fn variable(bus: &bus::Bus, name: &GameName, info: &GameInfo, vehicle: &str, variable: &str) -> String {
    let scenario = &info.scenario;
    let key = topic::helm(name, scenario, scenario.vehicle_by_name(vehicle).expect("it is there"));
    let answer = bus.ask(&key, Vec::new(), Duration::from_secs(10)).expect("the hub is there").expect("an answer");
    let report: HelmReport = serde_json::from_slice(&answer).expect("a report");
    report.variables.into_iter().find(|v| v.name == variable).expect("it has it").value
}

#[test]
fn a_killed_mate_does_not_silence_the_others_and_nonsense_hurts_nobody() {
    let dir = temporary();
    let sim = Sim::start(&talking_game(dir.path(), 80_000.0), &[]);
    let mut agents: Vec<Process> =
        ["blue_1", "blue_2", "blue_3", "red_1", "red_2", "red_3"].iter().map(|name| sim.agent(&[name])).collect();
    sim.wait_for_kind("started");
    sim.play_on(5.0);
    agents[1].kill();
    sim.wait_for_event("agent_lost", "blue_2");

    let (bus, name) = (sim.bus(), sim.name());
    let info = sim.info(&bus);
    let (sender, said) = channel();
    let hear = move |bytes: &[u8]| sender.send(codec::decode::<Say>(bytes)).unwrap_or_default();
    let _standing = bus.subscribe(topic::all_say(&name, &info.scenario, TeamId(0)), hear).expect("the hub is there");
    let publisher = bus
        .publisher(topic::say(&name, &info.scenario, TeamId(0), "stranger"), bus::Delivery::Wait)
        .expect("the hub is there");
    for vehicle in [1, 4, 5, 99] {
        let stamp = Stamp { seq: u64::MAX, version: Say::VERSION, ..Stamp::default() };
        let word = Word { vehicle: VehicleId(vehicle), key: 1, value: f64::NAN };
        publisher.send(&Say { stamp, words: vec![word] }).expect("the hub is there");
        publisher.send_raw(b"ahoy".to_vec()).expect("the hub is there");
    }
    let mut speakers = [0, 0, 0];
    while speakers[0] < 20 || speakers[2] < 20 {
        let say = said.recv_timeout(LIMIT).expect("they go on talking");
        // Our own nonsense comes by too.
        let Ok(say) = say.map_err(drop) else { continue };
        say.words.iter().filter(|word| word.value.is_finite()).for_each(|w| speakers[w.vehicle.index()] += 1);
    }
    assert_eq!(speakers[1], 0, "the dead do not talk");
    // What the third hears of the first goes on changing; the second's last message stands.
    let high = || variable(&bus, &name, &info, "blue_3", "high");
    let first = high();
    wait_until("it hears something new", || high() != first);
    let done = sim.stop();
    let lost = |boat: &str| done["outcome"]["counts"]["boats"][boat]["agents_lost"].as_u64();
    assert_eq!([lost("blue_1"), lost("blue_2"), lost("blue_3")], [Some(0), Some(1), Some(0)]);
}
