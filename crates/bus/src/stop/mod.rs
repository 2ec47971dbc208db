//! Stops of boats (E-stop and disarm) over all paths at once.
//!
//! [`StopClient`] is for operators: it sends a stop on all known paths, repeats it, and reports
//! when the boat's own status shows the stop. The paths are the topics of the game, the control
//! ports of gateways over TCP, and datagrams ([`StopRequest`]) to control ports and to the sim
//! ([`HubStopPort`]).

mod client;
mod datagram;
mod datagram_port;
mod gateway_link;
mod hub_port;
mod orders;

pub use client::StopClient;
pub use datagram::{DATAGRAM_MAX, States, StopRequest};
pub use datagram_port::DatagramPort;
pub use hub_port::HubStopPort;
pub use orders::{KnownBoat, StopNews, StopOrders};

use crate::{Bus, BusError, Declaration, Delivery, Priority, Publisher};
use messages::external::{GatewayStatus, OperatorCommand};
use messages::topic::{self, GameName};
use std::collections::BTreeMap;

/// The topics on which the real boats of a game are stopped.
struct StopTopics {
    bus: Bus,
    game: GameName,
    control: Publisher,
    stops: BTreeMap<String, Publisher>,
    _statuses: Vec<Declaration>,
}

impl StopTopics {
    /// Prepares to publish, and calls `take` with every status of the boats' gateways.
    fn open(
        bus: &Bus,
        game: &GameName,
        boats: &[String],
        take: impl Fn(GatewayStatus) + Clone + Send + Sync + 'static,
    ) -> Result<StopTopics, BusError> {
        // Sent before all other messages, and without waiting for lost packets, because stops are
        // repeated.
        let publisher = |key| bus.publisher_with(key, Priority::Urgent, Delivery::Newest);
        let mut stops = BTreeMap::new();
        let mut statuses = Vec::new();
        for boat in boats {
            stops.insert(boat.clone(), publisher(topic::stop(game, boat))?);
            statuses.push(bus.subscribe_status(game, boat, take.clone())?);
        }
        let control = publisher(topic::control(game))?;
        Ok(StopTopics {
            bus: bus.clone(),
            game: game.clone(),
            control,
            stops,
            _statuses: statuses,
        })
    }
}

/// A command that stops boats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopCommand {
    /// Standby, locked until released.
    EStop,
    /// Standby.
    Disarm,
}

impl StopCommand {
    /// The operator command for a gateway.
    pub fn operator_command(self) -> OperatorCommand {
        match self {
            StopCommand::EStop => OperatorCommand::EStop,
            StopCommand::Disarm => OperatorCommand::Disarm,
        }
    }

    /// The stop that a command contains, if any.
    pub fn of(command: &OperatorCommand) -> Option<StopCommand> {
        match command {
            OperatorCommand::EStop => Some(StopCommand::EStop),
            OperatorCommand::Disarm => Some(StopCommand::Disarm),
            _ => None,
        }
    }

    /// Whether a boat's state, as spelled by gateways, shows the stop.
    pub fn is_shown_by(self, state: &str) -> bool {
        state.starts_with("e-stopped")
            || (self == StopCommand::Disarm && state.starts_with("disarmed"))
    }
}
