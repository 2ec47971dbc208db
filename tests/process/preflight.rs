//! Before a boat starts: the pre-flight check, arming with and without its report, and dry runs.

use crate::gateway::{Loop, start_gateway};
use crate::support::{stderr, stdout, temporary, wait_until};
use messages::external::OperatorCommand;
use std::time::Duration;

/// Why the boat cannot be armed now.
fn refusal(all: &Loop) -> String {
    all.try_ask(&OperatorCommand::Arm).and_then(|reply| reply.refused).unwrap_or_default()
}

/// Stops the gateway: the boat serves one program at a time.
fn stop_gateway(all: &mut Loop) {
    all.gateway.signal("INT");
    all.gateway.wait();
}

/// Checks the boat in the gateway's place; returns what is printed, and all that is said besides.
fn check(all: &mut Loop, config: &str, report: &str) -> (String, String) {
    stop_gateway(all);
    let link = format!("tcp://127.0.0.1:{}", all.proxy.port);
    let args = ["gateway", "check", "--link", &link, "--vehicle", "blue_one", "--config", config, "--report", report];
    let checked = all.sim.run(&args);
    let (printed, said) = (stdout(&checked), stderr(&checked));
    assert!(checked.status.success(), "{printed}{said}");
    (printed, said)
}

/// Starts a gateway with these options.
fn begin_again(all: &mut Loop, options: &[&str]) {
    all.gateway = start_gateway(&all.sim, all.proxy.port, options);
    wait_until("it is in the game", || all.try_ask(&OperatorCommand::Status).is_some());
}

#[test]
fn a_boat_is_armed_with_a_passed_report_and_without_one_in_somebodys_name_alone() {
    let dir = temporary();
    let report = dir.path().join("report.json").display().to_string();
    let mut all = Loop::begin(&[], &["--config", "surveyor"]);
    wait_until("only the report is missing", || {
        let why = refusal(&all);
        why.contains("a passed pre-flight check") && !why.contains("a fresh order") && !why.contains("navigation")
    });
    check(&mut all, "surveyor", &report);
    let text = std::fs::read_to_string(dir.path().join("report.txt")).expect("it is written as text too");
    assert!(text.contains("geofence") && text.trim_end().ends_with("passed"), "{text}");

    let options = ["--config", "surveyor", "--preflight", &report];
    begin_again(&mut all, &options);
    all.arm();
    stop_gateway(&mut all);

    // The report of another boat does not count.
    let other = std::fs::read_to_string(&report).expect("it is written").replace("blue_one", "red_one");
    std::fs::write(&report, other).expect("it can be written");
    begin_again(&mut all, &options);
    wait_until("it is of another boat", || refusal(&all).contains("red_one"));
    stop_gateway(&mut all);

    begin_again(&mut all, &["--config", "surveyor", "--without-preflight", "Ada"]);
    all.arm();
}

#[test]
fn a_mavlink_boat_is_armed_with_a_passed_report_too() {
    let dir = temporary();
    let report = dir.path().join("report.json").display().to_string();
    let mut all = Loop::begin(&["--protocol", "mavlink"], &["--config", "blueboat"]);
    wait_until("the report is missing", || refusal(&all).contains("a passed pre-flight check"));
    let (printed, said) = check(&mut all, "blueboat", &report);
    assert!(printed.contains("GLOBAL_POSITION_INT") && printed.contains("nothing is missing"), "{printed}");
    assert!(said.contains("nothing but requests for telemetry"), "{said}");
    begin_again(&mut all, &["--config", "blueboat", "--preflight", &report]);
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
