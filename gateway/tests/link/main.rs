//! Tests links with this machine's real sockets and terminals.

#![allow(
    clippy::unwrap_used,
    reason = "test helpers may panic on impossible cases"
)]
#![allow(
    clippy::disallowed_methods,
    reason = "a link guarantees times in milliseconds of real time"
)]

mod address;
mod event_log;
mod pty;
mod serial;
mod shutdown;
mod tcp_client;
mod tcp_server;
mod udp;
