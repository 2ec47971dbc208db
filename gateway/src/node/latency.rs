//! Latencies through the gateway.

use hdrhistogram::Histogram;
use std::time::{Duration, Instant};

/// Maximum latency recorded, µs.
const LONGEST_US: u64 = 60_000_000;

/// The latencies of one path, µs.
pub(super) struct Latency(Histogram<u64>);

impl Latency {
    pub(super) fn new() -> Latency {
        // With three significant digits, memory stays bounded however long the gateway runs.
        Latency(Histogram::new_with_bounds(1, LONGEST_US, 3).expect("valid bounds"))
    }

    pub(super) fn note(&mut self, from: Instant, to: Instant) {
        let took: Duration = to.saturating_duration_since(from);
        let micros = u64::try_from(took.as_micros()).unwrap_or(LONGEST_US);
        self.0.saturating_record(micros.max(1));
    }

    /// Median and 99th percentile, µs.
    pub(super) fn summary_us(&self) -> Option<[f64; 2]> {
        let at = |quantile: f64| self.0.value_at_quantile(quantile) as f64;
        (!self.0.is_empty()).then(|| [at(0.5), at(0.99)])
    }
}
