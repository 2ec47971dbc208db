//! The boat's protocol as a command line argument.

use clap::ValueEnum;
use gateway::config::BoatProtocol;

/// A boat's protocol.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum ProtocolArg {
    /// NMEA sentences of a SeaRobotics Surveyor
    Surveyor,
    /// MAVLink as used by ArduPilot
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
