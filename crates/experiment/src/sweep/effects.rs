//! The effects of axes and their pairwise interactions: contrasts of means within seeds.
//!
//! All points play the same seeds, so differences are taken within each seed, and intervals are
//! over seeds alone. They describe these points, not other points of a sampled design.

use super::metric::{HEADLINES, METRICS, Metric, Metrics};
use super::plan::{Plan, Point};
use super::{AxisValue, Design};
use crate::estimate::{Estimate, OBSERVATIONS_MIN, mean_and_squares};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// The observation of a seed: the mean of both sides; `None` unless all its games were played.
pub(crate) type Observation = Option<Metrics>;

/// The observations by point, entry and seed.
pub(crate) struct Observations {
    pub(crate) by_point: Vec<Vec<Vec<Observation>>>,
}

/// The effect of an axis on an entry.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Effect {
    /// The key of the axis.
    pub axis: String,
    /// The name of the entry.
    pub entry: String,
    /// The levels from first to last; in a sampled design, groups of equally many points with
    /// ascending values.
    pub levels: Vec<Level>,
    /// By metric: the last level minus the first.
    pub contrasts: Vec<Option<Estimate>>,
}

/// The points at which an axis has one value, or neighbouring values.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Level {
    /// The label shown to people.
    pub label: String,
    /// For numeric axes, the mean value of the points.
    pub value: Option<f64>,
    /// The number of points.
    pub points: usize,
    /// The means over these points, by metric.
    pub metrics: Vec<Option<Estimate>>,
}

/// The interaction of two axes: their joint effect beyond their individual effects.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Interaction {
    /// The keys of the axes.
    pub axes: [String; 2],
    /// The name of the entry.
    pub entry: String,
    /// The name of the metric.
    pub metric: &'static str,
    /// The means where both are low, only the second is high, only the first is high, and both are
    /// high.
    pub cells: [f64; 4],
    /// The effect of the second axis where the first is high, minus its effect where the first is
    /// low.
    pub contrast: Estimate,
    /// The p-value of the contrast under the hypothesis of no interaction, uncorrected for multiple
    /// tests.
    pub p: f64,
    /// Whether it remains significant among all tests (Holm 1979, 5 %).
    pub matters: bool,
}

/// The points of one level, with its label and value.
struct Group {
    label: String,
    value: Option<f64>,
    points: Vec<usize>,
}

/// The minimum number of points in a group of a sampled axis.
const GROUP_POINTS_MIN: usize = 4;
/// The maximum number of groups of a sampled axis.
const GROUPS_MAX: usize = 8;

impl Observations {
    /// By seed: the mean of an entry's metric over points; `None` for seeds that are incomplete at
    /// any of these points.
    fn mean(&self, points: &[usize], entry: usize, metric: usize) -> Vec<Option<f64>> {
        let seeds = self
            .by_point
            .first()
            .and_then(|entries| entries.first())
            .map_or(0, Vec::len);
        let of_seed = |seed: usize| {
            let of_point =
                |point: &usize| Some(self.by_point[*point][entry][seed].as_ref()?.0[metric]);
            let all = points.iter().map(of_point).collect::<Option<Vec<f64>>>()?;
            let mean = all.iter().sum::<f64>() / all.len() as f64;
            mean.is_finite().then_some(mean)
        };
        (0..seeds).map(of_seed).collect()
    }

    /// The estimate of an entry's metric over points.
    pub(crate) fn estimate(
        &self,
        points: &[usize],
        entry: usize,
        metric: usize,
    ) -> Option<Estimate> {
        estimate(
            self.mean(points, entry, metric)
                .into_iter()
                .flatten()
                .collect(),
        )
    }

    /// The estimate of the difference of a metric between two entries at a point.
    pub(crate) fn difference(
        &self,
        point: usize,
        [one, other]: [usize; 2],
        metric: usize,
    ) -> Option<Estimate> {
        difference(
            &self.mean(&[point], one, metric),
            &self.mean(&[point], other, metric),
        )
    }
}

fn estimate(numbers: Vec<f64>) -> Option<Estimate> {
    (!numbers.is_empty()).then(|| Estimate::of(&numbers))
}

fn difference(one: &[Option<f64>], other: &[Option<f64>]) -> Option<Estimate> {
    estimate(
        one.iter()
            .zip(other)
            .filter_map(|(one, other)| Some((*one)? - (*other)?))
            .collect(),
    )
}

/// The effect of every axis on every entry.
pub(crate) fn effects(plan: &Plan, observed: &Observations) -> Vec<Effect> {
    let sweep = plan.sweep();
    let mut effects = vec![];
    for (k, axis) in sweep.axes.iter().enumerate() {
        let groups = groups(plan, k);
        for (entry, entrant) in sweep.entries.iter().enumerate() {
            let level = |group: &Group| Level {
                label: group.label.clone(),
                value: group.value,
                points: group.points.len(),
                metrics: (0..METRICS.len())
                    .map(|metric| observed.estimate(&group.points, entry, metric))
                    .collect(),
            };
            let contrast = |metric: usize| {
                let [first, last] = [groups.first()?, groups.last()?];
                let of = |group: &Group| observed.mean(&group.points, entry, metric);
                (groups.len() > 1).then(|| difference(&of(last), &of(first)))?
            };
            effects.push(Effect {
                axis: axis.key.clone(),
                entry: entrant.name.clone(),
                levels: groups.iter().map(level).collect(),
                contrasts: (0..METRICS.len()).map(contrast).collect(),
            });
        }
    }
    effects
}

/// The points grouped by the value of an axis; in a one-at-a-time design, only points where all
/// other axes are nominal.
fn groups(plan: &Plan, axis: usize) -> Vec<Group> {
    let sweep = plan.sweep();
    let points = plan.points();
    let about = &sweep.axes[axis];
    let others_are_nominal = |point: &Point| {
        let mut others = sweep
            .axes
            .iter()
            .zip(point)
            .enumerate()
            .filter(|(k, _)| *k != axis);
        others.all(|(_, (other, value))| *value == other.nominal())
    };
    let is_looked_at =
        |point: &Point| sweep.design != Design::OneAtATime || others_are_nominal(point);
    let is_sampled = matches!(sweep.design, Design::LatinHypercube | Design::Sobol);
    if is_sampled && about.values.is_empty() {
        return pieces(axis, points);
    }
    let group = |level: AxisValue| Group {
        label: level.to_string(),
        value: level.number(),
        points: (0..points.len())
            .filter(|i| is_looked_at(&points[*i]) && points[*i][axis] == level)
            .collect(),
    };
    let mut levels = about.levels();
    // In a one-at-a-time design the nominal value may not be one of the levels.
    let nominal = about.nominal();
    if sweep.design == Design::OneAtATime && !levels.contains(&nominal) {
        levels.push(nominal);
        levels.sort_by(|a, b| {
            a.number()
                .unwrap_or(0.0)
                .total_cmp(&b.number().unwrap_or(0.0))
        });
    }
    levels
        .into_iter()
        .map(group)
        .filter(|group| !group.points.is_empty())
        .collect()
}

/// Groups of an axis with equally many points.
fn pieces(axis: usize, points: &[Point]) -> Vec<Group> {
    let number = |i: &usize| points[*i][axis].number().unwrap_or(f64::NAN);
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|a, b| number(a).total_cmp(&number(b)));
    let count = (points.len() / GROUP_POINTS_MIN).clamp(1, GROUPS_MAX);
    let piece = |i: usize| {
        let points = order[i * order.len() / count..(i + 1) * order.len() / count].to_vec();
        let mean = points.iter().map(number).sum::<f64>() / points.len() as f64;
        let digits = if mean.abs() < 1.0 { 3 } else { 2 };
        Group {
            label: format!("{mean:.digits$}"),
            value: Some(mean),
            points,
        }
    };
    (0..count).map(piece).collect()
}

/// All pairwise interactions for the headline metrics, significant ones first.
pub(crate) fn interactions(plan: &Plan, observed: &Observations) -> Vec<Interaction> {
    let sweep = plan.sweep();
    if sweep.design == Design::OneAtATime {
        return vec![];
    }
    let halves: Vec<[Vec<usize>; 2]> = (0..sweep.axes.len())
        .map(|axis| halves(&groups(plan, axis)))
        .collect();
    let mut found = vec![];
    for a in 0..sweep.axes.len() {
        for b in a + 1..sweep.axes.len() {
            let cell = |i: usize| -> Vec<usize> {
                let one = &halves[a][i / 2];
                let other = &halves[b][i % 2];
                one.iter()
                    .filter(|point| other.contains(point))
                    .copied()
                    .collect()
            };
            let cells = [0, 1, 2, 3].map(cell);
            if cells.iter().any(Vec::is_empty) {
                continue;
            }
            let axes = [a, b].map(|axis| sweep.axes[axis].key.clone());
            for entry in 0..sweep.entries.len() {
                let of = |metric: &&'static str| {
                    interaction(plan, observed, (&axes, &cells), entry, metric)
                };
                found.extend(HEADLINES.iter().filter_map(of));
            }
        }
    }
    mark_those_that_matter(&mut found);
    found
}

/// The points at the low and the high end of an axis: the first and the last level, or the halves
/// if there are many.
fn halves(groups: &[Group]) -> [Vec<usize>; 2] {
    let middle = groups.len() / 2;
    let of = |groups: &[Group]| {
        groups
            .iter()
            .flat_map(|group| group.points.clone())
            .collect::<Vec<usize>>()
    };
    [of(&groups[..middle]), of(&groups[groups.len() - middle..])]
}

/// The interaction of two axes, whose points are in four cells as in [`Interaction::cells`].
fn interaction(
    plan: &Plan,
    observed: &Observations,
    (axes, cells): (&[String; 2], &[Vec<usize>; 4]),
    entry: usize,
    metric: &'static str,
) -> Option<Interaction> {
    let place = Metric::place(metric)?;
    let means = [0, 1, 2, 3].map(|cell| observed.mean(&cells[cell], entry, place));
    let contrast = |seed: usize| {
        let [low, second, first, both] = [0, 1, 2, 3].map(|cell| means[cell][seed]);
        Some(both? - first? - second? + low?)
    };
    let contrasts: Vec<f64> = (0..means[0].len()).filter_map(contrast).collect();
    let p = probability(&contrasts)?;
    let mean = |cell: usize| {
        let known: Vec<f64> = means[cell].iter().copied().flatten().collect();
        known.iter().sum::<f64>() / known.len() as f64
    };
    Some(Interaction {
        axes: axes.clone(),
        entry: plan.sweep().entries[entry].name.clone(),
        metric,
        cells: [0, 1, 2, 3].map(mean),
        contrast: Estimate::of(&contrasts),
        p,
        matters: false,
    })
}

/// The p-value of the mean of these numbers against 0, by Student's t; `None` for fewer than
/// [`OBSERVATIONS_MIN`] numbers.
fn probability(numbers: &[f64]) -> Option<f64> {
    let count = numbers.len() as f64;
    if numbers.len() < OBSERVATIONS_MIN {
        return None;
    }
    let (mean, squares) = mean_and_squares(numbers);
    let error = (squares / (count - 1.0) / count).sqrt();
    if error == 0.0 {
        return Some(if mean == 0.0 { 1.0 } else { 0.0 });
    }
    let student = StudentsT::new(0.0, 1.0, count - 1.0).ok()?;
    Some(2.0 * (1.0 - student.cdf((mean / error).abs())))
}

/// Applies Holm's procedure at 5 %, for each metric over all pairs and entries; then sorts the
/// significant ones first, by ascending p-value.
fn mark_those_that_matter(found: &mut [Interaction]) {
    found.sort_by(|a, b| a.p.total_cmp(&b.p));
    for metric in HEADLINES {
        let mut of_metric: Vec<&mut Interaction> = found
            .iter_mut()
            .filter(|one| one.metric == metric)
            .collect();
        let count = of_metric.len();
        for (i, one) in of_metric.iter_mut().enumerate() {
            if one.p > 0.05 / (count - i) as f64 {
                break;
            }
            one.matters = true;
        }
    }
    found.sort_by_key(|one| !one.matters);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_probability_is_that_of_the_tables_of_student() {
        // A mean of 1 with a standard error of 1 / 2.2622 over 10 numbers: the 97.5 % quantile with
        // 9 degrees of freedom.
        let spread = 1.0 / 2.2622 * 3.0;
        let numbers: Vec<f64> = (0..10)
            .map(|i| 1.0 + if i % 2 == 0 { spread } else { -spread })
            .collect();
        let p = probability(&numbers).expect("ten numbers");
        assert!((p - 0.05).abs() < 1e-4, "{p}");
        assert_eq!(
            (
                probability(&[2.0; 4]),
                probability(&[2.0; 5]),
                probability(&[0.0; 5])
            ),
            (None, Some(0.0), Some(1.0))
        );
        // Four equal seeds give no certainty.
        assert_eq!(
            estimate(vec![2.0; 4]),
            Some(Estimate {
                mean: 2.0,
                low: None,
                high: None
            })
        );
        assert!(estimate(vec![2.0; 5]).is_some_and(|five| five.low == Some(2.0)));
    }

    #[test]
    fn holm_stops_at_the_first_that_does_not_stand() {
        let of = |p: f64| Interaction {
            axes: ["a".to_owned(), "b".to_owned()],
            entry: "one".to_owned(),
            metric: "score",
            cells: [0.0; 4],
            contrast: Estimate {
                mean: 1.0,
                low: None,
                high: None,
            },
            p,
            matters: false,
        };
        // 0.01 < 0.05 / 4, and 0.02 > 0.05 / 3; 0.024 is below 0.05 / 2, but comes after a failed
        // test.
        let mut found = [0.024, 0.9, 0.01, 0.02].map(of);
        mark_those_that_matter(&mut found);
        assert_eq!(
            found.map(|one| (one.p, one.matters)),
            [(0.01, true), (0.02, false), (0.024, false), (0.9, false)]
        );
    }
}
