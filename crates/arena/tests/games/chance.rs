//! A scenario knows whether its seed matters: games with two seeds differ if, and only if, the
//! scenario says so.

use crate::files::{played, shipped};
use primitives::reseed::Reseed;
use primitives::time::SimTime;
use scenario::{Overrides, Scenario, load_with};
use sim::Contest;

/// The digest of a game after its first minute.
fn digest(scenario: &Scenario, seed: u64) -> String {
    let mut game = scenario
        .of_seed(seed)
        .unwrap_or_else(|problems| panic!("{problems}"));
    game.rules.time_limit = SimTime::from_s(60.0);
    played(&game).digest
}

/// The shipped games with few boats. Larger ones have the same sources of randomness but take too
/// long.
fn small_games() -> Vec<Scenario> {
    let scenario = |entry: std::io::Result<std::fs::DirEntry>| {
        let path = entry.expect("it can be read").path();
        let rehearsal = Overrides {
            simulate_all: true,
            ..Overrides::default()
        };
        load_with(&path, &rehearsal).unwrap_or_else(|problems| panic!("{problems}"))
    };
    let all = std::fs::read_dir(shipped("games"))
        .expect("the folder is there")
        .map(scenario);
    all.filter(|scenario| scenario.vehicles.len() <= 8)
        .collect()
}

#[test]
fn another_seed_in_the_midst_leaves_what_was_before_and_changes_what_is_drawn_after() {
    const AFTER_S: f64 = 20.0;
    let mut changed = vec![];
    for scenario in small_games() {
        let with = |reseed: Vec<Reseed>| {
            let drawn = scenario
                .of_seed(3)
                .unwrap_or_else(|problems| panic!("{problems}"));
            let mut game = Scenario { reseed, ..drawn };
            game.rules.time_limit = SimTime::from_s(40.0);
            let mut digests = vec![];
            let played = arena::play_observed(&game, agent::minds_of(&game), 3, |contest, _| {
                digests.push((contest.now(), contest.digest()));
                true
            });
            played.unwrap_or_else(|why| panic!("{}: {why}", game.name));
            digests
        };
        let first = with(vec![]);
        let again = with(vec![Reseed {
            after_s: AFTER_S,
            seed: 77,
        }]);
        let before =
            |all: &[(SimTime, u128)]| all.iter().filter(|(now, _)| now.as_s() <= AFTER_S).count();
        assert_eq!(
            first[..before(&first)],
            again[..before(&again)],
            "{}",
            scenario.name
        );
        if first.last() != again.last() {
            assert!(scenario.is_random(), "{}", scenario.name);
            let same = first
                .iter()
                .zip(&again)
                .take_while(|(one, other)| one == other)
                .count();
            assert!(
                same < before(&first) + 20,
                "{} changes late: from decision {same} on",
                scenario.name
            );
            changed.push(scenario.name);
        }
    }
    assert!(changed.len() > 4, "{changed:?}");
}

#[test]
fn a_snapshot_from_either_side_of_another_seed_goes_on_as_the_game_did() {
    for scenario in small_games().into_iter().filter(Scenario::is_random) {
        let reseed = [(10.0, 5), (14.0, 6)]
            .map(|(after_s, seed)| Reseed { after_s, seed })
            .to_vec();
        let drawn = scenario
            .of_seed(3)
            .unwrap_or_else(|problems| panic!("{problems}"));
        let game = Scenario { reseed, ..drawn };
        let begin = || Contest::new(&game, 3).unwrap_or_else(|why| panic!("{why}"));
        let mut contest = begin();
        let mut snapshots = vec![];
        while contest.now() < SimTime::from_s(20.0) && !contest.is_over() {
            snapshots.push(contest.snapshot());
            contest.advance();
        }
        // Restores snapshots from the end backwards, without playing the parts in between.
        for snapshot in snapshots.iter().rev().step_by(45) {
            let mut other = begin();
            other
                .restore(snapshot)
                .unwrap_or_else(|why| panic!("{why}"));
            while other.now() < contest.now() {
                other.advance();
            }
            assert_eq!(other.digest(), contest.digest(), "{}", game.name);
        }
    }
}

#[test]
fn two_seeds_are_two_games_where_a_scenario_is_random_and_one_where_it_is_not() {
    let mut random = 0;
    let mut fixed = 0;
    for scenario in small_games() {
        assert_eq!(
            digest(&scenario, 1) != digest(&scenario, 2),
            scenario.is_random(),
            "{}",
            scenario.name
        );
        *if scenario.is_random() {
            &mut random
        } else {
            &mut fixed
        } += 1;
    }
    assert!(
        random > 4 && fixed > 4,
        "{random} random games, {fixed} others"
    );
}

#[test]
fn the_seed_matters_to_a_policy_that_draws_its_actions() {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("drawn.toml");
    let model = shipped("policies/primitive_tag.onnx")
        .canonicalize()
        .expect("it is there");
    let base = shipped("strategies/policy.toml")
        .canonicalize()
        .expect("it is there");
    let game = shipped("games/pyquaticus_2v2.toml");
    for is_sampled in [true, false] {
        let text = format!(
            "base = {base:?}\n[behaviour.learned]\nmodel = {model:?}\nsampled = {is_sampled}\n"
        );
        std::fs::write(&path, text).expect("it is written");
        let overrides = Overrides {
            strategies: [("blue".to_owned(), path.clone())].into(),
            ..Overrides::default()
        };
        let scenario = load_with(&game, &overrides).unwrap_or_else(|problems| panic!("{problems}"));
        assert_eq!(scenario.is_random(), is_sampled);
        assert_eq!(digest(&scenario, 1) != digest(&scenario, 2), is_sampled);
    }
}
