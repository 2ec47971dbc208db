//! Restarted environments, games with given seeds, policies for one boat of a team, and setups as
//! users write them.

use super::fixture::{checked, file, raw, written};
use agent::{Action, ObservationSpace};
use learn::environment::{CriticInput, Games, RawObservation, RawSetup, SetupError};
use primitives::TeamId;
use scenario::Drawn;

fn games(raw: &RawSetup, count: usize, seed: u64) -> Games {
    Games::new(checked(raw), count, 1, seed, None).unwrap()
}

fn step(games: &mut Games, action: usize) {
    written(games, |games, rows| {
        let actions = vec![Action::Discrete(action); games.rows().0];
        games.step(&actions, true, rows).expect("new games begin");
    });
}

/// The observations after updating those of new games.
fn shown(games: &mut Games) -> Vec<f32> {
    written(games, |games, rows| games.show(rows))
}

fn seeds(games: &Games) -> Vec<u64> {
    (0..games.rows().0 / games.rows().1)
        .map(|game| games.standing(game).seed)
        .collect()
}

#[test]
fn seeds_count_up_and_can_be_chosen_anew() {
    let mut games = games(&raw(), 3, 10);
    assert_eq!(seeds(&games), [10, 11, 12]);
    games.restart(None).unwrap();
    assert_eq!(seeds(&games), [13, 14, 15]);
    games.restart(Some(4)).unwrap();
    assert_eq!(seeds(&games), [4, 5, 6]);
    games.restart_game(1, Some(2)).unwrap();
    games.restart_game(2, None).unwrap();
    assert_eq!(seeds(&games), [4, 2, 9]);
    (0..10).for_each(|_| step(&mut games, 3));
    assert_eq!(
        games
            .finished()
            .iter()
            .map(|one| one.standing.seed)
            .collect::<Vec<_>>(),
        [4, 2, 9]
    );
    assert_eq!(seeds(&games), [7, 5, 12]);
}

#[test]
fn a_game_restarted_by_its_seed_is_the_same_again() {
    let mut played = games(&raw(), 2, 20);
    (0..14).for_each(|_| step(&mut played, 3));
    // In the second episode of the second game, four steps later.
    let mut again = games(&raw(), 1, 1);
    again.restart_game(0, Some(23)).unwrap();
    (0..4).for_each(|_| step(&mut again, 3));
    assert_eq!(played.standing(1), again.standing(0));
    assert_eq!(played.contest(1).digest(), again.contest(0).digest());
}

#[test]
fn a_game_that_goes_on_is_not_observed_again() {
    let mut games = games(&raw(), 2, 20);
    let first = shown(&mut games);
    games.restart_game(1, Some(21)).unwrap();
    let again = shown(&mut games);
    let half = first.len() / 2;
    assert!(first[half..] == again[half..] && again[..half].iter().all(|number| *number == 9.0));
}

#[test]
fn a_seed_beyond_the_starts_is_refused() {
    let mut games = games(
        &RawSetup {
            starts: Some(3),
            ..raw()
        },
        1,
        5,
    );
    games.restart_game(0, Some(7)).unwrap();
    let error = games.restart_game(0, Some(8)).unwrap_err().to_string();
    assert!(error.starts_with("seed is 8, expected 5 to 7"), "{error}");
}

#[test]
fn a_policy_of_one_boat_has_each_boat_by_turns() {
    let raw = RawSetup {
        mates: Some(file("strategies/strategy_2.toml")),
        ..raw()
    };
    let one = games(&raw, 8, 0);
    assert_eq!(one.rows(), (8, 1));
    let boats: Vec<usize> = (0..8)
        .map(|game| one.boats(game)[0].unwrap().index())
        .collect();
    assert_eq!(boats, [0, 2, 1, 3, 0, 2, 1, 3]);
    let both = games(
        &RawSetup {
            opponents: vec![(1.0, None)],
            ..raw
        },
        2,
        0,
    );
    assert_eq!((both.rows(), both.boats(1).len()), ((4, 2), 2));
}

#[test]
fn a_side_that_is_named_learns() {
    let games = games(
        &RawSetup {
            team: Some("red".to_owned()),
            ..raw()
        },
        4,
        0,
    );
    assert!((0..4).all(|game| games.standing(game).side.learner == TeamId(1)));
}

#[test]
fn standings_are_what_the_outcome_says() {
    let mut games = games(
        &RawSetup {
            episode_max_s: None,
            opponents: vec![(1.0, None)],
            ..raw()
        },
        1,
        3,
    );
    // Full ahead until every boat has left the field.
    (0..300).for_each(|_| step(&mut games, 4));
    let standing = games.standing(0);
    let outcome = games.contest(0).outcome();
    assert_eq!(standing.steps, 300);
    for (place, team) in [
        standing.side.learner.index(),
        1 - standing.side.learner.index(),
    ]
    .into_iter()
    .enumerate()
    {
        let name = &games.setup().scenario.teams[team].name;
        assert_eq!(standing.counts[place], outcome.counts.teams[name]);
        assert_eq!(standing.score[place], outcome.score.teams[name]);
        assert!(standing.counts[place].out_of_bounds > 0);
    }
}

#[test]
fn what_is_wrong_with_a_setup_is_said() {
    let nowhere = || Some(file("strategies/nowhere.toml"));
    for (raw, message) in [
        (
            RawSetup {
                decision_s: Some(0.25),
                ..raw()
            },
            "decision_s is 0.25, expected a multiple of the game's decision_s (0.1 s)",
        ),
        (
            RawSetup {
                decision_s: Some(-0.5),
                ..raw()
            },
            "decision_s is -0.5",
        ),
        (
            RawSetup {
                episode_max_s: Some(f64::NAN),
                ..raw()
            },
            "episode_max_s is NaN, expected more than 0",
        ),
        (
            RawSetup {
                starts: Some(0),
                ..raw()
            },
            "starts is 0",
        ),
        (
            RawSetup {
                discount: 1.5,
                ..raw()
            },
            "discount is 1.5, expected 0 to 1",
        ),
        (
            RawSetup {
                team: Some("green".to_owned()),
                ..raw()
            },
            "team is \"green\", expected \"blue\" or \"red\"",
        ),
        (
            RawSetup {
                opponents: vec![(-1.0, None)],
                ..raw()
            },
            "an opponent's weight is -1",
        ),
        (
            RawSetup {
                opponents: vec![(1.0, nowhere())],
                ..raw()
            },
            "nowhere.toml",
        ),
        (
            RawSetup {
                mates: nowhere(),
                ..raw()
            },
            "nowhere.toml",
        ),
        (
            RawSetup {
                helm: Some(file("strategies/pav01.toml")),
                ..raw()
            },
            "has no behaviour of kind",
        ),
        (
            RawSetup {
                game: file("games/uneven_3v2.toml"),
                ..raw()
            },
            "the teams have 3 and 2 boats",
        ),
    ] {
        let error = raw
            .check()
            .map(|_| ())
            .map_err(|error: SetupError| error.to_string());
        assert!(
            error.as_ref().is_err_and(|error| error.contains(message)),
            "{message}: {error:?}"
        );
    }
    let observation = RawObservation::Squall { frames: 0 };
    assert!(
        RawSetup {
            observation,
            ..raw()
        }
        .check()
        .is_err()
    );
}

#[test]
fn team_sizes_must_fit_the_game_and_the_spaces() {
    let pyquaticus = RawObservation::Space(ObservationSpace::Pyquaticus);
    let squall = raw().observation;
    let sizes = "expected two ascending numbers from 1 to 2, the game's team size";
    let spaces = "expected observation \"squall\"";
    for (team_sizes, observation, message) in [
        ([[1, 3]; 2], squall, sizes),
        ([[1, 2], [1, 3]], squall, sizes),
        ([[2, 1]; 2], squall, sizes),
        ([[0, 1]; 2], squall, sizes),
        ([[1, 2]; 2], pyquaticus, spaces),
    ] {
        let raw = RawSetup {
            team_sizes: Some(team_sizes),
            observation,
            ..raw()
        };
        let error = raw.check().map(|_| ()).map_err(|error| error.to_string());
        assert!(
            error.as_ref().is_err_and(|error| error.contains(message)),
            "{team_sizes:?}: {error:?}"
        );
    }
}

#[test]
fn each_team_has_sizes_of_its_own_and_a_critic_sees_absent_boats_as_zeros() {
    let raw = RawSetup {
        team_sizes: Some([[1, 1], [1, 2]]),
        opponents: vec![(1.0, None)],
        critic: CriticInput::Truth,
        team: Some("blue".to_owned()),
        ..raw()
    };
    let mut games = games(&raw, 20, 0);
    shown(&mut games);
    let setup = games.setup();
    assert_eq!((games.rows().1, setup.rows_per_team()), (4, 2));
    let size = setup.truth_size();
    let mut both = 0;
    for game in 0..20 {
        let boats = games.boats(game);
        let has_boat: Vec<bool> = boats.iter().map(Option::is_some).collect();
        assert!(has_boat[..3] == [true, false, true], "{has_boat:?}");
        both += u32::from(has_boat[3]);
        let played = games.contest(game).scenario();
        for (row, whole) in [(0, 0), (2, 2), (3, 3)] {
            let boat = boats[row].map(|boat| setup.whole_game_boat(played, boat).index());
            assert!(boat.is_none_or(|boat| boat == whole), "row {row}: {boat:?}");
        }
        // The boat itself, a teammate, two enemies, and the game.
        let (truth, _) = games.truth(game);
        assert_eq!(truth.len(), 4 * size);
        for (row, values) in truth.chunks_exact(size).enumerate() {
            let slots = values.chunks_exact(11).take(4);
            let known: Vec<bool> = slots.map(|slot| slot.iter().any(|x| *x != 0.0)).collect();
            let want = match row {
                0 => [true, false, true, has_boat[3]],
                1 => [false; 4],
                2 => [true, has_boat[3], true, false],
                _ if !has_boat[3] => [false; 4],
                _ => [true, true, true, false],
            };
            assert_eq!(known, want, "row {row}");
        }
    }
    assert!((4..=16).contains(&both), "{both} of 20 with two red boats");
}

#[test]
fn a_game_with_fleets_of_random_size_is_not_for_learning() {
    let mut setup = checked(&raw());
    setup.scenario.drawn.push(Drawn {
        parameter: "game/fleet.0.count".to_owned(),
        value: 3.0,
    });
    let error = setup.check().unwrap_err().to_string();
    assert!(error.contains("`team_sizes`"), "{error}");
}

#[test]
fn room_for_other_boats_is_that_of_the_game() {
    let setup = raw().check().unwrap();
    assert_eq!(setup.observation_names().len(), setup.observation_size());
    assert_eq!(
        (
            setup.observation_size(),
            setup.decisions_per_step,
            setup.steps_max
        ),
        (2 * 92, 5, Some(10))
    );
}
