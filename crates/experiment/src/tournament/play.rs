//! Plays the games of a tournament.

use super::plan::{Match, Plan};
use crate::pipeline::{Game, Stop, play_game, play_in_order};
use agent::MindRunner;
use scenario::Scenario;
use serde::{Deserialize, Serialize};
use sim::Contest;
use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;

/// A game that was played or could not start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The match.
    pub of: Match,
    /// The result, or why the game could not start.
    pub result: Result<Game, String>,
}

/// Callbacks that observe every game of a tournament.
#[derive(Clone, Copy, Debug)]
pub struct Observer<B, S> {
    /// Called at the start of a game, with its seed.
    pub begin: B,
    /// Called before every decision and at the end, with the minds that led there.
    pub see: S,
}

/// Plays the games of a plan with these indices on several threads, until all are played or `stop`
/// is set, and passes each to `take` in order. Games cut short by `stop`, and all later games, are
/// omitted.
///
/// # Panics
/// If an index is out of range.
pub fn play(
    plan: &Plan,
    games: &[usize],
    threads: NonZeroUsize,
    stop: &AtomicBool,
    mut take: impl FnMut(Record),
) {
    let nobody = Observer {
        begin: |_: &Scenario| (),
        see: |(): &mut (), _: &Contest, _: &MindRunner| (),
    };
    play_observed(plan, games, (threads, stop), &nobody, |record, _| {
        take(record)
    });
}

/// Like [`play`], with an observer; each record of a game that started comes with the observer's
/// result.
///
/// # Panics
/// If an index is out of range.
pub fn play_observed<T: Send>(
    plan: &Plan,
    games: &[usize],
    (threads, stop): (NonZeroUsize, &AtomicBool),
    observer: &Observer<
        impl Fn(&Scenario) -> T + Sync,
        impl Fn(&mut T, &Contest, &MindRunner) + Sync,
    >,
    mut take: impl FnMut(Record, Option<T>),
) {
    let one = |(): &mut (), i: usize, stop: Stop<'_>| {
        let (of, scenario) = plan.match_at(games[i]);
        let played = scenario
            .of_seed(of.seed)
            .map_err(|problems| problems.to_string())
            .and_then(|scenario| {
                let mut seen = (observer.begin)(&scenario);
                let see = |contest: &Contest, runner: &MindRunner| {
                    (observer.see)(&mut seen, contest, runner)
                };
                let game = play_game(&scenario, of.seed, stop, see)?;
                Ok((game, seen))
            });
        match played {
            Ok((game, seen)) => (
                Record {
                    of,
                    result: Ok(game),
                },
                Some(seen),
            ),
            Err(why) => (
                Record {
                    of,
                    result: Err(why),
                },
                None,
            ),
        }
    };
    let Ok(()) = play_in_order(games.len(), (threads, stop), one, |(record, seen)| {
        take(record, seen);
        Ok::<(), Infallible>(())
    });
}
