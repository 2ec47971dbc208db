//! A bridge to MOOS: the boats of a game as MOOS communities, and a shoreside.
//!
//! Read [`wire`] first, then [`database`] (a MOOSDB without sockets), then [`boat`] (the variables
//! and orders of one boat). [`bridge`] joins a game.

mod back_seat;
pub mod boat;
pub mod bridge;
pub mod clock;
pub mod community;
pub mod database;
mod game;
pub mod mail;
mod pattern;
mod remote;
mod requests;
mod server;
pub mod share;
mod shoreside;
pub mod wire;
