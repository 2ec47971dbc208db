//! The games of a tournament, played on several threads.

use super::plan::{Match, Plan};
use crate::play_watched;
use game::count::Counts;
use game::{Outcome, Scenario};
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};

/// A game that was played, or could not be.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Which game.
    pub of: Match,
    /// How it ended, or why it could not start.
    pub result: Result<Game, String>,
}

/// How a game ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Game {
    /// Points of the first team and of the second.
    pub score: [u32; 2],
    /// What each of them did.
    pub counts: [Counts; 2],
    /// Which of them won; none is a draw.
    pub winner: Option<usize>,
    /// Digest of the final state and of all events, hex.
    pub digest: String,
}

/// Plays the games of a plan on `jobs` threads, until all are played or `stop` is set, and shows each to `watch`.
///
/// The records are in the order of the plan, and the same whatever the number of threads. Games that `stop` cut
/// short are not among them.
pub fn play(plan: &Plan, jobs: NonZeroUsize, stop: &AtomicBool, mut watch: impl FnMut(&Record)) -> Vec<Record> {
    /// Games that may wait to be shown.
    const QUEUE: usize = 64;
    let next = AtomicUsize::new(0);
    let mut records: Vec<(usize, Record)> = vec![];
    std::thread::scope(|scope| {
        let (sender, receiver) = sync_channel(QUEUE);
        for _ in 0..jobs.get().min(plan.games()) {
            let (next, sender) = (&next, sender.clone());
            scope.spawn(move || work(plan, next, stop, &sender));
        }
        drop(sender);
        for (index, record) in receiver {
            watch(&record);
            records.push((index, record));
        }
    });
    records.sort_unstable_by_key(|(index, _)| *index);
    records.into_iter().map(|(_, record)| record).collect()
}

/// What one thread does: the next game that nobody has taken, until there is none.
fn work(plan: &Plan, next: &AtomicUsize, stop: &AtomicBool, sender: &SyncSender<(usize, Record)>) {
    loop {
        let index = next.fetch_add(1, Ordering::Relaxed);
        if index >= plan.games() || stop.load(Ordering::Relaxed) {
            return;
        }
        let (of, scenario) = plan.match_at(index);
        let result = game_of(scenario, of.seed, stop);
        // A game that was stopped is no game.
        if stop.load(Ordering::Relaxed) || sender.send((index, Record { of, result })).is_err() {
            return;
        }
    }
}

fn game_of(scenario: &Scenario, seed: u64, stop: &AtomicBool) -> Result<Game, String> {
    let scenario = scenario.of_seed(seed).map_err(|problems| problems.to_string())?;
    let outcome = play_watched(&scenario, agent::minds_of(&scenario), seed, |_| !stop.load(Ordering::Relaxed));
    Ok(Game::new(&scenario, &outcome.map_err(|why| why.to_string())?))
}

impl Game {
    fn new(scenario: &Scenario, outcome: &Outcome) -> Game {
        let name = |side: usize| scenario.teams[side].name.as_str();
        Game {
            score: [0, 1].map(|side| outcome.score.teams[name(side)]),
            counts: [0, 1].map(|side| outcome.counts.teams[name(side)]),
            winner: (0..2).find(|side| outcome.winner.as_deref() == Some(name(*side))),
            digest: outcome.digest.clone(),
        }
    }
}
