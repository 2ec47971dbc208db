//! Collision avoidance: keeps clear of other boats, judged by the closest point of approach, with
//! one function per contact.

use super::nearest::{Nearest, is_meant, nearness};
use super::steering::keep_clear;
use super::{BehaviourLogic, BehaviourOutput};
use crate::ivp::Side;
use crate::situation::{MovingPoint, Situation};
use scenario::strategy::{AvoidCollision, Grade};

/// Boats that would pass starboard to starboard at less than this distance, m, pass port to port
/// instead, so that both choose the same side where either would do.
const PORT_TO_PORT_M: f64 = 2.0;
/// Relative speed below which no passing side is assigned, m/s.
const PASSING_MIN_M_S: f64 = 0.3;

impl BehaviourLogic for AvoidCollision {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let inner_m = self.inner_m.value(situation);
        let outer_m = self.outer_m.value(situation);
        let min_m = self.cpa_min_m.value(situation);
        let max_m = self.cpa_max_m.value(situation);
        let horizon_s = self.time_on_leg_s.value(situation);
        let mut nearest = Nearest::default();
        situation.near(outer_m, |i, distance_m| {
            if is_meant(self.contacts, situation, situation.other(i)) {
                nearest.add((distance_m, i));
            }
        });
        // Both boats are assumed to keep turning. If each assumes that the other goes straight,
        // both can turn to the same side again and again until they touch. Hull contacts per
        // boat-hour: 0.44 without this, 0.35 with it, and 0.03 with an agreed passing side as well
        // (random strategies in calm water, `crates/arena/examples/safety.rs`).
        let own = situation.turning_on();
        for (distance_m, i) in nearest.iter() {
            let other = situation.other(i);
            let contact = other.turning_on();
            // Applies reciprocal velocity obstacles (van den Berg, Lin and Manocha, ICRA 2008) to
            // boats that turn along arcs. Both boats give way: with the COLREGs roles of stand-on
            // and give-way, each would need to know the other's current state, but observations may
            // be old.
            let leave_to = side(own, contact);
            let function = keep_clear(situation, contact, 0.0, (min_m, max_m), horizon_s, leave_to);
            let share = graded(self.grade, nearness(distance_m, inner_m, outer_m));
            output.add_share(share, Some(other.vehicle), &function);
        }
    }
}

/// The side on which two approaching boats leave each other: the side on which they would pass
/// anyway. Both compute the same side, so neither turns into the other.
fn side(own: MovingPoint, contact: MovingPoint) -> Option<Side> {
    let line = contact.at - own.at;
    let past = contact.velocity - own.velocity;
    let past_m_s = past.length();
    if past_m_s < PASSING_MIN_M_S || line.dot(past) >= 0.0 {
        return None;
    }
    // The sign of the line of sight's rotation is the same from both ends, so the boats agree
    // without communication.
    let to_starboard_m = (line.north * past.east - line.east * past.north) / past_m_s;
    Some(if to_starboard_m < PORT_TO_PORT_M {
        Side::Port
    } else {
        Side::Starboard
    })
}

/// The fraction of the weight that applies; 1 at the inner distance and nearer.
fn graded(grade: Grade, nearness: f64) -> f64 {
    match grade {
        Grade::Linear => nearness,
        // The three shapes of MOOS-IvP's AvoidCollision between its outer and inner distances.
        Grade::Quasi => nearness * nearness.sqrt(),
        Grade::Quadratic => nearness * nearness,
    }
}

#[cfg(test)]
mod tests {
    use super::side;
    use crate::ivp::Side;
    use crate::situation::MovingPoint;
    use primitives::Ned;
    use primitives::stream::Stream;

    #[test]
    fn two_boats_choose_the_same_side() {
        let mut stream = Stream::new(1, "sides");
        let mut sides = [0; 3];
        for _ in 0..2_000 {
            let mut boat = || {
                let [north, east, velocity_north, velocity_east] =
                    [30.0, 30.0, 3.0, 3.0].map(|most| stream.between(-most, most));
                MovingPoint {
                    at: Ned { north, east },
                    velocity: Ned {
                        north: velocity_north,
                        east: velocity_east,
                    },
                }
            };
            let one = boat();
            let other = boat();
            assert_eq!(side(one, other), side(other, one), "{one:?}, {other:?}");
            sides[side(one, other).map_or(0, |side| 1 + side as usize)] += 1;
        }
        assert!(sides.iter().all(|n| *n > 200), "{sides:?}");
    }

    #[test]
    fn head_on_boats_leave_each_other_to_port() {
        let north = MovingPoint {
            at: Ned::default(),
            velocity: Ned {
                north: 2.0,
                east: 0.0,
            },
        };
        let south = |east| MovingPoint {
            at: Ned { north: 30.0, east },
            velocity: Ned {
                north: -2.0,
                east: 0.0,
            },
        };
        assert_eq!(side(north, south(-4.0)), Some(Side::Port));
        assert_eq!(side(north, south(0.0)), Some(Side::Port));
        assert_eq!(side(north, south(4.0)), Some(Side::Starboard));
        let gone = MovingPoint {
            velocity: Ned {
                north: 3.0,
                east: 0.0,
            },
            ..south(4.0)
        };
        assert_eq!(side(north, gone), None);
    }
}
