//! Networks and their training: gradients match finite differences, threads do not affect results,
//! and policies learn.

use super::fixture;
use learn::nn::{Adam, AdamSettings, Perceptron, Trace};
use learn::ppo::{ActorCritic, Batch, Lesson, choice};
use learn::training::Ppo;
use primitives::stream::Stream;

#[test]
fn gradients_are_the_slopes_of_the_output() {
    const STEP: f32 = 1e-2;
    // Suits values of about 1, from finite differences in single precision.
    const TOLERANCE: f32 = 5e-3;
    let mut stream = Stream::new(3, "gradient");
    let mut network = Perceptron::new(&[5, 7, 6, 3], 1.0, &mut stream);
    let input: Vec<f32> = (0..4 * 5).map(|_| stream.normal() as f32).collect();
    let weights: Vec<f32> = (0..4 * 3).map(|_| stream.normal() as f32).collect();
    let loss = |network: &Perceptron, input: &[f32]| -> f32 {
        let mut trace = Trace::default();
        network.forward(input, &mut trace);
        trace
            .output()
            .iter()
            .zip(&weights)
            .map(|(output, weight)| output * weight)
            .sum()
    };
    let mut trace = Trace::default();
    let mut by_input = vec![];
    network.forward(&input, &mut trace);
    let mut gradient = vec![0.0; network.parameters().len()];
    network.backward(
        &trace,
        &mut weights.clone(),
        &mut gradient,
        Some(&mut by_input),
    );
    for (i, slope) in gradient.iter().enumerate() {
        let mut at = |by: f32| {
            network.parameters_mut()[i] += by;
            let loss = loss(&network, &input);
            network.parameters_mut()[i] -= by;
            loss
        };
        let want = (at(STEP) - at(-STEP)) / (2.0 * STEP);
        assert!(
            (slope - want).abs() < TOLERANCE,
            "parameter {i}: got {slope}, want {want}"
        );
    }
    for (i, slope) in by_input.iter().enumerate() {
        let at = |by: f32| {
            let mut input = input.clone();
            input[i] += by;
            loss(&network, &input)
        };
        let want = (at(STEP) - at(-STEP)) / (2.0 * STEP);
        assert!(
            (slope - want).abs() < TOLERANCE,
            "input {i}: got {slope}, want {want}"
        );
    }
}

#[test]
fn first_weights_are_orthogonal_with_their_gain() {
    let network = Perceptron::new(&[6, 4, 2], 0.01, &mut Stream::new(1, "weights"));
    for (i, (inputs, outputs), gain) in [(0, (6, 4), 2.0_f32), (1, (4, 2), 1e-4)] {
        let (weights, biases) = network.layer(i);
        assert!(biases.iter().all(|bias| *bias == 0.0));
        for (a, b) in (0..outputs).flat_map(|a| (0..outputs).map(move |b| (a, b))) {
            let product: f32 = (0..inputs)
                .map(|row| weights[row * outputs + a] * weights[row * outputs + b])
                .sum();
            let want = if a == b { gain } else { 0.0 };
            assert!(
                (product - want).abs() < 1e-5 * gain,
                "{a} {b}: got {product}, want {want}"
            );
        }
    }
}

#[test]
fn adam_goes_as_its_authors_say() {
    // The first step is the learning rate, against the gradient's sign; the second was computed by
    // hand.
    let settings = AdamSettings {
        epsilon: 0.0,
        norm_max: None,
        ..AdamSettings::default()
    };
    let mut adam = Adam::new(2, settings);
    let mut parameters = [1.0_f32, -1.0];
    let norm = adam.step(&mut parameters, &[3.0, -4.0], 0.1);
    assert!(
        (norm - 5.0).abs() < 1e-6
            && (parameters[0] - 0.9).abs() < 1e-6
            && (parameters[1] + 0.9).abs() < 1e-6
    );
    adam.step(&mut parameters, &[0.0, -4.0], 0.1);
    // Mean 0.9 * 0.3 = 0.27, divided by 0.19 to correct its bias; mean square 0.999 * 0.009 =
    // 0.008991, divided by 0.001999.
    let want = 0.9 - 0.1 * (0.27 / 0.19) / libm::sqrtf(0.008_991 / 0.001_999);
    assert!(
        (parameters[0] - want).abs() < 1e-4,
        "got {parameters:?}, want {want}"
    );
    assert!((parameters[1] + 0.8).abs() < 1e-6, "{parameters:?}");
    // A gradient that is too long is scaled to the limit. In the first step, this changes only the
    // reported norm.
    let mut adam = Adam::new(1, AdamSettings::default());
    let mut parameters = [0.0_f32];
    assert!(
        (adam.step(&mut parameters, &[1e6], 0.1) - 1e6).abs() < 1.0
            && (parameters[0] + 0.1).abs() < 1e-4
    );
}

/// Samples of a one-step game: in each of eight observations, one action has a reward of 1. A
/// teacher's action has no reward.
fn sampled(learner: &ActorCritic, lesson: Lesson, stream: &mut Stream) -> Batch {
    let mut observations = vec![];
    let mut actions = vec![];
    let mut log_probabilities = vec![];
    let mut rewards = vec![];
    let mut trace = Trace::default();
    let mut all = [0.0; 4];
    for _ in 0..1500 {
        let picture = stream.below(8);
        let observation = observation(picture as usize);
        learner.actor.forward(&observation, &mut trace);
        choice::log_probabilities(trace.output(), &mut all);
        let action = choice::drawn(&all, stream.unit());
        observations.extend(observation);
        actions.push(if lesson == Lesson::Imitation {
            ((picture * 3 + 1) % 4) as u16
        } else {
            action as u16
        });
        log_probabilities.push(all[action]);
        rewards.push(if action as u64 == picture * 3 % 4 {
            1.0
        } else {
            0.0
        });
    }
    let states = observations.clone();
    let returns = rewards.clone();
    let counts = vec![true; rewards.len()];
    Batch {
        observations,
        states,
        actions,
        log_probabilities,
        advantages: rewards,
        returns,
        lesson,
        counts,
    }
}

fn observation(picture: usize) -> [f32; 3] {
    [0, 1, 2].map(|bit| if picture >> bit & 1 == 1 { 1.0 } else { -1.0 })
}

fn trained(
    lesson: Lesson,
    updates: usize,
    threads: usize,
    mut learner: ActorCritic,
) -> ActorCritic {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("threads");
    let settings = Ppo {
        learning_rate: 3e-3,
        minibatch: 600,
        divergence_max: 1e9,
        ..fixture::ppo()
    };
    for i in 0..updates {
        let mut stream = Stream::new(i as u64, "samples");
        let batch = sampled(&learner, lesson, &mut stream);
        let learnt = pool.install(|| learner.update(&batch, &settings, 1.0, &mut stream));
        assert!(
            learnt.divergence >= Some(0.0) && learnt.entropy > Some(0.0),
            "{learnt:?}"
        );
    }
    learner
}

#[test]
fn a_policy_learns_which_action_is_worth_most() {
    let learner = trained(
        Lesson::Reinforcement,
        40,
        2,
        ActorCritic::new(3, 3, &[32], 4, 1),
    );
    let mut trace = Trace::default();
    let mut value = Trace::default();
    for picture in 0..8_usize {
        let observation = observation(picture);
        learner.actor.forward(&observation, &mut trace);
        assert_eq!(
            choice::likeliest(trace.output()),
            picture * 3 % 4,
            "picture {picture}: {:?}",
            trace.output()
        );
        // The critic expects the actual reward, nearly always 1.
        learner.critic.forward(&observation, &mut value);
        let expected = value.output()[0] * learner.scale.deviation();
        assert!(
            (expected - 1.0).abs() < 0.2,
            "picture {picture}: {expected}"
        );
    }
}

#[test]
fn a_policy_imitates_its_teacher_whatever_comes_of_it() {
    let learner = trained(
        Lesson::Imitation,
        20,
        2,
        ActorCritic::new(3, 3, &[32], 4, 1),
    );
    let mut trace = Trace::default();
    for picture in 0..8_usize {
        learner.actor.forward(&observation(picture), &mut trace);
        assert_eq!(
            choice::likeliest(trace.output()),
            (picture * 3 + 1) % 4,
            "picture {picture}: {:?}",
            trace.output()
        );
    }
}

#[test]
fn training_is_the_same_to_the_bit_on_any_number_of_threads_and_when_it_is_resumed() {
    let start = ActorCritic::new(3, 3, &[16, 16], 4, 7);
    let trained = |threads, learner| trained(Lesson::Reinforcement, 4, threads, learner);
    let want = trained(1, start.clone());
    assert_ne!(want, start);
    for threads in [2, 3] {
        assert!(trained(threads, start.clone()) == want, "{threads} threads");
    }
    let saved = serde_json::to_string(&want).expect("JSON");
    let resumed: ActorCritic = serde_json::from_str(&saved).expect("the saved state is valid");
    assert!(trained(2, resumed) == trained(1, want));
}
