//! A one-page summary of a recorded game.

use crate::gateway::{Gateway, gateways};
use crate::statistics::{BoatStatistics, StatisticsBuilder};
use crate::step::for_each_step;
use recording::{Bag, Damaged, Recording};
use scenario::outcome::EventOutcome;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Minimum time between the first and the last message to compute a rate, s.
const RATE_OVER_MIN_S: f64 = 0.1;

/// A one-page summary of a game.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// The game's name on the network.
    pub game: String,
    /// The scenario's name.
    pub scenario: String,
    /// The seed of the game.
    pub seed: u64,
    /// The version of Squall that played it.
    pub version: String,
    /// The commit from which the program was built.
    pub commit: String,
    /// The pace.
    pub pace: String,
    /// Start of the game: UTC, ns since 1970.
    pub began_utc_ns: u64,
    /// Simulated duration, s.
    pub duration_s: f64,
    /// Wall-clock duration, s.
    pub wall_s: f64,
    /// Whether the file is truncated.
    pub is_cut: bool,
    /// Messages dropped because the disk was too slow; `None` if the file is truncated.
    pub dropped: Option<u64>,
    /// Damaged messages, excluded from all other values.
    pub damaged: Damaged,
    /// Size of the file, bytes.
    pub bytes: u64,
    /// Points by team, at the end of the file.
    pub score: BTreeMap<String, u32>,
    /// The winning team; `None` for a draw or a truncated file.
    pub winner: Option<String>,
    /// The digest of the game; `None` if the file is truncated.
    pub digest: Option<String>,
    /// All events, in order.
    pub events: Vec<EventOutcome>,
    /// Statistics of each boat, by vehicle index.
    pub boats: Vec<BoatStatistics>,
    /// The gateways of real boats.
    pub gateways: Vec<Gateway>,
    /// Contents of the file, by topic.
    pub topics: BTreeMap<String, Topic>,
}

/// A topic of a recording.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Topic {
    /// Number of messages.
    pub count: u64,
    /// Their total size, bytes.
    pub bytes: u64,
    /// Messages per simulated second, from the first to the last; `None` if these are less than a
    /// tenth of a second apart.
    pub rate_hz: Option<f64>,
}

impl Summary {
    /// Summarises a recording. Memory grows only with the number of events.
    pub fn of(recording: &Recording) -> Summary {
        let scenario = recording.scenario();
        let mut statistics = StatisticsBuilder::new(scenario);
        let mut times_s = None;
        let mut score = vec![];
        let mut events = vec![];
        let damaged = for_each_step(recording, |step| {
            statistics.add(&step);
            times_s = Some((
                times_s.map_or(step.time_s, |(first_s, _)| first_s),
                step.time_s,
            ));
            events.extend(
                step.events
                    .iter()
                    .map(|logged| EventOutcome::new(scenario, logged)),
            );
            score = step.score;
        });
        let gateways = gateways(recording);
        let header = recording.header();
        let ending = recording.ending();
        let wall_ns = recording.bag().span_utc_ns();
        Summary {
            game: header.game.clone(),
            scenario: scenario.name.clone(),
            seed: scenario.seed,
            version: header.info.version.clone(),
            commit: header.commit.clone(),
            pace: header.info.pace.clone(),
            began_utc_ns: header.began_utc_ns,
            duration_s: times_s.map_or(0.0, |(first_s, last_s)| last_s - first_s),
            wall_s: wall_ns as f64 * 1e-9,
            is_cut: recording.is_cut(),
            dropped: ending.map(|ending| ending.dropped),
            bytes: recording.bag().size(),
            score: scenario
                .teams
                .iter()
                .map(|team| team.name.clone())
                .zip(score)
                .collect(),
            winner: ending.and_then(|ending| ending.outcome.winner.clone()),
            digest: ending.map(|ending| ending.outcome.digest.clone()),
            events,
            boats: statistics.end(),
            damaged: gateways
                .iter()
                .fold(damaged, |all, gateway| all.and(&gateway.damaged)),
            gateways,
            topics: topics(recording.bag()),
        }
    }
}

/// The topics of a recording, by name.
pub fn topics(bag: &Bag) -> BTreeMap<String, Topic> {
    let mut topics: BTreeMap<&str, (Topic, [i64; 2])> = BTreeMap::new();
    for message in bag.messages() {
        let (topic, [first, last]) = topics
            .entry(message.topic)
            .or_insert((Topic::default(), [i64::MAX, i64::MIN]));
        topic.count += 1;
        topic.bytes += message.bytes.len() as u64;
        (*first, *last) = ((*first).min(message.at.0), (*last).max(message.at.0));
    }
    let rated = |(name, (topic, [first, last])): (&str, (Topic, [i64; 2]))| {
        let span_s = (last - first) as f64 * 1e-9;
        let rate_hz = (span_s >= RATE_OVER_MIN_S).then(|| (topic.count - 1) as f64 / span_s);
        (name.to_owned(), Topic { rate_hz, ..topic })
    };
    topics.into_iter().map(rated).collect()
}
