//! The recording of a payload.

use super::exo2::Measurement;
use crate::record::json;
use messages::payload::PayloadBytes;
use messages::{Message, Stamp};
use primitives::{SimTime, codec};
use recording::Entry;

/// Turns the bytes between a payload and its clients into entries of a recording.
pub struct PayloadEncoder {
    bytes_topic: String,
    values_topic: String,
    /// Pieces of bytes so far.
    pieces: u64,
}

impl PayloadEncoder {
    /// For the payload of this name.
    pub fn new(name: &str) -> PayloadEncoder {
        PayloadEncoder {
            bytes_topic: format!("payload/{name}"),
            values_topic: format!("values/{name}"),
            pieces: 0,
        }
    }

    /// The entry for bytes of this connection at `at` by the gateway's clock; empty if that side
    /// has closed it.
    pub fn bytes(&mut self, at: SimTime, connection: u32, outward: bool, data: &[u8]) -> Entry {
        let stamp = Stamp {
            valid_ns: at,
            seq: self.pieces,
            version: PayloadBytes::VERSION,
        };
        self.pieces += 1;
        let bytes = codec::encode(&PayloadBytes {
            stamp,
            connection,
            outward,
            data: data.to_vec(),
        });
        Entry::Message {
            topic: self.bytes_topic.clone(),
            schema: Some(PayloadBytes::SCHEMA),
            bytes,
            at,
        }
    }

    /// The entry for a measurement.
    pub fn values(&self, at: SimTime, measurement: &Measurement) -> Entry {
        json(&self.values_topic, at, measurement)
    }
}
