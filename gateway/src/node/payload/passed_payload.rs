//! A payload that is passed through, as shared by its threads.

use super::remarks::Remarks;
use super::tap::Taps;
use super::turn::Turn;
use crate::payload::PayloadPort;
use std::sync::Arc;

/// State shared by the threads of a payload.
pub(super) struct Payload {
    pub(super) port: PayloadPort,
    pub(super) taps: Taps,
    pub(super) turn: Turn,
    pub(super) remarks: Arc<Remarks>,
}

impl Payload {
    /// Logs a remark, unless one was logged just now.
    pub(super) fn remark(&self, text: &str) {
        self.remarks.make(text);
    }
}
