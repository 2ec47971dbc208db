//! A replay buffer of the newest transitions, from which minibatches are drawn.

use primitives::stream::Stream;
use serde::{Deserialize, Serialize};

/// One step of one boat.
#[derive(Clone, Copy, Debug)]
pub struct Transition<'a, A> {
    /// The observation before the step.
    pub observation: &'a [f32],
    /// The chosen action.
    pub action: A,
    /// The reward.
    pub reward: f32,
    /// The observation after the step, still in the same episode.
    pub next_observation: &'a [f32],
    /// Whether the step ended the game, so that no rewards follow.
    pub over: bool,
    /// Whether the boat followed the action. If not, as for a tagged boat, which is steered home,
    /// only values are learned from the transition.
    pub counts: bool,
}

/// The newest transitions, up to a capacity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Replay<A> {
    /// Observation size.
    size: usize,
    capacity: usize,
    /// Index of the oldest transition in a full buffer, which is replaced next.
    oldest: usize,
    kept: Minibatch<A>,
}

/// Transitions drawn from a buffer. Each list has one entry per transition.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Minibatch<A> {
    /// The observations before the step, transitions × values.
    pub observations: Vec<f32>,
    /// The observations after the step, transitions × values.
    pub next_observations: Vec<f32>,
    /// The chosen actions.
    pub actions: Vec<A>,
    /// The rewards.
    pub rewards: Vec<f32>,
    /// Whether each step ended the game.
    pub over: Vec<bool>,
    /// Whether the boat followed the action.
    pub counts: Vec<bool>,
}

impl<A> Minibatch<A> {
    /// The number of transitions.
    pub fn count(&self) -> usize {
        self.rewards.len()
    }
}

impl<A: Copy + Default> Replay<A> {
    /// An empty buffer for `capacity` transitions with observations of size `size`.
    ///
    /// # Panics
    /// If either is 0.
    pub fn new(size: usize, capacity: usize) -> Replay<A> {
        // The buffer is part of a training run's saved state, about 100 MB by default. Refilling it
        // by playing would require the earlier state of the games.
        assert!(size > 0 && capacity > 0, "{size}, {capacity}");
        Replay {
            size,
            capacity,
            oldest: 0,
            kept: Minibatch::default(),
        }
    }

    /// The number of transitions.
    pub fn count(&self) -> usize {
        self.kept.count()
    }

    /// Removes all transitions.
    pub fn clear(&mut self) {
        *self = Replay::new(self.size, self.capacity);
    }

    /// Stores a transition, replacing the oldest in a full buffer.
    ///
    /// # Panics
    /// If an observation has the wrong size.
    pub fn push(&mut self, transition: Transition<'_, A>) {
        let Transition {
            observation,
            action,
            reward,
            next_observation,
            over,
            counts,
        } = transition;
        assert!(observation.len() == self.size && next_observation.len() == self.size);
        let kept = &mut self.kept;
        if kept.count() < self.capacity {
            kept.observations.extend_from_slice(observation);
            kept.next_observations.extend_from_slice(next_observation);
            kept.actions.push(action);
            kept.rewards.push(reward);
            kept.over.push(over);
            kept.counts.push(counts);
            return;
        }
        let i = self.oldest;
        self.oldest = (i + 1) % self.capacity;
        let numbers = i * self.size..(i + 1) * self.size;
        kept.observations[numbers.clone()].copy_from_slice(observation);
        kept.next_observations[numbers].copy_from_slice(next_observation);
        (kept.actions[i], kept.rewards[i]) = (action, reward);
        (kept.over[i], kept.counts[i]) = (over, counts);
    }

    /// Draws transitions uniformly with replacement.
    ///
    /// # Panics
    /// If the buffer is empty.
    pub fn draw(&self, count: usize, stream: &mut Stream) -> Minibatch<A> {
        let kept = &self.kept;
        let drawn: Vec<usize> = (0..count)
            .map(|_| stream.below(kept.count() as u64) as usize)
            .collect();
        let rows = |from: &[f32]| -> Vec<f32> {
            let mut rows = Vec::with_capacity(count * self.size);
            drawn
                .iter()
                .for_each(|i| rows.extend_from_slice(&from[i * self.size..(i + 1) * self.size]));
            rows
        };
        Minibatch {
            observations: rows(&kept.observations),
            next_observations: rows(&kept.next_observations),
            actions: drawn.iter().map(|i| kept.actions[*i]).collect(),
            rewards: drawn.iter().map(|i| kept.rewards[*i]).collect(),
            over: drawn.iter().map(|i| kept.over[*i]).collect(),
            counts: drawn.iter().map(|i| kept.counts[*i]).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Replay, Transition};
    use primitives::stream::Stream;

    fn filled(capacity: usize, count: usize) -> Replay<u16> {
        let mut replay = Replay::new(2, capacity);
        for i in 0..count {
            let number = i as f32;
            replay.push(Transition {
                observation: &[number, -number],
                action: i as u16,
                reward: 10.0 * number,
                next_observation: &[number + 0.5, 0.0],
                over: i % 2 == 0,
                counts: i % 3 == 0,
            });
        }
        replay
    }

    #[test]
    fn the_newest_transitions_are_drawn_all_alike_and_whole() {
        const DRAWN: usize = 40_000;
        let replay = filled(8, 21);
        assert_eq!(replay.count(), 8);
        let minibatch = replay.draw(DRAWN, &mut Stream::new(1, "test/replay"));
        let mut times = [0_u32; 21];
        for i in 0..DRAWN {
            let action = minibatch.actions[i];
            times[usize::from(action)] += 1;
            let number = f32::from(action);
            assert_eq!(minibatch.observations[2 * i..2 * i + 2], [number, -number]);
            assert_eq!(
                minibatch.next_observations[2 * i..2 * i + 2],
                [number + 0.5, 0.0]
            );
            assert_eq!(minibatch.rewards[i], 10.0 * number);
            assert_eq!(
                (minibatch.over[i], minibatch.counts[i]),
                (action.is_multiple_of(2), action.is_multiple_of(3))
            );
        }
        assert_eq!(times[..13], [0; 13]);
        // Five standard deviations of the binomial distribution.
        assert!(
            times[13..]
                .iter()
                .all(|times| (f64::from(*times) - 5000.0).abs() < 5.0 * 66.2),
            "{times:?}"
        );
    }

    #[test]
    fn a_buffer_that_was_emptied_is_as_new() {
        let mut replay = filled(8, 21);
        replay.clear();
        assert!(replay.count() == 0 && replay == Replay::new(2, 8));
    }
}
