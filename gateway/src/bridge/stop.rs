//! What a boat is sent that is to stand still.

use super::{Bridge, command_encoder};
use crate::nmea::Command;
use crate::set_point::SetPoint;
use crate::supervisor::Control;
use game::gateway::SwitchWord;

/// What stops a boat, whatever it does: thrust zero, then standby.
#[must_use]
pub fn stop_message() -> Vec<u8> {
    command_encoder::bytes_of(&[command_encoder::of_set_point(SetPoint::ZERO), command_encoder::standby()])
}

impl Bridge {
    /// The shutdown message, sent before the link closes: thrust zero, then standby.
    #[must_use]
    pub fn shutdown_message(&self) -> Vec<u8> {
        let mut message = Vec::new();
        if self.plan.dry_run {
            return command_encoder::bytes_of(&[command_encoder::standby()]);
        }
        if self.upload.is_some() {
            message.extend(command_encoder::bytes_of(&[command_encoder::end_of_download()]));
        }
        message.extend(stop_message());
        message
    }

    /// Standby, with the next start-up word where the boat listens to us.
    pub(super) fn standby(&mut self) -> Command {
        let listens = self.conditions.control == Control::Granted && !self.under_way && !self.plan.dry_run;
        let word = if listens { self.words.pop_front() } else { None };
        command_encoder::standby_with(word.map_or("", SwitchWord::text))
    }
}
