//! Who is shown everything that happens at a node, and writes it down if it likes.

use crate::contest::Contest;
use game::SimTime;
use game::run_state::RecordingState;

/// Somebody who is shown everything. NoRecorder waits for it: it must be quick.
pub trait Recorder {
    /// A decision: the contest before it, with what was given since the one before ([`Contest::take_inputs`]). The pictures
    /// that were shown are heard.
    fn turn(&mut self, contest: &mut Contest);
    /// Something that went over the network.
    fn heard(&mut self, heard: RecordedMessage);
    /// How what it writes stands, if it writes.
    fn state(&self) -> Option<RecordingState>;
}

/// Something that went over the network.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedMessage {
    /// The topic, without the game's name.
    pub topic: String,
    /// The schema, for CDR; none for JSON.
    pub schema: Option<&'static str>,
    /// The message.
    pub bytes: Vec<u8>,
    /// Simulated time at which it came.
    pub at: SimTime,
}

/// A recorder that does not look.
pub struct NoRecorder;

impl Recorder for NoRecorder {
    fn turn(&mut self, _: &mut Contest) {}
    fn heard(&mut self, _: RecordedMessage) {}
    fn state(&self) -> Option<RecordingState> {
        None
    }
}
