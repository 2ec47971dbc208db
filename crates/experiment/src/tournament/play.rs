//! The games of a tournament, and how each ended.

use super::plan::{Match, Plan};
use crate::pipeline::{Game, Stop, play_game, play_in_order};
use agent::MindRunner;
use scenario::Scenario;
use serde::{Deserialize, Serialize};
use sim::Contest;
use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;

/// A game that was played, or could not be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Which game.
    pub of: Match,
    /// How it ended, or why it could not start.
    pub result: Result<Game, String>,
}

/// Who looks on at every game of a tournament, and what it makes of it.
#[derive(Clone, Copy, Debug)]
pub struct Observer<B, S> {
    /// Begins with a game, which has its seed.
    pub begin: B,
    /// Looks at it before every decision and at the end, and at the minds that have led there.
    pub see: S,
}

/// Plays the games of a plan at these places on so many threads, until all are played or `stop` is set, and gives each to `take`, in their
/// order. Games that `stop` cut short are not among them, nor any after those.
///
/// # Panics
/// If the plan has not as many.
pub fn play(plan: &Plan, games: &[usize], threads: NonZeroUsize, stop: &AtomicBool, mut take: impl FnMut(Record)) {
    let nobody = Observer { begin: |_: &Scenario| (), see: |(): &mut (), _: &Contest, _: &MindRunner| () };
    play_observed(plan, games, (threads, stop), &nobody, |record, _| take(record));
}

/// As [`play`], with somebody who looks on; with each record what came of that, of games that could start.
///
/// # Panics
/// If the plan has not as many.
pub fn play_observed<T: Send>(
    plan: &Plan,
    games: &[usize],
    (threads, stop): (NonZeroUsize, &AtomicBool),
    observer: &Observer<impl Fn(&Scenario) -> T + Sync, impl Fn(&mut T, &Contest, &MindRunner) + Sync>,
    mut take: impl FnMut(Record, Option<T>),
) {
    let one = |(): &mut (), i: usize, stop: Stop<'_>| {
        let (of, scenario) = plan.match_at(games[i]);
        let played = scenario.of_seed(of.seed).map_err(|problems| problems.to_string()).and_then(|scenario| {
            let mut seen = (observer.begin)(&scenario);
            let see = |contest: &Contest, runner: &MindRunner| (observer.see)(&mut seen, contest, runner);
            let game = play_game(&scenario, of.seed, stop, see)?;
            Ok((game, seen))
        });
        match played {
            Ok((game, seen)) => (Record { of, result: Ok(game) }, Some(seen)),
            Err(why) => (Record { of, result: Err(why) }, None),
        }
    };
    let Ok(()) = play_in_order(games.len(), (threads, stop), one, |(record, seen)| {
        take(record, seen);
        Ok::<(), Infallible>(())
    });
}
