//! The interface that all protocols share: commands to boats, and the gateway's end of a link.

use super::report::{Report, Shown};
use crate::config::SwitchWord;
use crate::set_point::SetPoint;
use crate::supervisor::Task;
use messages::external::Mission;
use primitives::SimTime;

/// A command to a boat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Stop, and stay passive.
    Standby,
    /// Standby, and set this switch, if the boat has it.
    Switch(SwitchWord),
    /// Zero thrust, whatever the boat's state; does not make the boat follow set-points.
    Zero,
    /// Follow this set-point.
    SetPoint(SetPoint),
    /// Execute this task with the boat's own controller.
    Task(Task),
    /// The upload of a mission has ended, whether or not it succeeded.
    EndOfUpload,
}

/// The progress of a mission upload.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum UploadStep {
    /// A message was sent.
    Sent,
    /// Nothing is due yet.
    Waiting,
    /// The boat has the whole mission.
    Done,
    /// The boat rejects the mission, for the given reason.
    Failed(String),
}

/// Counters with their names.
pub(crate) fn named<const N: usize>(counts: [(&str, u64); N]) -> Vec<(String, u64)> {
    counts.map(|(name, count)| (name.to_owned(), count)).into()
}

/// The gateway's end of a link, in one protocol.
pub trait Codec {
    /// Starts a new link, discarding the state of the previous one.
    fn begin_link(&mut self);

    /// Reads bytes from the boat, however they are split.
    fn read(&mut self, now: SimTime, bytes: &[u8], take: &mut dyn FnMut(Report));

    /// Appends the bytes of a command.
    fn write(&mut self, now: SimTime, command: Command, out: &mut Vec<u8>);

    /// Appends messages due without a command, such as a heartbeat or replies to the boat.
    fn keep_up(&mut self, now: SimTime, out: &mut Vec<u8>);

    /// Whether boats with this protocol have the modes of [`messages::external::BoatMode`].
    fn has_boat_modes(&self) -> bool;

    /// The report expected from a boat that has received this command.
    fn shown(&self, command: Command) -> Shown;

    /// A command in readable form.
    fn text(&self, command: Command) -> String;

    /// The stop message for any state of the boat: zero thrust, then standby. It does not take over
    /// a boat from others.
    fn stop_message(&self) -> Vec<u8>;

    /// Like [`Codec::stop_message`], regardless of who commands the boat, as far as the protocol
    /// allows.
    fn forced_stop_message(&self) -> Vec<u8>;

    /// Like [`Codec::stop_message`], after an incomplete write by a gateway that has died.
    fn guard_message(&self) -> Vec<u8> {
        self.stop_message()
    }

    /// Begins the upload of a mission.
    ///
    /// # Errors
    /// The fault of the mission.
    fn begin_upload(&mut self, now: SimTime, mission: &Mission) -> Result<(), String>;

    /// Continues the upload of a mission; returns `Done` if there is none.
    fn continue_upload(&mut self, now: SimTime, out: &mut Vec<u8>) -> UploadStep;

    /// Whether a mission is being uploaded.
    fn is_uploading(&self) -> bool;

    /// Discards the upload, if any; returns whether there was one. The boat is not notified.
    fn abort_upload(&mut self) -> bool;

    /// When the next message without a command is due, if any.
    fn due(&self) -> Option<SimTime>;

    /// Two lists: the counters by name, and how often each unknown message was received.
    fn counts(&self) -> [Vec<(String, u64)>; 2];
}
