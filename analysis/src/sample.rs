//! Made-up games whose figures are known in closed form.

use super::book::{Boat, Book, Moment};
use game::math;
use game::picture::Nav;
use std::f64::consts::TAU;

/// A book of moments every 0.1 s up to `span_s`, in which one boat does this.
pub(super) fn book(span_s: f64, at: impl Fn(f64) -> Moment) -> Book {
    let times_s: Vec<f64> = (0..=(span_s * 10.0).round() as usize).map(|i| i as f64 / 10.0).collect();
    let moments = times_s.iter().map(|time_s| at(*time_s)).collect();
    let boat = Boat { name: "blue_one".to_owned(), moments, ..Boat::default() };
    let score = vec![vec![0, 0]; times_s.len()];
    let teams = vec!["blue".to_owned(), "red".to_owned()];
    Book { boats: vec![boat], teams, score, times_s, events: vec![] }
}

/// A boat that sails clockwise about the datum, once in 100 s.
pub(super) fn circle(radius_m: f64, span_s: f64) -> Book {
    book(span_s, |time_s| {
        let turn_rad = TAU * time_s / 100.0;
        let (sin, cos) = math::sin_cos(turn_rad);
        let nav = Nav {
            north_m: radius_m * cos,
            east_m: radius_m * sin,
            psi_rad: turn_rad + TAU / 4.0,
            surge_m_s: TAU * radius_m / 100.0,
            ..Nav::default()
        };
        Moment { truth: nav, ..Moment::default() }
    })
}
