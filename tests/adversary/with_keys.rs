//! The adversary tests for a game with keys, in a separate test program, because zenoh uses more
//! threads in a process with keys.
#![allow(
    clippy::disallowed_methods,
    clippy::print_stderr,
    reason = "waits for processes by the clock, with a limit; prints measurements"
)]

mod certificate;
mod crowd;
#[allow(dead_code, reason = "shared with the games without keys")]
mod disturbed_game;
#[allow(dead_code, reason = "shared with the games without keys")]
mod intruder;
#[path = "../process/support.rs"]
#[allow(
    dead_code,
    unreachable_pub,
    reason = "shared with the tests of whole games"
)]
mod support;
