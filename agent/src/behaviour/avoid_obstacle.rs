//! Obstacle avoidance: keeps clear of what stands in the water.

use super::nearest::{Nearest, nearness};
use super::steering::{CPA_MIN_UTILITY, keep_clear, lag};
use super::{BehaviourLogic, BehaviourOutput};
use crate::ivp::Objective;
use crate::situation::{MovingPoint, Situation};
use game::Ned;
use game::field::{Obstacle, distance_to_line};
use game::strategy::AvoidObstacle;

pub(super) struct AvoidObstacleBehaviour {
    task: AvoidObstacle,
    /// Utilities of all courses and speeds, for obstacles without a closed form.
    table: Vec<f32>,
}

impl AvoidObstacleBehaviour {
    pub(super) fn new(task: AvoidObstacle) -> AvoidObstacleBehaviour {
        AvoidObstacleBehaviour { task, table: Vec::new() }
    }

    /// Fills the table with what each way is worth by its pass of a polygon: on as it goes while the boat turns, then
    /// straight. On one course a faster run is a longer one, so its pass is the smaller of its own and the slower runs'.
    fn fill(
        &mut self,
        situation: &Situation,
        output: &BehaviourOutput<'_>,
        corners: &[Ned],
        (min_m, max_m): (f64, f64),
        horizon_s: f64,
    ) {
        let (grid, lag) = (output.grid(), lag(situation));
        self.table.clear();
        for k in 0..grid.courses() {
            let (north, east) = grid.direction(k);
            let course = Ned { north: f64::from(north), east: f64::from(east) };
            let mut end = situation.at + situation.velocity.scaled(lag.duration_s(course));
            let start = end;
            let mut pass_m = distance_to_line(corners, (situation.at, start));
            for j in 0..grid.speeds() {
                let next = start + course.scaled(grid.speed_m_s(j) * horizon_s);
                pass_m = pass_m.min(distance_to_line(corners, (end, next)));
                self.table.push(worth(pass_m, min_m, max_m) as f32);
                end = next;
            }
        }
    }
}

impl BehaviourLogic for AvoidObstacleBehaviour {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let (inner_m, outer_m) = (self.task.inner_m.value(situation), self.task.outer_m.value(situation));
        let min_m = self.task.cpa_min_m.value(situation);
        let max_m = self.task.cpa_max_m.value(situation).max(min_m);
        let horizon_s = self.task.time_on_leg_s.value(situation);
        let obstacles = &situation.model.field.plan.obstacles;
        let distances = obstacles.iter().enumerate().map(|(i, obstacle)| (obstacle.distance(situation.at), i));
        for (distance_m, i) in Nearest::of(distances.filter(|(distance_m, _)| *distance_m < outer_m)).iter() {
            let share = nearness(distance_m, inner_m, outer_m);
            match &obstacles[i] {
                Obstacle::Circle { centre, radius_m } => {
                    let disc = MovingPoint { at: *centre, velocity: Ned::default() };
                    output.add_share(share, None, &keep_clear(situation, disc, *radius_m, (min_m, max_m), horizon_s));
                }
                Obstacle::Polygon { corners } => {
                    self.fill(situation, output, corners, (min_m, max_m), horizon_s);
                    output.add_share(share, None, &Objective::Table(&self.table));
                }
            }
        }
    }
}

/// Utility of a pass, as for contacts: from nothing at no distance to 100 at the largest.
fn worth(pass_m: f64, min_m: f64, max_m: f64) -> f64 {
    if pass_m <= min_m {
        CPA_MIN_UTILITY * pass_m / min_m.max(f64::MIN_POSITIVE)
    } else if pass_m >= max_m {
        100.0
    } else {
        CPA_MIN_UTILITY + (100.0 - CPA_MIN_UTILITY) * (pass_m - min_m) / (max_m - min_m)
    }
}
