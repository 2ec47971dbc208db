//! Attacks by someone who reaches a game's port and ignores our rules, using zenoh's own API.
#![allow(
    clippy::disallowed_methods,
    clippy::print_stderr,
    reason = "waits for processes by the clock, with a limit; prints measurements"
)]

mod another_machine;
mod attack;
mod boat;
mod control_port;
mod crowd;
mod disturbed_game;
mod fake_sim;
mod intruder;
mod network;
mod operate;
#[path = "../process/support.rs"]
#[allow(
    dead_code,
    unreachable_pub,
    reason = "shared with the tests of whole games"
)]
mod support;
mod take_over;
mod token;
#[path = "../process/two_hosts.rs"]
#[allow(dead_code, reason = "shared with the tests of whole games")]
mod two_hosts;
