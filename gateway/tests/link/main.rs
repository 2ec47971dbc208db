//! Tests links with this machine's real sockets and terminals.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests may also panic on the impossible"
)]
#![allow(
    clippy::disallowed_methods,
    reason = "a link's promises are given in milliseconds of real time"
)]

mod address;
mod event_log;
mod pty;
mod serial;
mod shutdown;
mod tcp_client;
mod tcp_server;
mod udp;
