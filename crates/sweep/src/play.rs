//! The games of a sweep, played on several threads, and what is measured of each.

use crate::metric::METRICS;
use crate::plan::{Job, Plan};
use agent::MindRunner;
use analysis::quality::GameQuality;
use analysis::{BoatStatistics, StatisticsBuilder, Step};
use game::boat::Drive;
use game::event::EventCursor;
use game::{Outcome, Scenario, VehicleId};
use sim::Contest;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};

/// A game that was played, or could not be.
#[derive(Clone, Debug, PartialEq)]
pub struct Played {
    /// Which game.
    pub job: Job,
    /// By metric, NaN where there is none; or why the game could not start.
    pub result: Result<Vec<f64>, String>,
    /// Digest of the final state and of all events, hex.
    pub digest: String,
    /// By vehicle.
    pub boats: Vec<BoatRow>,
}

/// What a boat did in a game.
#[derive(Clone, Debug, PartialEq)]
pub struct BoatRow {
    /// What is measured of any game.
    pub statistics: BoatStatistics,
    /// Energy taken from its battery, kJ; NaN without one.
    pub energy_kj: f64,
    /// Whether it is one of the entry's.
    pub is_own: bool,
}

/// Scenarios of the point that is played, by entry and side.
#[derive(Default)]
pub(crate) struct Loaded {
    point: Option<usize>,
    scenarios: BTreeMap<(usize, usize), Result<Scenario, String>>,
}

impl Loaded {
    fn scenario(&mut self, plan: &Plan, job: &Job) -> &Result<Scenario, String> {
        if self.point.replace(job.point) != Some(job.point) {
            self.scenarios.clear();
        }
        let load = || plan.scenario(job.point, job.entry, job.side).map_err(|problems| problems.to_string());
        self.scenarios.entry((job.entry, job.side)).or_insert_with(load)
    }
}

/// Plays the games from `from` to before `to` on `jobs` threads until all are played or `stop` is set, and gives each to `take`, in
/// order. Games that `stop` cut short are not among them, nor any after those.
///
/// # Errors
/// What `take` says: then no more are played.
pub fn play<E>(
    plan: &Plan,
    (from, to): (usize, usize),
    jobs: NonZeroUsize,
    stop: &AtomicBool,
    take: impl FnMut(Played) -> Result<(), E>,
) -> Result<(), E> {
    play_each(plan, to.saturating_sub(from), &|i| plan.job(from + i), (jobs, stop), take)
}

/// The same for any games of a plan, in their order.
pub(crate) fn play_jobs<E>(
    plan: &Plan,
    order: &[Job],
    jobs: NonZeroUsize,
    stop: &AtomicBool,
    take: impl FnMut(Played) -> Result<(), E>,
) -> Result<(), E> {
    play_each(plan, order.len(), &|i| order[i], (jobs, stop), take)
}

fn play_each<E>(
    plan: &Plan,
    count: usize,
    job: &(dyn Fn(usize) -> Job + Sync),
    (jobs, stop): (NonZeroUsize, &AtomicBool),
    mut take: impl FnMut(Played) -> Result<(), E>,
) -> Result<(), E> {
    /// Games that may wait to be taken.
    const QUEUE: usize = 64;
    let next = AtomicUsize::new(0);
    let refused = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let (sender, receiver) = sync_channel(QUEUE);
        for _ in 0..jobs.get().min(count) {
            let (next, sender, refused) = (&next, sender.clone(), &refused);
            scope.spawn(move || work(plan, (next, count), job, [stop, refused], &sender));
        }
        drop(sender);
        let (mut waiting, mut due) = (BTreeMap::new(), 0);
        for (i, played) in receiver {
            waiting.insert(i, played);
            while let Some(played) = waiting.remove(&due) {
                due += 1;
                take(played).inspect_err(|_| refused.store(true, Ordering::Relaxed))?;
            }
        }
        Ok(())
    })
}

/// What one thread does: the next game that nobody has taken, until there is none.
fn work(
    plan: &Plan,
    (next, count): (&AtomicUsize, usize),
    job: &(dyn Fn(usize) -> Job + Sync),
    stops: [&AtomicBool; 2],
    sender: &SyncSender<(usize, Played)>,
) {
    let is_stopped = || stops.iter().any(|stop| stop.load(Ordering::Relaxed));
    let mut loaded = Loaded::default();
    loop {
        let i = next.fetch_add(1, Ordering::Relaxed);
        if i >= count || is_stopped() {
            return;
        }
        let played = one(plan, job(i), &mut loaded, &is_stopped);
        // A game that was stopped is no game.
        if is_stopped() || sender.send((i, played)).is_err() {
            return;
        }
    }
}

/// Plays one game.
#[must_use]
pub fn play_one(plan: &Plan, index: usize) -> Played {
    one(plan, plan.job(index), &mut Loaded::default(), &|| false)
}

fn one(plan: &Plan, job: Job, loaded: &mut Loaded, is_stopped: &dyn Fn() -> bool) -> Played {
    let failed = |why: String| Played { job, result: Err(why), digest: String::new(), boats: vec![] };
    let scenario = match loaded.scenario(plan, &job) {
        Ok(scenario) => scenario.of_seed(job.seed).map_err(|problems| problems.to_string()),
        Err(why) => Err(why.clone()),
    };
    let scenario = match scenario {
        Ok(scenario) => scenario,
        Err(why) => return failed(why),
    };
    let mut watch = Watch::new(&scenario, job.side);
    let outcome = arena::play_observed(&scenario, agent::minds_of(&scenario), job.seed, |contest, runner| {
        watch.see(contest, runner);
        !is_stopped()
    });
    match outcome {
        Ok(outcome) => watch.end(job, &outcome),
        Err(why) => failed(why.to_string()),
    }
}

/// Looks on at a game.
struct Watch<'a> {
    scenario: &'a Scenario,
    cursor: EventCursor,
    quality: GameQuality,
    statistics: StatisticsBuilder<'a>,
    /// The least distance of any two boats' centres, m.
    closest_m: f64,
    /// The least distances to the edge of the field, of the entry's boats and of its opponent's, m.
    edges_m: [f64; 2],
    /// The entry's team.
    side: usize,
    /// By vehicle: energy taken from its battery, kJ.
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
            let edge_m = &mut self.edges_m[usize::from(self.scenario.vehicles[i].team.index() != self.side)];
            *edge_m = edge_m.min(self.scenario.field.inside_by_m(at));
        }
        for (i, energy_kj) in self.energies_kj.iter_mut().enumerate() {
            if let Drive::Thrusters { thruster, .. } = &self.scenario.boat_of(VehicleId::at(i)).drive
                && let Some(battery) = &thruster.flaws.battery
            {
                let spent = battery.charge - contest.world().state().flaws[i].charge;
                *energy_kj = spent * battery.capacity_joule / 1000.0;
            }
        }
    }

    fn end(self, job: Job, outcome: &Outcome) -> Played {
        let Watch { scenario, quality, statistics, energies_kj, closest_m, .. } = self;
        let nearness = quality.end().encounters.all();
        let own = &scenario.teams[job.side].name;
        let boat = |(statistics, energy_kj): (BoatStatistics, f64)| BoatRow {
            is_own: statistics.team == *own,
            statistics,
            energy_kj,
        };
        let boats: Vec<BoatRow> = statistics.end().into_iter().zip(energies_kj).map(boat).collect();
        let team = |is_own: bool, edge_m: f64| {
            let name = &scenario.teams[if is_own { job.side } else { 1 - job.side }].name;
            let counts = outcome.counts.teams[name];
            let sum =
                |of: &dyn Fn(&BoatRow) -> f64| boats.iter().filter(|boat| boat.is_own == is_own).map(of).sum::<f64>();
            [
                f64::from(outcome.score.teams[name]),
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
                edge_m,
            ]
        };
        let (ours, theirs) = (team(true, self.edges_m[0]), team(false, self.edges_m[1]));
        let won = match &outcome.winner {
            Some(winner) => f64::from(u8::from(winner == own)),
            None => 0.5,
        };
        let mut numbers = vec![won];
        numbers.extend(ours);
        numbers.extend(theirs);
        numbers.push(ours[0] - theirs[0]);
        numbers.extend([nearness.contacts as f64, nearness.near_misses as f64]);
        numbers.extend([if closest_m.is_finite() { closest_m } else { f64::NAN }, outcome.duration_s]);
        assert_eq!(numbers.len(), METRICS.len(), "a number for each metric");
        Played { job, result: Ok(numbers), digest: outcome.digest.clone(), boats }
    }
}
