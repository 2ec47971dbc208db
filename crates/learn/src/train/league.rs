//! Opponents of a policy that learns, and how often each is drawn: by how often it wins.

use crate::environment::Finished;
use crate::training::{self, Stage};
use scenario::policy::{PartialSpec, PolicyModel};
use serde::{Deserialize, Serialize};

/// Of the weight of its kind, an opponent that never wins has this share of an equal part.
const LEAST: f64 = 0.1;
/// What a game of the past counts for each that is played later.
const MEMORY: f64 = 0.98;

/// A past policy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct PastSelf {
    /// Samples that it had learnt from.
    pub(super) samples: u64,
    /// Its file.
    onnx: Vec<u8>,
}

/// How games against an opponent went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Record {
    games: f64,
    /// A draw is half a loss.
    lost: f64,
}

/// The opponents of a stage.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct League {
    /// In the order of the setup's opponents: the policy itself if it plays itself, the strategies, and past policies.
    records: Vec<Record>,
    /// How many of them are no past policies.
    fixed: usize,
    past: Vec<PastSelf>,
    /// How many past policies there were, those that are not kept any more included.
    kept: usize,
}

impl League {
    /// The opponents of another stage: past policies stay.
    pub(super) fn begin(&mut self, fixed: usize) {
        self.fixed = fixed;
        self.kept = self.past.len();
        self.records = vec![Record::default(); fixed + self.past.len()];
    }

    /// Forgets the past policies that are not kept, as games begin anew.
    pub(super) fn compact(&mut self) {
        let forgotten = self.kept - self.past.len();
        self.records.drain(self.fixed..self.fixed + forgotten);
        self.kept = self.past.len();
    }

    /// The past policies that are kept.
    pub(super) fn past(&self) -> impl Iterator<Item = PolicyModel> {
        self.past.iter().filter_map(PastSelf::model)
    }

    /// Keeps a policy; gives it as an opponent.
    pub(super) fn keep(&mut self, samples: u64, onnx: Vec<u8>, most: usize) -> Option<PolicyModel> {
        self.past.push(PastSelf { samples, onnx });
        self.kept += 1;
        self.records.push(Record::default());
        let surplus = self.past.len().saturating_sub(most);
        self.past.drain(..surplus);
        self.past.last().and_then(PastSelf::model)
    }

    /// When the newest past policy was kept.
    pub(super) fn newest(&self) -> u64 {
        self.past.last().map_or(0, |past| past.samples)
    }

    /// Takes in how games went.
    pub(super) fn see(&mut self, finished: &[Finished]) {
        for one in finished {
            let Some(record) = self.records.get_mut(one.standing.side.opponent) else { continue };
            let [own, theirs] = one.standing.score;
            let lost = if own > theirs {
                0.0
            } else if own == theirs {
                0.5
            } else {
                1.0
            };
            record.games = record.games * MEMORY + 1.0;
            record.lost = record.lost * MEMORY + lost;
        }
    }

    /// How often each opponent is drawn, in the order of the setup's.
    pub(super) fn weights(&self, stage: &Stage, league: &training::League) -> Vec<f64> {
        let plays_itself = self.fixed > stage.opponent.len();
        let strategies = usize::from(plays_itself)..self.fixed;
        let past = self.fixed + self.kept - self.past.len()..self.fixed + self.kept;
        let mut weights = vec![0.0; self.records.len()];
        for (range, total) in [(strategies, stage.strategies), (past.clone(), stage.past_selves)] {
            // Prioritised fictitious self-play (Vinyals and others, Nature 2019). Past policies
            // play from their ONNX files, as boats do.
            let urgencies: Vec<f64> = self.records[range.clone()].iter().map(|r| r.urgency(league.priority)).collect();
            let sum: f64 = urgencies.iter().sum();
            let parts = weights[range].iter_mut().zip(urgencies);
            parts.for_each(|(weight, urgency)| *weight = total * urgency / sum.max(f64::MIN_POSITIVE));
        }
        if plays_itself {
            // As long as there is no past, the present stands for it.
            weights[0] = stage.self_play + if past.is_empty() { stage.past_selves } else { 0.0 };
        }
        weights
    }
}

impl Record {
    /// How much there is to be learnt from it, by how often it wins.
    fn urgency(self, priority: f64) -> f64 {
        // As if it had won one game of two before.
        let lost = (self.lost + 1.0) / (self.games + 2.0);
        LEAST + (1.0 - LEAST) * libm::pow(lost, priority)
    }
}

impl PastSelf {
    fn model(&self) -> Option<PolicyModel> {
        let name = format!("after {} samples", self.samples);
        PolicyModel::read(&name, &self.onnx, PartialSpec::default()).ok()
    }
}
