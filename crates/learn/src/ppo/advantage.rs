//! Advantages: how much better a step came out than was expected (generalised advantage estimation, Schulman and others, ICLR 2016).

/// What is needed of a row's steps, each slice steps × rows.
#[derive(Clone, Copy, Debug)]
pub struct Steps<'a> {
    /// How many rows there are.
    pub rows: usize,
    /// What each step was worth.
    pub rewards: &'a [f32],
    /// What was expected before each step.
    pub values: &'a [f32],
    /// What is expected after each step: after the last of an episode that was cut off, of its last state.
    pub next_values: &'a [f32],
    /// Whether the game was over after the step: nothing is expected then.
    pub over: &'a [bool],
    /// Whether the episode ended with the step: what comes next is another one.
    pub ended: &'a [bool],
}

/// The advantage of every step, steps × rows: with the values the returns to learn.
#[must_use]
pub fn advantages(steps: Steps<'_>, discount: f32, lambda: f32) -> Vec<f32> {
    let Steps { rows, rewards, values, next_values, over, ended } = steps;
    let mut advantages = vec![0.0; rewards.len()];
    for row in 0..rows {
        let mut later = 0.0;
        for i in (row..rewards.len()).step_by(rows).rev() {
            let next = if over[i] { 0.0 } else { next_values[i] };
            let surprise = rewards[i] + discount * next - values[i];
            later = surprise + if ended[i] { 0.0 } else { discount * lambda * later };
            advantages[i] = later;
        }
    }
    advantages
}

#[cfg(test)]
mod tests {
    use super::{Steps, advantages};

    #[test]
    fn they_are_the_weighted_sums_of_all_later_surprises() {
        // Two rows of six steps; the first ends by its rules after the third, the second is cut off after the fourth.
        let (rows, count) = (2, 6);
        let number = |i: usize| (0.37 * i as f32).fract() - 0.4;
        let rewards: Vec<f32> = (0..rows * count).map(number).collect();
        let values: Vec<f32> = (0..rows * count).map(|i| number(i + 50)).collect();
        let next_values: Vec<f32> = (0..rows * count).map(|i| number(i + 90)).collect();
        let over: Vec<bool> = (0..rows * count).map(|i| i == 4).collect();
        let ended: Vec<bool> = (0..rows * count).map(|i| i == 4 || i == 7).collect();
        let (discount, lambda) = (0.9_f32, 0.8_f32);
        let steps =
            Steps { rows, rewards: &rewards, values: &values, next_values: &next_values, over: &over, ended: &ended };
        let got = advantages(steps, discount, lambda);
        for (first, got) in got.into_iter().enumerate() {
            let (mut want, mut weight) = (0.0_f64, 1.0_f64);
            for i in (first..rows * count).step_by(rows) {
                let next = if over[i] { 0.0 } else { next_values[i] };
                want += weight * f64::from(rewards[i] + discount * next - values[i]);
                weight *= f64::from(discount * lambda);
                if ended[i] {
                    break;
                }
            }
            assert!((f64::from(got) - want).abs() < 1e-5, "{first}: {got} not {want}");
        }
    }
}
