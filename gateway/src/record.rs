//! The recording of a gateway: all bytes both ways, all other inputs of its core, and events.
//!
//! The crate [`recording`] lists the topics. A step of the core is an input followed by its
//! results.

use crate::bridge::{Event, Input, Output, Plan};
use messages::external::LinkBytes;
use messages::{Message, Stamp};
use primitives::{SimTime, VehicleId, codec};
use recording::{Entry, Facts, Kind, Opening};
use serde::{Deserialize, Serialize};

/// The JSON topics. The topic of bytes contains the boat's name.
pub(crate) const INPUT: &str = "input";
pub(crate) const EVENT: &str = "event";

/// The topic of the bytes of a boat's link.
pub(crate) fn link_topic(boat: &str) -> String {
    format!("link/{boat}")
}

/// An input other than bytes; recordings store JSON as objects.
#[derive(Serialize, Deserialize)]
pub(crate) struct RecordedInput {
    pub(crate) input: Input,
}

/// An event.
#[derive(Serialize, Deserialize)]
pub(crate) struct RecordedEvent {
    pub(crate) event: Event,
}

/// The opening of a recording: the gateway's plan, the UTC time of its start (ns since 1970), and
/// the commit from which the program was built.
pub fn opening(plan: &Plan, began_utc_ns: u64, commit: &str) -> Opening {
    let plan_json = serde_json::to_string(plan).expect("a plan is JSON");
    let facts = [
        ("commit", commit.to_owned()),
        ("vehicle", plan.vehicle.clone()),
        ("plan", plan_json),
    ];
    let facts: Facts = facts.map(|(key, value)| (key.to_owned(), value)).into();
    Opening {
        kind: Kind::Gateway,
        began_utc_ns,
        facts,
        more: vec![],
        teams: vec![],
    }
}

/// Turns the steps of a core into entries of its recording.
pub struct StepEncoder {
    link_topic: String,
    vehicle: VehicleId,
    /// Number of chunks of bytes so far.
    pieces: u64,
}

impl StepEncoder {
    /// An encoder for the boat with this name; the boat's number comes from the game.
    pub fn new(boat: &str) -> StepEncoder {
        StepEncoder {
            link_topic: link_topic(boat),
            vehicle: VehicleId(0),
            pieces: 0,
        }
    }

    /// Sets the boat's number from now on.
    pub fn set_vehicle(&mut self, vehicle: VehicleId) {
        self.vehicle = vehicle;
    }

    /// The entries for a step at the time `at` of the gateway's clock; `game_now` is the game time
    /// as last received.
    pub fn step(
        &mut self,
        at: SimTime,
        game_now: SimTime,
        input: &Input,
        out: &Output,
    ) -> Vec<Entry> {
        let mut entries = match input {
            // Use CDR on a separate topic: link bytes make up most of a recording, and JSON would
            // be several times as long.
            Input::Bytes(bytes) => vec![self.link_bytes(at, game_now, false, bytes)],
            other => vec![json(
                INPUT,
                at,
                &RecordedInput {
                    input: other.clone(),
                },
            )],
        };
        if !out.bytes.is_empty() {
            entries.push(self.link_bytes(at, game_now, true, &out.bytes));
        }
        entries.extend(
            out.events
                .iter()
                .cloned()
                .map(|event| StepEncoder::event(at, event)),
        );
        entries
    }

    /// The entry for an event.
    pub fn event(at: SimTime, event: Event) -> Entry {
        json(EVENT, at, &RecordedEvent { event })
    }

    fn link_bytes(&mut self, at: SimTime, game_now: SimTime, outward: bool, data: &[u8]) -> Entry {
        let stamp = Stamp {
            valid_ns: game_now,
            seq: self.pieces,
            version: LinkBytes::VERSION,
        };
        self.pieces += 1;
        let bytes = codec::encode(&LinkBytes {
            stamp,
            vehicle: self.vehicle,
            outward,
            data: data.to_vec(),
        });
        Entry::Message {
            topic: self.link_topic.clone(),
            schema: Some(LinkBytes::SCHEMA),
            bytes,
            at,
        }
    }
}

/// The entry for a message as JSON.
fn json(topic: &str, at: SimTime, message: &impl Serialize) -> Entry {
    let bytes = serde_json::to_vec(message).expect("what a gateway records is JSON");
    Entry::Message {
        topic: topic.to_owned(),
        schema: None,
        bytes,
        at,
    }
}
