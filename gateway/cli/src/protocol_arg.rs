//! The boat's protocol as a command line argument.

use clap::ValueEnum;
use gateway::config::BoatProtocol;

/// What a boat speaks.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum ProtocolArg {
    /// The sentences of a SeaRobotics Surveyor
    Surveyor,
    /// MAVLink, as ArduPilot's boats speak it
    Mavlink,
}

impl ProtocolArg {
    /// The protocol that this argument selects.
    pub fn protocol(self) -> BoatProtocol {
        match self {
            ProtocolArg::Surveyor => BoatProtocol::Surveyor,
            ProtocolArg::Mavlink => BoatProtocol::Mavlink,
        }
    }
}
