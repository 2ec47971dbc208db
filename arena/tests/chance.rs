//! A scenario knows whether its seed matters: games of two seeds differ exactly where it says so.

use game::Scenario;
use game::scenario::{Overrides, load_with};
use game::time::SimTime;
use std::path::Path;

/// What is left of the first minute of a game: it may depend on the seed nowhere else.
fn digest(scenario: &Scenario, seed: u64) -> String {
    let mut game = scenario.of_seed(seed).unwrap_or_else(|problems| panic!("{problems}"));
    game.rules.time_limit = SimTime::from_s(60.0);
    arena::play(&game, agent::minds_of(&game), seed).unwrap_or_else(|why| panic!("{why}")).digest
}

#[test]
fn two_seeds_are_two_games_where_a_scenario_is_random_and_one_where_it_is_not() {
    let games = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/games");
    let (mut random, mut fixed) = (0, 0);
    for entry in std::fs::read_dir(games).expect("the folder is there") {
        let path = entry.expect("it can be read").path();
        let rehearsal = Overrides { simulate_all: true, ..Overrides::default() };
        let scenario = load_with(&path, &rehearsal).unwrap_or_else(|problems| panic!("{problems}"));
        // Larger games are random by what smaller ones have too, and take long.
        if scenario.vehicles.len() > 8 {
            continue;
        }
        assert_eq!(digest(&scenario, 1) != digest(&scenario, 2), scenario.is_random(), "{}", scenario.name);
        *if scenario.is_random() { &mut random } else { &mut fixed } += 1;
    }
    assert!(random > 4 && fixed > 4, "{random} random games, {fixed} others");
}
