//! Decides when a point counts as reached.

use primitives::Ned;
use primitives::angle::wrap_pi;
use std::f64::consts::TAU;

/// How far beyond its closest distance a point must be to count as receding, m; less may be noise.
const AWAY_M: f64 = 0.5;

/// A point that the boat approaches. It is reached within the capture radius, or within the slip
/// radius once it recedes. A boat that has circled the point cannot turn tightly enough to reach
/// it. The point then counts as reached, as does every later point that the boat approaches as
/// closely.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arrival {
    nearest_m: f64,
    /// The bearing of the point and its accumulated change, rad.
    bearing_rad: Option<f64>,
    turned_rad: f64,
    /// Distance at which the boat has circled a point, m: closer points count as reached.
    gone_round_m: f64,
}

impl Arrival {
    pub(super) fn new() -> Arrival {
        Arrival {
            nearest_m: f64::INFINITY,
            bearing_rad: None,
            turned_rad: 0.0,
            gone_round_m: 0.0,
        }
    }

    /// The approach to the next point.
    pub(super) fn next(self) -> Arrival {
        Arrival {
            gone_round_m: self.gone_round_m,
            ..Arrival::new()
        }
    }

    /// Whether the boat reaches the point; `line` is the point's position relative to the boat.
    pub(super) fn reaches(&mut self, line: Ned, capture_radius_m: f64, slip_radius_m: f64) -> bool {
        let distance_m = line.length();
        let bearing_rad = Ned::default().bearing_rad(line);
        let before_rad = self.bearing_rad.replace(bearing_rad).unwrap_or(bearing_rad);
        self.turned_rad += wrap_pi(bearing_rad - before_rad);
        if self.turned_rad.abs() >= TAU {
            self.gone_round_m = self.gone_round_m.max(distance_m);
        }
        self.nearest_m = self.nearest_m.min(distance_m);
        distance_m <= capture_radius_m.max(self.gone_round_m)
            || (self.nearest_m <= slip_radius_m && distance_m > self.nearest_m + AWAY_M)
    }
}

#[cfg(test)]
mod tests {
    use super::Arrival;
    use primitives::{Ned, math};
    use std::f64::consts::TAU;

    fn line(distance_m: f64, bearing_rad: f64) -> Ned {
        let (sin, cos) = math::sin_cos(bearing_rad);
        Ned {
            north: distance_m * cos,
            east: distance_m * sin,
        }
    }

    #[test]
    fn a_point_is_reached_near_by_or_when_it_draws_away_within_the_slip_radius() {
        for (what, distances_m, want) in [
            ("not yet", &[20.0, 10.0, 6.0][..], false),
            ("captured", &[20.0, 10.0, 2.9], true),
            (
                "receding within the slip radius",
                &[20.0, 10.0, 6.0, 6.6],
                true,
            ),
            ("noise", &[20.0, 10.0, 6.0, 6.3], false),
            ("receding too far away", &[20.0, 16.0, 18.0], false),
        ] {
            let mut arrival = Arrival::new();
            let got = distances_m.iter().fold(false, |_, distance_m| {
                arrival.reaches(line(*distance_m, 1.0), 3.0, 15.0)
            });
            assert_eq!(got, want, "{what}");
        }
    }

    #[test]
    fn a_point_that_was_gone_round_is_reached_and_so_are_those_as_near_after_it() {
        // A 5 m circle around the point at 10 degrees per decision, in either direction: never
        // within the capture radius, never receding.
        for side in [1.0, -1.0] {
            let mut arrival = Arrival::new();
            let bearing_rad = |decision: u32| side * TAU * f64::from(decision) / 36.0;
            let first = (0..100)
                .find(|decision| arrival.reaches(line(5.0, bearing_rad(*decision)), 3.0, 15.0));
            assert!(
                first.is_some_and(|decision| (36..=37).contains(&decision)),
                "{first:?}"
            );
            arrival = arrival.next();
            assert!(
                arrival.reaches(line(4.9, 0.0), 3.0, 15.0),
                "as near as the previous point"
            );
            assert!(
                !arrival.next().reaches(line(5.2, 0.0), 3.0, 15.0),
                "farther away"
            );
        }
        // A weaving course does not circle the point.
        let mut arrival = Arrival::new();
        assert!((0..1000).all(|i| !arrival.reaches(
            line(50.0 - 0.04 * f64::from(i), f64::from(i % 2)),
            3.0,
            15.0
        )));
    }
}
