//! Intercept: steers for the earliest point at which a boat can be met (lead pursuit).

use super::steering::steer_heading;
use super::{BehaviourLogic, BehaviourOutput};
use crate::situation::{MovingPoint, Situation, meeting_time_s};
use primitives::Ned;
use scenario::strategy::Intercept;

impl BehaviourLogic for Intercept {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let Some(contact) = situation.boat(self.contact).copied() else {
            return;
        };
        let giveup_m = self.giveup_m.value(situation);
        if giveup_m > 0.0 && situation.at.distance(contact.at) > giveup_m {
            return;
        }
        let speed_m_s = self
            .speed_m_s
            .value(situation)
            .min(situation.model.speed_max_m_s);
        // The same water carries both boats: relative to it, the contact's velocity is reduced by
        // the drift.
        let velocity = contact.velocity() - situation.motion.drift();
        let meeting = meeting_point(
            situation.at,
            speed_m_s,
            MovingPoint {
                at: contact.at,
                velocity,
            },
        );
        let heading_rad = situation.at.bearing_rad(meeting);
        output.add_share(
            1.0,
            Some(contact.vehicle),
            &steer_heading(heading_rad, speed_m_s, 0.5),
        );
    }
}

/// The earliest point at which a boat at `from`, driving straight at this speed, meets a contact of
/// constant velocity; the contact's current position if they never meet.
pub(super) fn meeting_point(from: Ned, speed_m_s: f64, contact: MovingPoint) -> Ned {
    let time_s = meeting_time_s(contact.at - from, contact.velocity, speed_m_s);
    // A faster contact that moves away cannot be met. The boat steers for the contact's current
    // position, because the contact may turn.
    contact.at + contact.velocity.scaled(time_s.unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boats_meet_where_both_arrive_at_once() {
        let contact = |north, east, v_north, v_east| MovingPoint {
            at: Ned { north, east },
            velocity: Ned {
                north: v_north,
                east: v_east,
            },
        };
        // The contact crosses at right angles: a 3-4-5 triangle.
        let got = meeting_point(Ned::default(), 2.0, contact(40.0, 0.0, 0.0, 1.2));
        assert!(
            got.distance(Ned {
                north: 40.0,
                east: 30.0
            }) < 1e-9,
            "{got:?}"
        );
        for point in [
            contact(50.0, 10.0, -1.0, 0.5),
            contact(-20.0, 30.0, 1.5, 1.0),
            contact(9.0, 9.0, 0.0, 0.0),
        ] {
            let got = meeting_point(Ned::default(), 2.5, point);
            let speed_m_s = point.velocity.length();
            let times_s = (
                got.length() / 2.5,
                if speed_m_s > 0.0 {
                    got.distance(point.at) / speed_m_s
                } else {
                    -1.0
                },
            );
            assert!(
                times_s.1 < 0.0 || (times_s.0 - times_s.1).abs() < 1e-9,
                "{point:?}: {times_s:?}"
            );
        }
        // A faster contact that moves away is chased at its current position.
        let got = meeting_point(Ned::default(), 1.0, contact(10.0, 0.0, 2.0, 0.0));
        assert_eq!(
            got,
            Ned {
                north: 10.0,
                east: 0.0
            }
        );
        // An approaching contact of the same speed is met half-way.
        let got = meeting_point(Ned::default(), 2.0, contact(10.0, 0.0, -2.0, 0.0));
        assert!(
            got.distance(Ned {
                north: 5.0,
                east: 0.0
            }) < 1e-9,
            "{got:?}"
        );
    }
}
