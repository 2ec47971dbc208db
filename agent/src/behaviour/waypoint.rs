//! Waypoint: drives along a list of points.

use super::arrival::Arrival;
use super::steering::steer;
use super::{BehaviourLogic, BehaviourOutput};
use crate::situation::Situation;
use primitives::Ned;
use scenario::strategy::Waypoint;

#[derive(Clone)]
pub(super) struct WaypointBehaviour {
    task: Waypoint,
    /// Number of points reached in this round.
    reached: usize,
    rounds: u32,
    arrival: Arrival,
    /// Start of the leg to the next point.
    from: Ned,
}

impl WaypointBehaviour {
    pub(super) fn new(task: Waypoint) -> WaypointBehaviour {
        WaypointBehaviour {
            task,
            reached: 0,
            rounds: 0,
            arrival: Arrival::new(),
            from: Ned::default(),
        }
    }

    /// The point to steer for on the way from `from` to `to`.
    fn aim(&self, situation: &Situation, to: Ned) -> Ned {
        let lead_m = self.task.lead_m.value(situation);
        let leg = to - self.from;
        let length_m = leg.length();
        if lead_m <= 0.0 || length_m < 1e-6 {
            return to;
        }
        // A point on the leg ahead of the boat, like MOOS-IvP's `lead`: a boat pushed off the line
        // returns to it, not just to its end.
        let along_m = (situation.at - self.from).dot(leg) / length_m + lead_m;
        if along_m >= length_m {
            to
        } else {
            self.from + leg.scaled(along_m.max(0.0) / length_m)
        }
    }
}

impl BehaviourLogic for WaypointBehaviour {
    fn begin(&mut self, situation: &Situation) {
        (self.reached, self.rounds, self.arrival, self.from) = (0, 0, Arrival::new(), situation.at);
    }

    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let count = self.task.points.len();
        let index = if self.task.reverse {
            count - 1 - self.reached
        } else {
            self.reached
        };
        let Some(point) = situation.locate(&self.task.points[index]) else {
            return;
        };
        let capture_m = self.task.capture_radius_m.value(situation);
        let slip_m = self.task.slip_radius_m.value(situation);
        if self
            .arrival
            .reaches(point.at - situation.at, capture_m, slip_m)
        {
            output.reached = true;
            (self.arrival, self.from) = (self.arrival.next(), point.at);
            self.reached += 1;
            if self.reached == count {
                self.reached = 0;
                self.rounds += 1;
                output.complete = f64::from(self.rounds) > self.task.repeat.value(situation);
            }
        }
        let speed_m_s = self.task.speed_m_s.value(situation);
        let course_rad = situation.at.bearing_rad(self.aim(situation, point.at));
        output.add(&steer(
            situation,
            course_rad,
            speed_m_s,
            self.task.course_share.value(situation),
        ));
    }
}
