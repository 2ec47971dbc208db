//! Obstacle avoidance: keeps clear of what stands in the water.

use super::loiter::distance_to_side;
use super::{CPA_MIN_UTILITY, Conduct, lag, nearness};
use crate::helm::{Bid, Scene};
use crate::ivp::{Approach, Closest, Objective};
use game::Ned;
use game::field::Obstacle;
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

    /// Fills the table with what each straight run is worth by its pass of a polygon.
    ///
    /// On one course a faster run is a longer one, so its pass is the smaller of its own end's and of the slower runs'. The
    /// ends lie a step of the speeds times the time on leg apart: what stands between two of them is missed by half of
    /// that at most.
    fn fill(&mut self, scene: &Scene, bid: &Bid<'_>, corners: &[Ned], (min_m, max_m): (f64, f64), horizon_s: f64) {
        let grid = bid.problem().grid();
        self.table.clear();
        for k in 0..grid.courses() {
            let (north, east) = grid.direction(k);
            let mut pass_m = f64::INFINITY;
            for j in 0..grid.speeds() {
                let run_m = grid.speed_m_s(j) * horizon_s;
                let end = scene.at + Ned { north: f64::from(north), east: f64::from(east) }.scaled(run_m);
                pass_m = pass_m.min(distance_to_polygon(corners, end));
                self.table.push(worth(pass_m, min_m, max_m) as f32);
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
        for obstacle in &scene.chart.field.plan.obstacles {
            match obstacle {
                Obstacle::Circle { centre, radius_m } => {
                    let line = *centre - scene.at;
                    let share = nearness(line.length() - radius_m, inner_m, outer_m);
                    let closest = Closest {
                        north_m: line.north,
                        east_m: line.east,
                        velocity_north_m_s: 0.0,
                        velocity_east_m_s: 0.0,
                        horizon_s,
                        min_m: min_m + radius_m,
                        max_m: max_m + radius_m,
                        approach: Approach::Avoid { at_min: CPA_MIN_UTILITY },
                        lag: Some(lag(scene)),
                    };
                    bid.ask_for(share, None, &Objective::Closest(closest));
                }
                Obstacle::Polygon { corners } => {
                    let share = nearness(distance_to_polygon(corners, scene.at), inner_m, outer_m);
                    if share > 0.0 {
                        self.fill(scene, bid, corners, (min_m, max_m), horizon_s);
                        bid.ask_for(share, None, &Objective::Table(&self.table));
                    }
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

/// The distance to a polygon, m; 0 inside.
fn distance_to_polygon(corners: &[Ned], at: Ned) -> f64 {
    let next = corners.iter().skip(1).chain(corners.first());
    let (mut distance_m, mut inside) = (f64::INFINITY, false);
    for (a, b) in corners.iter().zip(next) {
        distance_m = distance_m.min(distance_to_side(*a, *b, at));
        // Even and odd crossings of the line to the east.
        if (a.north > at.north) != (b.north > at.north) {
            let east = a.east + (b.east - a.east) * (at.north - a.north) / (b.north - a.north);
            inside ^= at.east < east;
        }
    }
    if inside { 0.0 } else { distance_m }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polygon_is_as_far_as_its_nearest_side_and_no_distance_inside() {
        // An L: not convex.
        let corners = [(0.0, 0.0), (10.0, 0.0), (10.0, 4.0), (4.0, 4.0), (4.0, 10.0), (0.0, 10.0)];
        let corners = corners.map(|(north, east)| Ned { north, east });
        for (at, want_m) in
            [((2.0, 2.0), 0.0), ((9.0, 3.0), 0.0), ((7.0, 7.0), 3.0), ((-3.0, -4.0), 5.0), ((12.0, 2.0), 2.0)]
        {
            let got_m = distance_to_polygon(&corners, Ned { north: at.0, east: at.1 });
            assert!((got_m - want_m).abs() < 1e-9, "{at:?}: {got_m} m");
        }
    }
}
