//! What an operator's command asks of the supervisor.

use crate::supervisor::{OperatorRequest, Scope, Task};
use game::external::OperatorCommand;

/// The request in a command; `None` where it asks nothing of the supervisor, or needs an upload first.
pub(super) fn request_from(command: &OperatorCommand) -> Option<OperatorRequest> {
    match command {
        OperatorCommand::Arm => Some(OperatorRequest::Arm),
        OperatorCommand::Disarm => Some(OperatorRequest::Disarm),
        OperatorCommand::EStop => Some(OperatorRequest::EStop(Scope::Boat)),
        OperatorCommand::Release => Some(OperatorRequest::Release(Scope::Boat)),
        OperatorCommand::StationKeep => Some(OperatorRequest::Delegate(Task::StationKeep)),
        OperatorCommand::GoToErp => Some(OperatorRequest::Delegate(Task::GoToErp)),
        OperatorCommand::Status | OperatorCommand::Mission(_) => None,
    }
}
