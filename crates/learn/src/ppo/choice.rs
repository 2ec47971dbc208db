//! The choice among discrete actions by their logits.

/// Computes the log probabilities of actions.
pub fn log_probabilities(logits: &[f32], out: &mut [f32]) {
    let most = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let sum: f32 = logits.iter().map(|logit| libm::expf(logit - most)).sum();
    let less = most + libm::logf(sum);
    out.iter_mut()
        .zip(logits)
        .for_each(|(out, logit)| *out = logit - less);
}

/// The action that a uniform random number from 0 to 1 selects.
pub fn drawn(log_probabilities: &[f32], unit: f64) -> usize {
    let mut left = unit;
    let chosen = log_probabilities.iter().position(|log| {
        left -= f64::from(libm::expf(*log));
        left < 0.0
    });
    chosen.unwrap_or_else(|| likeliest(log_probabilities))
}

/// The action with the largest logit. Ties go to the first.
pub fn likeliest(logits: &[f32]) -> usize {
    (1..logits.len()).fold(0, |best, i| if logits[i] > logits[best] { i } else { best })
}

#[cfg(test)]
mod tests {
    use super::{drawn, likeliest, log_probabilities};

    #[test]
    fn probabilities_are_those_of_the_logits() {
        let logits = [1.0_f32, -2.0, 0.5, 80.0, 79.0];
        let mut logs = [0.0; 5];
        log_probabilities(&logits, &mut logs);
        let sum: f64 = logs.iter().map(|log| libm::exp(f64::from(*log))).sum();
        assert!(
            (sum - 1.0).abs() < 1e-5 && (logs[3] - logs[4] - 1.0).abs() < 1e-5,
            "{logs:?}"
        );
        assert_eq!(likeliest(&logits), 3);
        let counts = (0..10_000).fold([0_u32; 5], |mut counts, i| {
            counts[drawn(&logs, (f64::from(i) + 0.5) / 10_000.0)] += 1;
            counts
        });
        assert!(
            (i64::from(counts[3]) - 7311).abs() <= 1 && counts[..3] == [0; 3],
            "{counts:?}"
        );
        assert_eq!(drawn(&logs, 1.0), 3);
    }
}
