//! The futures of a replay: what would have happened with other strategies or in another sea.

use crate::scenario_files;
use crate::whatif_command::{changes, check, past_at, rows};
use experiment::whatif::{self, Fan, Future};
use recording::Recording;
use scenario::Kind;
use serde_json::{Value, json};
use shore::page::replay::{Futures, Question};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Maximum number of futures for a page.
const FUTURES_MAX: u32 = 1000;
/// Number of times at which fan charts have values.
const TIMES: usize = 121;

/// A recorded game to continue.
pub(super) struct ReplayFutures {
    recording: Arc<Recording>,
    strategies: BTreeSet<String>,
    seas: BTreeSet<String>,
}

impl ReplayFutures {
    /// `None` if the game cannot be continued.
    pub(super) fn new(recording: &Arc<Recording>) -> Option<ReplayFutures> {
        check(recording).ok().map(|()| ReplayFutures {
            recording: Arc::clone(recording),
            strategies: scenario_files::all_names(Kind::STRATEGY),
            seas: scenario_files::all_names(Kind::SEA),
        })
    }

    /// Checks the question: a page may use only the strategies and seas that it offers.
    fn check(&self, question: &Question) -> Result<(), String> {
        let Question {
            at_s, futures, sea, ..
        } = question;
        if !(5..=FUTURES_MAX).contains(futures) {
            return Err(format!("{futures} futures, expected 5 to {FUTURES_MAX}"));
        }
        if !(0.0..=86_400.0).contains(at_s) {
            return Err(format!(
                "the time of the change is {at_s} s, expected 0 to 86400 s"
            ));
        }
        let unknown = |kind: &str, name: &str| Err(format!("there is no {kind} {name:?}"));
        let strategies = question.teams.values().chain(question.vehicles.values());
        for name in strategies {
            if !self.strategies.contains(name) {
                return unknown("strategy", name);
            }
        }
        match sea {
            Some(name) if !self.seas.contains(name) => unknown("sea", name),
            _ => Ok(()),
        }
    }
}

fn pairs(of: &BTreeMap<String, String>) -> impl Iterator<Item = (&str, &str)> {
    of.iter()
        .map(|(name, strategy)| (name.as_str(), strategy.as_str()))
}

impl Futures for ReplayFutures {
    fn choices(&self) -> Value {
        json!({ "strategies": self.strategies, "seas": self.seas, "futures_max": FUTURES_MAX })
    }

    fn play(
        &mut self,
        question: &Question,
        stop: &AtomicBool,
        progress: &mut dyn FnMut(u32),
    ) -> Result<Value, String> {
        self.check(question)?;
        let told = |why: anyhow::Error| format!("{why:#}");
        let past = past_at(&self.recording, question.at_s).map_err(told)?;
        let sea = question.sea.as_deref();
        let sea = sea.map(|name| scenario_files::find(name, Kind::SEA));
        let sea = sea.transpose().map_err(told)?;
        let (teams, boats) = (pairs(&question.teams), pairs(&question.vehicles));
        let changes = changes(&past, teams, boats, sea.as_deref());
        let changes = changes.map_err(told)?;
        let count = question.futures as usize;
        let threads = experiment::threads(None, count);
        let mut futures: Vec<[Future; 2]> = vec![];
        whatif::compare(&past, &changes, count, (threads, stop), |future| {
            futures.push(future);
            progress(futures.len() as u32);
            Ok(())
        })?;
        if futures.is_empty() {
            return Err("stopped".to_owned());
        }
        let from_s = past.until.as_s();
        let to_s = past.scenario.rules.time_limit.as_s();
        let step_s = (to_s - from_s) / (TIMES - 1) as f64;
        let times_s: Vec<f64> = (0..TIMES).map(|i| from_s + step_s * i as f64).collect();
        let fans = [0, 1].map(|side| {
            let futures = futures.iter().map(|pair| &pair[side]);
            [0, 1].map(|team| Fan::of(futures.clone(), team, &times_s).points)
        });
        let teams = [0, 1].map(|team| past.scenario.teams[team].name.as_str());
        Ok(
            json!({ "quantities": rows(teams, &futures), "t_s": times_s, "recorded": fans[0], "changed": fans[1] }),
        )
    }
}
