//! Primitive policies, each with a single task: the values of places, and the actions of shipped
//! policies.

use super::fixture::{begun, file, strategy, training};
use agent::{Action, ActionSpace};
use learn::environment::{Player, Setup, VectorEnvironment};
use learn::rewards::{Place, Rewards, progress};
use primitives::VehicleId;
use scenario::strategy::Task;

fn setup(name: &str) -> Setup {
    let training = training(&format!("primitive_{name}"));
    Setup::of_stage(&training, &training.stage[0]).unwrap()
}

#[test]
fn the_gains_of_a_place_add_up_to_what_it_is_worth_where_a_boat_has_come_to() {
    let place = Place {
        flag: 1.0,
        home: 2.0,
        intruder: 3.0,
        guard: 4.0,
        shield: 5.0,
        clear: 6.0,
    };
    let setup = Setup {
        rewards: Rewards {
            place,
            ..Rewards::default()
        },
        ..setup("pick_up")
    };
    let mut environment = begun(setup, 4, 2, 9);
    let (rows, per_game) = environment.rows();
    let worth = |environment: &VectorEnvironment, row: usize| {
        let game = row / per_game;
        let place_of = row % per_game;
        let contest = environment.contest(game);
        let seed = contest.scenario().seed;
        let boats: Vec<VehicleId> = environment
            .setup()
            .pilots_of(
                contest.scenario(),
                environment.standing(game).side.learner,
                seed,
            )
            .collect();
        place.of(&progress(contest, true)[boats[place_of].index()])
    };
    let first: Vec<f64> = (0..rows).map(|row| worth(&environment, row)).collect();
    let mut sums = vec![0.0; rows];
    for step in 0..60 {
        let actions: Vec<Action> = (0..rows)
            .map(|row| Action::Discrete((step / 5 + 3 * row) % 17))
            .collect();
        environment.step(&actions).unwrap();
        sums.iter_mut()
            .zip(environment.rewards())
            .for_each(|(sum, reward)| *sum += f64::from(*reward));
    }
    for (row, (sum, first)) in sums.iter().zip(first).enumerate() {
        let gain = worth(&environment, row) - first;
        assert!(
            (sum - gain).abs() < 1e-4,
            "row {row}: got {sum}, want {gain}"
        );
        assert!(gain.abs() > 1e-3, "row {row} has not moved");
    }
}

#[test]
fn the_shielder_has_a_teammate_driven_by_a_strategy() {
    let setup = setup("shield");
    assert_eq!(
        setup.mates.as_ref().map(|strategy| strategy.name.as_str()),
        Some("easy_attacker")
    );
    assert_eq!((setup.rows_per_game(), setup.team_size()), (1, 2));
}

#[test]
fn the_options_of_the_chooser_are_the_shipped_policies() {
    let strategy = strategy("primitives");
    let role = &strategy.roles[0];
    let policies = role
        .behaviours
        .iter()
        .filter_map(|behaviour| match &behaviour.task {
            Task::Policy(policy) => policy.model.as_ref(),
            _ => None,
        });
    let mut trained: Vec<String> = policies
        .map(|model| {
            assert_eq!(model.spec.action, ActionSpace::Pyquaticus);
            model
                .network()
                .metadata()
                .get("squall.training")
                .cloned()
                .unwrap_or_default()
        })
        .collect();
    let options = role.texts(role.options().expect("the role has options"));
    let mut wanted: Vec<String> = options
        .iter()
        .map(|option| format!("primitive_{option}"))
        .collect();
    trained.sort();
    wanted.sort();
    assert_eq!(trained, wanted);
}

/// The fraction of time that boats spend at home and untagged, with actions from `act`.
fn at_home(mut act: impl FnMut(&[f32]) -> Action) -> f64 {
    let mut setup = setup("retreat");
    setup.opponents.retain(
        |(_, player)| matches!(player, Player::Strategy(strategy) if strategy.name == "pav01"),
    );
    setup
        .opponents
        .iter_mut()
        .for_each(|(weight, _)| *weight = 1.0);
    let size = setup.observation_size();
    let mut environment = begun(setup, 16, 2, 77);
    let mut looks = 0.0;
    let mut home = 0.0;
    for _ in 0..119 {
        let actions: Vec<Action> = environment
            .observations()
            .chunks_exact(size)
            .map(&mut act)
            .collect();
        environment.step(&actions).unwrap();
        for game in 0..16 {
            let contest = environment.contest(game);
            let team = environment.standing(game).side.learner;
            for (i, boat) in progress(contest, true).iter().enumerate() {
                if contest.scenario().team_of(VehicleId::at(i)) == team {
                    looks += 1.0;
                    home += f64::from(u8::from(!boat.tagged && boat.from_home < 0.125));
                }
            }
        }
    }
    home / looks
}

#[test]
fn who_retreats_comes_home() {
    let bytes = std::fs::read(file("policies/primitive_retreat.onnx")).expect("a model");
    let mut network = onnx::Network::read(&bytes).unwrap();
    let by_policy = at_home(|observation| {
        network.evaluate(observation);
        Action::likeliest(network.output(0))
    });
    let stopped = at_home(|_| Action::Discrete(16));
    assert!(
        by_policy > 2.0 * stopped,
        "at home for {by_policy} of the time, stationary boats for {stopped}"
    );
}
