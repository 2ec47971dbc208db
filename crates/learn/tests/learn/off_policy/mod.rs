//! TD3 and double DQN: their steps match an independent implementation, their gradients match
//! finite differences, threads do not affect results, and they learn.

mod step;
mod toy;

use super::fixture;
use learn::nn::Perceptron;
use learn::off_policy::Minibatch;
use learn::off_policy::dqn::DqnLearner;
use learn::off_policy::td3::{NUMBERS, Td3Learner, drawn};
use primitives::stream::Stream;

/// Random transitions with observations of three numbers; every third one does not count.
fn random<A>(count: usize, stream: &mut Stream, action: impl Fn(&mut Stream) -> A) -> Minibatch<A> {
    let mut rows = || (0..3 * count).map(|_| stream.normal() as f32).collect();
    Minibatch {
        observations: rows(),
        next_observations: rows(),
        actions: (0..count).map(|_| action(stream)).collect(),
        rewards: (0..count).map(|_| stream.normal() as f32).collect(),
        over: (0..count).map(|i| i % 4 == 0).collect(),
        counts: (0..count).map(|i| i % 3 != 0).collect(),
    }
}

/// Compares a gradient with finite differences of the loss, parameter by parameter.
fn assert_slopes<L: Clone>(
    learner: &L,
    network: impl Fn(&mut L) -> &mut Perceptron,
    gradient_and_loss: impl Fn(&L) -> (Vec<f32>, f32),
) {
    const STEP: f32 = 1e-2;
    // Suits slopes of about 0.1, from finite differences in single precision.
    const TOLERANCE: f32 = 1e-3;
    let (gradient, _) = gradient_and_loss(learner);
    assert!(
        gradient.iter().any(|slope| slope.abs() > 30.0 * TOLERANCE),
        "{gradient:?}"
    );
    for (i, slope) in gradient.iter().enumerate() {
        let at = |by: f32| {
            let mut learner = learner.clone();
            network(&mut learner).parameters_mut()[i] += by;
            gradient_and_loss(&learner).1
        };
        let want = (at(STEP) - at(-STEP)) / (2.0 * STEP);
        assert!(
            (slope - want).abs() < TOLERANCE,
            "parameter {i}: got {slope}, want {want}"
        );
    }
}

#[test]
fn the_gradient_of_the_policy_of_td3_goes_through_its_first_critic() {
    let stream = &mut Stream::new(4, "test/gradient");
    let mut learner = Td3Learner::new(3, &[6, 5], 9);
    learner.actor = Perceptron::new(&[3, 6, 5, NUMBERS], 1.0, stream);
    let minibatch = random(7, stream, drawn);
    assert_slopes(
        &learner,
        |learner| &mut learner.actor,
        |learner| learner.actor_gradient(&minibatch),
    );
}

#[test]
fn only_what_boats_did_as_they_were_told_trains_the_policy() {
    let stream = &mut Stream::new(5, "test/counts");
    let learner = Td3Learner::new(3, &[6], 9);
    let minibatch = random(9, stream, drawn);
    let mut other = minibatch.clone();
    for i in (0..9).filter(|i| !minibatch.counts[*i]) {
        other.observations[3 * i] += 1.0;
    }
    assert!(learner.actor_gradient(&other) == learner.actor_gradient(&minibatch));
    other.observations[3] += 1.0;
    assert!(learner.actor_gradient(&other) != learner.actor_gradient(&minibatch));
    other.counts.fill(false);
    let (gradient, loss) = learner.actor_gradient(&other);
    assert!(
        loss == 0.0
            && gradient.len() == learner.actor.parameters().len()
            && gradient.iter().all(|g| *g == 0.0)
    );
}

#[test]
fn the_gradient_of_double_dqn_is_the_slope_of_its_loss() {
    let stream = &mut Stream::new(6, "test/gradient");
    let mut learner = DqnLearner::new(3, &[6, 5], 4, 9);
    learner.network = Perceptron::new(&[3, 6, 5, 4], 1.0, stream);
    learner.target = Perceptron::new(&[3, 6, 5, 4], 1.0, stream);
    let minibatch = random(11, stream, |stream| stream.below(4) as u16);
    let settings = fixture::dqn();
    assert_slopes(
        &learner,
        |learner| &mut learner.network,
        |learner| learner.gradient(&minibatch, &settings),
    );
}
