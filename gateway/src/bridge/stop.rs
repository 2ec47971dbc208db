//! The messages that stop a boat.

use super::Bridge;
use crate::protocol::Command;
use primitives::SimTime;

impl Bridge {
    /// The shutdown message, sent before the link closes: zero thrust, then standby.
    pub fn shutdown_message(&self) -> Vec<u8> {
        let mut message = Vec::new();
        // Use a copy: the guard's message is regenerated repeatedly, and must have no side effects.
        let mut protocol = self.protocol.clone();
        if self.plan.dry_run {
            protocol.write(SimTime::ZERO, Command::Standby, &mut message);
            return message;
        }
        // During a mission upload the boat might read the stop as a mission line.
        if protocol.abort_upload() {
            protocol.write(SimTime::ZERO, Command::EndOfUpload, &mut message);
        }
        message.extend(protocol.stop_message());
        message
    }

    /// The message that the guard sends the boat when the gateway cannot.
    pub fn guard_message(&self) -> Vec<u8> {
        self.protocol.guard_message()
    }

    /// Standby, with the next start-up word if the boat accepts our commands.
    pub(super) fn standby(&mut self) -> Command {
        let listens = self.conditions.control.is_none() && !self.under_way && !self.plan.dry_run;
        // Words such as THR_ON switch outputs of the boat. They are sent once, one at a time, with
        // standby sentences, and only while the boat reports that we are in control, so that none
        // is lost.
        let word = if listens {
            self.words.pop_front()
        } else {
            None
        };
        word.map_or(Command::Standby, Command::Switch)
    }
}
