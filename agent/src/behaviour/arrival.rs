//! When a point counts as reached.

/// A point draws away when it is this much farther than it once was, m: less may be noise of the position.
const AWAY_M: f64 = 0.5;

/// A point that is being approached: reached within one radius, or within the other when it draws away again.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arrival {
    nearest_m: f64,
}

impl Arrival {
    pub(super) fn new() -> Arrival {
        Arrival { nearest_m: f64::INFINITY }
    }

    /// Whether the point, now so far away, is reached.
    pub(super) fn reaches(&mut self, distance_m: f64, capture_radius_m: f64, slip_radius_m: f64) -> bool {
        self.nearest_m = self.nearest_m.min(distance_m);
        distance_m <= capture_radius_m || (self.nearest_m <= slip_radius_m && distance_m > self.nearest_m + AWAY_M)
    }
}

#[cfg(test)]
mod tests {
    use super::Arrival;

    #[test]
    fn a_point_is_reached_near_by_or_when_it_draws_away_within_the_slip_radius() {
        for (what, distances_m, want) in [
            ("not yet", &[20.0, 10.0, 6.0][..], false),
            ("captured", &[20.0, 10.0, 2.9], true),
            ("slipped by", &[20.0, 10.0, 6.0, 6.6], true),
            ("noise", &[20.0, 10.0, 6.0, 6.3], false),
            ("drawing away too far off", &[20.0, 16.0, 18.0], false),
        ] {
            let mut arrival = Arrival::new();
            let got = distances_m.iter().fold(false, |_, distance_m| arrival.reaches(*distance_m, 3.0, 15.0));
            assert_eq!(got, want, "{what}");
        }
    }
}
