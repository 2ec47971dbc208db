//! Futures of a recorded game: the same past up to a given time, and then other minds and other random numbers.

use crate::pipeline::{Game, play_in_order};
use agent::MindRunner;
use messages::input::Input;
use primitives::reseed::Reseed;
use primitives::{SimTime, VehicleId};
use scenario::Scenario;
use scenario::strategy::Strategy;
use sim::{Contest, NoStart};
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;

/// A game up to a given time.
pub struct Past {
    /// The game, with its seed.
    pub scenario: Scenario,
    /// All inputs of the recorded game, in order.
    pub inputs: Vec<Input>,
    /// The time after which futures differ.
    pub until: SimTime,
}

/// Boats that continue with other minds, and the strategies that these follow.
pub type Changes<'a> = &'a [(VehicleId, Box<Strategy>)];

/// Plays the past and one of its futures, in which everything is drawn by `seed`. All minds see what
/// they saw in the past. Stops when `watch`, which sees the contest before every decision and at the
/// end, returns `false`. Returns the contest.
///
/// # Errors
/// If the game cannot start.
pub fn play(
    past: &Past,
    changes: Changes<'_>,
    seed: u64,
    mut watch: impl FnMut(&mut Contest) -> bool,
) -> Result<Contest, NoStart> {
    let reseed = vec![Reseed {
        after_s: past.until.as_s(),
        seed,
    }];
    let scenario = Scenario {
        reseed,
        ..past.scenario.clone()
    };
    let mut contest = Contest::new(&scenario, scenario.seed)?;
    let mut runner: MindRunner = arena::runner_of(agent::minds_of(&scenario));
    for input in &past.inputs {
        if *input == Input::Pictured {
            if contest.now() >= past.until || !watch(&mut contest) {
                break;
            }
            let stamp = contest.pictures()[0].stamp;
            runner.decide(stamp, |vehicle| Some(contest.picture_of(vehicle)));
        }
        contest.give(*input);
    }
    for (vehicle, strategy) in changes {
        runner.replace(*vehicle, agent::mind_by(&scenario, *vehicle, strategy));
    }
    while watch(&mut contest) && !contest.is_over() {
        arena::decide(&mut contest, &mut runner);
        contest.advance();
    }
    Ok(contest)
}

/// Plays futures numbered from 0: each as recorded and with the changes, both with the same random numbers.
/// Passes the games to `take` in order.
///
/// # Errors
/// That of `take`, which ends the games, and the reason why a game cannot start.
pub fn compare(
    past: &Past,
    changes: Changes<'_>,
    futures: usize,
    (threads, stop): (NonZeroUsize, &AtomicBool),
    mut take: impl FnMut([Game; 2]) -> Result<(), String>,
) -> Result<(), String> {
    play_in_order(
        futures,
        (threads, stop),
        |(), i, stop| {
            let game = |changes| {
                let contest = play(past, changes, seed_of(past, i), |_| !stop.is_set());
                let contest = contest.map_err(|why| why.to_string())?;
                Ok::<Game, String>(Game::new(&past.scenario, contest.outcome()))
            };
            Ok::<_, String>([game(&[])?, game(changes)?])
        },
        |games| take(games?),
    )
}

/// The seed of a future.
pub fn seed_of(past: &Past, future: usize) -> u64 {
    // Far from the seeds that people use, so that the first future is not that of another recorded game.
    past.scenario.seed.wrapping_add(1_000_003 + future as u64) & (i64::MAX as u64)
}
