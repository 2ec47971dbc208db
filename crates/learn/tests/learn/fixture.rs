//! Helpers for the tests: shipped files, setups of environments, and short training runs.

use agent::ActionSpace;
use learn::environment::{
    CriticInput, Games, RawObservation, RawSetup, Rows, Setup, VectorEnvironment,
};
use learn::train::{Progress, Trainer};
use learn::training::{Dqn, Evaluation, Layers, League, Opponent, Ppo, Stage, Td3, Training};
use scenario::Scenario;
use scenario::strategy::Strategy;
use std::path::{Path, PathBuf};

pub(crate) fn file(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../scenarios")
        .join(path)
}

pub(crate) fn game(name: &str) -> Scenario {
    scenario::load(&file(&format!("games/{name}.toml")))
        .unwrap_or_else(|problems| panic!("{problems}"))
}

pub(crate) fn strategy(name: &str) -> Box<Strategy> {
    let strategy = scenario::load_file::<scenario::strategy::Strategy>(&file(&format!(
        "strategies/{name}.toml"
    )));
    Box::new(strategy.unwrap_or_else(|problems| panic!("{problems}")))
}

pub(crate) fn training(name: &str) -> Training {
    let training = scenario::load_file::<Training>(&file(&format!("training/{name}.toml")));
    training.unwrap_or_else(|problems| panic!("{problems}"))
}

/// The default settings of PPO; only a training file provides them.
pub(crate) fn ppo() -> Ppo {
    training("first").ppo
}

pub(crate) fn td3() -> Td3 {
    Td3 {
        reward_scale: 1.0,
        ..training("paper_2023_td3").td3.unwrap()
    }
}

pub(crate) fn dqn() -> Dqn {
    Dqn {
        discount: 0.995,
        ..training("options_dqn").dqn.unwrap()
    }
}

/// A setup against Pav01, with episodes of 5 s.
pub(crate) fn raw() -> RawSetup {
    RawSetup {
        game: file("games/pyquaticus_2v2.toml"),
        sea: None,
        team_sizes: None,
        observation: RawObservation::Squall { frames: 2 },
        action: ActionSpace::Pyquaticus,
        helm: None,
        decision_s: Some(0.5),
        decision_min_s: 0.0,
        episode_max_s: Some(5.0),
        starts: None,
        team: None,
        mates: None,
        opponents: vec![(1.0, Some(file("strategies/pav01.toml")))],
        rewards: Some(file("rewards/bold.toml")),
        discount: 0.99,
        critic: CriticInput::Observation,
    }
}

pub(crate) fn checked(raw: &RawSetup) -> Setup {
    raw.check().unwrap_or_else(|error| panic!("{error}"))
}

pub(crate) fn begun(setup: Setup, games: usize, threads: usize, seed: u64) -> VectorEnvironment {
    VectorEnvironment::new(setup, games, threads, seed, None)
        .unwrap_or_else(|error| panic!("{error}"))
}

/// Lets `work` write the rows of games. Returns the observations; those not written are 9.
pub(crate) fn written(games: &mut Games, work: impl FnOnce(&mut Games, Rows<'_>)) -> Vec<f32> {
    let rows = games.rows().0;
    let numbers = games.rows().0 * games.setup().observation_size();
    let mut observations = vec![9.0; numbers];
    let mut final_observations = vec![0.0; numbers];
    let mut rewards = vec![0.0; rows];
    let mut counts = vec![false; rows];
    let shown = Rows {
        observations: &mut observations,
        final_observations: &mut final_observations,
        rewards: &mut rewards,
        counts: &mut counts,
    };
    work(games, shown);
    observations
}

/// A short stage with strategies and past policies as opponents, and a helm on request.
pub(crate) fn stage(name: &str, game: &str, helm: Option<&str>) -> Stage {
    Stage {
        name: name.to_owned(),
        game: file(game),
        rewards: file("rewards/bold.toml"),
        helm: helm.map(file),
        self_play: 1.0,
        past_selves: 1.0,
        strategies: 1.0,
        opponent: vec![Opponent {
            strategy: file("strategies/pav01.toml"),
        }],
        starts: Some(8),
        episode_max_s: Some(20.0),
        samples: 4_000,
        ..training("first").stage.remove(0)
    }
}

/// A short training run of these stages with a small network.
pub(crate) fn short(base: Training, stage: Vec<Stage>) -> Training {
    let opponents = vec![file("strategies/pav01.toml")];
    Training {
        games: 8,
        network: Layers {
            hidden: vec![16],
            ..base.network
        },
        league: League {
            every_samples: 1_000,
            most: 2,
            priority: 1.0,
        },
        evaluation: Evaluation {
            every_samples: 3_000,
            games: 2,
            opponents,
        },
        stage,
        ..base
    }
}

pub(crate) fn trainer(training: Training, threads: usize) -> Trainer {
    Trainer::new(training, threads).unwrap_or_else(|error| panic!("{error}"))
}

pub(crate) fn updated(trainer: &mut Trainer) -> Progress {
    trainer.update().unwrap_or_else(|error| panic!("{error}"))
}

/// The state after a whole training run, and the progress of its updates.
pub(crate) fn trained(mut trainer: Trainer) -> (Vec<u8>, Vec<Progress>) {
    let mut progress = vec![];
    while !trainer.is_over() {
        progress.push(updated(&mut trainer));
    }
    (trainer.state(), progress)
}
