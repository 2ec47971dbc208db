//! Before a boat starts: the pre-flight check, arming with and without its report, and dry runs.

use crate::gateway::Loop;
use crate::support::{stderr, stdout, temporary, wait_until};
use messages::external::OperatorCommand;
use std::path::Path;
use std::time::Duration;

/// The reason why the boat is not armed; empty if it is armed or there is no answer.
fn refused(all: &Loop) -> String {
    all.try_ask(&OperatorCommand::Arm)
        .and_then(|reply| reply.refused)
        .unwrap_or_default()
}

/// Runs the check, which passes, with this gateway file in place of the gateway. Returns its output
/// and its errors.
fn check(all: &mut Loop, config: &str, report: &Path) -> [String; 2] {
    all.end_gateway();
    let link = format!("tcp://127.0.0.1:{}", all.proxy.port);
    let report = report.display().to_string();
    let check = [
        "gateway",
        "check",
        "--link",
        &link,
        "--vehicle",
        "blue_one",
        "--config",
        config,
        "--report",
        &report,
    ];
    let checked = all.sim.run(&check);
    let said = [stdout(&checked), stderr(&checked)];
    assert!(checked.status.success(), "{}", said.concat());
    said
}

#[test]
fn a_boat_is_armed_with_a_passed_report_and_without_one_in_somebodys_name_alone() {
    let dir = temporary();
    let report = dir.path().join("report.json");
    let mut all = Loop::begin(&[], &["--config", "surveyor"]);
    wait_until("only the report is missing", || {
        let why = refused(&all);
        why.contains("a passed pre-flight check")
            && !why.contains("a fresh order")
            && !why.contains("navigation")
    });
    check(&mut all, "surveyor", &report);
    let text =
        std::fs::read_to_string(report.with_extension("txt")).expect("it is written as text too");
    assert!(
        text.contains("geofence") && text.trim_end().ends_with("passed"),
        "{text}"
    );

    let options = [
        "--config",
        "surveyor",
        "--preflight",
        &report.display().to_string(),
    ];
    all.restart_gateway(&options);
    all.arm();
    all.end_gateway();

    // The report of a different boat does not count.
    let other = std::fs::read_to_string(&report)
        .expect("it is written")
        .replace("blue_one", "red_one");
    std::fs::write(&report, other).expect("it can be written");
    all.restart_gateway(&options);
    wait_until("it is of another boat", || {
        refused(&all).contains("red_one")
    });
    all.end_gateway();

    all.restart_gateway(&["--config", "surveyor", "--without-preflight", "Ada"]);
    all.arm();
}

#[test]
fn a_mavlink_boat_is_armed_with_a_passed_report_too() {
    let dir = temporary();
    let report = dir.path().join("report.json");
    let mut all = Loop::begin(&["--protocol", "mavlink"], &["--config", "blueboat"]);
    wait_until("the report is missing", || {
        refused(&all).contains("a passed pre-flight check")
    });
    let [printed, said] = check(&mut all, "blueboat", &report);
    assert!(
        printed.contains("GLOBAL_POSITION_INT") && printed.contains("nothing is missing"),
        "{printed}"
    );
    assert!(said.contains("only requests for telemetry"), "{said}");
    all.restart_gateway(&[
        "--config",
        "blueboat",
        "--preflight",
        &report.display().to_string(),
    ]);
    all.arm();
}

#[test]
fn in_a_dry_run_the_gateway_is_armed_and_the_boat_stays_where_it_is() {
    let all = Loop::begin(&[], &["--arm", "--dry-run"]);
    all.await_gateway();
    all.wait_for_state("armed");
    wait_until("it would drive the boat", || {
        let would = all.status().would_send.unwrap_or_default();
        would.starts_with("$PSEAC,T,") && !would.starts_with("$PSEAC,T,0,0,0,")
    });
    for _ in 0..30 {
        std::thread::sleep(Duration::from_millis(100));
        assert!(all.boat().1, "its thrusters turn");
        assert!(
            all.status().last_sent.starts_with("$PSEAC,L,"),
            "{}",
            all.status().last_sent
        );
    }
}
