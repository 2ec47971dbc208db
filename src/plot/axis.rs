//! The axis of a panel, with its label positions.

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use std::ops::Range;

/// Maximum number of labels on an axis.
const LABELS: f64 = 9.0;
/// Allowed steps between labels of angles, degrees.
const ANGLES_DEG: [f64; 12] = [
    1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0, 360.0, 720.0, 1800.0,
];

/// An axis with labels at multiples of 1, 2 or 5, or for angles at compass steps.
pub(crate) struct Axis {
    range: (f64, f64),
    labels: Vec<f64>,
    /// Decimal places of the labels.
    pub(crate) places: usize,
}

impl Axis {
    /// The axis with this name and unit, over a non-empty range.
    pub(crate) fn new(name: &str, range: (f64, f64)) -> Axis {
        let wide = range.1 - range.0;
        let is_enough = |step: &f64| wide / step <= LABELS;
        let mut places = 12;
        let mut step = 1e-12;
        let decimal = loop {
            match [step, 2.0 * step, 5.0 * step].into_iter().find(is_enough) {
                Some(step) => break step,
                None => (step, places) = (10.0 * step, places - 1),
            }
        };
        let angle = Some(ANGLES_DEG).filter(|_| name.contains("degrees") && decimal >= 1.0);
        let step = angle
            .and_then(|steps| steps.into_iter().find(is_enough))
            .unwrap_or(decimal);
        let first = (range.0 / step - 1e-9).ceil();
        let count = (range.1 / step + 1e-9).floor() - first;
        let labels = (0..=count.clamp(0.0, LABELS) as u32)
            .map(|i| (first + f64::from(i)) * step)
            .collect();
        Axis {
            range,
            labels,
            places: usize::try_from(places).unwrap_or_default(),
        }
    }
}

impl Ranged for Axis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let share = (value - self.range.0) / (self.range.1 - self.range.0);
        limit.0 + (share * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            vec![]
        } else {
            self.labels.clone()
        }
    }

    fn range(&self) -> Range<f64> {
        self.range.0..self.range.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_stand_at_round_numbers_with_the_places_they_need() {
        for (name, range, want) in [
            ("m", (0.0, 100.0), "0 20 40 60 80 100"),
            ("m/s", (-0.1, 1.9), "0.0 0.5 1.0 1.5"),
            ("m", (0.93, 1.13), "0.95 1.00 1.05 1.10"),
            ("m", (-3.0, -1.0), "-3.0 -2.5 -2.0 -1.5 -1.0"),
            (
                "N",
                (0.0, 4e6),
                "0 500000 1000000 1500000 2000000 2500000 3000000 3500000 4000000",
            ),
            ("degrees", (0.0, 360.0), "0 45 90 135 180 225 270 315 360"),
            ("degrees", (-20.0, 3810.0), "0 720 1440 2160 2880 3600"),
            ("degrees", (-0.3, 0.3), "-0.3 -0.2 -0.1 0.0 0.1 0.2 0.3"),
            ("degrees", (0.0, 1e5), "0 20000 40000 60000 80000 100000"),
        ] {
            let Axis { labels, places, .. } = Axis::new(name, range);
            let labels: Vec<String> = labels
                .into_iter()
                .map(|at| primitives::math::decimal(at, places))
                .collect();
            assert_eq!(labels.join(" "), want, "{name} {range:?}");
        }
    }

    #[test]
    fn any_range_has_an_axis() {
        for range in [(0.0, 1e-11), (-1e300, 1e300), (5.0, 5.0 + 1e-9)] {
            let Axis { labels, .. } = Axis::new("m", range);
            assert!(
                labels.len() <= LABELS as usize + 1 && labels.iter().all(|at| at.is_finite()),
                "{range:?}"
            );
        }
    }
}
