//! The league: a learning policy's opponents, drawn according to how often they win.

use crate::environment::Finished;
use crate::training::{self, Stage};
use scenario::policy::{PartialSpec, PolicyModel};
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;

/// Draw weight of an opponent that never wins, relative to that of one that always wins.
const LEAST: f64 = 0.1;
/// Factor on a game's weight for each later game.
const MEMORY: f64 = 0.98;

/// A past version of the policy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct PastSelf {
    /// Number of samples that it had learned from.
    pub(super) samples: u64,
    onnx: Vec<u8>,
}

/// Results against an opponent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Record {
    games: f64,
    /// Losses; a draw counts half.
    lost: f64,
}

/// The opponents of a stage.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct League {
    /// In the order of the setup's opponents: the policy itself in self-play, strategies, past
    /// policies.
    records: Vec<Record>,
    /// The number of records that are not past policies.
    fixed: usize,
    past: Vec<PastSelf>,
    /// The number of past policies so far, including discarded ones.
    kept: usize,
}

impl League {
    /// Sets the opponents of the next stage; past policies are kept.
    pub(super) fn begin(&mut self, fixed: usize) {
        self.fixed = fixed;
        self.kept = self.past.len();
        self.records = vec![Record::default(); fixed + self.past.len()];
    }

    /// Removes the records of discarded past policies when games restart.
    pub(super) fn compact(&mut self) {
        let forgotten = self.kept - self.past.len();
        self.records.drain(self.fixed..self.fixed + forgotten);
        self.kept = self.past.len();
    }

    pub(super) fn past(&self) -> &[PastSelf] {
        &self.past
    }

    /// Stores a past policy, keeping at most `most` of them, and returns it as an opponent.
    pub(super) fn keep(&mut self, samples: u64, onnx: Vec<u8>, most: usize) -> Option<PolicyModel> {
        self.past.push(PastSelf { samples, onnx });
        self.kept += 1;
        self.records.push(Record::default());
        let surplus = self.past.len().saturating_sub(most);
        self.past.drain(..surplus);
        self.past.last().and_then(PastSelf::model)
    }

    pub(super) fn newest(&self) -> u64 {
        self.past.last().map_or(0, |past| past.samples)
    }

    pub(super) fn see(&mut self, finished: &[Finished]) {
        for one in finished {
            let Some(record) = self.records.get_mut(one.standing.side.opponent) else {
                continue;
            };
            let [own, theirs] = one.standing.score;
            let lost = match own.cmp(&theirs) {
                Ordering::Greater => 0.0,
                Ordering::Equal => 0.5,
                Ordering::Less => 1.0,
            };
            record.games = record.games * MEMORY + 1.0;
            record.lost = record.lost * MEMORY + lost;
        }
    }

    /// The opponents' draw weights, in the setup's order.
    pub(super) fn weights(&self, stage: &Stage, league: &training::League) -> Vec<f64> {
        let plays_itself = self.fixed > stage.opponent.len();
        let strategies = usize::from(plays_itself)..self.fixed;
        let past = self.fixed + self.kept - self.past.len()..self.fixed + self.kept;
        let mut weights = vec![0.0; self.records.len()];
        for (range, total) in [
            (strategies, stage.strategies),
            (past.clone(), stage.past_selves),
        ] {
            // Prioritised fictitious self-play (Vinyals and others, Nature 2019). Past policies
            // play from their ONNX files, as on boats.
            let urgencies: Vec<f64> = self.records[range.clone()]
                .iter()
                .map(|r| r.urgency(league.priority))
                .collect();
            let sum: f64 = urgencies.iter().sum();
            let parts = weights[range].iter_mut().zip(urgencies);
            parts.for_each(|(weight, urgency)| {
                *weight = total * urgency / sum.max(f64::MIN_POSITIVE)
            });
        }
        if plays_itself {
            // Without past policies, the current policy takes over their weight.
            weights[0] = stage.self_play
                + if past.is_empty() {
                    stage.past_selves
                } else {
                    0.0
                };
        }
        weights
    }
}

impl Record {
    /// How much can be learned from an opponent, estimated from its fraction of wins.
    fn urgency(self, priority: f64) -> f64 {
        // The prior is one win in two games.
        let lost = (self.lost + 1.0) / (self.games + 2.0);
        LEAST + (1.0 - LEAST) * libm::pow(lost, priority)
    }
}

impl PastSelf {
    pub(super) fn model(&self) -> Option<PolicyModel> {
        let name = format!("after {} samples", self.samples);
        PolicyModel::read(&name, &self.onnx, PartialSpec::default()).ok()
    }
}
