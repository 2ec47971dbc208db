//! Team messages between processes are received exactly one decision later.

use crate::support::{LIMIT, Process, Sim, assert_a_game_each, helm, own, wait_until};
use messages::helm::HelmReport;
use messages::{Message, Say, Stamp, Word, topic};
use primitives::{TeamId, VehicleId, codec};
use std::sync::mpsc::channel;

#[test]
fn boats_that_talk_play_the_same_game_across_processes_as_in_one() {
    assert_a_game_each(&own("talking_200s"), &["1", "2", "3"]);
}

/// A variable of a boat, as reported by its helm.
fn variable(report: HelmReport, variable: &str) -> String {
    report
        .variables
        .into_iter()
        .find(|v| v.name == variable)
        .expect("it has it")
        .value
}

#[test]
fn a_killed_teammate_does_not_silence_the_others_and_nonsense_is_harmless() {
    let sim = Sim::start("talking", &[]);
    let mut agents: Vec<Process> = ["blue_1", "blue_2", "blue_3", "red_1", "red_2", "red_3"]
        .iter()
        .map(|name| sim.agent(&[name]))
        .collect();
    sim.wait_for_kind("started");
    sim.play_on(5.0);
    agents[1].kill();
    sim.wait_for_event("agent_lost", "blue_2");

    let (bus, name, scenario) = sim.session();
    let (sender, said) = channel();
    let hear = move |bytes: &[u8]| sender.send(codec::decode::<Say>(bytes)).unwrap_or_default();
    let _standing = bus
        .subscribe(topic::say(&name, &scenario, TeamId(0)), hear)
        .expect("the hub is up");
    let publisher = bus
        .publisher(
            topic::say(&name, &scenario, TeamId(0)),
            bus::Priority::Normal,
        )
        .expect("the hub is up");
    for vehicle in [1, 4, 5, 99] {
        let stamp = Stamp {
            seq: u64::MAX,
            version: Say::VERSION,
            ..Stamp::default()
        };
        let word = Word {
            vehicle: VehicleId(vehicle),
            key: 1,
            value: f64::NAN,
        };
        publisher
            .send(&Say {
                stamp,
                words: vec![word],
            })
            .expect("the hub is up");
        publisher.send_raw(b"ahoy".to_vec()).expect("the hub is up");
    }
    let mut speakers = [0, 0, 0];
    while speakers[0] < 20 || speakers[2] < 20 {
        let say = said.recv_timeout(LIMIT).expect("they keep talking");
        // Skip our own invalid messages.
        let Ok(say) = say.map_err(drop) else { continue };
        say.words
            .iter()
            .filter(|word| word.value.is_finite())
            .for_each(|w| speakers[w.vehicle.index()] += 1);
    }
    assert_eq!(speakers[1], 0, "the dead do not talk");
    // The third boat's view of the first keeps changing; the second's last message stays.
    let high = || variable(helm(&bus, (&name, &scenario), "blue_3", b""), "high");
    let first = high();
    wait_until("it hears something new", || high() != first);
    let done = sim.stop();
    let lost = |boat: &str| done["outcome"]["counts"]["boats"][boat]["agents_lost"].as_u64();
    assert_eq!(
        [lost("blue_1"), lost("blue_2"), lost("blue_3")],
        [Some(0), Some(1), Some(0)]
    );
}
