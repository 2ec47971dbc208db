//! The box around the bow that must be free of other real boats.

use crate::config::Halt;
use messages::picture::Nav;
use primitives::SimTime;
use primitives::frame::{Ned, Rotation, body_from_ned};

/// The box around the bow.
#[derive(Clone, Debug)]
pub(crate) struct BowWatch {
    rules: Halt,
    half_length_m: f64,
    /// When another boat was last in the box.
    blocked_at: SimTime,
}

impl BowWatch {
    /// The box for a boat of the given length.
    pub(crate) fn new(rules: Halt, length_m: f64) -> BowWatch {
        BowWatch {
            rules,
            half_length_m: 0.5 * length_m,
            blocked_at: SimTime::LONG_AGO,
        }
    }

    /// Whether another boat is in the box, or was within the last `clear_s`.
    pub(crate) fn is_blocked(&mut self, now: SimTime, nav: &Nav, others: &[Ned]) -> bool {
        // A box of zero length disables the check, for fleets whose boats avoid each other by
        // themselves.
        if self.rules.ahead_m <= 0.0 {
            return false;
        }
        let rotation = Rotation::from_heading(nav.psi_rad);
        // The box is specified for 2 m/s, as in Aquaticus' collision filter (7 m by 3 m), and grows
        // with the speed. It is never shorter than the boat: the next order may start a boat at
        // rest.
        let ahead_m = (self.rules.ahead_m * 0.5 * nav.surge_m_s).max(2.0 * self.half_length_m);
        let is_in = |other: &Ned| {
            let seen = body_from_ned(rotation, *other - nav.at());
            (-self.half_length_m..=ahead_m).contains(&seen.ahead)
                && seen.starboard.abs() <= 0.5 * self.rules.width_m
        };
        if others.iter().any(is_in) {
            self.blocked_at = now;
        }
        // Not a latched failsafe: boats in a game often come close, and continue once the box has
        // been empty for a moment.
        (now - self.blocked_at).as_s() < self.rules.clear_s || self.blocked_at == now
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(seconds: f64) -> SimTime {
        SimTime::from_s(seconds)
    }

    #[test]
    fn the_box_about_the_bow_grows_with_speed_and_stays_shut_for_a_moment() {
        let rules = Halt {
            ahead_m: 7.0,
            width_m: 3.0,
            clear_s: 1.0,
        };
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
            let nav = Nav {
                north_m: 20.0,
                east_m: 10.0,
                psi_rad,
                surge_m_s: speed_m_s,
                ..Nav::default()
            };
            assert_eq!(
                bow.is_blocked(at(0.0), &nav, &other),
                blocked,
                "{x_ahead} ahead, {y_port} to port at {speed_m_s} m/s"
            );
            assert_eq!(
                bow.is_blocked(at(0.9), &nav, &[]),
                blocked,
                "not clear for long enough"
            );
            assert!(!bow.is_blocked(at(1.1), &nav, &[]));
        }
        let none = Halt {
            ahead_m: 0.0,
            ..rules
        };
        let nav = Nav {
            surge_m_s: 2.0,
            ..Nav::default()
        };
        assert!(!BowWatch::new(none, 1.8).is_blocked(at(0.0), &nav, &[Ned::default()]));
    }
}
