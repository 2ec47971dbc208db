//! The sim's replies to observers, and the topics subscribed to only for the recorder.

use crate::contest::Contest;
use messages::{Message, PolicyProposal, Say};
use primitives::codec;
use scenario::Scenario;
use scenario::outcome::EventOutcome;
use serde::de::DeserializeOwned;

/// The waves, as JSON.
pub(super) fn water_json(contest: &Contest) -> Vec<u8> {
    serde_json::to_vec(&contest.world().sea().water()).expect("waves are JSON")
}

/// Maximum number of events in a reply: a link carries at most a megabyte at once, and observers
/// wait only briefly.
const EVENTS_MAX: usize = 5000;

/// The events so far, as JSON; only the last ones if there are too many.
pub(super) fn events_json(contest: &Contest) -> Vec<u8> {
    let scenario = contest.scenario();
    let all = contest.events();
    let events = all[all.len().saturating_sub(EVENTS_MAX)..]
        .iter()
        .map(|logged| EventOutcome::new(scenario, logged));
    serde_json::to_vec(&events.collect::<Vec<_>>()).expect("events are JSON")
}

/// A topic that is subscribed to only for the recorder.
pub(super) struct RecordedTopic {
    pub(super) topic: String,
    pub(super) schema: &'static str,
    /// Validates messages, so that every recorded one can be read.
    pub(super) is_sound: fn(&[u8]) -> bool,
}

impl RecordedTopic {
    fn of<M: Message + DeserializeOwned>(topic: String) -> RecordedTopic {
        // Check before recording: an unknown sender's message must not make a reader fail.
        RecordedTopic {
            topic,
            schema: M::SCHEMA,
            is_sound: |bytes| codec::decode::<M>(bytes).is_ok(),
        }
    }
}

/// The topics of team messages and proposals.
pub(super) fn recorded_topics(scenario: &Scenario) -> Vec<RecordedTopic> {
    let boats = scenario.vehicles.iter().map(|vehicle| &vehicle.name);
    let says = scenario
        .teams
        .iter()
        .map(|team| RecordedTopic::of::<Say>(format!("say/{}", team.name)));
    let proposals = boats.map(|name| RecordedTopic::of::<PolicyProposal>(format!("policy/{name}")));
    says.chain(proposals).collect()
}
