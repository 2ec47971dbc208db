//! Obstacle avoidance: keeps clear of what stands in the water.

use super::nearest::{Nearest, nearness};
use super::steering::{CPA_MIN_UTILITY, keep_clear, lag};
use super::{BehaviourLogic, BehaviourOutput};
use crate::ivp::{Objective, Table};
use crate::situation::{MovingPoint, Situation};
use game::Ned;
use game::field::{Obstacle, distance_to_line, sides};
use game::strategy::AvoidObstacle;

pub(super) struct AvoidObstacleBehaviour {
    task: AvoidObstacle,
    /// What is known of the obstacles that are polygons, by obstacle; empty before the first decision.
    outlines: Vec<Outline>,
    /// Utilities of all courses and speeds, for obstacles without a closed form.
    table: Table,
    /// Where the boat is in the end, by speed, on one course: on a straight line.
    ends: Vec<Ned>,
}

impl AvoidObstacleBehaviour {
    pub(super) fn new(task: AvoidObstacle) -> AvoidObstacleBehaviour {
        AvoidObstacleBehaviour { task, outlines: Vec::new(), table: Table::default(), ends: Vec::new() }
    }

    /// Fills the table with what each way is worth by its pass of a polygon: on as it goes while the boat turns, then
    /// straight. On one course a faster run is a longer one, so its pass is the smaller of its own and the slower runs'.
    fn fill(
        &mut self,
        situation: &Situation,
        output: &BehaviourOutput<'_>,
        obstacle: usize,
        (min_m, max_m): (f64, f64),
        horizon_s: f64,
    ) {
        let (grid, lag, outline) = (output.grid(), lag(situation), &self.outlines[obstacle]);
        let drift_m = situation.motion.drift().scaled(horizon_s);
        self.table.clear(grid);
        for k in 0..grid.courses() {
            let (north, east) = grid.direction(k);
            let course = Ned { north: f64::from(north), east: f64::from(east) };
            let start = situation.at + situation.velocity.scaled(lag.duration_s(course));
            let turning_m = outline.pass_m((situation.at, start), f64::INFINITY, max_m);
            self.ends.clear();
            let end = |speed_m_s: &f64| start + course.scaled(speed_m_s * horizon_s) + drift_m;
            self.ends.extend(grid.speeds_m_s().iter().map(end));
            let drifting_m = outline.pass_m((start, self.ends[0]), turning_m, max_m);
            let mut speed = 0;
            let mut lower = |speeds: usize, pass_m: f64| {
                let utility = worth(pass_m, min_m, max_m) as f32;
                if utility < 100.0 {
                    let row = self.table.lowered_mut(k).iter_mut().flat_map(|lanes| &mut lanes.0);
                    row.skip(speed).take(speeds).for_each(|lowered| *lowered = utility);
                }
                speed += speeds;
            };
            lower(1, drifting_m);
            outline.each_pass(&self.ends, drifting_m, max_m, &mut lower);
        }
    }
}

/// A polygon, with what bounds its distance from below.
struct Outline {
    corners: Vec<Ned>,
    /// Half planes that hold all of it: outward unit normals, and how far out it reaches along each, m.
    half_planes: Vec<(Ned, f64)>,
}

/// What rounding may take from a bound, m, with room to spare.
const ROUNDING_M: f64 = 1e-6;

impl Outline {
    fn new(corners: &[Ned]) -> Outline {
        let about = |(a, b): (Ned, Ned)| {
            let side = (b - a).scaled(1.0 / (b - a).length().max(f64::MIN_POSITIVE));
            [1.0, -1.0].map(|out| Ned { north: out * side.east, east: -out * side.north })
        };
        let reach_m = |normal: Ned| corners.iter().map(|corner| corner.dot(normal)).fold(f64::NEG_INFINITY, f64::max);
        let half_planes = sides(corners).flat_map(about).map(|normal| (normal, reach_m(normal))).collect();
        Outline { corners: corners.to_vec(), half_planes }
    }

    /// No point of a straight line is nearer, m.
    fn least_m(&self, (a, b): (Ned, Ned)) -> f64 {
        let out_m = |(normal, reach_m): &(Ned, f64)| a.dot(*normal).min(b.dot(*normal)) - reach_m;
        self.half_planes.iter().map(out_m).fold(0.0, f64::max) - ROUNDING_M
    }

    /// The pass of a line, m, or `before_m` if that is nearer; where it is farther than `max_m`, any number beyond.
    fn pass_m(&self, line: (Ned, Ned), before_m: f64, max_m: f64) -> f64 {
        if self.least_m(line) > before_m.min(max_m) {
            return before_m;
        }
        before_m.min(distance_to_line(&self.corners, line))
    }

    /// The nearest pass so far of each leg between points on a straight line, with `before_m` as the one before them, m: so
    /// many legs, and theirs. Many legs that pass farther off are dealt with at once.
    fn each_pass(&self, points: &[Ned], before_m: f64, max_m: f64, each: &mut impl FnMut(usize, f64)) -> f64 {
        let legs = points.len() - 1;
        let line = (points[0], points[legs]);
        if before_m <= 0.0 || self.least_m(line) > before_m.min(max_m) {
            each(legs, before_m);
            return before_m;
        }
        if legs == 1 {
            let pass_m = before_m.min(distance_to_line(&self.corners, line));
            each(1, pass_m);
            return pass_m;
        }
        let half_m = self.each_pass(&points[..=legs / 2], before_m, max_m, each);
        self.each_pass(&points[legs / 2..], half_m, max_m, each)
    }
}

impl BehaviourLogic for AvoidObstacleBehaviour {
    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let (inner_m, outer_m) = (self.task.inner_m.value(situation), self.task.outer_m.value(situation));
        let min_m = self.task.cpa_min_m.value(situation);
        let max_m = self.task.cpa_max_m.value(situation).max(min_m);
        let horizon_s = self.task.time_on_leg_s.value(situation);
        let obstacles = &situation.model.field.plan.obstacles;
        if self.outlines.is_empty() {
            let corners = |obstacle: &Obstacle| match obstacle {
                Obstacle::Circle { .. } => Outline::new(&[]),
                Obstacle::Polygon { corners } => Outline::new(corners),
            };
            self.outlines = obstacles.iter().map(corners).collect();
        }
        let distances = obstacles.iter().enumerate().map(|(i, obstacle)| (obstacle.distance(situation.at), i));
        for (distance_m, i) in Nearest::of(distances.filter(|(distance_m, _)| *distance_m < outer_m)).iter() {
            let share = nearness(distance_m, inner_m, outer_m);
            match &obstacles[i] {
                Obstacle::Circle { centre, radius_m } => {
                    let disc = MovingPoint { at: *centre, velocity: Ned::default() };
                    output.add_share(share, None, &keep_clear(situation, disc, *radius_m, (min_m, max_m), horizon_s));
                }
                Obstacle::Polygon { .. } => {
                    self.fill(situation, output, i, (min_m, max_m), horizon_s);
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

#[cfg(test)]
mod tests {
    use super::*;
    use game::stream::Stream;

    #[test]
    fn passes_are_worth_what_they_are_leg_by_leg() {
        let (min_m, max_m) = (1.0, 4.0);
        let (mut dealt_with, mut legs, mut near) = (0, 0, 0);
        for seed in 0..2_000 {
            let mut stream = Stream::new(seed, "obstacle");
            let mut within =
                |most_m: f64| Ned { north: stream.between(-most_m, most_m), east: stream.between(-most_m, most_m) };
            // Of any shape, sides that cross each other included.
            let corners: Vec<Ned> = (0..3 + seed as usize % 4).map(|_| within(8.0)).collect();
            let (start, step) = (within(20.0), within(2.0));
            let points: Vec<Ned> = (0..=36).map(|j| start + step.scaled(f64::from(j))).collect();
            let outline = Outline::new(&corners);
            let mut got = Vec::new();
            outline.each_pass(&points, f64::INFINITY, max_m, &mut |legs, pass_m| {
                dealt_with += 1;
                got.extend(std::iter::repeat_n(worth(pass_m, min_m, max_m), legs));
            });
            let mut pass_m = f64::INFINITY;
            for (leg, got) in points.windows(2).zip(&got) {
                pass_m = pass_m.min(distance_to_line(&corners, (leg[0], leg[1])));
                assert_eq!(
                    *got,
                    worth(pass_m, min_m, max_m),
                    "seed {seed}: {pass_m} m from {corners:?}, from {start:?} by {step:?}"
                );
                near += usize::from(*got < 100.0);
            }
            legs += got.len();
        }
        assert!(legs == 36 * 2_000 && 3 * dealt_with < legs && near > 5_000, "{dealt_with} of {legs}, {near} near");
    }
}
