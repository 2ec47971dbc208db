//! The program as users run it: whole games across processes, with failures of single nodes.
#![allow(
    clippy::disallowed_methods,
    clippy::print_stderr,
    reason = "waits for processes by the clock, with a limit; reports skipped tests"
)]

mod boat_alone;
mod console;
mod ending;
mod external;
mod faults;
mod games;
mod gateway;
mod helm;
mod hosts;
mod keys;
mod mavlink;
mod network;
mod place;
mod policy;
mod preflight;
mod proxy;
mod recording;
mod refusals;
mod shore;
mod sitl;
mod support;
mod talk;
mod two_hosts;
