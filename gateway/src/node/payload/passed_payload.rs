//! A payload that is passed through, as its threads share it.

use super::remarks::Remarks;
use super::tap::Taps;
use super::turn::Turn;
use crate::payload::PayloadPort;
use std::sync::Arc;

/// What the threads of a payload share.
pub(super) struct Payload {
    pub(super) port: PayloadPort,
    pub(super) taps: Taps,
    pub(super) turn: Turn,
    pub(super) remarks: Arc<Remarks>,
}

impl Payload {
    /// Has something logged, unless something was just now.
    pub(super) fn remark(&self, text: &str) {
        self.remarks.make(text);
    }
}
