//! Orbits: a boat circles the same point at the same radius, again and again.
//!
//! A circle is fitted to the last minute of a track (Kåsa's linear least squares: Kåsa, IEEE
//! Transactions on Instrumentation and Measurement 25, 1976). It is an orbit if every position is
//! near the circle and the boat completed at least one turn in that minute.

use primitives::Ned;
use primitives::angle::wrap_pi;
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// Minimum duration of an orbit, s.
pub const ORBIT_MIN_S: f64 = 60.0;
/// Time between examined positions, s.
const SPACING_S: f64 = 1.0;
/// Tolerated deviation of positions from the circle: a distance (m), or a fraction of the radius if
/// that is larger. Waves and gusts move a boat by that much.
const OFF_M: f64 = 1.0;
const OFF_SHARE: f64 = 0.15;
/// Radius within which a boat counts as at rest, m.
const RADIUS_MIN_M: f64 = 1.0;

/// Finds the orbits of one boat.
#[derive(Clone, Debug, Default)]
pub(super) struct OrbitDetector {
    /// Times, s, and positions of the last minute.
    places: VecDeque<(f64, Ned)>,
    is_orbit: bool,
}

/// The contribution of one position to the orbits of a boat.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct OrbitPart {
    /// Whether this position starts an orbit.
    pub(super) begun: bool,
    /// Orbit time not counted yet, s.
    pub(super) lasted_s: f64,
}

impl OrbitDetector {
    /// Adds the next position of the track.
    pub(super) fn add(&mut self, time_s: f64, at: Ned) -> OrbitPart {
        /// Rounding error of times, s.
        const ROUNDING_S: f64 = 1e-6;
        let last_s = self
            .places
            .back()
            .map_or(f64::NEG_INFINITY, |(last_s, _)| *last_s);
        if time_s - last_s < SPACING_S - ROUNDING_S {
            return OrbitPart::default();
        }
        self.places.push_back((time_s, at));
        while self
            .places
            .get(1)
            .is_some_and(|(second_s, _)| time_s - second_s >= ORBIT_MIN_S - ROUNDING_S)
        {
            self.places.pop_front();
        }
        let first_s = self.places.front().map_or(time_s, |(first_s, _)| *first_s);
        let is_orbit = time_s - first_s >= ORBIT_MIN_S - ROUNDING_S && goes_round(&self.places);
        let was_orbit = std::mem::replace(&mut self.is_orbit, is_orbit);
        match (was_orbit, is_orbit) {
            (_, false) => OrbitPart::default(),
            (false, true) => OrbitPart {
                begun: true,
                lasted_s: time_s - first_s,
            },
            (true, true) => OrbitPart {
                begun: false,
                lasted_s: time_s - last_s,
            },
        }
    }
}

/// Whether a track lies on a circle and completes at least one turn.
fn goes_round(places: &VecDeque<(f64, Ned)>) -> bool {
    let Some((centre, radius_m)) = circle(places) else {
        return false;
    };
    let off_m = OFF_M.max(OFF_SHARE * radius_m);
    if radius_m < RADIUS_MIN_M
        || places
            .iter()
            .any(|(_, at)| (at.distance(centre) - radius_m).abs() > off_m)
    {
        return false;
    }
    let bearings = places.iter().map(|(_, at)| centre.bearing_rad(*at));
    let swept_rad: f64 = bearings
        .clone()
        .zip(bearings.skip(1))
        .map(|(from, to)| wrap_pi(to - from))
        .sum();
    swept_rad.abs() >= TAU
}

/// The best-fitting circle, as centre and radius in m; `None` for a straight line.
///
/// Relative to the mean position, the centre solves two linear equations in the second and third
/// moments.
fn circle(places: &VecDeque<(f64, Ned)>) -> Option<(Ned, f64)> {
    let share = 1.0 / places.len() as f64;
    let mean = places
        .iter()
        .fold(Ned::default(), |sum, (_, at)| sum + *at)
        .scaled(share);
    let mut nn = 0.0;
    let mut ee = 0.0;
    let mut ne = 0.0;
    let mut third = Ned::default();
    for (_, at) in places {
        let p = *at - mean;
        nn += p.north * p.north;
        ee += p.east * p.east;
        ne += p.north * p.east;
        third = third + p.scaled(0.5 * p.dot(p));
    }
    let determinant = nn * ee - ne * ne;
    if determinant <= 1e-9 * (nn + ee) * (nn + ee) {
        return None;
    }
    let north = (third.north * ee - third.east * ne) / determinant;
    let east = (third.east * nn - third.north * ne) / determinant;
    let radius_m = (north * north + east * east + (nn + ee) * share).sqrt();
    radius_m
        .is_finite()
        .then_some((mean + Ned { north, east }, radius_m))
}

#[cfg(test)]
mod tests {
    use super::*;
    use primitives::math;

    /// Number and duration (s) of the orbits of a boat with these positions, sampled ten times a
    /// second.
    fn orbits(span_s: f64, at: impl Fn(f64) -> Ned) -> (u64, f64) {
        let mut detector = OrbitDetector::default();
        let steps = (span_s * 10.0).round() as usize;
        let parts = (0..=steps)
            .map(|i| i as f64 / 10.0)
            .map(|time_s| detector.add(time_s, at(time_s)));
        parts.fold((0, 0.0), |(count, lasted_s), part| {
            (count + u64::from(part.begun), lasted_s + part.lasted_s)
        })
    }

    fn round(radius_m: f64, turn_rad: f64) -> Ned {
        let (sin, cos) = math::sin_cos(turn_rad);
        Ned {
            north: 100.0 + radius_m * cos,
            east: -50.0 + radius_m * sin,
        }
    }

    #[test]
    fn a_circle_is_an_orbit_for_as_long_as_it_lasts() {
        let is = |got: (u64, f64), count: u64, lasted_s: f64| {
            got.0 == count && (got.1 - lasted_s).abs() < 1e-6
        };
        for radius_m in [2.0, 4.0, 15.0] {
            let got = orbits(200.0, |time_s| round(radius_m, -TAU * time_s / 20.0));
            assert!(is(got, 1, 200.0), "{radius_m} m: {got:?}");
        }
        let short = orbits(59.0, |time_s| round(4.0, TAU * time_s / 20.0));
        assert!(is(short, 0, 0.0), "less than a minute: {short:?}");
        // Two orbits of a minute and a half each, with a straight run of 100 s between.
        let twice = orbits(280.0, |time_s| match time_s {
            before if before < 90.0 => round(4.0, TAU * before / 20.0),
            between if between < 190.0 => {
                round(4.0, TAU * 4.5)
                    + Ned {
                        north: -(between - 90.0),
                        east: 0.0,
                    }
            }
            after => {
                round(4.0, TAU * (after - 180.0) / 20.0)
                    + Ned {
                        north: -100.0,
                        east: 0.0,
                    }
            }
        });
        assert!(twice.0 == 2 && (twice.1 - 180.0).abs() < 4.0, "{twice:?}");
    }

    #[test]
    fn what_is_no_circle_is_no_orbit() {
        let straight = |time_s: f64| Ned {
            north: 1.5 * time_s,
            east: -time_s,
        };
        let still = |_: f64| Ned {
            north: 3.0,
            east: 4.0,
        };
        let ellipse = |time_s: f64| {
            let at = round(10.0, TAU * time_s / 40.0);
            Ned {
                north: 2.0 * at.north,
                east: at.east,
            }
        };
        let slow = |time_s: f64| round(20.0, TAU * time_s / 100.0);
        let to_and_fro = |time_s: f64| round(10.0, 2.0 * math::sin_cos(TAU * time_s / 30.0).0);
        let spiral = |time_s: f64| round(2.0 + 0.2 * time_s, TAU * time_s / 20.0);
        for (what, got) in [
            ("a straight line", orbits(200.0, straight)),
            ("lying still", orbits(200.0, still)),
            ("an ellipse", orbits(200.0, ellipse)),
            ("less than once round in a minute", orbits(200.0, slow)),
            ("an arc to and fro", orbits(200.0, to_and_fro)),
            ("a spiral", orbits(200.0, spiral)),
        ] {
            assert_eq!(got.0, 0, "{what}: {got:?}");
        }
    }
}
