//! Turning points: how the chance of winning changed during a recorded game, and how much each boat
//! contributed, estimated from futures that start at many moments.

use crate::Estimate;
use crate::pipeline::{Game, play_in_order};
use crate::whatif::{Changes, Moment, Past, future_of, seed_of};
use agent::MindRunner;
use messages::helm::HelmReport;
use parking_lot::Mutex;
use primitives::{SimTime, VehicleId};
use scenario::Scenario;
use scenario::outcome::EventOutcome;
use scenario::strategy::Strategy;
use serde::{Deserialize, Serialize};
use sim::Contest;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// Minimum time between two moments with futures, s.
const STEP_S: f64 = 5.0;
/// Number of moments on each side of a change whose futures are used to estimate it.
const WINDOW: usize = 3;
/// Number of changes that get more futures in each round.
const REFINED: usize = 6;
/// Maximum number of reported turning points.
const REPORTED: usize = 5;
/// The 97.5 % quantile of the normal distribution.
const NORMAL_975: f64 = 1.96;

/// The games to play.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Total number of futures for the curve.
    pub futures: usize,
    /// Number of games from the start in which each boat is replaced by the baseline; as many are
    /// played as recorded, for comparison.
    pub futures_of_boat: usize,
    /// The strategy that replaces each boat's strategy in turn.
    pub baseline: Strategy,
}

/// How the chances of winning changed in a recorded game.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// The teams. Chances are the first team's; a draw counts half.
    pub teams: [String; 2],
    /// The chance of winning over time.
    pub curve: Vec<Point>,
    /// The largest changes whose intervals exclude zero, by time.
    pub turning_points: Vec<TurningPoint>,
    /// Each boat's contribution, by vehicle index.
    pub boats: Vec<Added>,
}

/// The chance of winning at a moment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Time, s.
    pub at_s: f64,
    /// The first team's chance with its 95 % interval, from the futures of this moment and its
    /// neighbours. At the end of the game, its result.
    pub chance: Estimate,
    /// Number of futures from this moment.
    pub futures: usize,
}

/// A change of the chance of winning.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TurningPoint {
    /// The time before the change, s.
    pub from_s: f64,
    /// The time after the change, s.
    pub to_s: f64,
    /// The chances before and after.
    pub chance: [f64; 2],
    /// The difference of the chances, with its 95 % interval.
    pub change: Estimate,
    /// The events around the change, from the moment before `from_s` to the moment after `to_s`.
    pub events: Vec<EventOutcome>,
    /// The decisions of the boats involved in the events, or of all boats if there are no events.
    pub decisions: Vec<BoatDecision>,
}

/// A boat's decision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoatDecision {
    /// The boat.
    pub vehicle: String,
    /// The helm's mode.
    pub mode: String,
    /// Course, compass degrees; `None` if the boat holds.
    pub course_deg: Option<f64>,
    /// Speed, m/s; `None` if the boat holds.
    pub speed_m_s: Option<f64>,
}

/// A boat's contribution to its team, compared with the baseline in its place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Added {
    /// The boat.
    pub vehicle: String,
    /// Its team.
    pub team: String,
    /// The team's chance of winning minus its chance with the baseline.
    pub chance: Estimate,
    /// The team's lead in points minus its lead with the baseline.
    pub margin: Estimate,
}

/// The moments of a game, and the results of their futures.
struct Course {
    moments: Vec<Mutex<Moment>>,
    at: Vec<SimTime>,
    decisions: Vec<Vec<BoatDecision>>,
    /// By moment: the first team's result in each future: 1 for a win, 0.5 for a draw.
    values: Vec<Vec<f64>>,
    /// The end of the recorded game.
    end: Contest,
}

/// Plays the futures. `past` is the whole game. Calls `tell` after each of the [`games`] games
/// played. Returns `None` if `stop` was set.
///
/// # Errors
/// If the recording contains no decision, the game cannot start, or a mind cannot be copied.
pub fn turning_points(
    past: &Past,
    plan: &Plan,
    (threads, stop): (NonZeroUsize, &AtomicBool),
    mut tell: impl FnMut(),
) -> Result<Option<Report>, String> {
    let mut course = Course::of(past, plan.futures)?;
    let all: Vec<usize> = (0..course.at.len()).collect();
    let mut due = all.repeat((plan.futures / 2 / all.len()).max(1));
    let mut left = plan.futures;
    due.truncate(left);
    while !due.is_empty() && !stop.load(Ordering::Relaxed) {
        left -= due.len();
        course.play(past, &due, (threads, stop), &mut tell)?;
        due = course.next_round();
        due.truncate(left);
    }
    let boats = boats(past, &course.moments[0], plan, (threads, stop), &mut tell)?;
    if stop.load(Ordering::Relaxed) {
        return Ok(None);
    }
    Ok(Some(course.report(&past.scenario, boats)))
}

/// Number of games that [`turning_points`] plays.
pub fn games(scenario: &Scenario, plan: &Plan) -> usize {
    plan.futures + plan.futures_of_boat * (scenario.vehicles.len() + 1)
}

impl Course {
    /// Plays the game, and keeps a moment every five seconds, or at longer intervals if there are
    /// few `futures`.
    fn of(past: &Past, futures: usize) -> Result<Course, String> {
        let step_s = STEP_S.max(2.0 * past.until.as_s() / futures.max(1) as f64);
        let mut at = vec![];
        let mut decisions = vec![];
        let mut moments = vec![];
        let end = Moment::of(past, |contest, runner| {
            if contest.now().as_s() >= step_s * at.len() as f64 {
                at.push(contest.now());
                decisions.push(decisions_of(contest.scenario(), runner));
                moments.push(Moment::copy_of(contest, runner).map(Mutex::new));
            }
            true
        });
        if at.is_empty() {
            return Err("the recording contains no decision".to_owned());
        }
        Ok(Course {
            values: vec![vec![]; at.len()],
            moments: moments.into_iter().collect::<Result<_, _>>()?,
            at,
            decisions,
            end: end.map_err(|why| why.to_string())?.contest,
        })
    }

    /// Plays one future of each of these moments.
    fn play(
        &mut self,
        past: &Past,
        due: &[usize],
        run: (NonZeroUsize, &AtomicBool),
        tell: &mut impl FnMut(),
    ) -> Result<(), String> {
        // Futures of different moments with the same number use the same random numbers.
        let mut counts: Vec<usize> = self.values.iter().map(Vec::len).collect();
        let futures: Vec<(usize, usize)> = due
            .iter()
            .map(|moment| {
                counts[*moment] += 1;
                (*moment, counts[*moment] - 1)
            })
            .collect();
        let Course {
            moments, values, ..
        } = self;
        let none = Changes::default();
        play_in_order(
            futures.len(),
            run,
            |(), i, stop| {
                let (moment, future) = futures[i];
                let seed = seed_of(past, future);
                let game = future_of(&past.scenario, &moments[moment], (seed, &none), stop)?.game;
                Ok::<_, String>((moment, game))
            },
            |played| {
                let (moment, game) = played?;
                values[moment].push(value(game.winner));
                tell();
                Ok(())
            },
        )
    }

    /// The values of the futures on both sides of the change after moment `i`.
    fn sides(&self, i: usize) -> [Vec<f64>; 2] {
        let [before, after] = self.windows(i);
        [before, after].map(|window| self.values[window].concat())
    }

    fn windows(&self, i: usize) -> [Range<usize>; 2] {
        let middle = i + 1;
        [
            middle.saturating_sub(WINDOW)..middle,
            middle..(middle + WINDOW).min(self.at.len()),
        ]
    }

    /// The largest changes, largest first, each far enough from larger ones.
    fn largest(&self) -> Vec<(usize, Estimate)> {
        let mut changes: Vec<(usize, Estimate)> = (0..self.at.len().saturating_sub(1))
            .map(|i| (i, difference(&self.sides(i))))
            .collect();
        changes.sort_by(|(_, a), (_, b)| b.mean.abs().total_cmp(&a.mean.abs()));
        let mut chosen: Vec<(usize, Estimate)> = vec![];
        for (i, change) in changes {
            if chosen.iter().all(|(other, _)| other.abs_diff(i) >= WINDOW) {
                chosen.push((i, change));
            }
        }
        chosen
    }

    /// The moments around the largest changes.
    fn next_round(&self) -> Vec<usize> {
        let largest = self.largest().into_iter().take(REFINED);
        largest
            .flat_map(|(i, _)| self.windows(i))
            .flatten()
            .collect()
    }

    fn report(&self, scenario: &Scenario, boats: Vec<Added>) -> Report {
        let mut curve: Vec<Point> = (0..self.at.len())
            .map(|i| {
                let near = i.saturating_sub(1)..(i + 2).min(self.at.len());
                Point {
                    at_s: self.at[i].as_s(),
                    chance: share(&self.values[near].concat()),
                    futures: self.values[i].len(),
                }
            })
            .collect();
        if self.end.is_over() {
            let result = value(Game::new(scenario, self.end.outcome()).winner);
            curve.push(Point {
                at_s: self.end.now().as_s(),
                chance: Estimate {
                    mean: result,
                    low: Some(result),
                    high: Some(result),
                },
                futures: 0,
            });
        }
        let is_clear = |change: &Estimate| change.low > Some(0.0) || change.high < Some(0.0);
        let mut turning_points: Vec<TurningPoint> = self
            .largest()
            .into_iter()
            .filter(|(_, change)| is_clear(change))
            .take(REPORTED)
            .map(|(i, change)| self.turning_point(scenario, i, change))
            .collect();
        turning_points.sort_by(|a, b| a.from_s.total_cmp(&b.from_s));
        Report {
            teams: [0, 1].map(|team| scenario.teams[team].name.clone()),
            curve,
            turning_points,
            boats,
        }
    }

    fn turning_point(&self, scenario: &Scenario, i: usize, change: Estimate) -> TurningPoint {
        let [from, to] = [self.at[i], self.at[i + 1]];
        // Up to the middle moments of both windows.
        let last = self.at.len() - 1;
        let around = self.at[i.saturating_sub(1)]..=self.at[(i + 2).min(last)];
        let events: Vec<EventOutcome> = self
            .end
            .events()
            .iter()
            .filter(|logged| around.contains(&logged.at))
            .map(|logged| EventOutcome::new(scenario, logged))
            .collect();
        let takes_part = |boat: &BoatDecision| {
            let is = |name: &Option<String>| name.as_ref() == Some(&boat.vehicle);
            events.is_empty()
                || events
                    .iter()
                    .any(|event| is(&event.vehicle) || is(&event.other))
        };
        let decisions = self.decisions[i].iter().filter(|boat| takes_part(boat));
        TurningPoint {
            from_s: from.as_s(),
            to_s: to.as_s(),
            chance: self.sides(i).map(|values| share(&values).mean),
            change,
            decisions: decisions.cloned().collect(),
            events,
        }
    }
}

/// The value of a game for the first team.
fn value(winner: Option<usize>) -> f64 {
    match winner {
        Some(0) => 1.0,
        Some(_) => 0.0,
        None => 0.5,
    }
}

/// The share of wins. The interval adds two wins and two losses (Agresti and Coull, The American
/// Statistician 52, 1998), so that a few equal results do not give certainty.
fn share(values: &[f64]) -> Estimate {
    let [wins, count] = [values.iter().sum::<f64>(), values.len() as f64];
    let [centre, error] = moved(wins, count, 2.0);
    Estimate {
        mean: wins / count,
        low: Some((centre - NORMAL_975 * error).max(0.0)),
        high: Some((centre + NORMAL_975 * error).min(1.0)),
    }
}

/// The change of the share of wins. The interval adds a win and a loss on each side (Agresti and
/// Caffo, The American Statistician 54, 2000).
fn difference(sides: &[Vec<f64>; 2]) -> Estimate {
    let [wins, count] = [
        sides.each_ref().map(|values| values.iter().sum::<f64>()),
        sides.each_ref().map(|values| values.len() as f64),
    ];
    let [before, after] = [0, 1].map(|side| moved(wins[side], count[side], 1.0));
    let centre = after[0] - before[0];
    let half = NORMAL_975 * primitives::math::length(before[1], after[1]);
    Estimate {
        mean: wins[1] / count[1] - wins[0] / count[0],
        low: Some((centre - half).max(-1.0)),
        high: Some((centre + half).min(1.0)),
    }
}

/// The share with `more` additional wins and losses, and its standard error.
fn moved(wins: f64, count: f64, more: f64) -> [f64; 2] {
    let share = (wins + more) / (count + 2.0 * more);
    [share, (share * (1.0 - share) / (count + 2.0 * more)).sqrt()]
}

/// The decisions of all boats.
fn decisions_of(scenario: &Scenario, runner: &MindRunner) -> Vec<BoatDecision> {
    let reports = runner.minds().filter_map(|(_, mind)| mind.report());
    let decision = |report: HelmReport| BoatDecision {
        vehicle: scenario.vehicles[report.vehicle.index()].name.clone(),
        mode: report.mode,
        course_deg: report.course_deg,
        speed_m_s: report.speed_m_s,
    };
    reports.map(decision).collect()
}

/// Compares every boat with the baseline in its place, over whole games with the same random
/// numbers.
fn boats(
    past: &Past,
    start: &Mutex<Moment>,
    plan: &Plan,
    run: (NonZeroUsize, &AtomicBool),
    tell: &mut impl FnMut(),
) -> Result<Vec<Added>, String> {
    let count = past.scenario.vehicles.len();
    let mut games: Vec<Game> = vec![];
    // In each round of games, the first is as recorded, and in each of the others one boat is
    // replaced.
    play_in_order(
        plan.futures_of_boat * (count + 1),
        run,
        |(), i, stop| {
            let replaced = (i % (count + 1)).checked_sub(1).map(|boat| {
                let baseline = Box::new(plan.baseline.clone());
                (VehicleId::at(boat), baseline)
            });
            let changes = Changes {
                minds: replaced.into_iter().collect(),
                sea: None,
            };
            let seed = seed_of(past, i / (count + 1));
            future_of(&past.scenario, start, (seed, &changes), stop)
        },
        |game| {
            games.push(game?.game);
            tell();
            Ok::<_, String>(())
        },
    )?;
    let rounds: Vec<&[Game]> = games.chunks_exact(count + 1).collect();
    if rounds.is_empty() {
        return Ok(vec![]);
    }
    let added = |boat: usize| {
        let team = past.scenario.vehicles[boat].team;
        let sign = if team.index() == 0 { 1.0 } else { -1.0 };
        let difference = |of: fn(&Game) -> f64| {
            let each = rounds
                .iter()
                .map(|games| sign * (of(&games[0]) - of(&games[boat + 1])));
            Estimate::of(&each.collect::<Vec<_>>())
        };
        Added {
            vehicle: past.scenario.vehicles[boat].name.clone(),
            team: past.scenario.teams[team.index()].name.clone(),
            chance: difference(|game| value(game.winner)),
            margin: difference(|game| game.margin() as f64),
        }
    };
    Ok((0..count).map(added).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sides(wins: [usize; 2], counts: [usize; 2]) -> [Vec<f64>; 2] {
        [0, 1].map(|side| {
            let value = |i| if i < wins[side] { 1.0 } else { 0.0 };
            (0..counts[side]).map(value).collect()
        })
    }

    #[test]
    fn intervals_are_those_of_agresti() {
        // By R: DescTools::BinomDiffCI(56, 70, 48, 80, method = "ac").
        let change = difference(&sides([48, 56], [80, 70]));
        let want = [0.2, 0.0525, 0.3358];
        let got = [change.mean, change.low.unwrap(), change.high.unwrap()];
        // By R: binom::binom.agresti.coull(0, 10), whose 1.96² additional games are 4 here.
        let none = share(&[0.0; 10]);
        let want_none = [0.0, 0.0, 0.326];
        let got_none = [none.mean, none.low.unwrap(), none.high.unwrap()];
        for (got, want) in got.iter().zip(want).chain(got_none.iter().zip(want_none)) {
            assert!(
                (got - want).abs() < 1e-4 + 0.004 * f64::from(want == 0.326),
                "{got} {want}"
            );
        }
    }
}
