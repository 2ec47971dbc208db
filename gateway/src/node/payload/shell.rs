//! The gateway services that payloads need.

use super::super::clock::Clock;
use super::super::loop_input::Call;
use bus::InboxSender;
use recording::BulkRecorder;
use std::path::PathBuf;

/// The gateway services that payloads need.
pub(crate) struct Shell {
    /// The recorder, and its file.
    pub(crate) record: Option<(BulkRecorder, PathBuf)>,
    /// Minimum free disk space for recording payload bytes, MiB.
    pub(crate) space_min_mib: u64,
    pub(crate) clock: Clock,
    pub(crate) calls: InboxSender<Call>,
}
