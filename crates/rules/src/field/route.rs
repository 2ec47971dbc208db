//! A route: the closed path along which a flag's home moves.

use super::sides;
use primitives::frame::Ned;
use primitives::time::SimTime;
use serde::{Deserialize, Serialize};

/// A closed path at constant speed. Its position depends only on the time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Route {
    /// The corners: the start first, and back to it after the last.
    pub points: Vec<Ned>,
    /// The length of the path up to the end of each leg, m.
    pub ends_m: Vec<f64>,
    /// Speed, m/s.
    pub speed_m_s: f64,
}

impl Route {
    /// The route through these points, of which neighbours must differ.
    pub fn new(points: Vec<Ned>, speed_m_s: f64) -> Route {
        let mut length_m = 0.0;
        let ends_m = sides(&points).map(|(from, to)| {
            length_m += from.distance(to);
            length_m
        });
        Route {
            ends_m: ends_m.collect(),
            points,
            speed_m_s,
        }
    }

    /// The position at a time; before the game, the start.
    pub fn at(&self, now: SimTime) -> Ned {
        let length_m = self.ends_m.last().copied().unwrap_or(0.0);
        let gone_m = self.speed_m_s * now.as_s().max(0.0) % length_m;
        let mut from_m = 0.0;
        for ((from, to), end_m) in sides(&self.points).zip(&self.ends_m) {
            if gone_m < *end_m {
                return from + (to - from).scaled((gone_m - from_m) / (end_m - from_m));
            }
            from_m = *end_m;
        }
        self.points.first().copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_route_is_followed_at_its_speed_and_closes() {
        let corners = [(10.0, 10.0), (40.0, 10.0), (40.0, 50.0)];
        let route = Route::new(corners.map(|(x, y)| Ned::from_xy(x, y)).to_vec(), 2.0);
        // 30 m east, 40 m north, 50 m back: 60 s a round.
        for (time_s, x, y) in [
            (-1e9, 10.0, 10.0),
            (0.0, 10.0, 10.0),
            (5.0, 20.0, 10.0),
            (15.0, 40.0, 10.0),
            (25.0, 40.0, 30.0),
            (35.0, 40.0, 50.0),
            (47.5, 25.0, 30.0),
            (60.0, 10.0, 10.0),
            (665.0, 20.0, 10.0),
        ] {
            let got = route.at(SimTime::from_s(time_s));
            let off_m = got.distance(Ned::from_xy(x, y));
            assert!(off_m < 1e-9, "after {time_s} s at {got:?}");
        }
    }
}
