//! Plays the games of an experiment on several threads and returns them in order.
//!
//! Tournaments, leagues and sweeps define the games and their measurements; this module plays them.
//! Results do not depend on the number of threads.

use agent::MindRunner;
use rules::count::Counts;
use scenario::{Outcome, Scenario};
use serde::{Deserialize, Serialize};
use sim::Contest;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};

/// The result of a game.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Game {
    /// Points of the first and the second team.
    pub score: [u32; 2],
    /// Event counts of each team.
    pub counts: [Counts; 2],
    /// The index of the winning team; `None` for a draw.
    pub winner: Option<usize>,
    /// Duration, simulated s.
    pub duration_s: f64,
    /// Digest of the final state and of all events, hex.
    pub digest: String,
}

impl Game {
    pub(crate) fn new(scenario: &Scenario, outcome: Outcome) -> Game {
        let name = |side: usize| scenario.teams[side].name.as_str();
        Game {
            score: [0, 1].map(|side| outcome.score.teams[name(side)]),
            counts: [0, 1].map(|side| outcome.counts.teams[name(side)]),
            winner: (0..2).find(|side| outcome.winner.as_deref() == Some(name(*side))),
            duration_s: outcome.duration_s,
            digest: outcome.digest,
        }
    }

    /// The first team's lead over the second, points.
    pub fn margin(&self) -> i64 {
        i64::from(self.score[0]) - i64::from(self.score[1])
    }
}

/// Two flags, either of which stops the games.
#[derive(Clone, Copy)]
pub(crate) struct Stop<'a>([&'a AtomicBool; 2]);

impl Stop<'_> {
    pub(crate) fn is_set(self) -> bool {
        self.0.iter().any(|stop| stop.load(Ordering::Relaxed))
    }
}

/// Plays a scenario with a seed. `see` receives the contest and the minds before every decision and
/// at the end. The error states why the game could not start.
pub(crate) fn play_game(
    scenario: &Scenario,
    seed: u64,
    stop: Stop<'_>,
    mut see: impl FnMut(&Contest, &MindRunner),
) -> Result<Game, String> {
    let outcome = arena::play_observed(
        scenario,
        agent::minds_of(scenario),
        seed,
        |contest, runner| {
            see(contest, runner);
            !stop.is_set()
        },
    );
    Ok(Game::new(scenario, outcome.map_err(|why| why.to_string())?))
}

/// Plays the games numbered from 0 to `count` - 1 on several threads, until all are played or
/// `stop` is set, and passes each row to `take` in order. `play` plays one game, using the state
/// that its thread keeps between games. Games cut short by `stop`, and all after them, yield no
/// rows.
///
/// # Errors
/// The error of `take`, which ends the games.
pub(crate) fn play_in_order<K: Default, R: Send, E>(
    count: usize,
    (threads, stop): (NonZeroUsize, &AtomicBool),
    play: impl Fn(&mut K, usize, Stop<'_>) -> R + Sync,
    mut take: impl FnMut(R) -> Result<(), E>,
) -> Result<(), E> {
    /// Maximum number of rows queued for `take`.
    const QUEUE: usize = 64;
    let next = AtomicUsize::new(0);
    let refused = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let (sender, receiver) = sync_channel(QUEUE);
        for _ in 0..threads.get().min(count) {
            let next = &next;
            let sender = sender.clone();
            let play = &play;
            let stop = Stop([stop, &refused]);
            scope.spawn(move || work((next, count), play, stop, &sender));
        }
        drop(sender);
        let mut waiting = BTreeMap::new();
        let mut due = 0;
        for (i, row) in receiver {
            waiting.insert(i, row);
            while let Some(row) = waiting.remove(&due) {
                due += 1;
                take(row).inspect_err(|_| refused.store(true, Ordering::Relaxed))?;
            }
        }
        Ok(())
    })
}

/// Calls `run` with each number from 0 to `count` - 1 on several threads, and passes the results to
/// `take` in order.
pub fn run_in_order<R: Send>(
    count: usize,
    threads: NonZeroUsize,
    run: impl Fn(usize) -> R + Sync,
    mut take: impl FnMut(R),
) {
    let never = AtomicBool::new(false);
    let each = |(): &mut (), i: usize, _: Stop<'_>| run(i);
    let Ok(()) = play_in_order(count, (threads, &never), each, |row| {
        take(row);
        Ok::<(), std::convert::Infallible>(())
    });
}

/// The loop of one thread: plays the next unassigned game until none is left.
fn work<K: Default, R>(
    (next, count): (&AtomicUsize, usize),
    play: &impl Fn(&mut K, usize, Stop<'_>) -> R,
    stop: Stop<'_>,
    sender: &SyncSender<(usize, R)>,
) {
    let mut kept = K::default();
    loop {
        let i = next.fetch_add(1, Ordering::Relaxed);
        if i >= count || stop.is_set() {
            return;
        }
        let row = play(&mut kept, i, stop);
        // A stopped game is incomplete.
        if stop.is_set() || sender.send((i, row)).is_err() {
            return;
        }
    }
}
