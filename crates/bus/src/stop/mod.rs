//! Stops of boats, E-stop and disarm, by every path at once.
//!
//! [`StopClient`] is for operators: it sends a stop on all paths that it knows, repeats it, and says when the boat's own status
//! shows it. The paths are the topics of the game, the control ports of gateways over TCP, and datagrams ([`StopRequest`]) to
//! control ports and to the sim ([`HubStopPort`]).

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

use messages::external::OperatorCommand;

/// What stops boats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopCommand {
    /// Standby, and nothing else until it is released.
    EStop,
    /// Standby.
    Disarm,
}

impl StopCommand {
    /// The command to a gateway.
    #[must_use]
    pub fn operator_command(self) -> OperatorCommand {
        match self {
            StopCommand::EStop => OperatorCommand::EStop,
            StopCommand::Disarm => OperatorCommand::Disarm,
        }
    }

    /// The command that is this stop, if it is one.
    #[must_use]
    pub fn of(command: &OperatorCommand) -> Option<StopCommand> {
        match command {
            OperatorCommand::EStop => Some(StopCommand::EStop),
            OperatorCommand::Disarm => Some(StopCommand::Disarm),
            _ => None,
        }
    }

    /// Whether a boat in this state has obeyed, as gateways spell it.
    #[must_use]
    pub fn is_shown_by(self, state: &str) -> bool {
        state.starts_with("e-stopped") || (self == StopCommand::Disarm && state.starts_with("safed"))
    }
}
