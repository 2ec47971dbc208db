//! What a boat is sent that is to stand still.

use super::Bridge;
use crate::protocol::Command;
use crate::supervisor::Control;
use primitives::SimTime;

impl Bridge {
    /// The shutdown message, sent before the link closes: thrust zero, then standby.
    #[must_use]
    pub fn shutdown_message(&self) -> Vec<u8> {
        let mut message = Vec::new();
        // A copy: what the shutdown would send is asked for again and again, for the guard, and
        // must change nothing.
        let mut protocol = self.protocol.clone();
        if self.plan.dry_run {
            protocol.write(SimTime::ZERO, Command::Standby, &mut message);
            return message;
        }
        // A boat in the middle of a download might take the stop for one of its lines.
        if protocol.abort_upload() {
            protocol.write(SimTime::ZERO, Command::EndOfUpload, &mut message);
        }
        message.extend(protocol.stop_message());
        message
    }

    /// What its guard sends the boat when the gateway cannot.
    #[must_use]
    pub fn guard_message(&self) -> Vec<u8> {
        self.protocol.guard_message()
    }

    /// Standby, with the next start-up word where the boat listens to us.
    pub(super) fn standby(&mut self) -> Command {
        let listens = self.conditions.control == Control::Granted && !self.under_way && !self.plan.dry_run;
        // Words such as THR_ON switch outputs of the boat and are sent once. They ride on
        // standby sentences, one at a time, and only when the boat reports us in control, so
        // that none is lost on a boat that ignores us.
        let word = if listens { self.words.pop_front() } else { None };
        word.map_or(Command::Standby, Command::Switch)
    }
}
