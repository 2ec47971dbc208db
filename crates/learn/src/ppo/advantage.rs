//! Generalised advantage estimation (Schulman and others, ICLR 2016): how much better than expected
//! each step turned out.

/// Rows of steps; each list is steps × rows.
#[derive(Clone, Debug, Default)]
pub struct Steps {
    /// The number of rows.
    pub rows: usize,
    /// The reward of each step.
    pub rewards: Vec<f32>,
    /// The expected value before each step.
    pub values: Vec<f32>,
    /// The expected value after each step, still in the same episode.
    pub next_values: Vec<f32>,
    /// Whether the step ended the game, so that the expected value is 0.
    pub over: Vec<bool>,
    /// Whether the step ended the episode, so that the next step belongs to a new one.
    pub ended: Vec<bool>,
}

impl Steps {
    /// The advantage of every step, steps × rows. The sums of advantages and `values` are the
    /// returns to learn.
    pub fn advantages(&self, discount: f32, lambda: f32) -> Vec<f32> {
        let Steps {
            rows,
            rewards,
            values,
            next_values,
            over,
            ended,
        } = self;
        let mut advantages = vec![0.0; rewards.len()];
        for row in 0..*rows {
            let mut later = 0.0;
            for i in (row..rewards.len()).step_by(*rows).rev() {
                let next = if over[i] { 0.0 } else { next_values[i] };
                let surprise = rewards[i] + discount * next - values[i];
                later = surprise
                    + if ended[i] {
                        0.0
                    } else {
                        discount * lambda * later
                    };
                advantages[i] = later;
            }
        }
        advantages
    }
}

#[cfg(test)]
mod tests {
    use super::Steps;

    #[test]
    fn they_are_the_weighted_sums_of_all_later_surprises() {
        // Two rows of six steps: in the first, the game is over after the third step; the second is
        // cut off after the fourth.
        let rows = 2;
        let count = 6;
        let number = |i: usize| (0.37 * i as f32).fract() - 0.4;
        let steps = Steps {
            rows,
            rewards: (0..rows * count).map(number).collect(),
            values: (0..rows * count).map(|i| number(i + 50)).collect(),
            next_values: (0..rows * count).map(|i| number(i + 90)).collect(),
            over: (0..rows * count).map(|i| i == 4).collect(),
            ended: (0..rows * count).map(|i| i == 4 || i == 7).collect(),
        };
        let discount = 0.9_f32;
        let lambda = 0.8_f32;
        let got = steps.advantages(discount, lambda);
        for (first, got) in got.into_iter().enumerate() {
            let mut want = 0.0_f64;
            let mut weight = 1.0_f64;
            for i in (first..rows * count).step_by(rows) {
                let next = if steps.over[i] {
                    0.0
                } else {
                    steps.next_values[i]
                };
                want += weight * f64::from(steps.rewards[i] + discount * next - steps.values[i]);
                weight *= f64::from(discount * lambda);
                if steps.ended[i] {
                    break;
                }
            }
            assert!(
                (f64::from(got) - want).abs() < 1e-5,
                "{first}: got {got}, want {want}"
            );
        }
    }
}
