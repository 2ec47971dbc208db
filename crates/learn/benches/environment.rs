//! Environment steps on one core with random actions, and the start of a new game in a batch. Each
//! step contains four agent steps, or two if helms play the other team.

use agent::{Action, ActionSpace, ObservationSpace, Spaces};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use learn::environment::{Control, Player, Setup, VectorEnvironment};
use learn::rewards::Rewards;
use learn::training::CriticInput;
use primitives::stream::Stream;
use std::path::Path;

// On one core, with all four boats observed at every decision, game decisions per second: 192,000
// in calm water, 75,000 with sea and sensors, 26,000 with both against strategy 4. A new game takes
// 0.03 ms in calm water and 0.41 ms with a sea, including one step. More than half of that time
// goes into the sea's tables for each boat; a quarter into rechecking the scenario with the drawn
// numbers.
const GAMES: usize = 64;

fn setup(game: &str, opponent: Player) -> Setup {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../scenarios/games/{game}.toml"));
    Setup {
        team_sizes: None,
        scenario: scenario::load(&path).unwrap_or_else(|problems| panic!("{problems}")),
        spaces: Spaces {
            observation: ObservationSpace::Pyquaticus,
            action: ActionSpace::Pyquaticus,
        },
        control: Control::Direct,
        teacher: None,
        critic: CriticInput::Observation,
        decisions_per_step: 1,
        steps_max: None,
        starts: None,
        learner: None,
        mates: None,
        opponents: vec![(1.0, opponent)],
        rewards: Rewards::default(),
        discount: 0.99,
    }
}

fn steps(c: &mut Criterion) {
    let mut group = c.benchmark_group("environment");
    let strategy =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/strategies/strategy_4.toml");
    let strategy = scenario::load_file::<scenario::strategy::Strategy>(&strategy)
        .unwrap_or_else(|problems| panic!("{problems}"));
    let games = [
        ("calm", "pyquaticus_2v2", Player::Policy),
        ("sea and sensors", "surveyor_2v2", Player::Policy),
        (
            "sea and sensors against strategy 4",
            "surveyor_2v2",
            Player::Strategy(Box::new(strategy)),
        ),
    ];
    for (name, game, opponent) in games {
        let mut environment = VectorEnvironment::new(setup(game, opponent), GAMES, 1, 1, None)
            .unwrap_or_else(|e| panic!("{e}"));
        let mut stream = Stream::new(1, "actions");
        let rows = environment.rows().0;
        group
            .throughput(Throughput::Elements(GAMES as u64))
            .sample_size(20);
        group.bench_function(name, |b| {
            b.iter(|| {
                let actions: Vec<Action> = (0..rows)
                    .map(|_| Action::Discrete(stream.below(17) as usize))
                    .collect();
                environment.step(&actions).unwrap_or_else(|e| panic!("{e}"));
            });
        });
    }
    // One step of one decision, then a new game.
    for (name, game, starts) in [
        ("new game, calm", "pyquaticus_2v2", None),
        ("new game, sea and sensors", "surveyor_2v2", None),
        (
            "new game, sea and sensors, one of 100 starts",
            "surveyor_2v2",
            Some(100),
        ),
    ] {
        let setup = Setup {
            steps_max: Some(1),
            starts,
            ..setup(game, Player::Policy)
        };
        let mut environment =
            VectorEnvironment::new(setup, 1, 1, 1, None).unwrap_or_else(|e| panic!("{e}"));
        let actions = vec![Action::Discrete(0); environment.rows().0];
        group.throughput(Throughput::Elements(1));
        group.bench_function(name, |b| {
            b.iter(|| environment.step(&actions).unwrap_or_else(|e| panic!("{e}")))
        });
    }
    group.finish();
}

criterion_group!(benches, steps);
criterion_main!(benches);
