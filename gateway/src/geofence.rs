//! The geofence round the field, and the box about the bow in which no other boat may be.

use game::SimTime;
use game::field::{Field, distance_to_outline, is_within};
use game::frame::{Ned, Rotation, body_from_ned};
use game::gateway::{Geofence, Halt};
use game::picture::Nav;

/// The geofence round a field.
#[derive(Clone, Debug)]
pub struct GeofenceWatch {
    corners: [Ned; 4],
    rules: Geofence,
    /// Since when the boat is outside or about to be.
    since: Option<SimTime>,
}

impl GeofenceWatch {
    /// The geofence of this field.
    #[must_use]
    pub fn new(field: &Field, rules: Geofence) -> GeofenceWatch {
        GeofenceWatch { corners: field.corners, rules, since: None }
    }

    /// Whether a boat here with this velocity over the ground is inside and can stop inside. A breach counts after the
    /// debounce time.
    pub fn is_inside(&mut self, now: SimTime, at: Ned, velocity_m_s: Ned) -> bool {
        let way = self.stopping_way(velocity_m_s);
        if self.contains(at) && self.contains(at + way) {
            self.since = None;
            return true;
        }
        let since = *self.since.get_or_insert(now);
        (now - since).as_s() < self.rules.debounce_s
    }

    /// The way to rest: reaction time at its speed, then v² / (2 a).
    fn stopping_way(&self, velocity_m_s: Ned) -> Ned {
        let speed_m_s = velocity_m_s.length();
        velocity_m_s.scaled(self.rules.reaction_s + speed_m_s / (2.0 * self.rules.deceleration_m_s2))
    }

    /// Whether a position is inside the geofence: in the field, or within the margin.
    #[must_use]
    pub fn contains(&self, at: Ned) -> bool {
        is_within(&self.corners, at) || distance_to_outline(&self.corners, at) <= self.rules.margin_m
    }
}

/// The box about the bow.
#[derive(Clone, Debug)]
pub struct BowWatch {
    rules: Halt,
    half_length_m: f64,
    /// When a boat was last in it.
    blocked_at: SimTime,
}

impl BowWatch {
    /// The box of a boat of this length.
    #[must_use]
    pub fn new(rules: Halt, length_m: f64) -> BowWatch {
        BowWatch { rules, half_length_m: 0.5 * length_m, blocked_at: SimTime::LONG_AGO }
    }

    /// Whether another boat is in the box, or was within the last `clear_s`.
    pub fn is_blocked(&mut self, now: SimTime, nav: &Nav, others: &[Ned]) -> bool {
        if self.rules.ahead_m <= 0.0 {
            return false;
        }
        let rotation = Rotation::from_heading(nav.psi_rad);
        let ahead_m = (self.rules.ahead_m * 0.5 * nav.surge_m_s).max(2.0 * self.half_length_m);
        let is_in = |other: &Ned| {
            let seen = body_from_ned(rotation, *other - nav.at());
            (-self.half_length_m..=ahead_m).contains(&seen.ahead) && seen.starboard.abs() <= 0.5 * self.rules.width_m
        };
        if others.iter().any(is_in) {
            self.blocked_at = now;
        }
        (now - self.blocked_at).as_s() < self.rules.clear_s || self.blocked_at == now
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field() -> Field {
        let game = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/games/pav01_vs_pav01.toml");
        game::scenario::load(&game).unwrap_or_else(|problems| panic!("{problems}")).field
    }

    const RULES: Geofence = Geofence { margin_m: 30.0, deceleration_m_s2: 0.25, reaction_s: 1.0, debounce_s: 0.5 };

    fn at(seconds: f64) -> SimTime {
        SimTime::from_s(seconds)
    }

    #[test]
    fn a_boat_must_be_inside_and_able_to_stop_inside() {
        // The field is 160 x 80 m from the datum; at 3 m/s a boat needs 3 + 18 = 21 m.
        for (x, y, east_m_s, inside) in [
            (80.0, 40.0, 3.0, true),
            (168.9, 40.0, 3.0, true),
            (169.1, 40.0, 3.0, false),
            (169.1, 40.0, -3.0, true),
            (189.9, 40.0, 0.0, true),
            (190.1, 40.0, 0.0, false),
            (190.1, 40.0, -3.0, false),
            (80.0, -30.1, 0.0, false),
        ] {
            let mut geofence = GeofenceWatch::new(&field(), RULES);
            let velocity = Ned { north: 0.0, east: east_m_s };
            geofence.is_inside(at(0.0), Ned::from_xy(x, y), velocity);
            assert_eq!(geofence.is_inside(at(0.5), Ned::from_xy(x, y), velocity), inside, "{x}, {y} at {east_m_s}");
        }
    }

    #[test]
    fn one_fix_outside_is_not_enough() {
        let mut geofence = GeofenceWatch::new(&field(), RULES);
        let (inside, outside) = (Ned::from_xy(80.0, 40.0), Ned::from_xy(80.0, 400.0));
        for (seconds, place, want) in [
            (0.0, outside, true),
            (0.4, outside, true),
            (0.45, inside, true),
            (0.6, outside, true),
            (1.2, outside, false),
        ] {
            assert_eq!(geofence.is_inside(at(seconds), place, Ned::default()), want, "{seconds}");
        }
    }

    #[test]
    fn the_box_about_the_bow_grows_with_speed_and_stays_shut_for_a_moment() {
        let rules = Halt { ahead_m: 7.0, width_m: 3.0, clear_s: 1.0 };
        for (x_ahead, y_port, speed_m_s, blocked) in [
            (6.9, 0.0, 2.0, true),
            (7.1, 0.0, 2.0, false),
            (6.9, 0.0, 1.0, false),
            (1.7, 0.0, 0.0, true),
            (3.0, 1.4, 2.0, true),
            (3.0, 1.6, 2.0, false),
            (-1.5, 0.0, 2.0, false),
        ] {
            let mut bow = BowWatch::new(rules, 1.8);
            let other = [Ned::from_xy(10.0 + x_ahead, 20.0 + y_port)];
            let psi_rad = 90_f64.to_radians();
            let nav = Nav { north_m: 20.0, east_m: 10.0, psi_rad, surge_m_s: speed_m_s, ..Nav::default() };
            assert_eq!(
                bow.is_blocked(at(0.0), &nav, &other),
                blocked,
                "{x_ahead} ahead, {y_port} to port at {speed_m_s} m/s"
            );
            assert_eq!(bow.is_blocked(at(0.9), &nav, &[]), blocked, "not clear for long enough");
            assert!(!bow.is_blocked(at(1.1), &nav, &[]));
        }
        let none = Halt { ahead_m: 0.0, ..rules };
        let nav = Nav { surge_m_s: 2.0, ..Nav::default() };
        assert!(!BowWatch::new(none, 1.8).is_blocked(at(0.0), &nav, &[Ned::default()]));
    }
}
