//! Training runs with TD3 and double DQN learn, and their model files play like the trained
//! policies.

use super::fixture::{self, stage, trainer, training, updated};
use learn::nn::Trace;
use learn::off_policy::td3;
use learn::train::{Learner, Trainer};
use learn::training::{Algorithm, Dqn, Td3, Training};
use primitives::stream::Stream;
use scenario::policy::{PartialSpec, PolicyModel};

/// Two short stages with strategies, past policies, a helm in the second, and a buffer that
/// overflows.
pub(crate) fn short(algorithm: Algorithm) -> Training {
    let (td3, dqn) = match algorithm {
        Algorithm::Td3(td3) => (Some(td3), None),
        Algorithm::Dqn(dqn) => (None, Some(dqn)),
        Algorithm::Ppo(_) => (None, None),
    };
    let (helm, base) = match algorithm {
        Algorithm::Td3(_) => ("strategies/policy.toml", training("paper_2023_td3")),
        _ => ("strategies/options.toml", training("options_dqn")),
    };
    let stages = vec![
        // Options belong to a strategy, so a stage with options needs a helm.
        stage(
            "first",
            "games/pav01_afloat.toml",
            dqn.is_some().then_some(helm),
        ),
        stage("helm", "games/surveyor_2v2.toml", Some(helm)),
    ];
    Training {
        td3,
        dqn,
        ..fixture::short(base, stages)
    }
}

/// Each algorithm with a buffer that overflows. Games restart after a number of optimiser steps
/// that is not a multiple of 7, so that a resumed run depends on that number.
pub(crate) fn algorithms() -> [Algorithm; 2] {
    let td3 = Td3 {
        steps: 8,
        minibatches: 8,
        minibatch: 300,
        buffer: 2_000,
        warm_up: 500,
        delay: 7,
        ..fixture::td3()
    };
    let dqn = Dqn {
        steps: 8,
        minibatches: 3,
        minibatch: 300,
        buffer: 2_000,
        warm_up: 500,
        ..fixture::dqn()
    };
    [
        Algorithm::Td3(td3),
        Algorithm::Dqn(Dqn {
            target_every: 7,
            epsilon_samples: 4_000,
            ..dqn
        }),
    ]
}

#[test]
fn a_stage_begins_with_an_empty_buffer_and_statistics_are_those_of_the_algorithm() {
    for algorithm in algorithms() {
        let mut trainer = trainer(short(algorithm), 2);
        let known = |trainer: &Trainer| match trainer.learner() {
            Learner::Td3(of) => of.replay.count(),
            Learner::Dqn(of) => of.replay.count(),
            Learner::Ppo(_) => panic!("expected an off-policy algorithm"),
        };
        let mut last = 0;
        while !trainer.is_over() {
            let before = trainer.samples().0;
            let progress = updated(&mut trainer);
            let learnt = progress.learnt;
            assert_eq!(learnt.value_loss.is_some(), learnt.epochs.is_some());
            assert_eq!(
                learnt.policy_loss.is_some(),
                learnt.epochs.is_some() && algorithm.name() == "td3"
            );
            assert_eq!(
                (learnt.entropy, learnt.divergence, learnt.clipped),
                (None, None, None)
            );
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
    let mut trainer = trainer(short(td3), 2);
    while trainer.samples().0 < 2_000 {
        updated(&mut trainer);
    }
    let model = PolicyModel::read(
        "td3.onnx",
        &trainer.model().unwrap(),
        PartialSpec::default(),
    )
    .unwrap();
    assert_eq!(model.spec, trainer.spec());
    let mut network = model.network();
    let mut trace = Trace::default();
    let stream = &mut Stream::new(1, "test/observation");
    for size in [0.3, 1.0, 10.0, 1000.0] {
        for _ in 0..50 {
            let observation: Vec<f32> = (0..model.input_size())
                .map(|_| (size * stream.normal()) as f32)
                .collect();
            trainer.learner().actor().forward(&observation, &mut trace);
            network.evaluate(&observation);
            let got = network.output(model.output());
            let want = td3::action(trace.output());
            assert!(
                got.iter().all(|number| (-1.0..=1.0).contains(number)),
                "{got:?}"
            );
            // The sums in a layer are in a different order.
            assert!(
                got.iter()
                    .zip(want)
                    .all(|(got, want)| (got - want).abs() < TOLERANCE),
                "got {got:?}, want {want:?}"
            );
        }
    }
}
