//! A simulated network in virtual time, for tests: it runs unmodified node code deterministically,
//! faults included.
//!
//! Nodes are threads of this process that block only through `bus`. Exactly one of them runs at a
//! time; when all are waiting, virtual time jumps to the next event. One seed determines which
//! ready thread runs, how long messages take and which are lost: the same seed and nodes give the
//! same trace. Tests start with [`SimulatedNetwork`]. Inside a node, [`bus::Bus`], [`bus::clock`]
//! and everything that waits use the simulation, because it replaces the process's
//! [`bus::Runtime`].

mod conditions;
mod declared;
mod event;
mod link;
mod packet;
mod routing;
mod run;
mod runtime;
mod scheduler;
mod session;
mod state;
mod verdict;

pub use conditions::{Conditions, Damage, Fault};
pub use run::{Run, SimulatedNetwork};
pub use verdict::{NodeEnd, Published, Verdict};
