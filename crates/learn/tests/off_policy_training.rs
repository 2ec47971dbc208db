//! Training runs with TD3 and double DQN are reproducible, with or without an interruption; they learn;
//! and their files play the trained policy.

use scenario::policy::{PartialSpec, PolicyModel};

use learn::environment::SetupError;
use learn::nn::Trace;
use learn::off_policy::td3;
use learn::train::{Learner, Progress, Trainer};
use learn::training::{Algorithm, Dqn, Evaluation, Layers, League, Opponent, Stage, Td3, Training};
use primitives::stream::Stream;
use std::path::{Path, PathBuf};

fn file(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").join(path)
}

fn shipped(name: &str) -> Training {
    scenario::load_file::<learn::training::Training>(&file(&format!("training/{name}.toml")))
        .unwrap_or_else(|problems| panic!("{problems}"))
}

/// Two short stages with strategies, past policies, a helm in the second, and a buffer that
/// overflows.
fn short(algorithm: Algorithm) -> Training {
    let stage = |name: &str, game: &str, helm: Option<&str>| Stage {
        name: name.to_owned(),
        game: file(game),
        rewards: file("rewards/bold.toml"),
        helm: helm.map(file),
        self_play: 1.0,
        past_selves: 1.0,
        strategies: 1.0,
        opponent: vec![Opponent { strategy: file("strategies/pav01.toml") }],
        starts: Some(8),
        episode_max_s: Some(20.0),
        samples: 4_000,
        ..shipped("first").stage[0].clone()
    };
    let (name, base) = match algorithm {
        Algorithm::Td3(_) => ("policy", shipped("paper_2023_td3")),
        _ => ("options", shipped("options_dqn")),
    };
    let helm = format!("strategies/{name}.toml");
    // Options belong to a strategy, so a stage with options needs a helm.
    let first = matches!(algorithm, Algorithm::Dqn(_)).then_some(helm.as_str());
    let stage =
        vec![stage("first", "games/pav01_afloat.toml", first), stage("helm", "games/surveyor_2v2.toml", Some(&helm))];
    let (td3, dqn) = match algorithm {
        Algorithm::Td3(td3) => (Some(td3), None),
        Algorithm::Dqn(dqn) => (None, Some(dqn)),
        Algorithm::Ppo(_) => (None, None),
    };
    Training {
        games: 8,
        network: Layers { hidden: vec![16], ..base.network.clone() },
        td3,
        dqn,
        league: League { every_samples: 1_000, most: 2, priority: 1.0 },
        evaluation: Evaluation { every_samples: 3_000, games: 2, opponents: vec![file("strategies/pav01.toml")] },
        stage,
        ..base
    }
}

/// Each algorithm with a buffer that overflows. Games restart after a number of optimiser steps
/// that is not a multiple of 7, so that a resumed training depends on that number.
fn algorithms() -> [Algorithm; 2] {
    let td3 = Td3 { steps: 8, minibatches: 8, minibatch: 300, buffer: 2_000, warm_up: 500, delay: 7, ..Td3::default() };
    let dqn = Dqn { steps: 8, minibatches: 3, minibatch: 300, buffer: 2_000, warm_up: 500, ..Dqn::default() };
    [Algorithm::Td3(td3), Algorithm::Dqn(Dqn { target_every: 7, epsilon_samples: 4_000, ..dqn })]
}

fn updated(trainer: &mut Trainer) -> Progress {
    trainer.update().unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn the_same_file_trains_the_same_weights_on_any_number_of_threads_and_resumed() {
    for algorithm in algorithms() {
        let begun = |threads| {
            Trainer::new(short(algorithm), threads).unwrap_or_else(|error| panic!("{}: {error}", algorithm.name()))
        };
        let run = |threads| {
            let (mut trainer, mut progress) = (begun(threads), vec![]);
            while !trainer.is_over() {
                progress.push(updated(&mut trainer));
            }
            (trainer.state(), progress)
        };
        let (state, progress) = run(1);
        let (name, learnt) = (algorithm.name(), progress.iter().filter(|one| one.learnt.epochs.is_some()).count());
        assert!(learnt > 20 && learnt < progress.len(), "{name}: {learnt} of {} updates learnt", progress.len());
        assert!(progress.iter().flat_map(|one| &one.finished).any(|(_, name)| name.starts_with("after ")), "{name}");
        assert!(run(3) == (state.clone(), progress), "{name}: 3 threads gave other results");

        // Resumed wherever possible.
        let (mut trainer, mut taken_up) = (begun(2), 0);
        while !trainer.is_over() {
            if updated(&mut trainer).can_be_resumed {
                let resumed = Trainer::resume(short(algorithm), 2, &trainer.state());
                trainer = resumed.unwrap_or_else(|error| panic!("{name}: {error}"));
                taken_up += 1;
            }
        }
        assert!(taken_up > 2 && trainer.state() == state, "{name}: other results after resuming {taken_up} times");
    }
}

#[test]
fn a_stage_begins_with_an_empty_buffer_and_statistics_are_those_of_the_algorithm() {
    for algorithm in algorithms() {
        let mut trainer = Trainer::new(short(algorithm), 2).unwrap_or_else(|error| panic!("{error}"));
        let known = |trainer: &Trainer| match trainer.learner() {
            Learner::Td3(of) => of.replay.len(),
            Learner::Dqn(of) => of.replay.len(),
            Learner::Ppo(_) => panic!("expected an off-policy algorithm"),
        };
        let mut last = 0;
        while !trainer.is_over() {
            let before = trainer.samples().0;
            let progress = updated(&mut trainer);
            let learnt = progress.learnt;
            assert_eq!(learnt.value_loss.is_some(), learnt.epochs.is_some());
            assert_eq!(learnt.policy_loss.is_some(), learnt.epochs.is_some() && algorithm.name() == "td3");
            assert_eq!((learnt.entropy, learnt.divergence, learnt.clipped), (None, None, None));
            // At least twelve rows per step; those of tagged boats count only for values.
            assert!(progress.samples - before <= 8 * 8 * 4 && known(&trainer) <= 2_000);
            if progress.samples > 5_000 && progress.stage == 0 {
                last = known(&trainer);
            }
        }
        assert_eq!(known(&trainer), 0, "{last} before the end of the stage");
    }
}

#[test]
fn a_policy_of_td3_plays_from_its_file_as_it_was_trained() {
    const TOLERANCE: f32 = 1e-5;
    let [td3, _] = algorithms();
    let mut trainer = Trainer::new(short(td3), 2).unwrap_or_else(|error| panic!("{error}"));
    while trainer.samples().0 < 2_000 {
        updated(&mut trainer);
    }
    let bytes = trainer.model().unwrap_or_else(|error| panic!("{error}"));
    let model = PolicyModel::read("td3.onnx", &bytes, PartialSpec::default()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(model.spec, trainer.spec());
    let (mut network, mut trace) = (model.network(), Trace::default());
    let stream = &mut Stream::new(1, "test/observation");
    for size in [0.3, 1.0, 10.0, 1000.0] {
        for _ in 0..50 {
            let observation: Vec<f32> = (0..model.input_size()).map(|_| (size * stream.normal()) as f32).collect();
            trainer.learner().actor().forward(&observation, &mut trace);
            network.evaluate(&observation);
            let (got, want) = (network.output(model.output()), td3::action(trace.output()));
            assert!(got.iter().all(|number| (-1.0..=1.0).contains(number)), "{got:?}");
            // The sums of a layer have another order.
            assert!(
                got.iter().zip(want).all(|(got, want)| (got - want).abs() < TOLERANCE),
                "got {got:?}, want {want:?}"
            );
        }
    }
}

#[test]
fn an_algorithm_for_other_actions_is_refused() {
    let [td3, dqn] = algorithms();
    for (training, want) in [
        (Training { td3: None, ..short(td3) }, "action is continuous, expected discrete with ppo"),
        (Training { td3: short(td3).td3, ..short(dqn) }, "action is discrete, expected continuous with td3"),
        (Training { td3: None, dqn: short(dqn).dqn, ..short(td3) }, "action is continuous, expected discrete with dqn"),
    ] {
        let error = Trainer::new(training, 1).err();
        assert!(matches!(&error, Some(error @ SetupError::Field { .. }) if error.to_string() == want), "{error:?}");
    }
}
