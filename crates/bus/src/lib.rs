//! Squall over zenoh: the only crate that depends on it.
//!
//! A game is a star: the sim's session is the *hub* (a zenoh router); agents and observers are
//! *leaves* (zenoh clients with one link). By default the hub listens on loopback only and no node
//! scouts: two runs on one machine never meet.
//!
//! Functions of this crate block or call back. Callbacks run on zenoh's threads and must only pass
//! data on.

mod access;
mod admission;
mod bus;
pub mod clock;
mod connections;
mod control;
mod descriptor;
mod error;
pub mod game_search;
mod gateway_port;
mod inbox;
pub mod keys;
mod latest;
mod linger;
mod link_lock;
mod local_registry;
mod net;
mod open_files;
mod parcel;
mod place;
mod query;
mod ros_session;
mod runtime;
mod session;
mod sim_liveness;
pub mod stop;
mod thread;
pub mod token;
mod watched;
mod zenoh_session;
mod zenoh_threads;

pub use bus::{Bus, Delivery, Priority, Publisher};
pub use connections::{Connections, Slot};
pub use control::control;
pub use error::BusError;
pub use game_search::ANSWER;
pub use gateway_port::{GATEWAY_PORT_KEY, ask_gateway};
pub use inbox::{Inbox, InboxSender, inbox};
pub use latest::Latest;
pub use link_lock::{LinkLock, LinkLockError};
pub use local_registry::{
    Entry, GatewayEntry, Registration, gateways as local_gateways, list as local_registry,
    register, register_gateway,
};
pub use net::{DEFAULT_PORT, Net, free_port, is_loopback, is_same_place};
pub use parcel::Parcel;
pub use place::{Place, PlacedSession};
pub use query::Query;
pub use ros_session::{RosPublisher, RosSession};
pub use runtime::{Runtime, System, random_bytes, random_number, replace_runtime};
pub use session::{
    Declaration, Encoding, OnBytes, OnLinkLost, OnQuery, OnToken, PendingQuery, Sender, Session,
    keys_meet,
};
pub use sim_liveness::{Patience, SimState, SimWatch};
pub use thread::{NodeThread, start_thread};
pub use token::{CurrentToken, Token};
pub use watched::Watched;
pub use zenoh_threads::{HUB_RUNTIME, RUNTIME, RUNTIME_VARIABLE, restart_for_keys};
