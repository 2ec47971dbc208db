//! Plays the games of a sweep and measures them.

use super::metric::Metrics;
use super::plan::{Job, Plan};
use super::table::Row;
use crate::pipeline::{Game, Stop, play_game, play_in_order};
use agent::MindRunner;
use analysis::quality::GameQuality;
use analysis::{BoatStatistics, StatisticsBuilder, Step};
use primitives::VehicleId;
use rules::event::EventCursor;
use scenario::Scenario;
use scenario::boat::Drive;
use sim::Contest;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;

/// A game that was played or could not start.
#[derive(Clone, Debug, PartialEq)]
pub struct Played {
    /// The game's row in the table of games.
    pub row: Row,
    /// The measurements by vehicle.
    pub boats: Vec<BoatRow>,
}

/// The measurements of a boat in a game.
#[derive(Clone, Debug, PartialEq)]
pub struct BoatRow {
    /// The measurements common to all games.
    pub statistics: BoatStatistics,
    /// Energy drawn from the boat's battery, kJ; NaN without a battery.
    pub energy_kj: f64,
    /// Whether the boat belongs to the entry.
    pub is_own: bool,
}

/// The scenarios of the current point, by entry and side.
#[derive(Default)]
struct Loaded {
    point: Option<usize>,
    scenarios: BTreeMap<(usize, usize), Result<Scenario, String>>,
}

impl Loaded {
    fn scenario(&mut self, plan: &Plan, job: &Job) -> &Result<Scenario, String> {
        if self.point.replace(job.point) != Some(job.point) {
            self.scenarios.clear();
        }
        let load = || {
            plan.scenario(job.point, job.entry, job.side)
                .map_err(|problems| problems.to_string())
        };
        self.scenarios
            .entry((job.entry, job.side))
            .or_insert_with(load)
    }
}

/// Plays the games from `from` to `to` - 1 on several threads until all are played or `stop` is
/// set, and passes each to `take` in order. Games cut short by `stop`, and all later games, are
/// omitted.
///
/// # Errors
/// The error of `take`, which ends the games.
pub fn play<E>(
    plan: &Plan,
    (from, to): (usize, usize),
    threads: NonZeroUsize,
    stop: &AtomicBool,
    take: impl FnMut(Played) -> Result<(), E>,
) -> Result<(), E> {
    let one =
        |loaded: &mut Loaded, i: usize, stop: Stop<'_>| one(plan, plan.job(from + i), loaded, stop);
    play_in_order(to.saturating_sub(from), (threads, stop), one, take)
}

fn one(plan: &Plan, job: Job, loaded: &mut Loaded, stop: Stop<'_>) -> Played {
    let scenario = match loaded.scenario(plan, &job) {
        Ok(scenario) => scenario
            .of_seed(job.seed)
            .map_err(|problems| problems.to_string()),
        Err(why) => Err(why.clone()),
    };
    let played = scenario.and_then(|scenario| {
        let mut watch = Watch::new(&scenario, job.side);
        let game = play_game(&scenario, job.seed, stop, |contest, runner| {
            watch.see(contest, runner)
        })?;
        let (metrics, boats) = watch.end(&game);
        Ok((metrics, game.digest, boats))
    });
    let (result, digest, boats) = match played {
        Ok((metrics, digest, boats)) => (Ok(metrics), digest, boats),
        Err(why) => (Err(why), String::new(), vec![]),
    };
    Played {
        row: Row {
            job,
            boats: boats.len(),
            digest,
            result,
        },
        boats,
    }
}

/// Observes a game.
struct Watch<'a> {
    scenario: &'a Scenario,
    cursor: EventCursor,
    quality: GameQuality,
    statistics: StatisticsBuilder,
    /// The smallest distance between the centres of two boats, m.
    closest_m: f64,
    /// By team: the smallest distance of its boats from the edge of the field, m.
    edges_m: [f64; 2],
    /// The index of the entry's team.
    side: usize,
    /// Energy drawn from the battery, by vehicle, kJ.
    energies_kj: Vec<f64>,
}

impl<'a> Watch<'a> {
    fn new(scenario: &'a Scenario, side: usize) -> Watch<'a> {
        Watch {
            scenario,
            cursor: EventCursor::default(),
            quality: GameQuality::new(scenario),
            statistics: StatisticsBuilder::new(scenario),
            closest_m: f64::INFINITY,
            edges_m: [f64::INFINITY; 2],
            side,
            energies_kj: vec![f64::NAN; scenario.vehicles.len()],
        }
    }

    fn see(&mut self, contest: &Contest, runner: &MindRunner) {
        let orders = runner.orders().map(|(_, order)| order);
        let step = Step::of_frame(self.scenario, &contest.frame(&mut self.cursor), orders);
        self.quality.add(&step, &[]);
        self.statistics.add(&step);
        for (i, one) in step.samples.iter().enumerate() {
            let at = one.truth.at();
            for other in &step.samples[..i] {
                self.closest_m = at.distance(other.truth.at()).min(self.closest_m);
            }
            let edge_m =
                &mut self.edges_m[usize::from(self.scenario.vehicles[i].team.index() != 0)];
            *edge_m = edge_m.min(self.scenario.field.inside_by_m(at));
        }
        for (i, energy_kj) in self.energies_kj.iter_mut().enumerate() {
            if let Drive::Thrusters { thruster, .. } =
                &self.scenario.boat_of(VehicleId::at(i)).drive
                && let Some(battery) = &thruster.flaws.battery
            {
                let spent = battery.charge - contest.world().state().flaws[i].charge;
                *energy_kj = spent * battery.capacity_joule / 1000.0;
            }
        }
    }

    fn end(self, game: &Game) -> (Metrics, Vec<BoatRow>) {
        let Watch {
            scenario,
            quality,
            statistics,
            energies_kj,
            closest_m,
            edges_m,
            side,
            ..
        } = self;
        let nearness = quality.end().encounters.all();
        let own = &scenario.teams[side].name;
        let boat = |(statistics, energy_kj): (BoatStatistics, f64)| BoatRow {
            is_own: statistics.team == *own,
            statistics,
            energy_kj,
        };
        let boats: Vec<BoatRow> = statistics
            .end()
            .into_iter()
            .zip(energies_kj)
            .map(boat)
            .collect();
        // In the order of `METRICS`, from the score to the distance from the edge.
        let team = |team: usize| -> [f64; 12] {
            let counts = &game.counts[team];
            let is_own = team == side;
            let sum = |of: &dyn Fn(&BoatRow) -> f64| {
                boats
                    .iter()
                    .filter(|boat| boat.is_own == is_own)
                    .map(of)
                    .sum::<f64>()
            };
            [
                f64::from(game.score[team]),
                f64::from(counts.grabs),
                f64::from(counts.captures),
                f64::from(counts.tags),
                f64::from(counts.tagged),
                f64::from(counts.out_of_bounds),
                f64::from(counts.collisions),
                sum(&|boat| boat.statistics.tagged_s),
                sum(&|boat| boat.statistics.outside_s),
                sum(&|boat| boat.statistics.distance_m),
                sum(&|boat| boat.energy_kj),
                edges_m[team],
            ]
        };
        let own = team(side);
        let opponent = team(1 - side);
        let win_share = game
            .winner
            .map_or(0.5, |winner| f64::from(u8::from(winner == side)));
        let of_game = [
            own[0] - opponent[0],
            nearness.contacts as f64,
            nearness.near_misses as f64,
            if closest_m.is_finite() {
                closest_m
            } else {
                f64::NAN
            },
            game.duration_s,
        ];
        let all = [&[win_share], &own[..], &opponent, &of_game].concat();
        (
            Metrics(all.try_into().expect("a number for each metric")),
            boats,
        )
    }
}
