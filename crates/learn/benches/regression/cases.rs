//! The measured cases.

use agent::{Action, ActionSpace, ObservationSpace, Spaces};
use learn::environment::{Control, Player, Setup, VectorEnvironment};
use learn::rewards::Rewards;
use learn::training::CriticInput;
use onnx::Network;
use primitives::stream::Stream;
use primitives::{SimTime, VehicleId};
use scenario::Scenario;
use scenario::strategy::Strategy;
use std::hint::black_box;
use std::path::{Path, PathBuf};

/// A named piece of work.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) run: Box<dyn FnMut()>,
}

pub(crate) fn all() -> Vec<Case> {
    let helms = || Player::Strategy(Box::new(strategy("strategy_4")));
    vec![
        game("game 2v2 with helms: 60 s", "surveyor_2v2", 60.0),
        game("game 20v20 with helms: 2 s", "fleet_20v20", 2.0),
        game("game 100v100 with helms: 0.4 s", "fleet_100v100", 0.4),
        physics("physics 500v500: 1 s", "swarm_500v500", 1.0),
        steps(
            "20 steps of 64 games, calm",
            "pyquaticus_2v2",
            64,
            Player::Policy,
        ),
        steps(
            "20 steps of 1024 games, calm",
            "pyquaticus_2v2",
            1024,
            Player::Policy,
        ),
        steps(
            "20 steps of 64 games, sea",
            "surveyor_2v2",
            64,
            Player::Policy,
        ),
        steps(
            "20 steps of 256 games, sea",
            "surveyor_2v2",
            256,
            Player::Policy,
        ),
        steps(
            "20 steps of 64 games, sea, against helms",
            "surveyor_2v2",
            64,
            helms(),
        ),
        network("1000 evaluations of a policy"),
    ]
}

/// The start of a game and its first seconds.
fn game(name: &'static str, file: &str, until_s: f64) -> Case {
    let scenario = scenario_of(file);
    Case {
        name,
        run: Box::new(move || play(&scenario, until_s, agent::minds_of(&scenario))),
    }
}

/// Like [`game`], but with boats that hold, so that helms cost nothing.
fn physics(name: &'static str, file: &str, until_s: f64) -> Case {
    let (scenario, idle) = (scenario_of(file), strategy("idle"));
    let run = move || {
        let boats = (0..scenario.vehicles.len()).map(VehicleId::at);
        let minds = boats.map(|vehicle| agent::mind_by(&scenario, vehicle, &idle));
        play(&scenario, until_s, minds.collect());
    };
    Case {
        name,
        run: Box::new(run),
    }
}

fn play(scenario: &Scenario, until_s: f64, minds: Vec<Box<dyn agent::Mind>>) {
    let until = SimTime::from_s(until_s);
    let outcome = arena::play_watched(scenario, minds, 1, |contest| contest.now() < until);
    black_box(outcome.unwrap_or_else(|e| panic!("{e}")));
}

/// Random actions in a batch of games on one thread.
fn steps(name: &'static str, file: &str, games: usize, opponent: Player) -> Case {
    let setup = Setup {
        team_sizes: None,
        scenario: scenario_of(file),
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
    };
    let environment = VectorEnvironment::new(setup, games, 1, 1, None);
    let mut environment = environment.unwrap_or_else(|e| panic!("{e}"));
    let rows = environment.rows().0;
    let mut stream = Stream::new(1, "actions");
    let actions: Vec<Action> = (0..rows)
        .map(|_| Action::Discrete(stream.below(17) as usize))
        .collect();
    let mut step = move || environment.step(&actions).unwrap_or_else(|e| panic!("{e}"));
    Case {
        name,
        run: Box::new(move || (0..20).for_each(|_| step())),
    }
}

fn network(name: &'static str) -> Case {
    let file = scenarios().join("policies/options.onnx");
    let bytes = std::fs::read(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let mut network = Network::read(&bytes).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let row = vec![0.5; network.input_size()];
    Case {
        name,
        run: Box::new(move || {
            for _ in 0..1000 {
                network.evaluate(black_box(&row));
                black_box(network.output(0)[0]);
            }
        }),
    }
}

fn scenario_of(game: &str) -> Scenario {
    scenario::load(&scenarios().join(format!("games/{game}.toml")))
        .unwrap_or_else(|e| panic!("{e}"))
}

fn strategy(name: &str) -> Strategy {
    scenario::load_file(&scenarios().join(format!("strategies/{name}.toml")))
        .unwrap_or_else(|e| panic!("{e}"))
}

fn scenarios() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios")
}
