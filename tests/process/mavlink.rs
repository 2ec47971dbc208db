//! A MAVLink boat with real processes and real sockets: it is driven and stopped like a Surveyor.

use crate::gateway::{Loop, start_gateway};
use crate::support::{result_of, run, stdout, temporary, wait_until};
use messages::external::OperatorCommand;
use std::time::Duration;

const CONFIG: [&str; 4] = ["--config", "scenarios/gateways/blueboat.toml", "--without-preflight", "Ada"];

fn under_way() -> Loop {
    Loop::of(&["--protocol", "mavlink"], &CONFIG)
}

#[test]
fn stale_orders_a_killed_gateway_and_an_e_stop_stop_a_mavlink_boat() {
    let mut all = under_way();
    all.agents.kill();
    all.stops_within(Duration::from_secs(1));
    all.wait_for_state("no fresh order");
    all.agents = all.sim.agent(&["blue_one", "red_one"]);
    all.sim.wait_for_event("agent_back", "blue_one");
    all.arm();
    // The guard survives a killed gateway; without it the boat would drop its set-point only after
    // three seconds.
    all.gateway.kill();
    all.stops_within(Duration::from_millis(500));
    all.gateway = start_gateway(&all.sim, all.proxy.port, &CONFIG);
    wait_until("it is in the game", || all.try_ask(&OperatorCommand::Status).is_some());
    all.wait_for_state("safed");
    all.arm();
    all.e_stop_and_release();
    all.arm();
    all.proxy.cut();
    all.stops_within(Duration::from_millis(300));
    all.wait_for_state("the link is lost");
}

#[test]
fn a_suspended_gateway_of_a_mavlink_boat_is_replaced_by_its_guard() {
    let all = under_way();
    all.gateway.signal("STOP");
    all.stops_within(Duration::from_millis(500));
    all.gateway.signal("CONT");
    wait_until("it says what happened", || !all.status().failsafes.is_empty());
    std::thread::sleep(Duration::from_secs(1));
    assert!(all.boat().1, "it does not go on by itself");
    all.arm();
}

#[test]
fn a_game_through_gateways_by_mavlink_is_played_and_replayed() {
    let dir = temporary();
    let (game, gateways) = ("scenarios/games/mixed_2v2.toml", "scenarios/gateways/emulated_mavlink.toml");
    let records = dir.path().display().to_string();
    let result = result_of(&[game, "--emulate", "--pace", "10x", "--gateway", gateways, "--record-gateways", &records]);
    let teams = result["counts"]["teams"].as_object().expect("teams");
    let grabs: u64 = teams.values().map(|counts| counts["grabs"].as_u64().expect("a count")).sum();
    assert!(grabs > 0, "{teams:?}");
    let events = result["events"].as_array().expect("events");
    for bad in ["nav_lost", "agent_lost", "quarantined"] {
        assert!(!events.iter().any(|event| event["event"] == bad), "{bad}: {events:?}");
    }
    for name in ["blue_one", "red_one"] {
        let file = dir.path().join(format!("{name}.mcap")).display().to_string();
        let output = run(&["gateway", "replay", &file]);
        let printed = stdout(&output);
        assert!(output.status.success() && printed.contains("the recording, byte for byte"), "{printed}");
    }
}
