//! Games of an experiment: played on several threads, handed over in their order.
//!
//! Tournaments, leagues and sweeps say which games there are and what is measured of them; this plays them. What comes of it does not
//! depend on the number of threads.

use agent::MindRunner;
use rules::count::Counts;
use scenario::{Outcome, Scenario};
use serde::{Deserialize, Serialize};
use sim::Contest;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};

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

impl Game {
    fn new(scenario: &Scenario, outcome: Outcome) -> Game {
        let name = |side: usize| scenario.teams[side].name.as_str();
        Game {
            score: [0, 1].map(|side| outcome.score.teams[name(side)]),
            counts: [0, 1].map(|side| outcome.counts.teams[name(side)]),
            winner: (0..2).find(|side| outcome.winner.as_deref() == Some(name(*side))),
            duration_s: outcome.duration_s,
            digest: outcome.digest,
        }
    }
}

/// Whether somebody wants no more games.
#[derive(Clone, Copy)]
pub(crate) struct Stop<'a>([&'a AtomicBool; 2]);

impl Stop<'_> {
    pub(crate) fn is_set(self) -> bool {
        self.0.iter().any(|stop| stop.load(Ordering::Relaxed))
    }
}

/// Plays a scenario of a seed; `see` is shown the contest before every decision and at the end, and the minds that have led there. The error says why
/// it could not start.
pub(crate) fn play_game(
    scenario: &Scenario,
    seed: u64,
    stop: Stop<'_>,
    mut see: impl FnMut(&Contest, &MindRunner),
) -> Result<Game, String> {
    let outcome = arena::play_observed(scenario, agent::minds_of(scenario), seed, |contest, runner| {
        see(contest, runner);
        !stop.is_set()
    });
    Ok(Game::new(scenario, outcome.map_err(|why| why.to_string())?))
}

/// Plays games by their numbers from 0 to before `count` on so many threads, until all are played or `stop` is set, and gives each row to `take`,
/// in order. `play` plays one, with what the thread keeps from game to game. Games that `stop` cut short are not among the rows, nor any
/// after those.
///
/// # Errors
/// What `take` says: then no more are played.
pub(crate) fn play_in_order<K: Default, R: Send, E>(
    count: usize,
    (threads, stop): (NonZeroUsize, &AtomicBool),
    play: impl Fn(&mut K, usize, Stop<'_>) -> R + Sync,
    mut take: impl FnMut(R) -> Result<(), E>,
) -> Result<(), E> {
    /// Rows that may wait to be taken.
    const QUEUE: usize = 64;
    let next = AtomicUsize::new(0);
    let refused = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let (sender, receiver) = sync_channel(QUEUE);
        for _ in 0..threads.get().min(count) {
            let (next, sender, play, stop) = (&next, sender.clone(), &play, Stop([stop, &refused]));
            scope.spawn(move || work((next, count), play, stop, &sender));
        }
        drop(sender);
        let (mut waiting, mut due) = (BTreeMap::new(), 0);
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

/// What one thread does: the next game that nobody has taken, until there is none.
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
        // A game that was stopped is no game.
        if stop.is_set() || sender.send((i, row)).is_err() {
            return;
        }
    }
}
