//! Links against real sockets and terminals of this machine.

#![allow(clippy::unwrap_used, reason = "helpers of tests too may stop at what cannot be")]
#![allow(clippy::disallowed_methods, reason = "what a link promises is told in milliseconds of the wall clock")]

mod address;
mod ears;
mod last_words;
mod latency;
mod pty;
mod serial;
mod tcp_client;
mod tcp_server;
mod udp;
