//! Futures of a recorded game.

use experiment::whatif::{Past, compare, play, seed_of};
use primitives::reseed::Reseed;
use primitives::{SimTime, VehicleId};
use scenario::Scenario;
use scenario::strategy::Strategy;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// The moment from which futures differ, s.
const UNTIL_S: f64 = 5.0;

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
    let future = play(&past, &[], seed, |contest| {
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
    let idle = scenario::load_file::<Strategy>(&shipped("strategies/idle")).unwrap();
    let changes = [0, 1].map(|boat| (VehicleId(boat), Box::new(idle.clone())));
    let played = |threads: usize| {
        let mut all = vec![];
        let threads = NonZeroUsize::new(threads).unwrap();
        let taken = compare(
            &past,
            &changes,
            6,
            (threads, &AtomicBool::new(false)),
            |games| {
                all.push(games);
                Ok(())
            },
        );
        taken.unwrap();
        all
    };
    let futures = played(1);
    assert_eq!(futures, played(2), "whatever the number of threads");
    let grabs = |of: usize| {
        futures
            .iter()
            .map(|games| games[of].counts[0].grabs)
            .sum::<u32>()
    };
    assert!(
        grabs(0) > grabs(1),
        "idle boats grab less: {} {}",
        grabs(0),
        grabs(1)
    );
    let first = &futures[0];
    assert_ne!(first[0].digest, first[1].digest);
}
