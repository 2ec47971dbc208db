//! Synthetic games whose statistics are known in closed form.

use crate::series::{BoatSeries, GameSeries};
use crate::step::Sample;
use messages::picture::Nav;
use primitives::math;
use std::f64::consts::TAU;

/// A game with samples every 0.1 s up to `span_s`, in which one boat moves as given by `at`.
pub(crate) fn game(span_s: f64, at: impl Fn(f64) -> Sample) -> GameSeries {
    let times_s: Vec<f64> = (0..=(span_s * 10.0).round() as usize)
        .map(|i| i as f64 / 10.0)
        .collect();
    let samples = times_s.iter().map(|time_s| at(*time_s)).collect();
    let boat = BoatSeries {
        name: "blue_one".to_owned(),
        samples,
        ..BoatSeries::default()
    };
    let score = vec![vec![0, 0]; times_s.len()];
    let teams = vec!["blue".to_owned(), "red".to_owned()];
    GameSeries {
        boats: vec![boat],
        teams,
        score,
        times_s,
        ..GameSeries::default()
    }
}

/// A boat that drives clockwise around the datum, once in 100 s.
pub(crate) fn circle(radius_m: f64, span_s: f64) -> GameSeries {
    game(span_s, |time_s| {
        let turn_rad = TAU * time_s / 100.0;
        let (sin, cos) = math::sin_cos(turn_rad);
        let nav = Nav {
            north_m: radius_m * cos,
            east_m: radius_m * sin,
            psi_rad: turn_rad + TAU / 4.0,
            surge_m_s: TAU * radius_m / 100.0,
            ..Nav::default()
        };
        Sample {
            truth: nav,
            ..Sample::default()
        }
    })
}
