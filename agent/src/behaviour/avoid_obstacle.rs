//! Obstacle avoidance: keeps clear of what stands in the water.

use super::{CPA_MIN_UTILITY, Conduct, Nearest, lag, nearness};
use crate::helm::{Bid, Scene};
use crate::ivp::{Approach, Closest, Objective};
use game::Ned;
use game::field::{Obstacle, distance_to_line};
use game::strategy::AvoidObstacle;

pub(super) struct Conductor {
    task: AvoidObstacle,
    /// Utilities of all courses and speeds, for obstacles without a closed form.
    table: Vec<f32>,
}

impl Conductor {
    pub(super) fn new(task: AvoidObstacle) -> Conductor {
        Conductor { task, table: Vec::new() }
    }

    /// Fills the table with what each way is worth by its pass of a polygon: on as it goes while the boat turns, then
    /// straight. On one course a faster run is a longer one, so its pass is the smaller of its own and the slower runs'.
    fn fill(&mut self, scene: &Scene, bid: &Bid<'_>, corners: &[Ned], (min_m, max_m): (f64, f64), horizon_s: f64) {
        let (grid, lag) = (bid.grid(), lag(scene));
        self.table.clear();
        for k in 0..grid.courses() {
            let (north, east) = grid.direction(k);
            let course = Ned { north: f64::from(north), east: f64::from(east) };
            let mut end = scene.at + scene.velocity.scaled(lag.duration_s(course.north, course.east));
            let start = end;
            let mut pass_m = distance_to_line(corners, (scene.at, start));
            for j in 0..grid.speeds() {
                let next = start + course.scaled(grid.speed_m_s(j) * horizon_s);
                pass_m = pass_m.min(distance_to_line(corners, (end, next)));
                self.table.push(worth(pass_m, min_m, max_m) as f32);
                end = next;
            }
        }
    }
}

impl Conduct for Conductor {
    fn act(&mut self, scene: &Scene, bid: &mut Bid<'_>) {
        let (inner_m, outer_m) = (self.task.inner_m.value(scene), self.task.outer_m.value(scene));
        let min_m = self.task.cpa_min_m.value(scene);
        let max_m = self.task.cpa_max_m.value(scene).max(min_m);
        let horizon_s = self.task.time_on_leg_s.value(scene);
        let obstacles = &scene.chart.field.plan.obstacles;
        let distances = obstacles.iter().enumerate().map(|(i, obstacle)| (obstacle.distance(scene.at), i));
        for (distance_m, i) in Nearest::of(distances.filter(|(distance_m, _)| *distance_m < outer_m)).iter() {
            let share = nearness(distance_m, inner_m, outer_m);
            match &obstacles[i] {
                Obstacle::Circle { centre, radius_m } => {
                    let line = *centre - scene.at;
                    let closest = Closest {
                        north_m: line.north,
                        east_m: line.east,
                        velocity_north_m_s: 0.0,
                        velocity_east_m_s: 0.0,
                        horizon_s,
                        min_m: min_m + radius_m,
                        max_m: max_m + radius_m,
                        touch_m: *radius_m,
                        approach: Approach::Avoid { at_min: CPA_MIN_UTILITY },
                        lag: Some(lag(scene)),
                    };
                    bid.ask_for(share, None, &Objective::Closest(closest));
                }
                Obstacle::Polygon { corners } => {
                    self.fill(scene, bid, corners, (min_m, max_m), horizon_s);
                    bid.ask_for(share, None, &Objective::Table(&self.table));
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
