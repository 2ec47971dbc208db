//! Tests links with real sockets and terminals of this machine.

#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests too may stop at what cannot be"
)]
#![allow(
    clippy::disallowed_methods,
    reason = "a link's promises are in milliseconds of real time"
)]

mod address;
mod event_log;
mod pty;
mod serial;
mod shutdown;
mod tcp_client;
mod tcp_server;
mod udp;
