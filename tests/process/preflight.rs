//! Before a boat starts: the pre-flight check, arming with and without its report, and dry runs.

use crate::gateway::{Loop, start_gateway};
use crate::support::{stderr, stdout, temporary, wait_until};
use messages::external::OperatorCommand;
use std::time::Duration;

#[test]
fn a_boat_is_armed_with_a_passed_report_and_without_one_in_somebodys_name_alone() {
    let dir = temporary();
    let report = dir.path().join("report.json").display().to_string();
    let mut all = Loop::begin(&[], &["--config", "surveyor"]);
    let refused = || all.try_ask(&OperatorCommand::Arm).and_then(|reply| reply.refused).unwrap_or_default();
    wait_until("only the report is missing", || {
        let why = refused();
        why.contains("a passed pre-flight check") && !why.contains("a fresh order") && !why.contains("navigation")
    });
    // The boat serves one program at a time.
    all.gateway.signal("INT");
    all.gateway.wait();

    let link = format!("tcp://127.0.0.1:{}", all.proxy.port);
    let check =
        ["gateway", "check", "--link", &link, "--vehicle", "blue_one", "--config", "surveyor", "--report", &report];
    let checked = all.sim.squall(&check).output().expect("the program starts");
    assert!(checked.status.success(), "{}{}", stdout(&checked), stderr(&checked));
    let text = std::fs::read_to_string(dir.path().join("report.txt")).expect("it is written as text too");
    assert!(text.contains("geofence") && text.trim_end().ends_with("passed"), "{text}");

    let options = ["--config", "surveyor", "--preflight", &report];
    all.gateway = start_gateway(&all.sim, all.proxy.port, &options);
    wait_until("it is in the game", || all.try_ask(&OperatorCommand::Status).is_some());
    all.arm();
    all.gateway.signal("INT");
    all.gateway.wait();

    // The report of another boat does not count.
    let other = std::fs::read_to_string(&report).expect("it is written").replace("blue_one", "red_one");
    std::fs::write(&report, other).expect("it can be written");
    all.gateway = start_gateway(&all.sim, all.proxy.port, &options);
    let refused = || all.try_ask(&OperatorCommand::Arm).and_then(|reply| reply.refused).unwrap_or_default();
    wait_until("it is of another boat", || refused().contains("red_one"));
    all.gateway.signal("INT");
    all.gateway.wait();

    all.gateway = start_gateway(&all.sim, all.proxy.port, &["--config", "surveyor", "--without-preflight", "Ada"]);
    wait_until("it is in the game", || all.try_ask(&OperatorCommand::Status).is_some());
    all.arm();
}

#[test]
fn a_mavlink_boat_is_armed_with_a_passed_report_too() {
    let dir = temporary();
    let report = dir.path().join("report.json").display().to_string();
    let mut all = Loop::begin(&["--protocol", "mavlink"], &["--config", "blueboat"]);
    let refused = || all.try_ask(&OperatorCommand::Arm).and_then(|reply| reply.refused).unwrap_or_default();
    wait_until("the report is missing", || refused().contains("a passed pre-flight check"));
    all.gateway.signal("INT");
    all.gateway.wait();
    let link = format!("tcp://127.0.0.1:{}", all.proxy.port);
    let check =
        ["gateway", "check", "--link", &link, "--vehicle", "blue_one", "--config", "blueboat", "--report", &report];
    let checked = all.sim.squall(&check).output().expect("the program starts");
    let (printed, said) = (stdout(&checked), stderr(&checked));
    assert!(checked.status.success(), "{printed}{said}");
    assert!(printed.contains("GLOBAL_POSITION_INT") && printed.contains("nothing is missing"), "{printed}");
    assert!(said.contains("nothing but requests for telemetry"), "{said}");
    all.gateway = start_gateway(&all.sim, all.proxy.port, &["--config", "blueboat", "--preflight", &report]);
    wait_until("it is in the game", || all.try_ask(&OperatorCommand::Status).is_some());
    all.arm();
}

#[test]
fn in_a_dry_run_the_gateway_is_armed_and_the_boat_stays_where_it_is() {
    let all = Loop::begin(&[], &["--arm", "--dry-run"]);
    wait_until("it is in the game", || all.try_ask(&OperatorCommand::Status).is_some());
    all.wait_for_state("armed");
    wait_until("it would drive the boat", || {
        let would = all.status().would_send.unwrap_or_default();
        would.starts_with("$PSEAC,T,") && !would.starts_with("$PSEAC,T,0,0,0,")
    });
    for _ in 0..30 {
        std::thread::sleep(Duration::from_millis(100));
        assert!(all.boat().1, "its thrusters turn");
        assert!(all.status().last_sent.starts_with("$PSEAC,L,"), "{}", all.status().last_sent);
    }
}
