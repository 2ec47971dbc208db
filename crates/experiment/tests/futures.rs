//! Futures of a recorded game, and the turning points that they show.

use experiment::turning::{Plan, Report, games, turning_points};
use experiment::whatif::{Changes, Fan, Past, compare, play, seed_of};
use primitives::reseed::Reseed;
use primitives::{SimTime, VehicleId};
use scenario::Scenario;
use scenario::strategy::Strategy;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// The time from which futures differ, s.
const UNTIL_S: f64 = 5.0;

fn strategy(name: &str) -> Box<Strategy> {
    let path = shipped(&format!("strategies/{name}"));
    Box::new(scenario::load_file(&path).expect("a strategy"))
}

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../scenarios/{name}.toml"))
}

/// A game of a minute and a half, recorded, up to `UNTIL_S`.
fn past() -> Past {
    let mut scenario = scenario::load(&shipped("games/surveyor_2v2")).expect("a game");
    scenario.rules.time_limit = SimTime::from_s(90.0);
    let mut inputs = vec![];
    let minds = agent::minds_of(&scenario);
    let played = arena::play_watched(&scenario, minds, scenario.seed, |contest| {
        inputs.extend(contest.take_inputs());
        contest.keep_inputs();
        true
    });
    played.expect("it starts");
    Past {
        scenario,
        inputs,
        until: SimTime::from_s(UNTIL_S),
    }
}

/// The whole game.
fn whole() -> Past {
    let past = past();
    let until = past.scenario.rules.time_limit;
    Past { until, ..past }
}

#[test]
fn without_changes_a_future_is_the_game_that_its_minds_play() {
    let past = past();
    let seed = seed_of(&past, 3);
    let reseed = vec![Reseed {
        after_s: UNTIL_S,
        seed,
    }];
    let whole = Scenario {
        reseed,
        ..past.scenario.clone()
    };
    let want = arena::play(&whole, agent::minds_of(&whole), whole.seed).unwrap();
    let mut states = vec![];
    let future = play(&past, &Changes::default(), seed, |contest| {
        states.push((contest.now(), contest.digest()));
        true
    });
    assert_eq!(future.unwrap().outcome().digest, want.digest);
    let mut recorded = vec![];
    let again = arena::play_watched(
        &past.scenario,
        agent::minds_of(&past.scenario),
        past.scenario.seed,
        |contest| {
            recorded.push((contest.now(), contest.digest()));
            true
        },
    );
    assert_ne!(
        again.unwrap().digest,
        want.digest,
        "another seed, another future"
    );
    let until = recorded
        .iter()
        .take_while(|(now, _)| *now <= past.until)
        .count();
    assert_eq!(states[..until], recorded[..until], "the past is the same");
}

#[test]
fn changed_boats_follow_another_strategy_from_the_moment_on() {
    let past = past();
    let idle = strategy("idle");
    let changes = Changes {
        minds: [0, 1].map(|boat| (VehicleId(boat), idle.clone())).into(),
        sea: None,
    };
    let played = |threads: usize| {
        let mut all = vec![];
        let threads = NonZeroUsize::new(threads).unwrap();
        let taken = compare(
            &past,
            &changes,
            6,
            (threads, &AtomicBool::new(false)),
            |future| {
                all.push(future);
                Ok(())
            },
        );
        taken.unwrap();
        all
    };
    let futures = played(1);
    assert_eq!(futures, played(2), "whatever the number of threads");
    for (i, pair) in futures.iter().enumerate() {
        for (future, changes) in pair.iter().zip([&Changes::default(), &changes]) {
            let again = play(&past, changes, seed_of(&past, i), |_| true).unwrap();
            let want = again.outcome().digest;
            assert_eq!(future.game.digest, want, "as from the start");
            let (_, end) = future.scores.last().expect("a score at the moment");
            assert_eq!(*end, future.game.score);
        }
    }
    let grabs = |of: usize| {
        futures
            .iter()
            .map(|pair| pair[of].game.counts[0].grabs)
            .sum::<u32>()
    };
    assert!(
        grabs(0) > grabs(1),
        "idle boats grab less: {} {}",
        grabs(0),
        grabs(1)
    );
    let first = &futures[0];
    assert_ne!(first[0].game.digest, first[1].game.digest);
    let fan = Fan::of(
        futures.iter().map(|pair| &pair[0]),
        0,
        &[past.until.as_s(), 90.0],
    );
    let mut points: Vec<u32> = futures.iter().map(|pair| pair[0].game.score[0]).collect();
    points.sort_unstable();
    let at_end = fan.points.map(|points| points[1]);
    assert_eq!(
        at_end,
        [0, 1, 2, 4, 5].map(|rank| points[rank]),
        "the nearest ranks of six"
    );
}

#[test]
fn another_sea_takes_over_at_the_moment() {
    let past = past();
    let sea: scenario::sea::Sea = scenario::load_file(&shipped("seas/gale")).expect("a sea");
    let changes = Changes {
        minds: vec![],
        sea: Some(sea.clone()),
    };
    let seed = seed_of(&past, 0);
    let states = |changes: &Changes| {
        let mut states = vec![];
        play(&past, changes, seed, |contest| {
            let wind = contest.scenario().sea.wind.as_ref();
            let wind_m_s = wind.map_or(0.0, |wind| wind.speed_10m_m_s);
            states.push((contest.now(), contest.digest(), wind_m_s));
            true
        })
        .expect("it starts");
        states
    };
    let (calm, gale) = (states(&Changes::default()), states(&changes));
    let before = calm
        .iter()
        .take_while(|(now, ..)| *now <= past.until)
        .count();
    assert!(before > 10);
    let digests = |of: &[(SimTime, u128, f64)]| of.iter().map(|state| state.1).collect::<Vec<_>>();
    assert_eq!(digests(&calm[..before]), digests(&gale[..before]));
    assert_ne!(calm[before].1, gale[before].1, "from the first decision on");
    assert!(gale[before].2 > calm[before].2 + 10.0);
}

/// The report from a few futures of the game.
fn development(past: &Past, baseline: &str, threads: usize) -> Report {
    let plan = Plan {
        futures: 60,
        futures_of_boat: 6,
        baseline: *strategy(baseline),
    };
    let mut played = 0;
    let threads = NonZeroUsize::new(threads).expect("some threads");
    let run = (threads, &AtomicBool::new(false));
    let report = turning_points(past, &plan, run, || played += 1);
    assert_eq!(played, games(&past.scenario, &plan));
    report.expect("it plays").expect("it was not stopped")
}

#[test]
fn chances_are_those_of_futures_played_from_the_start() {
    let past = whole();
    let report = development(&past, "idle", 2);
    assert_eq!(
        report,
        development(&past, "idle", 1),
        "on any number of threads"
    );
    let (end, moments) = report.curve.split_last().unwrap();
    assert_eq!(moments.len(), 18, "every 5 s of 90 s");
    assert_eq!(moments.iter().map(|point| point.futures).sum::<usize>(), 60);
    assert_eq!((end.at_s, end.futures), (90.0, 0));
    let values = |i: usize| {
        let past = Past {
            until: SimTime::from_s(moments[i].at_s),
            ..past.clone()
        };
        let played = (0..moments[i].futures).map(move |future| {
            let contest =
                play(&past, &Changes::default(), seed_of(&past, future), |_| true).unwrap();
            let [blue, red] = [contest.score()[0], contest.score()[1]];
            f64::midpoint(f64::from(blue > red), f64::from(blue >= red))
        });
        played.collect::<Vec<f64>>()
    };
    for i in [0, 9] {
        let near = values_near(i, values);
        let want = near.iter().sum::<f64>() / near.len() as f64;
        let got = moments[i].chance;
        assert!((got.mean - want).abs() < 1e-12, "{want} {got:?}");
        assert!(got.low.unwrap() <= want && want <= got.high.unwrap());
    }
    for boat in &report.boats {
        assert!(
            boat.margin.high > Some(0.0),
            "worse than an idle boat: {boat:?}"
        );
    }
}

/// The values of a moment and its neighbours.
fn values_near(i: usize, values: impl Fn(usize) -> Vec<f64>) -> Vec<f64> {
    (i.saturating_sub(1)..=i + 1).flat_map(values).collect()
}

#[test]
fn a_boat_adds_nothing_if_the_baseline_is_what_it_plays() {
    let past = whole();
    for boat in development(&past, "pav01", 2).boats {
        let added = [boat.chance.mean, boat.margin.mean];
        assert_eq!(added, [0.0; 2], "{}", boat.vehicle);
    }
}
