//! The distance between two tracks, sample by sample and as shapes.

use crate::series::{BoatSeries, GameSeries};
use primitives::Ned;
use serde::{Deserialize, Serialize};

/// Distance between a boat's tracks in two games.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrackDifference {
    /// Mean distance at the same time, m.
    pub mean_m: f64,
    /// Root mean square distance, m.
    pub rms_m: f64,
    /// Largest distance, m.
    pub max_m: f64,
    /// Distance at the end of the common time, m.
    pub final_m: f64,
    /// Discrete Fréchet distance of the tracks as shapes, m: the shortest leash with which two
    /// walkers can follow one track each, pausing but never going back. Timing does not count.
    pub frechet_m: f64,
}

/// Maximum points per track: time grows with the product of both tracks' points, memory with their
/// sum.
const SHAPE_POINTS: usize = 2000;

/// Distance between a boat's tracks in two games in their common time; `None` without a common
/// sample.
pub(crate) fn apart(
    (a, in_a): (&GameSeries, &BoatSeries),
    (b, in_b): (&GameSeries, &BoatSeries),
) -> Option<TrackDifference> {
    let begin_s = a.times_s.first()?.max(*b.times_s.first()?);
    let end_s = a.times_s.last()?.min(*b.times_s.last()?);
    let common = |series: &GameSeries, boat: &BoatSeries| -> (Vec<f64>, Vec<Ned>) {
        let all = series.times_s.iter().copied().zip(boat.track());
        all.filter(|(time_s, _)| (begin_s..=end_s).contains(time_s))
            .unzip()
    };
    let (times_s, common_a) = common(a, in_a);
    let (_, common_b) = common(b, in_b);
    let track_b: Vec<Ned> = in_b.track().collect();
    let distance_m =
        |(time_s, at): (&f64, &Ned)| at.distance(place_at(&b.times_s, &track_b, *time_s));
    // Compare at the times of the first game's samples.
    let distances_m: Vec<f64> = times_s.iter().zip(&common_a).map(distance_m).collect();
    let final_m = *distances_m.last()?;
    Some(TrackDifference {
        mean_m: distances_m.iter().sum::<f64>() / distances_m.len() as f64,
        rms_m: crate::statistics::rms(distances_m.iter().copied())?,
        max_m: distances_m.iter().copied().fold(0.0, f64::max),
        final_m,
        frechet_m: frechet_m(&thinned(&common_a), &thinned(&common_b)),
    })
}

/// The position on a track at a time, interpolated linearly.
fn place_at(times_s: &[f64], track: &[Ned], time_s: f64) -> Ned {
    let after = times_s
        .partition_point(|t| *t < time_s)
        .min(track.len() - 1);
    let before = after.saturating_sub(1);
    let step_s = times_s[after] - times_s[before];
    let share = if step_s > 0.0 {
        ((time_s - times_s[before]) / step_s).clamp(0.0, 1.0)
    } else {
        1.0
    };
    // This weighted sum yields each sample's own position exactly.
    track[before].scaled(1.0 - share) + track[after].scaled(share)
}

/// Every nth point, and the last.
fn thinned(track: &[Ned]) -> Vec<Ned> {
    let every = track.len().div_ceil(SHAPE_POINTS).max(1);
    let last = track
        .last()
        .filter(|_| !(track.len() - 1).is_multiple_of(every));
    track.iter().step_by(every).chain(last).copied().collect()
}

/// The discrete Fréchet distance of two tracks, m (Eiter and Mannila, "Computing discrete Fréchet
/// distance", Technical Report CD-TR 94/64, TU Wien 1994), computed row by row instead of
/// recursively.
fn frechet_m(a: &[Ned], b: &[Ned]) -> f64 {
    let mut row: Vec<f64> = vec![];
    for (i, place) in a.iter().enumerate() {
        let mut diagonal = f64::INFINITY;
        for (j, other) in b.iter().enumerate() {
            let left = if j > 0 { row[j - 1] } else { f64::INFINITY };
            let above = if i > 0 { row[j] } else { f64::INFINITY };
            let reached = if i == 0 && j == 0 {
                0.0
            } else {
                left.min(above).min(diagonal)
            };
            let leash = reached.max(place.distance_squared(*other));
            diagonal = above;
            if i == 0 {
                row.push(leash)
            } else {
                row[j] = leash
            }
        }
    }
    row.last().copied().unwrap_or(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made_up;
    use std::f64::consts::TAU;

    fn line(points: &[(f64, f64)]) -> Vec<Ned> {
        points.iter().map(|(x, y)| Ned::from_xy(*x, *y)).collect()
    }

    #[test]
    fn the_leash_is_as_long_as_the_worst_place() {
        let there = line(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.0)]);
        let beside = line(&[(0.0, 2.0), (1.0, 2.0), (2.0, 2.0), (3.0, 2.0)]);
        let mut back = there.clone();
        back.reverse();
        // The same track with a pause; a detour; the track back, whose ends are 3 m apart.
        let rest = line(&[
            (0.0, 0.0),
            (1.0, 0.0),
            (1.0, 0.0),
            (1.0, 0.0),
            (2.0, 0.0),
            (3.0, 0.0),
        ]);
        let detour = line(&[(0.0, 0.0), (1.0, 5.0), (3.0, 0.0)]);
        for (other, want_m) in [
            (&there, 0.0),
            (&beside, 2.0),
            (&rest, 0.0),
            (&detour, 26.0_f64.sqrt().min(5.0)),
            (&back, 3.0),
        ] {
            let got_m = frechet_m(&there, other);
            assert!((got_m - want_m).abs() < 1e-12, "{other:?}: {got_m}");
            assert_eq!(got_m, frechet_m(other, &there));
        }
        assert_eq!(frechet_m(&[], &[]), 0.0);
    }

    #[test]
    fn a_boat_that_is_late_is_apart_in_time_and_not_in_shape() {
        let a = made_up::circle(20.0, 100.0);
        let mut b = a.clone();
        // Waits 5 s at the start.
        let samples = b.boats[0].samples.clone();
        for (i, sample) in b.boats[0].samples.iter_mut().enumerate() {
            *sample = samples[i.saturating_sub(50)];
        }
        let apart = apart((&a, &a.boats[0]), (&b, &b.boats[0])).expect("they were on together");
        let chord_m = 2.0 * 20.0 * primitives::math::sin_cos(TAU * 5.0 / 100.0 / 2.0).0;
        assert!(
            (apart.max_m - chord_m).abs() < 1e-9 && (apart.final_m - chord_m).abs() < 1e-9,
            "{apart:?}"
        );
        assert!(
            apart.mean_m < chord_m && apart.rms_m < chord_m && apart.mean_m > 0.9 * chord_m,
            "{apart:?}"
        );
    }

    #[test]
    fn a_track_lies_on_itself_however_it_is_sampled() {
        let a = made_up::circle(20.0, 50.0);
        let mut coarse = a.clone();
        let even = |i: &usize| i.is_multiple_of(2);
        coarse.times_s = (0..a.times_s.len())
            .filter(even)
            .map(|i| a.times_s[i])
            .collect();
        coarse.boats[0].samples = (0..a.times_s.len())
            .filter(even)
            .map(|i| a.boats[0].samples[i])
            .collect();
        let apart = apart((&a, &a.boats[0]), (&coarse, &coarse.boats[0])).expect("a track");
        assert!(apart.max_m < 1e-3, "{apart:?}");
    }

    #[test]
    fn long_tracks_are_thinned_and_keep_their_ends() {
        let long: Vec<Ned> = (0..10_001)
            .map(|i| Ned::from_xy(f64::from(i), 0.0))
            .collect();
        let thin = thinned(&long);
        assert!(thin.len() <= SHAPE_POINTS + 1 && thin[0] == long[0] && thin.last() == long.last());
        assert_eq!(thinned(&long[..7]), &long[..7]);
    }
}
