//! Waypoint: drives along a list of points.

use super::{Conduct, head};
use crate::helm::{Bid, Scene};
use game::Ned;
use game::strategy::Waypoint;

/// A point draws away when it is this much farther than it once was, m: less may be noise of the position.
const AWAY_M: f64 = 0.5;

/// A point that is being approached: reached within one radius, or within the other when it draws away again.
#[derive(Clone, Copy, Debug)]
pub(super) struct Approach {
    nearest_m: f64,
}

impl Approach {
    pub(super) fn new() -> Approach {
        Approach { nearest_m: f64::INFINITY }
    }

    /// Whether the point, now so far away, is reached.
    pub(super) fn reaches(&mut self, distance_m: f64, capture_radius_m: f64, slip_radius_m: f64) -> bool {
        self.nearest_m = self.nearest_m.min(distance_m);
        distance_m <= capture_radius_m || (self.nearest_m <= slip_radius_m && distance_m > self.nearest_m + AWAY_M)
    }
}

pub(super) struct Conductor {
    task: Waypoint,
    /// How many points of this round were reached.
    reached: usize,
    rounds: u32,
    approach: Approach,
    /// Where the leg to the next point begins.
    from: Ned,
}

impl Conductor {
    pub(super) fn new(task: Waypoint) -> Conductor {
        Conductor { task, reached: 0, rounds: 0, approach: Approach::new(), from: Ned::default() }
    }

    /// The point to steer for on the way from `from` to `to`.
    fn aim(&self, scene: &Scene, to: Ned) -> Ned {
        let lead_m = self.task.lead_m.value(scene);
        let leg = to - self.from;
        let length_m = leg.length();
        if lead_m <= 0.0 || length_m < 1e-6 {
            return to;
        }
        let along_m = (scene.at - self.from).dot(leg) / length_m + lead_m;
        if along_m >= length_m { to } else { self.from + leg.scaled(along_m.max(0.0) / length_m) }
    }
}

impl Conduct for Conductor {
    fn begin(&mut self, scene: &Scene) {
        (self.reached, self.rounds, self.approach, self.from) = (0, 0, Approach::new(), scene.at);
    }

    fn act(&mut self, scene: &Scene, bid: &mut Bid<'_>) {
        let count = self.task.points.len();
        let index = if self.task.reverse { count - 1 - self.reached } else { self.reached };
        let Some(spot) = scene.spot(&self.task.points[index]) else { return };
        let distance_m = scene.at.distance(spot.at);
        let (capture_m, slip_m) = (self.task.capture_radius_m.value(scene), self.task.slip_radius_m.value(scene));
        if self.approach.reaches(distance_m, capture_m, slip_m) {
            bid.reached = true;
            (self.approach, self.from) = (Approach::new(), spot.at);
            self.reached += 1;
            if self.reached == count {
                self.reached = 0;
                self.rounds += 1;
                bid.complete = f64::from(self.rounds) > self.task.repeat.value(scene);
            }
        }
        let speed_m_s = self.task.speed_m_s.value(scene);
        let course_rad = scene.at.bearing_rad(self.aim(scene, spot.at));
        bid.ask(&head(scene, course_rad, speed_m_s, self.task.course_share.value(scene)));
    }
}

#[cfg(test)]
mod tests {
    use super::Approach;

    #[test]
    fn a_point_is_reached_near_by_or_when_it_draws_away_within_the_slip_radius() {
        for (what, distances_m, want) in [
            ("not yet", &[20.0, 10.0, 6.0][..], false),
            ("captured", &[20.0, 10.0, 2.9], true),
            ("slipped by", &[20.0, 10.0, 6.0, 6.6], true),
            ("noise", &[20.0, 10.0, 6.0, 6.3], false),
            ("drawing away too far off", &[20.0, 16.0, 18.0], false),
        ] {
            let mut approach = Approach::new();
            let got = distances_m.iter().fold(false, |_, distance_m| approach.reaches(*distance_m, 3.0, 15.0));
            assert_eq!(got, want, "{what}");
        }
    }
}
