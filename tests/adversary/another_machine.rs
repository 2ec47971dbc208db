//! A stranger on the network on which a game listens.

use crate::attack::ATTACKS;
use crate::disturbed_game::{DisturbedGame, SPEED};
use crate::intruder::{Intruder, Target};
use crate::support::{FOUR, Process, token, wait_until};
use crate::two_hosts::{ENDPOINT, GAME, Hosts};
use bus::{Bus, Net};
use messages::Control;
use messages::topic::GameName;
use std::time::{Duration, Instant};

/// The variable that marks a process as started on the other machine.
const THERE: &str = "SQUALL_TEST_OTHER_MACHINE";

/// Runs another of these tests in a process on the second machine.
fn on_the_other(hosts: &Hosts, test: &str) -> Process {
    let mut command = hosts.command(1, std::env::current_exe().expect("this is a process"));
    command
        .args(["--exact", "--ignored"])
        .arg(format!("another_machine::{test}"))
        .env(THERE, "");
    Process::start(command)
}

/// The game, in a process on the second machine; `None` in any other process.
fn game_there() -> Option<Target> {
    if std::env::var_os(THERE).is_none() {
        eprintln!("skipped: a process on another machine, which a test starts there");
        return None;
    }
    Some(Target {
        endpoint: ENDPOINT.to_owned(),
        game: GameName::new(GAME).expect("a name"),
    })
}

#[test]
fn connections_whose_other_end_has_vanished_keep_nobody_out() {
    const COUNT: usize = 30;
    let Some(hosts) = Hosts::connect() else {
        return;
    };
    let sim = hosts.sim("patient", &["--join-s", "600"]);
    let descriptors = || {
        std::fs::read_dir(format!("/proc/{}/fd", sim.process.0.id()))
            .expect("it runs")
            .count()
    };
    let before = descriptors();
    let connect = format!(
        "for i in $(seq {COUNT}); do exec {{fd}}<>/dev/tcp/10.77.0.1/7447; done; sleep 600"
    );
    let mut command = hosts.command(1, "bash");
    command.args(["-c", &connect]);
    let _vanished = Process::start(command);
    wait_until("it is connected", || descriptors() >= before + COUNT);
    hosts.cable("down");
    // Vanished connections are closed one by one while agents join.
    std::thread::sleep(Duration::from_secs(6));
    let start = Instant::now();
    let _agents = hosts.agent(0, &FOUR);
    sim.wait_for_kind("started");
    assert!(
        start.elapsed() < Duration::from_secs(20),
        "{:?}",
        start.elapsed()
    );
    sim.stop();
}

#[test]
fn a_stranger_on_another_machine_changes_no_game_and_hears_no_orders() {
    let Some(hosts) = Hosts::connect() else {
        return;
    };
    let sim = hosts.sim("pav01_600s", &["--speed", SPEED]);
    let agents = vec![hosts.agent(0, &FOUR[..2]), hosts.agent(1, &FOUR[2..])];
    sim.wait_for_kind("started");
    let mut game = DisturbedGame {
        sim,
        agents,
        operator: None,
    };
    let mut stranger = on_the_other(&hosts, "what_the_stranger_does");
    while stranger.0.try_wait().expect("it can be asked").is_none() {
        game.check();
    }
    assert!(
        stranger.wait().success(),
        "the stranger was allowed to do something"
    );
    assert!(
        on_the_other(&hosts, "what_the_operator_does")
            .wait()
            .success()
    );
    game.ends_as_if_undisturbed();
}

#[test]
#[ignore = "a process on another machine, which the test above starts there"]
fn what_the_stranger_does() {
    let Some(target) = game_there() else { return };
    let intruder = Intruder::of(&target);
    let secret = ["**", "order/*", "order/**", "nav/*"].map(|topic| intruder.listen(topic));
    let open = intruder.listen("frame");
    for (_, attack) in ATTACKS {
        drop(attack(&target));
    }
    std::thread::sleep(Duration::from_millis(500));
    assert!(open.keys().len() > 20, "what everyone may hear is heard");
    let is_open = |key: &String| *key == target.topic("frame");
    assert_eq!(
        secret
            .iter()
            .flat_map(|heard| heard.keys())
            .find(|key| !is_open(key)),
        None
    );
}

#[test]
#[ignore = "a process on another machine, which the test above starts there"]
fn what_the_operator_does() {
    let Some(Target { endpoint, game }) = game_there() else {
        return;
    };
    let net = Net {
        connect: vec![endpoint],
        token: Some(token()),
        ..Net::default()
    };
    let operator = Bus::leaf(&net).expect("the port is open");
    bus::control(&operator, &game, Control::Speed(None)).expect("it may");
}
