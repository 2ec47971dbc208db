//! Two steps of each optimiser match numpy; see `reference.py`.

use crate::fixture;
use learn::nn::Perceptron;
use learn::off_policy::Minibatch;
use learn::off_policy::dqn::DqnLearner;
use learn::off_policy::td3::{NUMBERS, Numbers, Td3Learner};
use learn::training::{Dqn, Td3};

const ROWS: usize = 300;
/// Suits values of about 1 in single precision, changed by two steps of 0.001.
const TOLERANCE: f64 = 1e-5;

/// The same as `numbers` in `reference.py`.
fn numbers(count: usize, phase: f64, size: f64) -> Vec<f32> {
    (0..count)
        .map(|i| (size * libm::sin(1.3 * i as f64 + phase)) as f32)
        .collect()
}

fn set(network: &mut Perceptron, phase: f64) {
    let given = numbers(network.parameters().len(), phase, 0.5);
    network.parameters_mut().copy_from_slice(&given);
}

fn minibatch<A>(actions: Vec<A>) -> Minibatch<A> {
    Minibatch {
        observations: numbers(3 * ROWS, 0.1, 1.0),
        next_observations: numbers(3 * ROWS, 0.2, 1.0),
        actions,
        rewards: numbers(ROWS, 0.3, 4.0),
        over: (0..ROWS).map(|i| i % 7 == 3).collect(),
        counts: (0..ROWS).map(|i| i % 5 != 1).collect(),
    }
}

fn pairs(phase: f64, size: f64) -> Vec<Numbers> {
    let all = numbers(NUMBERS * ROWS, phase, size);
    all.chunks_exact(NUMBERS)
        .map(|pair| [pair[0], pair[1]])
        .collect()
}

/// Compares numbers with a line of `reference.txt`.
fn assert_reference(name: &str, got: &[f32]) {
    let mut lines = include_str!("reference.txt")
        .lines()
        .map(|line| line.split(' '));
    let mut line = lines
        .find(|line| line.clone().next() == Some(name))
        .unwrap_or_else(|| panic!("reference.txt has no line {name}"));
    line.next();
    let want: Vec<f64> = line
        .map(|number| number.parse().expect("a number"))
        .collect();
    assert_eq!(got.len(), want.len(), "{name}");
    for (i, (got, want)) in got.iter().zip(want).enumerate() {
        assert!(
            (f64::from(*got) - want).abs() < TOLERANCE,
            "{name} {i}: got {got}, want {want}"
        );
    }
}

#[test]
fn two_steps_of_td3_are_those_of_numpy() {
    let settings = Td3 {
        learning_rate: 1e-3,
        discount: 0.9,
        reward_scale: 0.5,
        target_rate: 0.1,
        delay: 2,
        ..fixture::td3()
    };
    let mut learner = Td3Learner::new(3, &[5], 1);
    set(&mut learner.actor, 1.0);
    set(&mut learner.target_actor, 2.0);
    for (i, phase) in [3.0, 4.0].into_iter().enumerate() {
        set(&mut learner.critics[i], phase);
        set(&mut learner.target_critics[i], phase + 2.0);
    }
    let minibatch = minibatch(pairs(0.4, 1.0));
    let noise = pairs(0.5, 0.5);
    let first = learner.step(&minibatch, &noise, &settings);
    let second = learner.step(&minibatch, &noise, &settings);
    assert_eq!(first.actor, None);
    assert_reference("td3.critic_loss.1", &[first.critic]);
    assert_reference("td3.critic_loss.2", &[second.critic]);
    assert_reference(
        "td3.actor_loss.2",
        &[second.actor.expect("every second step updates the policy")],
    );
    assert_reference("td3.actor", learner.actor.parameters());
    assert_reference("td3.target_actor", learner.target_actor.parameters());
    for i in 0..2 {
        assert_reference(&format!("td3.critic.{i}"), learner.critics[i].parameters());
        assert_reference(
            &format!("td3.target_critic.{i}"),
            learner.target_critics[i].parameters(),
        );
    }
}

#[test]
fn two_steps_of_double_dqn_are_those_of_numpy() {
    let settings = Dqn {
        learning_rate: 1e-3,
        discount: 0.9,
        reward_scale: 0.5,
        target_every: 2,
        ..fixture::dqn()
    };
    let mut learner = DqnLearner::new(3, &[5], 4, 1);
    set(&mut learner.network, 7.0);
    set(&mut learner.target, 8.0);
    let minibatch = minibatch((0..ROWS).map(|i| (i * 3 % 4) as u16).collect());
    let before = learner.target.clone();
    assert_reference("dqn.loss.1", &[learner.step(&minibatch, &settings)]);
    assert_eq!(learner.target, before);
    assert_reference("dqn.loss.2", &[learner.step(&minibatch, &settings)]);
    assert_reference("dqn.network", learner.network.parameters());
    assert_eq!(learner.target, learner.network);
}
