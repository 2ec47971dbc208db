//! Environments play the same games as the arena, on any number of threads.

use super::fixture::{begun, checked, file, raw, strategy};
use agent::{Action, ActionSpace, Mind, ObservationSpace, Pilot, Spaces};
use learn::environment::{
    Control, Player, RawObservation, RawSetup, Setup, Teacher, VectorEnvironment,
};
use learn::rewards::{Potential, Rewards, Worth};
use learn::training::CriticInput;
use messages::{Order, Picture};
use primitives::stream::Stream;
use primitives::{TeamId, VehicleId};
use std::collections::BTreeMap;

const SPACES: Spaces = Spaces {
    observation: ObservationSpace::Squall {
        mates: 1,
        enemies: 2,
        frames: 2,
    },
    action: ActionSpace::Pyquaticus,
};

fn setup(game: &str, opponents: Vec<(f64, Player)>) -> Setup {
    let worth = Worth {
        grab: 1.0,
        capture: 2.0,
        tag: 0.5,
        left_field: -1.0,
        ..Worth::default()
    };
    let rewards = Rewards {
        boat: worth,
        potential: Potential {
            attack: 1.0,
            untag: 0.5,
        },
        ..Rewards::default()
    };
    let game = file(&format!("games/{game}.toml"));
    let setup = checked(&RawSetup {
        game,
        episode_max_s: None,
        ..raw()
    });
    assert_eq!(setup.spaces, SPACES);
    Setup {
        opponents,
        rewards,
        ..setup
    }
}

/// An action that depends on the observation.
fn chosen(observation: &[f32]) -> Action {
    let sum: u32 = observation.iter().fold(7, |sum, number| {
        sum.wrapping_mul(31).wrapping_add(number.to_bits())
    });
    Action::Discrete(sum as usize % 17)
}

/// Plays a step with these actions.
fn act(environment: &mut VectorEnvironment) {
    let size = environment.setup().observation_size();
    let actions: Vec<Action> = environment
        .observations()
        .chunks_exact(size)
        .map(chosen)
        .collect();
    environment.step(&actions).unwrap();
}

fn played(threads: usize) -> (Vec<u32>, Vec<learn::environment::Finished>) {
    let opponents = vec![
        (1.0, Player::Policy),
        (1.0, Player::Strategy(strategy("pav01"))),
    ];
    let setup = Setup {
        steps_max: Some(120),
        ..setup("surveyor_2v2", opponents)
    };
    let mut environment = begun(setup, 6, threads, 11);
    let mut numbers = vec![];
    let mut finished = vec![];
    for _ in 0..300 {
        act(&mut environment);
        let shown = environment
            .observations()
            .iter()
            .chain(environment.rewards())
            .chain(environment.final_observations());
        numbers.extend(shown.map(|number| number.to_bits()));
        numbers.extend(environment.counts().iter().map(|counts| u32::from(*counts)));
        finished.extend_from_slice(environment.finished());
    }
    (numbers, finished)
}

#[test]
fn a_critic_is_given_the_truth_that_sensors_do_not_tell() {
    let opponents = vec![(1.0, Player::Policy)];
    let setup = Setup {
        critic: CriticInput::Truth,
        ..setup("surveyor_2v2", opponents)
    };
    let mut environment = begun(setup, 2, 1, 3);
    let observation = environment.setup().observation_size();
    let state = environment.setup().state_size();
    for _ in 0..40 {
        environment.step(&[Action::Discrete(3); 8]).unwrap();
    }
    let mut off_m = 0.0_f64;
    for (row, (state, observed)) in environment
        .states()
        .chunks_exact(state)
        .zip(environment.observations().chunks_exact(observation))
        .enumerate()
    {
        assert_eq!(&state[..observation], observed);
        let contest = environment.contest(row / 4);
        // The learning team's boats come first: in every second game, those of the second team.
        let me = VehicleId::at((row + if row / 4 == 0 { 2 } else { 0 }) % 4);
        let scenario = contest.scenario();
        let field = &scenario.field;
        let sign = if scenario.team_of(me).index() == 0 {
            1.0
        } else {
            -1.0
        };
        let truth = contest
            .frame(&mut rules::event::EventCursor::default())
            .vehicles[me.index()]
        .nav;
        let ahead =
            sign * (truth.at() - field.middle()).dot(field.along) / (0.5 * field.plan.width_m);
        assert!(
            (f64::from(state[observation]) - ahead).abs() < 1e-6,
            "row {row}: got {}, want {ahead}",
            state[observation]
        );
        off_m = off_m.max((f64::from(observed[0]) - ahead).abs() * 0.5 * field.plan.width_m);
    }
    assert!(off_m > 0.05, "the sensors' largest error is {off_m} m");
}

#[test]
fn games_are_the_same_bytes_on_any_number_of_threads() {
    let (numbers, finished) = played(1);
    assert!(
        finished.len() >= 12 && finished.iter().all(|one| one.cut_off),
        "{finished:?}"
    );
    let sides = |team| {
        finished
            .iter()
            .any(|one| one.standing.side.learner == TeamId(team))
    };
    assert!(
        sides(0) && sides(1) && finished.iter().any(|one| one.standing.side.opponent == 0),
        "{finished:?}"
    );
    assert!(finished.iter().any(|one| one.standing.side.opponent == 1));
    for threads in [2, 3] {
        assert!(
            played(threads) == (numbers.clone(), finished.clone()),
            "{threads} threads"
        );
    }
}

/// A mind with the same actions as the environment's test.
struct Scripted {
    pilot: Pilot,
    decisions: u32,
}

impl Mind for Scripted {
    fn decide(&mut self, picture: &Picture) -> Order {
        if self.decisions.is_multiple_of(5) {
            let action = chosen(self.pilot.observe(picture));
            self.pilot.act(action);
        }
        self.decisions += 1;
        self.pilot.decide(picture)
    }
}

/// Ends a game in the arena after 200 steps of an environment.
fn goes_on(contest: &mut sim::Contest) -> bool {
    // The environment has observed the boats after its last step.
    contest.pictures();
    contest.decision() < 1000
}

#[test]
fn a_game_is_the_one_that_the_arena_plays() {
    for control in [Control::Direct, Control::Helm(strategy("teleop"))] {
        let setup = Setup {
            control,
            ..setup(
                "surveyor_2v2",
                vec![(1.0, Player::Strategy(strategy("strategy_2")))],
            )
        };
        let seed = 4;
        let mut environment = begun(setup.clone(), 1, 1, seed);
        (0..200).for_each(|_| act(&mut environment));
        let learner = environment.standing(0).side.learner;
        let scenario = setup.scenario.of_seed(seed).unwrap();
        let mind = |vehicle: VehicleId| -> Box<dyn Mind> {
            if scenario.team_of(vehicle) != learner {
                return agent::mind_by(&scenario, vehicle, &strategy("strategy_2"));
            }
            let pilot = match &setup.control {
                Control::Direct => Pilot::direct(&scenario, vehicle, SPACES),
                Control::Helm(strategy) => Pilot::helm(
                    &scenario,
                    vehicle,
                    agent::roles::role_in(&scenario, vehicle, strategy),
                    SPACES,
                ),
            };
            Box::new(Scripted {
                pilot,
                decisions: 0,
            })
        };
        let minds = (0..4).map(|i| mind(VehicleId::at(i))).collect();
        let outcome = arena::play_watched(&setup.scenario, minds, seed, goes_on).unwrap();
        assert_eq!(environment.contest(0).outcome().digest, outcome.digest);
    }
}

#[test]
fn team_sizes_are_drawn_for_every_game_and_rows_without_a_boat_do_not_count() {
    let setup = checked(&RawSetup {
        game: file("games/fleet_20v20.toml"),
        observation: RawObservation::Space(ObservationSpace::Squall {
            mates: 3,
            enemies: 6,
            frames: 1,
        }),
        opponents: vec![(1.0, None), (1.0, Some(file("strategies/pav01.toml")))],
        team_sizes: Some([[1, 6]; 2]),
        episode_max_s: Some(0.5),
        ..raw()
    });
    let mut environment = begun(setup, 1, 1, 0);
    let size = environment.setup().observation_size();
    assert_eq!((size, environment.rows().1), (44 + 9 * 16, 12));
    let mut drawn = [[0; 7]; 2];
    let mut unequal = 0;
    for _ in 0..600 {
        let scenario = environment.contest(0).scenario();
        let of_team = |team| {
            scenario
                .vehicles
                .iter()
                .filter(|v| v.team == TeamId(team))
                .count()
        };
        let sizes = [of_team(0), of_team(1)];
        (0..2).for_each(|team| drawn[team][sizes[team]] += 1);
        unequal += u32::from(sizes[0] != sizes[1]);
        let standing = environment.standing(0);
        let learner = standing.side.learner.index();
        let enemies = if standing.side.opponent == 0 {
            sizes[1 - learner]
        } else {
            0
        };
        let boats = environment.boats(0).to_vec();
        assert_eq!(boats.iter().flatten().count(), sizes[learner] + enemies);
        for (row, boat) in boats.iter().enumerate() {
            // Six rows for each team.
            let team = if row < 6 { learner } else { 1 - learner };
            let has_boat = row % 6 < if row < 6 { sizes[learner] } else { enemies };
            let team_of = boat.map(|boat| scenario.team_of(boat).index());
            assert_eq!(team_of, has_boat.then_some(team), "row {row} of {sizes:?}");
        }
        let counts = environment.counts();
        assert!(
            (0..12).all(|row| counts[row] == boats[row].is_some()),
            "{sizes:?}"
        );
        // Each slot of another boat begins with whether it is known; the distance comes fourth.
        let at = |boat: usize| environment.contest(0).world().state().boats[boat].pose.at;
        for (row, observation) in environment.observations().chunks_exact(size).enumerate() {
            let known: f32 = observation[44..].iter().step_by(16).sum();
            let Some(me) = &boats[row] else {
                assert_eq!(known, 0.0);
                continue;
            };
            let team = scenario.team_of(*me);
            let size = sizes[team.index()];
            let enemies = scenario.vehicles.len() - size;
            assert_eq!(known, (enemies + (size - 1).min(3)) as f32);
            let mates = (0..scenario.vehicles.len()).map(VehicleId::at);
            let mates = mates.filter(|mate| mate != me && scenario.team_of(*mate) == team);
            let mut want_m: Vec<f64> = mates
                .map(|mate| at(mate.index()).distance(at(me.index())))
                .collect();
            // With too few slots, the nearest teammates are seen, within the errors of receivers.
            want_m.sort_by(f64::total_cmp);
            for (i, want_m) in want_m.iter().enumerate().take(3).filter(|_| size > 4) {
                let off_m = 100.0 * f64::from(observation[44 + 16 * i + 3]) - want_m;
                assert!(off_m.abs() < 10.0, "mate {i} of {size}: {off_m} m");
            }
        }
        environment.step(&[Action::Discrete(4); 12]).unwrap();
    }
    // Expected: 100 teams of each size, and unequal teams in five of six games. Five standard
    // deviations are 46.
    assert!(
        drawn
            .iter()
            .all(|sizes| sizes[1..].iter().all(|n| (54..146).contains(n))),
        "{drawn:?}"
    );
    assert!((454..546).contains(&unequal), "{unequal}");
}

#[test]
fn a_teacher_that_does_not_drive_labels_the_policys_own_games() {
    let base = setup("surveyor_2v2", vec![(1.0, Player::Policy)]);
    let taught_by = |drives| Setup {
        teacher: Some(Teacher {
            strategy: strategy("strategy_2"),
            drives,
            options: BTreeMap::new(),
        }),
        ..base.clone()
    };
    let played = |setup: Setup| {
        let mut environment = begun(setup, 1, 1, 4);
        let mut taught = vec![];
        for step in 0..200 {
            environment
                .step(&[step / 20, 4, 12, 16].map(Action::Discrete))
                .unwrap();
            taught.push(environment.taught(0).to_vec());
        }
        (environment.contest(0).outcome().digest, taught)
    };
    let (alone, no_labels) = played(base.clone());
    let (advised, labels) = played(taught_by(false));
    let (driven, demonstrated) = played(taught_by(true));
    assert_eq!(advised, alone, "the adviser changes the game");
    assert_ne!(advised, driven);
    assert!(no_labels.iter().all(Vec::is_empty));
    // At first, the situations are the same; later, the policy's actions have changed them.
    assert_eq!(labels[0], demonstrated[0]);
    assert_ne!(labels[100], demonstrated[100]);
    assert!(labels.iter().flatten().flatten().count() > 700);
}

#[test]
fn a_teacher_plays_as_its_strategy_does_and_shows_actions_that_ask_for_it() {
    let teacher = Teacher {
        strategy: strategy("strategy_2"),
        drives: true,
        options: BTreeMap::new(),
    };
    let base = setup("surveyor_2v2", vec![(1.0, Player::Policy)]);
    let setup = Setup {
        teacher: Some(teacher),
        ..base
    };
    let mut environment = begun(setup.clone(), 1, 1, 4);
    let mut taught = vec![];
    for _ in 0..200 {
        environment.step(&[Action::Discrete(16); 4]).unwrap();
        taught.extend(environment.taught(0).iter().flatten().copied());
    }
    let scenario = setup.scenario.of_seed(4).unwrap();
    let mind = |i| agent::mind_by(&scenario, VehicleId::at(i), &strategy("strategy_2"));
    let outcome =
        arena::play_watched(&setup.scenario, (0..4).map(mind).collect(), 4, goes_on).unwrap();
    assert_eq!(environment.contest(0).outcome().digest, outcome.digest);
    // Expect set-points at nearly every decision, straight ahead at full speed more often than by
    // chance, and turns of every kind.
    let times = |action| {
        taught
            .iter()
            .filter(|one| **one == Action::Discrete(action))
            .count()
    };
    let kinds = (0..17).filter(|action| times(*action) > 0).count();
    assert!(
        taught.len() > 700 && times(4) > 100 && kinds > 10,
        "{} of {}, {kinds} kinds",
        times(4),
        taught.len()
    );
}

#[test]
fn rewards_are_what_events_say_and_potentials_cancel_out() {
    let opponents = vec![(1.0, Player::Strategy(strategy("pav01")))];
    let base = Setup {
        discount: 1.0,
        ..setup("surveyor_2v2", opponents)
    };
    let total = |rewards: Rewards| {
        let mut environment = begun(
            Setup {
                rewards,
                ..base.clone()
            },
            1,
            1,
            5,
        );
        let size = environment.setup().observation_size();
        let mut stream = Stream::new(3, "actions");
        let mut sum = [0.0_f64; 2];
        while environment.finished().is_empty() {
            let rows = environment.observations().len() / size;
            let actions: Vec<Action> = (0..rows)
                .map(|_| Action::Discrete(stream.below(17) as usize))
                .collect();
            environment.step(&actions).unwrap();
            sum.iter_mut()
                .zip(environment.rewards())
                .for_each(|(sum, reward)| *sum += f64::from(*reward));
        }
        (sum, environment.finished()[0].standing.score)
    };
    // Points of both teams under the rules of the game.
    let points = Worth {
        grab: 1.0,
        capture: 2.0,
        ..Worth::default()
    };
    let minus = Worth {
        grab: -1.0,
        capture: -2.0,
        ..Worth::default()
    };
    let (sum, score) = total(Rewards {
        team: points,
        enemy: minus,
        ..Rewards::default()
    });
    let ahead = f64::from(score[0]) - f64::from(score[1]);
    assert!(
        score[1] > 0 && sum.iter().all(|sum| (sum - ahead).abs() < 1e-4),
        "{sum:?}, {score:?}"
    );
    // Undiscounted, a potential sums to minus its initial value whatever the actions.
    let potential = Potential {
        attack: 1.0,
        untag: 0.5,
    };
    let (sum, _) = total(Rewards {
        potential,
        ..Rewards::default()
    });
    let first: Vec<f64> = {
        let environment = begun(base.clone(), 1, 1, 5);
        let contest = environment.contest(0);
        let team = environment.standing(0).side.learner;
        let flag = contest.scenario().field.flags[1 - team.index()].start;
        let boats = contest.last_pictures()[team.index()].own.iter();
        boats
            .map(|boat| boat.nav.at().distance(flag) / contest.scenario().field.plan.width_m - 1.0)
            .collect()
    };
    for (sum, first) in sum.iter().zip(first) {
        assert!((sum - first).abs() < 1e-3, "{sum}, {first}");
    }
}

#[test]
fn starts_come_round_again_and_are_those_of_their_seeds() {
    let of = |starts| {
        let opponents = vec![(1.0, Player::Policy)];
        let setup = Setup {
            starts,
            steps_max: Some(20),
            ..setup("surveyor_2v2", opponents)
        };
        begun(setup, 2, 2, 30)
    };
    let mut new = of(None);
    let mut again = of(Some(3));
    let size = new.setup().observation_size();
    let mut seeds = vec![];
    for step in 0..100 {
        let same_start = |environment: &VectorEnvironment, game: usize| {
            environment.contest(game).scenario().seed
        };
        for game in 0..2 {
            if same_start(&new, game) == same_start(&again, game) {
                let of_game = 4 * game * size..4 * (game + 1) * size;
                assert_eq!(
                    new.observations()[of_game.clone()],
                    again.observations()[of_game],
                    "step {step}, game {game}"
                );
            }
        }
        [&mut new, &mut again].into_iter().for_each(act);
        seeds.extend(again.finished().iter().map(|one| one.standing.seed));
    }
    assert_eq!(seeds, [30, 31, 32, 30, 31, 32, 30, 31, 32, 30]);
}
