//! Quantiles of any number of values in bounded memory, accurate to one part in 128.
//!
//! Values are counted in bins of equal ratio, as in `HdrHistogram` (Tene) and `DDSketch` (Masson,
//! Rim and Lee, PVLDB 12, 2019). The bit patterns of non-negative numbers sort like the numbers, so
//! the exponent and the leading bits of the mantissa identify the bin.

use std::collections::BTreeMap;

/// The number of mantissa bits dropped: 7 of 52 are kept.
const DROPPED_BITS: u32 = 52 - 7;
/// Values below the smallest bin share a bin, and so do values above the largest.
const RANGE: (f64, f64) = (1e-3, 1e9);

/// A histogram of non-negative values.
#[derive(Clone, Debug, Default)]
pub(crate) struct Quantile {
    /// Count and largest value, by bin.
    bins: BTreeMap<u64, (u64, f64)>,
    count: u64,
}

impl Quantile {
    /// Adds a value; NaN counts as the largest.
    pub(crate) fn add(&mut self, value: f64) {
        let value = if value.is_nan() { f64::INFINITY } else { value };
        // Statistics are updated at each decision rather than computed from series, which took 500
        // MB for 40 boats in a recording of 1.3 GB.
        let (count, largest) = self
            .bins
            .entry(value.clamp(RANGE.0, RANGE.1).to_bits() >> DROPPED_BITS)
            .or_default();
        (*count, *largest) = (*count + 1, largest.max(value));
        self.count += 1;
    }

    /// The quantile at this fraction of the values, by nearest rank; at most one part in 128 too
    /// large. `None` without values.
    pub(crate) fn at(&self, share: f64) -> Option<f64> {
        let rank = ((share * self.count as f64).ceil() as u64).max(1);
        let mut reached = 0;
        let mut bins = self.bins.values().map(|(count, largest)| {
            reached += count;
            (reached, *largest)
        });
        bins.find(|(reached, _)| *reached >= rank)
            .map(|(_, largest)| largest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_is_the_nearest_rank_or_a_little_more(mut values in proptest::collection::vec(1e-3..1e6_f64, 1..300)) {
            let mut quantile = Quantile::default();
            values.iter().for_each(|value| quantile.add(*value));
            values.sort_by(f64::total_cmp);
            for share in [0.0, 0.5, 0.95, 1.0] {
                let exact = values[((share * values.len() as f64).ceil() as usize).max(1) - 1];
                let got = quantile.at(share).expect("there are some");
                prop_assert!(got >= exact && got <= exact * (1.0 + 1.0 / 128.0), "{got} for {exact} at {share}");
            }
        }
    }

    #[test]
    fn however_many_there_are_the_bins_are_few() {
        let mut quantile = Quantile::default();
        assert_eq!(quantile.at(0.95), None);
        (0..1_000_000).for_each(|i| quantile.add(f64::from(i) * 1e-3));
        assert!(quantile.bins.len() < 2600, "{}", quantile.bins.len());
        [f64::NAN, f64::INFINITY, 1e300, 0.0, 1e-300]
            .into_iter()
            .for_each(|odd| quantile.add(odd));
        assert!(
            quantile
                .at(0.5)
                .is_some_and(|median| (median - 500.0).abs() < 4.0)
                && quantile.bins.len() < 2600
        );
    }
}
