//! A MAVLink boat with real processes and real sockets: it is driven and stopped like a Surveyor.

use crate::gateway::{Loop, count, emulated_game};
use std::time::Duration;

const CONFIG: [&str; 4] = [
    "--config",
    "scenarios/gateways/blueboat.toml",
    "--without-preflight",
    "Ada",
];

fn under_way() -> Loop {
    Loop::of(&["--protocol", "mavlink"], &CONFIG)
}

#[test]
fn stale_orders_a_killed_gateway_and_an_e_stop_stop_a_mavlink_boat() {
    let mut all = under_way();
    all.outlive_an_agent();
    // The guard survives a killed gateway; without it the boat would drop its set-point only after
    // three seconds.
    all.outlive_a_gateway(&CONFIG);
    all.e_stop_and_release();
    all.arm();
    all.proxy.cut();
    all.stops_within(Duration::from_millis(300));
    all.wait_for_state("the link is lost");
}

#[test]
fn a_suspended_gateway_of_a_mavlink_boat_is_replaced_by_its_guard() {
    under_way().suspend_the_gateway();
}

#[test]
fn a_game_through_gateways_by_mavlink_is_played_and_replayed() {
    let result = emulated_game("scenarios/gateways/emulated_mavlink.toml");
    assert!(count(&result, "grabs") > 0, "{}", result["counts"]);
}
