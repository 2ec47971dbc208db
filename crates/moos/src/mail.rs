//! The unread mail of a client.

use crate::wire::{self, Msg};
use std::collections::VecDeque;
use std::sync::Arc;

/// Maximum total length of a client's unread mail, bytes.
pub(crate) const MAIL_MAX: usize = 8 << 20;

/// Unread mail of a client: encoded messages, shared by all recipients.
#[derive(Default)]
pub struct Mail {
    /// The messages, oldest first.
    pub messages: VecDeque<Arc<[u8]>>,
    pub(crate) bytes: usize,
    /// The answer to a clock comparison, which must begin a packet.
    pub timing: Option<Msg>,
    /// Whether the client has left.
    pub is_closed: bool,
}

impl Mail {
    /// Adds a message. Returns the number of old messages dropped to make room for it.
    pub(crate) fn push(&mut self, message: &Arc<[u8]>) -> u64 {
        self.bytes += message.len();
        self.messages.push_back(Arc::clone(message));
        let mut displaced = 0;
        // Drop half of the mail at once, as MOOS clients do with unsent mail, so that this rarely
        // happens.
        if self.bytes > MAIL_MAX {
            while self.bytes > MAIL_MAX / 2 {
                let Some(old) = self.messages.pop_front() else {
                    break;
                };
                self.bytes -= old.len();
                displaced += 1;
            }
        }
        displaced
    }

    /// Takes as much unread mail as fits in one packet, which begins with `first`. `None` if the
    /// packet would be empty.
    pub fn take_packet(&mut self, first: Option<&Msg>) -> Option<Vec<u8>> {
        let mut encoded = Vec::new();
        first
            .into_iter()
            .for_each(|msg| wire::encode(msg, &mut encoded));
        let mut length = encoded.len();
        let fits = |message: &&Arc<[u8]>| {
            length += message.len();
            length <= wire::PACKET_MAX / 2
        };
        let count = self.messages.iter().take_while(fits).count();
        let taken: Vec<Arc<[u8]>> = self.messages.drain(..count).collect();
        self.bytes -= taken.iter().map(|message| message.len()).sum::<usize>();
        let first = first.map(|_| encoded.as_slice());
        let is_empty = first.is_none() && taken.is_empty();
        (!is_empty).then(|| {
            wire::packet(
                first
                    .into_iter()
                    .chain(taken.iter().map(|message| &**message)),
            )
        })
    }
}
