//! The games of a tournament, played on several threads.

use super::plan::{Match, Plan};
use agent::MindRunner;
use rules::count::Counts;
use scenario::{Outcome, Scenario};
use serde::{Deserialize, Serialize};
use sim::Contest;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};

/// A game that was played, or could not be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Which game.
    pub of: Match,
    /// How it ended, or why it could not start.
    pub result: Result<Game, String>,
}

/// How a game ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Game {
    /// Points of the first team and of the second.
    pub score: [u32; 2],
    /// What each of them did.
    pub counts: [Counts; 2],
    /// Which of them won; none is a draw.
    pub winner: Option<usize>,
    /// How long it was, simulated s.
    pub duration_s: f64,
    /// Digest of the final state and of all events, hex.
    pub digest: String,
}

/// Who looks on at every game of a tournament, and what it makes of it.
#[derive(Clone, Copy, Debug)]
pub struct Observer<B, S> {
    /// Begins with a game, which has its seed.
    pub begin: B,
    /// Looks at it before every decision and at the end, and at the minds that have led there.
    pub see: S,
}

/// Plays the games of a plan on `jobs` threads, until all are played or `stop` is set, and shows each to `watch`.
///
/// The records are in the order of the plan, and the same whatever the number of threads. Games that `stop` cut
/// short are not among them.
pub fn play(plan: &Plan, jobs: NonZeroUsize, stop: &AtomicBool, watch: impl FnMut(&Record)) -> Vec<Record> {
    play_some(plan, 0..plan.games(), jobs, stop, watch)
}

/// As [`play`], with somebody who looks on; with each record what came of that, of games that could start.
pub fn play_observed<T: Send>(
    plan: &Plan,
    jobs: NonZeroUsize,
    stop: &AtomicBool,
    observer: &Observer<impl Fn(&Scenario) -> T + Sync, impl Fn(&mut T, &Contest, &MindRunner) + Sync>,
    watch: impl FnMut(&Record),
) -> Vec<(Record, Option<T>)> {
    play_from(plan, &(0..plan.games()).collect::<Vec<_>>(), jobs, stop, observer, watch)
}

/// As [`play`], of the games at these places alone, in whichever process.
///
/// # Panics
/// If the plan has not as many.
pub fn play_some(
    plan: &Plan,
    games: Range<usize>,
    jobs: NonZeroUsize,
    stop: &AtomicBool,
    watch: impl FnMut(&Record),
) -> Vec<Record> {
    play_these(plan, &games.collect::<Vec<_>>(), jobs, stop, watch)
}

/// As [`play`], of the games at these places alone, in their order.
///
/// # Panics
/// If the plan has not as many.
pub fn play_these(
    plan: &Plan,
    games: &[usize],
    jobs: NonZeroUsize,
    stop: &AtomicBool,
    watch: impl FnMut(&Record),
) -> Vec<Record> {
    let nobody = Observer { begin: |_: &Scenario| (), see: |(): &mut (), _: &Contest, _: &MindRunner| () };
    play_from(plan, games, jobs, stop, &nobody, watch).into_iter().map(|(record, _)| record).collect()
}

fn play_from<T: Send>(
    plan: &Plan,
    games: &[usize],
    jobs: NonZeroUsize,
    stop: &AtomicBool,
    observer: &Observer<impl Fn(&Scenario) -> T + Sync, impl Fn(&mut T, &Contest, &MindRunner) + Sync>,
    mut watch: impl FnMut(&Record),
) -> Vec<(Record, Option<T>)> {
    /// Games that may wait to be shown.
    const QUEUE: usize = 64;
    let next = AtomicUsize::new(0);
    let mut records: Vec<(usize, Record, Option<T>)> = vec![];
    std::thread::scope(|scope| {
        let (sender, receiver) = sync_channel(QUEUE);
        for _ in 0..jobs.get().min(games.len()) {
            let (next, sender) = (&next, sender.clone());
            scope.spawn(move || work(plan, (next, games), stop, observer, &sender));
        }
        drop(sender);
        for (place, record, seen) in receiver {
            watch(&record);
            records.push((place, record, seen));
        }
    });
    records.sort_unstable_by_key(|(place, ..)| *place);
    records.into_iter().map(|(_, record, seen)| (record, seen)).collect()
}

/// What one thread does: the next game that nobody has taken, until there is none.
fn work<T>(
    plan: &Plan,
    (next, games): (&AtomicUsize, &[usize]),
    stop: &AtomicBool,
    observer: &Observer<impl Fn(&Scenario) -> T, impl Fn(&mut T, &Contest, &MindRunner)>,
    sender: &SyncSender<(usize, Record, Option<T>)>,
) {
    loop {
        let place = next.fetch_add(1, Ordering::Relaxed);
        let Some(&index) = games.get(place).filter(|_| !stop.load(Ordering::Relaxed)) else { return };
        let (of, scenario) = plan.match_at(index);
        let (result, seen) = match game_of(scenario, of.seed, stop, observer) {
            Ok((game, seen)) => (Ok(game), Some(seen)),
            Err(why) => (Err(why), None),
        };
        // A game that was stopped is no game.
        if stop.load(Ordering::Relaxed) || sender.send((place, Record { of, result }, seen)).is_err() {
            return;
        }
    }
}

fn game_of<T>(
    scenario: &Scenario,
    seed: u64,
    stop: &AtomicBool,
    observer: &Observer<impl Fn(&Scenario) -> T, impl Fn(&mut T, &Contest, &MindRunner)>,
) -> Result<(Game, T), String> {
    let scenario = scenario.of_seed(seed).map_err(|problems| problems.to_string())?;
    let mut seen = (observer.begin)(&scenario);
    let outcome = crate::play_observed(&scenario, agent::minds_of(&scenario), seed, |contest, runner| {
        (observer.see)(&mut seen, contest, runner);
        !stop.load(Ordering::Relaxed)
    });
    Ok((Game::new(&scenario, &outcome.map_err(|why| why.to_string())?), seen))
}

impl Game {
    fn new(scenario: &Scenario, outcome: &Outcome) -> Game {
        let name = |side: usize| scenario.teams[side].name.as_str();
        Game {
            score: [0, 1].map(|side| outcome.score.teams[name(side)]),
            counts: [0, 1].map(|side| outcome.counts.teams[name(side)]),
            winner: (0..2).find(|side| outcome.winner.as_deref() == Some(name(*side))),
            duration_s: outcome.duration_s,
            digest: outcome.digest.clone(),
        }
    }
}
