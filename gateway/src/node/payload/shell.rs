//! What payloads need of the gateway.

use super::super::clock::Clock;
use super::super::loop_input::Call;
use bus::InboxSender;
use recording::BulkRecorder;
use std::path::PathBuf;

/// What payloads need of the gateway.
pub(crate) struct Shell {
    /// The recorder, and its file.
    pub(crate) record: Option<(BulkRecorder, PathBuf)>,
    /// What the disk must have free for bytes of payloads to be recorded, MiB.
    pub(crate) space_min_mib: u64,
    pub(crate) clock: Clock,
    pub(crate) calls: InboxSender<Call>,
}
