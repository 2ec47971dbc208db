//! Translates an operator's command into a request to the supervisor.

use super::Bridge;
use crate::supervisor::{OperatorRequest, Scope, Task};
use messages::external::{BoatMode, OperatorCommand};

/// The supervisor request for a command; `None` if the command has none, or if its request depends
/// on the boat.
pub(super) fn request_from(command: &OperatorCommand) -> Option<OperatorRequest> {
    match command {
        OperatorCommand::Arm => Some(OperatorRequest::Arm),
        OperatorCommand::Disarm => Some(OperatorRequest::Disarm),
        OperatorCommand::EStop => Some(OperatorRequest::EStop(Scope::Boat)),
        OperatorCommand::Release => Some(OperatorRequest::Release(Scope::Boat)),
        OperatorCommand::StationKeep => Some(OperatorRequest::Delegate(Task::StationKeep)),
        OperatorCommand::GoToErp => Some(OperatorRequest::Delegate(Task::GoToErp)),
        // A mission must be uploaded first. A mode has numbers that must be checked against the
        // limits in the gateway file.
        OperatorCommand::Status | OperatorCommand::Mission(_) | OperatorCommand::Mode(_) => None,
    }
}

impl Bridge {
    /// The request for a different mode of the boat's own controller, or the reason for its
    /// refusal.
    pub(super) fn request_mode(&self, mode: BoatMode) -> Result<OperatorRequest, String> {
        let limit_pct = self.plan.gateway.limits.thrust_max_pct;
        match mode {
            _ if !self.protocol.has_boat_modes() => {
                Err("a boat that speaks MAVLink has no such mode".to_owned())
            }
            BoatMode::Heading { heading_deg, .. } if !(0.0..=360.0).contains(&heading_deg) => Err(
                format!("the heading is {heading_deg}, expected 0 to 360 degrees"),
            ),
            BoatMode::Heading { thrust_pct, .. } if !(0.0..=limit_pct).contains(&thrust_pct) => {
                Err(format!(
                    "the thrust is {thrust_pct}, expected 0 to {limit_pct} % (limits.thrust_max_pct)"
                ))
            }
            mode => Ok(OperatorRequest::Delegate(Task::Mode(mode))),
        }
    }
}
