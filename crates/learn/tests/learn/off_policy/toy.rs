//! Small problems with known solutions, learned from random transitions.

use crate::fixture;
use learn::nn::Trace;
use learn::off_policy::dqn::DqnLearner;
use learn::off_policy::td3::{self, Td3Learner};
use learn::off_policy::{Replay, Transition};
use learn::training::{Dqn, Td3};
use primitives::stream::Stream;

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("threads")
        .install(work)
}

/// The next position on a line from -1 to 1.
fn moved(place: f32, action: f32) -> f32 {
    (place + 0.3 * action).clamp(-1.0, 1.0)
}

/// Random steps on the line. The cost is the squared distance from the middle, plus a cost for a
/// second component other than 0.5. A fifth of the steps ignore the action.
fn steps_on_a_line(count: usize) -> Replay<td3::Numbers> {
    let mut replay = Replay::new(1, count);
    let stream = &mut Stream::new(2, "test/line");
    for i in 0..count {
        let place = stream.between(-1.0, 1.0) as f32;
        let action = td3::drawn(stream);
        let counts = i % 5 != 0;
        let next = moved(place, if counts { action[0] } else { 1.0 });
        let cost = next * next
            + if counts {
                0.5 * (action[1] - 0.5) * (action[1] - 0.5)
            } else {
                0.0
            };
        // Steps that ignore the action start farther out, since being tagged is a different state.
        let mark = if counts { 0.0 } else { 3.0 };
        replay.push(Transition {
            observation: &[place + mark],
            action,
            reward: -cost,
            next_observation: &[next],
            over: false,
            counts,
        });
    }
    replay
}

fn trained_td3(steps: usize, threads: usize) -> Td3Learner {
    let settings = Td3 {
        minibatch: 600,
        learning_rate: 3e-3,
        discount: 0.8,
        target_rate: 0.02,
        smoothing: 0.05,
        ..fixture::td3()
    };
    let replay = steps_on_a_line(4000);
    let stream = &mut Stream::new(3, "test/learning");
    let mut learner = Td3Learner::new(1, &[16, 16], 5);
    on_threads(threads, || {
        for _ in 0..steps {
            let losses = learner.update(&replay, &settings, stream);
            assert!(
                losses.critic.is_finite() && losses.critic >= 0.0,
                "{losses:?}"
            );
        }
    });
    learner
}

#[test]
fn td3_learns_to_go_to_the_middle_of_a_line_and_stay_there() {
    let learner = trained_td3(3000, 2);
    let mut trace = Trace::default();
    for start in [-0.95_f32, -0.4, 0.1, 0.8] {
        let mut place = start;
        for _ in 0..6 {
            learner.actor.forward(&[place], &mut trace);
            let [go, idle] = td3::action(trace.output());
            assert!(
                (idle - 0.5).abs() < 0.25,
                "from {start}, at {place}: got {idle}, want 0.5"
            );
            place = moved(place, go);
        }
        assert!(place.abs() < 0.1, "from {start} to {place}");
    }
    // In the middle, there are no further costs. At the end of the line, the costs are those of one
    // step and of the steps that follow.
    let value = |place: f32| {
        let mut trace = Trace::default();
        learner.critics[0].forward(&[place, (-place / 0.3).clamp(-1.0, 1.0), 0.5], &mut trace);
        trace.output()[0]
    };
    let want = -(0.7_f32.powi(2) + 0.8 * 0.4_f32.powi(2) + 0.64 * 0.1_f32.powi(2));
    // The smaller of two critics underestimates slightly.
    assert!(
        value(0.0).abs() < 0.15 && (value(1.0) - want).abs() < 0.15,
        "got {} {}, want {want}",
        value(0.0),
        value(1.0)
    );
}

/// The last place in a row; reaching it wins.
const LAST: usize = 7;

fn shown(place: usize) -> [f32; LAST] {
    std::array::from_fn(|i| if i == place { 1.0 } else { 0.0 })
}

/// Random steps to the left and right in a row of places.
fn steps_in_a_row(count: usize) -> Replay<u16> {
    let mut replay = Replay::new(LAST, count);
    let stream = &mut Stream::new(2, "test/row");
    for _ in 0..count {
        let place = stream.below(LAST as u64) as usize;
        let action = stream.below(2) as u16;
        let next = if action == 1 {
            place + 1
        } else {
            place.saturating_sub(1)
        };
        replay.push(Transition {
            observation: &shown(place),
            action,
            reward: if next == LAST { 1.0 } else { 0.0 },
            next_observation: &shown(next),
            over: next == LAST,
            counts: true,
        });
    }
    replay
}

fn trained_dqn(steps: usize, threads: usize) -> DqnLearner {
    let settings = Dqn {
        minibatch: 300,
        learning_rate: 3e-3,
        discount: 0.8,
        target_every: 20,
        ..fixture::dqn()
    };
    let replay = steps_in_a_row(2000);
    let stream = &mut Stream::new(3, "test/learning");
    let mut learner = DqnLearner::new(LAST, &[32], 2, 5);
    on_threads(threads, || {
        (0..steps).for_each(|_| _ = learner.update(&replay, &settings, stream))
    });
    learner
}

#[test]
fn double_dqn_learns_what_every_place_in_a_row_is_worth() {
    let learner = trained_dqn(600, 2);
    let mut trace = Trace::default();
    for place in 0..LAST {
        learner.network.forward(&shown(place), &mut trace);
        let right = 0.8_f32.powi((LAST - 1 - place) as i32);
        let left = 0.8_f32.powi((LAST - place.saturating_sub(1)) as i32);
        for (value, want) in trace.output().iter().zip([left, right]) {
            assert!(
                (value - want).abs() < 0.05,
                "place {place}: got {:?}, want {left} and {right}",
                trace.output()
            );
        }
    }
}

#[test]
fn learning_is_the_same_to_the_bit_on_any_number_of_threads() {
    for threads in [2, 3] {
        assert!(
            trained_td3(9, threads) == trained_td3(9, 1),
            "TD3, {threads} threads"
        );
        assert!(
            trained_dqn(9, threads) == trained_dqn(9, 1),
            "double DQN, {threads} threads"
        );
    }
}
