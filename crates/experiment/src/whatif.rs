//! Futures of a recorded game: the same past up to a given time, then other minds and other random
//! numbers.

use crate::pipeline::{Game, Stop, play_in_order};
use agent::MindRunner;
use messages::input::Input;
use parking_lot::Mutex;
use primitives::reseed::Reseed;
use primitives::{SimTime, VehicleId};
use scenario::Scenario;
use scenario::sea::Sea;
use scenario::strategy::Strategy;
use serde::Serialize;
use sim::{Contest, NoStart};
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;

/// A game up to a given time.
#[derive(Clone)]
pub struct Past {
    /// The game, with its seed.
    pub scenario: Scenario,
    /// All inputs of the recorded game, in order.
    pub inputs: Vec<Input>,
    /// The time of the decision after which futures differ.
    pub until: SimTime,
}

/// The changes to the recorded game after [`Past::until`].
#[derive(Clone, Debug, Default)]
pub struct Changes {
    /// Boats that continue with other minds, and the strategies that these follow.
    pub minds: Vec<(VehicleId, Box<Strategy>)>,
    /// The sea, if it changes.
    pub sea: Option<Sea>,
}

/// A future of a recorded game.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Future {
    /// The whole game.
    #[serde(flatten)]
    pub game: Game,
    /// The score from [`Past::until`] on, at each change: time, s, and points of both teams.
    pub scores: Vec<(f64, [u32; 2])>,
}

impl Future {
    /// The score at a time; before [`Past::until`], the first score.
    fn score_at(&self, at_s: f64) -> [u32; 2] {
        let after = self.scores.partition_point(|(since_s, _)| *since_s <= at_s);
        self.scores[after.saturating_sub(1)].1
    }
}

/// Quantiles of a [`Fan`]: the median, and the bounds of the middle 50 and 90 %.
pub const QUANTILES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// A team's points over time in many futures, for a fan chart.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fan {
    /// For each of [`QUANTILES`], the points at every time.
    pub points: [Vec<u32>; 5],
}

impl Fan {
    /// A team's fan at these times. Without futures it is empty.
    pub fn of<'a>(
        futures: impl Iterator<Item = &'a Future> + Clone,
        team: usize,
        times_s: &[f64],
    ) -> Fan {
        let mut points: [Vec<u32>; 5] = Default::default();
        for at_s in times_s {
            let mut all: Vec<u32> = futures
                .clone()
                .map(|future| future.score_at(*at_s)[team])
                .collect();
            all.sort_unstable();
            for (points, share) in points.iter_mut().zip(QUANTILES) {
                // The nearest rank, so that the chart shows scores that occurred.
                let rank = (share * all.len() as f64).ceil() as usize;
                points.extend(all.get(rank.saturating_sub(1)));
            }
        }
        Fan { points }
    }
}

/// A game at a moment, with its minds. It can be continued any number of times.
pub(crate) struct Moment {
    pub(crate) contest: Contest,
    runner: MindRunner,
}

impl Moment {
    /// A copy of a game and its minds.
    pub(crate) fn copy_of(contest: &Contest, runner: &MindRunner) -> Result<Moment, String> {
        Ok(Moment {
            contest: contest.clone(),
            runner: fork(runner)?,
        })
    }

    /// Plays the past. All minds see the same pictures as in the recorded game. Stops early when
    /// `watch`, which sees contest and minds before every decision, returns `false`.
    pub(crate) fn of(
        past: &Past,
        mut watch: impl FnMut(&mut Contest, &MindRunner) -> bool,
    ) -> Result<Moment, NoStart> {
        let mut contest = Contest::new(&past.scenario, past.scenario.seed)?;
        let mut runner: MindRunner = arena::runner_of(agent::minds_of(&past.scenario));
        for input in &past.inputs {
            if *input == Input::Pictured {
                if contest.now() >= past.until || !watch(&mut contest, &runner) {
                    break;
                }
                let stamp = contest.pictures()[0].stamp;
                runner.decide(stamp, |vehicle| Some(contest.picture_of(vehicle)));
            }
            contest.give(*input);
        }
        Ok(Moment { contest, runner })
    }

    /// This moment, with all later random numbers drawn with `seed`.
    pub(crate) fn reseeded(&self, seed: u64) -> Result<Moment, String> {
        let contest = self.contest.reseeded(seed);
        Ok(Moment {
            contest: contest.map_err(|why| why.to_string())?,
            runner: fork(&self.runner)?,
        })
    }

    /// Makes the changes and plays to the end, or until `watch`, which sees the contest before
    /// every decision and at the end, returns `false`.
    pub(crate) fn end(
        mut self,
        changes: &Changes,
        mut watch: impl FnMut(&mut Contest) -> bool,
    ) -> Result<Contest, NoStart> {
        if let Some(sea) = &changes.sea {
            self.contest = self.contest.in_sea(sea)?;
        }
        for (vehicle, strategy) in &changes.minds {
            let mind = agent::mind_by(self.contest.scenario(), *vehicle, strategy);
            self.runner.replace(*vehicle, mind);
        }
        while watch(&mut self.contest) && !self.contest.is_over() {
            arena::decide(&mut self.contest, &mut self.runner);
            self.contest.advance();
        }
        Ok(self.contest)
    }
}

/// A copy of all minds.
fn fork(runner: &MindRunner) -> Result<MindRunner, String> {
    let copy = runner.fork();
    copy.ok_or_else(|| {
        "a boat of this game is controlled by a program whose state cannot be copied".to_owned()
    })
}

/// Plays the past and one of its futures, with random numbers drawn with `seed`. Stops when
/// `watch`, which sees the contest before every decision and at the end, returns `false`. Returns
/// the contest. Its scenario has the seed, so that a recording of it can be replayed unless the sea
/// was changed.
///
/// # Errors
/// If the game cannot start.
pub fn play(
    past: &Past,
    changes: &Changes,
    seed: u64,
    mut watch: impl FnMut(&mut Contest) -> bool,
) -> Result<Contest, NoStart> {
    let mut past = past.clone();
    past.scenario.reseed.push(Reseed {
        after_s: past.until.as_s(),
        seed,
    });
    let moment = Moment::of(&past, |contest, _| watch(contest))?;
    moment.end(changes, watch)
}

/// Plays futures numbered from 0: each once as recorded and once with the changes, both with the
/// same random numbers. Passes them to `take` in order.
///
/// # Errors
/// The error of `take`, which ends the games, or the reason why a game cannot start.
pub fn compare(
    past: &Past,
    changes: &Changes,
    futures: usize,
    (threads, stop): (NonZeroUsize, &AtomicBool),
    mut take: impl FnMut([Future; 2]) -> Result<(), String>,
) -> Result<(), String> {
    let moment = Moment::of(past, |_, _| true).map_err(|why| why.to_string())?;
    let moment = Mutex::new(moment);
    play_in_order(
        futures,
        (threads, stop),
        |(), i, stop| {
            let future =
                |changes| future_of(&past.scenario, &moment, (seed_of(past, i), changes), stop);
            Ok::<_, String>([future(&Changes::default())?, future(changes)?])
        },
        |futures| take(futures?),
    )
}

/// Continues from a moment, with this seed and these changes, until the end or `stop`.
pub(crate) fn future_of(
    scenario: &Scenario,
    moment: &Mutex<Moment>,
    (seed, changes): (u64, &Changes),
    stop: Stop<'_>,
) -> Result<Future, String> {
    let future = moment.lock().reseeded(seed)?;
    let mut scores: Vec<(f64, [u32; 2])> = vec![];
    let contest = future.end(changes, |contest| {
        let score = [contest.score()[0], contest.score()[1]];
        if scores.last().is_none_or(|(_, last)| *last != score) {
            scores.push((contest.now().as_s(), score));
        }
        !stop.is_set()
    });
    let contest = contest.map_err(|why| why.to_string())?;
    Ok(Future {
        game: Game::new(scenario, contest.outcome()),
        scores,
    })
}

/// The seed of a future.
pub fn seed_of(past: &Past, future: usize) -> u64 {
    // Far from the seeds that people use, so that the first future is not the same as another
    // recorded game.
    past.scenario.seed.wrapping_add(1_000_003 + future as u64) & (i64::MAX as u64)
}
