//! Clearance: how far the boat stays inside the edges of a region, for each course and speed.
//!
//! After a decision the boat keeps its motion for its reaction time, turns the shorter way at its
//! turn rate, then drives straight.

use crate::ivp::{Courses, Grid, LANES, Lanes, Table, larger, smaller};
use crate::own_motion::Handling;
use primitives::angle::wrap_pi;
use primitives::instructions::Kernel;
use primitives::{Ned, math};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Maximum single-precision error of a distance bound, with a margin, m.
const ROUNDING_M: f32 = 0.01;

/// Lowers the utilities of a table according to each candidate's clearance from the edges.
///
/// A candidate's value is the fraction of `save_m` by which it stays inside. Half of the value is
/// for the closest distance to an edge on the way, half for the distance at the end of the
/// look-ahead. The worst edge counts. The fraction `x` yields `x + bend x (1 - x)` of each half.
pub(super) struct Clearance<'a> {
    pub(super) table: &'a mut Table,
    pub(super) grid: &'a Grid,
    /// For each edge: its outward unit normal, and how far inside it the boat is, m.
    pub(super) edges: &'a [(Ned, f64)],
    /// Distance beyond which edges are ignored, m.
    pub(super) reach_m: f64,
    pub(super) heading_rad: f64,
    /// Forward speed through the water, like the candidates' speeds, m/s.
    pub(super) surge_m_s: f64,
    /// Velocity that wind and current add to the boat's, m/s.
    pub(super) drift: Ned,
    pub(super) handling: Handling,
    pub(super) lookahead_s: f64,
    pub(super) save_m: f64,
    /// Extra value of the first metres from the edge: 0 weights all metres of `save_m` equally, 1
    /// gives the first ones double weight and the last ones none.
    pub(super) bend: f64,
}

impl Kernel for Clearance<'_> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let mut seen = [Edge::default(); 4];
        let mut count = 0;
        for edge in self
            .edges
            .iter()
            .filter(|(_, inside_m)| *inside_m <= self.reach_m)
        {
            seen[count] = self.seen(*edge);
            count += 1;
        }
        for (block, courses) in self.grid.courses_side_by_side().iter().enumerate() {
            let turns = Turns::new(&self, courses);
            for edge in &seen[..count] {
                if self.may_be_low(courses, &turns, edge) {
                    self.lower(LANES * block, &Ways::new(&self, courses, &turns, edge));
                }
            }
        }
    }
}

impl Clearance<'_> {
    fn seen(&self, (normal, inside_m): (Ned, f64)) -> Edge {
        // With angles from the edge's outward normal, one formula serves all four edges, and the
        // outward component of a course is a cosine.
        let from_rad = wrap_pi(self.heading_rad - math::atan2(normal.east, normal.north));
        let (sin_from, cos_from) = math::sin_cos(from_rad);
        let start_m = (inside_m - self.handling.reaction_s * self.surge_m_s * cos_from) as f32;
        let drift_m = (self.lookahead_s * self.drift.dot(normal)) as f32;
        Edge {
            normal,
            from_rad,
            sin_from,
            start_m,
            drift_m,
        }
    }

    /// Whether any of the courses may come near the edge; cheap for courses that lead away.
    #[inline(always)]
    fn may_be_low(&self, courses: &Courses, turns: &Turns, edge: &Edge) -> bool {
        let least_m = self.save_m + f64::from(edge.drift_m).max(0.0) + f64::from(ROUNDING_M);
        // Assumes the larger of the old speed and the top speed. Courses that lead away from an
        // edge or cannot reach it (most courses, even near an edge) are skipped 16 at a time.
        let out_s =
            (f64::from(edge.start_m) - least_m) / self.surge_m_s.max(self.grid.speed_max_m_s());
        let mut may_be_low = false;
        for i in 0..LANES {
            let cos_to =
                courses.north.0[i] * edge.normal.north + courses.east.0[i] * edge.normal.east;
            let straight_s = turns.straight_s.0[i] * cos_to;
            // The turn leads outward by at most its length.
            let most_s = turns.duration_s.0[i] + if straight_s > 0.0 { straight_s } else { 0.0 };
            may_be_low |= most_s > out_s;
        }
        may_be_low
    }

    /// Lowers the utilities of a group of courses.
    #[inline(always)]
    fn lower(&mut self, first: usize, ways: &Ways) {
        let worth = ((50.0 / self.save_m) as f32, self.bend as f32);
        let old_m_s = self.surge_m_s as f32;
        let most_m_s = larger(old_m_s, self.grid.speed_max_m_s() as f32);
        // A bit mask finds the courses that need work, without a branch for each.
        let mut low = ways.low(most_m_s, self.save_m as f32);
        while low != 0 {
            let i = low.trailing_zeros() as usize;
            low &= low - 1;
            if first + i >= self.grid.courses() {
                return;
            }
            let way = ways.at(i);
            let speeds = self.grid.speeds_side_by_side();
            // Lower, do not set: in a corner the boat is near two edges, and the worse one counts.
            for (row, speed_m_s) in self.table.lowered_mut(first + i).iter_mut().zip(speeds) {
                for i in 0..LANES {
                    row.0[i] = smaller(row.0[i], way.utility(old_m_s, speed_m_s.0[i], worth));
                }
            }
        }
    }
}

/// An edge of the region relative to the boat.
#[derive(Clone, Copy, Default)]
struct Edge {
    /// Outward unit normal.
    normal: Ned,
    /// The heading's angle to the normal and its sine, rad.
    from_rad: f64,
    sin_from: f64,
    /// Distance inside the edge at the start of the turn, m.
    start_m: f32,
    /// Outward drift over the whole path, m.
    drift_m: f32,
}

/// A turn to a course and the straight run after it.
#[derive(Clone, Copy)]
struct Turn {
    /// Turn angle, rad, positive to starboard.
    by_rad: f64,
    turn_rad_s: f64,
    duration_s: f64,
}

impl Turn {
    #[inline(always)]
    fn new(by_rad: f64, handling: &Handling) -> Turn {
        let turn_rad_s = handling.mean_turn_rad_s(by_rad);
        Turn {
            by_rad,
            turn_rad_s,
            duration_s: by_rad.abs() / turn_rad_s,
        }
    }
}

/// Turns to a group of courses, and the part of the straight runs after them that does not depend
/// on the edge.
struct Turns {
    by_rad: Lanes<f64>,
    turn_rad_s: Lanes<f64>,
    duration_s: Lanes<f64>,
    straight_s: Lanes<f64>,
    /// Minimum and maximum mean speed on the straight run, m/s.
    slowest_m_s: Lanes<f32>,
    fastest_m_s: Lanes<f32>,
}

impl Turns {
    #[inline(always)]
    fn new(clearance: &Clearance<'_>, courses: &Courses) -> Turns {
        let handling = &clearance.handling;
        let zeros = Lanes::splat(0.0);
        let speeds = Lanes::splat(0.0);
        let mut turns = Turns {
            by_rad: zeros,
            turn_rad_s: zeros,
            duration_s: zeros,
            straight_s: zeros,
            slowest_m_s: speeds,
            fastest_m_s: speeds,
        };
        for i in 0..LANES {
            turns.by_rad.0[i] = wrap_pi(courses.rad.0[i] - clearance.heading_rad);
        }
        for i in 0..LANES {
            let turn = Turn::new(turns.by_rad.0[i], handling);
            let straight_s = clearance.lookahead_s - handling.reaction_s - turn.duration_s;
            let straight_s = if straight_s > 0.0 { straight_s } else { 0.0 };
            let within = reached(
                clearance.surge_m_s,
                turn.duration_s + 0.5 * straight_s,
                handling,
            );
            turns.turn_rad_s.0[i] = turn.turn_rad_s;
            turns.duration_s.0[i] = turn.duration_s;
            turns.straight_s.0[i] = straight_s;
            turns.slowest_m_s.0[i] = within.0;
            turns.fastest_m_s.0[i] = within.1;
        }
        turns
    }

    #[inline(always)]
    fn at(&self, i: usize) -> Turn {
        Turn {
            by_rad: self.by_rad.0[i],
            turn_rad_s: self.turn_rad_s.0[i],
            duration_s: self.duration_s.0[i],
        }
    }
}

/// Minimum and maximum speed that the boat's acceleration allows after this time, m/s.
#[inline(always)]
fn reached(old_m_s: f64, after_s: f64, handling: &Handling) -> (f32, f32) {
    let slowest_m_s = old_m_s - handling.deceleration_m_s2 * after_s;
    (
        slowest_m_s as f32,
        (old_m_s + handling.acceleration_m_s2 * after_s) as f32,
    )
}

/// A turn relative to an edge: outward distances per m/s of speed.
#[derive(Clone, Copy)]
struct Outward {
    /// The farthest outward distance during the turn, divided by the speed, s.
    farthest_s: f64,
    /// The time of the farthest point, s.
    farthest_after_s: f64,
    /// The outward distance at the end of the turn, divided by the speed, s.
    end_s: f64,
}

impl Outward {
    /// A turn between two angles to the edge's outward normal, each given with its sine.
    ///
    /// The outward distance is the integral of the cosine: the sine divided by the turn rate, with
    /// extremes at right angles to the normal.
    #[inline(always)]
    fn new(turn: &Turn, (from_rad, sin_from): (f64, f64), sin_to: f64) -> Outward {
        // Mirror the turn, so that one formula serves turns to both sides and a mirrored scene
        // gives the same bits.
        let side = if turn.by_rad < 0.0 { -1.0 } else { 1.0 };
        let end_s = side * (sin_to - sin_from) / turn.turn_rad_s;
        let to_parallel_rad = (side * FRAC_PI_2 - from_rad) * side;
        // Both angles are within half a turn, so no division is needed.
        let to_parallel_rad = if to_parallel_rad < 0.0 {
            to_parallel_rad + TAU
        } else {
            to_parallel_rad
        };
        let parallel_s = (1.0 - side * sin_from) / turn.turn_rad_s;
        let parallel_after_s = to_parallel_rad / turn.turn_rad_s;
        // All cases are computed without branches, so that this vectorises over a group of courses.
        let ends_out = end_s > 0.0;
        let end_out_s = if ends_out { end_s } else { 0.0 };
        let end_after_s = if ends_out { turn.duration_s } else { 0.0 };
        // The farthest point is where the boat is parallel to the edge if the turn passes that
        // heading; otherwise it is at the start or the end.
        let is_parallel = (to_parallel_rad < turn.by_rad.abs()) & (parallel_s > end_s);
        Outward {
            farthest_s: if is_parallel { parallel_s } else { end_out_s },
            farthest_after_s: if is_parallel {
                parallel_after_s
            } else {
                end_after_s
            },
            end_s,
        }
    }
}

/// A path on a course relative to an edge, as a function of the new speed: out to the farthest
/// point of the turn, back to its end, and straight on. The speed changes from old to new as
/// fast as the boat's acceleration allows, but on the way out no faster than linearly in time.
#[derive(Clone, Copy)]
struct Way {
    /// Distance inside the edge at the start of the turn, m.
    start_m: f32,
    /// Outward drift over the whole path, m.
    drift_m: f32,
    /// Outward distance to the farthest point of the turn, and back from there, divided by the
    /// speed, s.
    out_s: f32,
    back_s: f32,
    /// Outward distance on the straight run, divided by the speed, s.
    straight_s: f32,
    /// Minimum and maximum mean speed on each part of the path, m/s.
    within: [(f32, f32); 3],
}

impl Way {
    /// The utility of the closest distance to the edge and of the final distance.
    #[inline(always)]
    fn utility(&self, old_m_s: f32, new_m_s: f32, (per_m, bend): (f32, f32)) -> f32 {
        let [out, back, straight] = self.within;
        // The arc is driven at the mean of the old and new speeds and the rest at the new speed,
        // both within the acceleration limits.
        let farthest_m = self.start_m - self.out_s * held(0.5 * (old_m_s + new_m_s), out);
        let end_m = farthest_m - self.drift_m + self.back_s * held(new_m_s, back)
            - self.straight_s * held(new_m_s, straight);
        let least_m = smaller(farthest_m, end_m);
        // The nearest point and the end each count for half: of two courses that come equally near,
        // the one that then leads away is better, even for a boat that is already outside.
        kept(least_m * per_m, bend) + kept(end_m * per_m, bend)
    }
}

/// Paths on a group of courses.
struct Ways {
    start_m: f32,
    drift_m: f32,
    out_s: Lanes<f32>,
    back_s: Lanes<f32>,
    straight_s: Lanes<f32>,
    /// Minimum and maximum mean speeds, m/s.
    slowest_m_s: [Lanes<f32>; 3],
    fastest_m_s: [Lanes<f32>; 3],
}

impl Ways {
    #[inline(always)]
    fn new(clearance: &Clearance<'_>, courses: &Courses, turns: &Turns, edge: &Edge) -> Ways {
        let normal = edge.normal;
        let zeros = Lanes::splat(0.0);
        let mut ways = Ways {
            start_m: edge.start_m,
            drift_m: edge.drift_m,
            out_s: zeros,
            back_s: zeros,
            straight_s: zeros,
            slowest_m_s: [zeros, zeros, turns.slowest_m_s],
            fastest_m_s: [zeros, zeros, turns.fastest_m_s],
        };
        for i in 0..LANES {
            let turn = turns.at(i);
            let sin_to = normal.north * courses.east.0[i] - normal.east * courses.north.0[i];
            let cos_to = courses.north.0[i] * normal.north + courses.east.0[i] * normal.east;
            let outward = Outward::new(&turn, (edge.from_rad, edge.sin_from), sin_to);
            let after_s = [
                0.5 * outward.farthest_after_s,
                0.5 * (outward.farthest_after_s + turn.duration_s),
            ];
            let [out, back] =
                after_s.map(|after_s| reached(clearance.surge_m_s, after_s, &clearance.handling));
            ways.out_s.0[i] = outward.farthest_s as f32;
            ways.back_s.0[i] = (outward.farthest_s - outward.end_s) as f32;
            ways.straight_s.0[i] = (turns.straight_s.0[i] * cos_to) as f32;
            (ways.slowest_m_s[0].0[i], ways.fastest_m_s[0].0[i]) = out;
            (ways.slowest_m_s[1].0[i], ways.fastest_m_s[1].0[i]) = back;
        }
        ways
    }

    /// The path on one of the courses.
    #[inline(always)]
    fn at(&self, i: usize) -> Way {
        let within = |part: usize| (self.slowest_m_s[part].0[i], self.fastest_m_s[part].0[i]);
        Way {
            start_m: self.start_m,
            drift_m: self.drift_m,
            out_s: self.out_s.0[i],
            back_s: self.back_s.0[i],
            straight_s: self.straight_s.0[i],
            within: [within(0), within(1), within(2)],
        }
    }

    /// A bit mask of the paths that may come within `save_m` of the edge at some speed up to
    /// `most_m_s`.
    #[inline(always)]
    fn low(&self, most_m_s: f32, save_m: f32) -> u32 {
        let begins_m = self.start_m - larger(self.drift_m, 0.0) - ROUNDING_M;
        let mut bits = 0;
        for i in 0..LANES {
            // Mean speeds are non-negative and at most the larger of the old and new speeds.
            let least_m =
                begins_m - (self.out_s.0[i] + larger(self.straight_s.0[i], 0.0)) * most_m_s;
            bits |= u32::from(least_m < save_m) << i;
        }
        bits
    }
}

/// A speed clamped to a range.
#[inline(always)]
fn held(speed_m_s: f32, (slowest, fastest): (f32, f32)) -> f32 {
    smaller(larger(speed_m_s, slowest), fastest)
}

/// Half of the utility, 0 to 50, for a distance as a fraction of `save_m`.
#[inline(always)]
fn kept(part: f32, bend: f32) -> f32 {
    let linear = larger(smaller(part, 50.0), 0.0);
    linear + bend * linear * (1.0 - 0.02 * linear)
}

#[cfg(test)]
mod tests {
    use super::*;
    use primitives::instructions::Instructions;

    /// A boat that makes every turn at the same yaw rate.
    const HANDLING: Handling = Handling::evenly(0.35);

    /// The farthest and the last outward distance for a turn at 1 m/s, computed in small steps, m.
    fn stepped(from_rad: f64, by_rad: f64) -> (f64, f64) {
        let steps = 100_000;
        let dt_s = by_rad.abs() / HANDLING.turn_rad_s / f64::from(steps);
        let mut out_m = 0.0;
        let mut farthest_m = 0.0_f64;
        for step in 0..steps {
            let angle_rad = from_rad + by_rad * (f64::from(step) + 0.5) / f64::from(steps);
            out_m += dt_s * math::sin_cos(angle_rad).1;
            farthest_m = farthest_m.max(out_m);
        }
        (farthest_m, out_m)
    }

    #[test]
    fn a_turn_goes_out_as_far_as_small_steps_say() {
        for from_deg in (-180..180).step_by(25) {
            for by_deg in (-180..=180).step_by(20) {
                let from_rad = f64::from(from_deg).to_radians();
                let by_rad = f64::from(by_deg).to_radians();
                let turn = Turn::new(by_rad, &HANDLING);
                let sine = |angle_rad| math::sin_cos(angle_rad).0;
                let outward =
                    Outward::new(&turn, (from_rad, sine(from_rad)), sine(from_rad + by_rad));
                let (farthest_m, out_m) = stepped(from_rad, by_rad);
                let farthest_s = outward.farthest_s;
                let after_s = outward.farthest_after_s;
                let end_s = outward.end_s;
                assert!(
                    (0.0..=turn.duration_s + 1e-9).contains(&after_s),
                    "{after_s}"
                );
                let what = format!("from {from_deg} by {by_deg} degrees");
                assert!(
                    (farthest_s - farthest_m).abs() < 1e-4,
                    "{what}: {farthest_s} m, {farthest_m}"
                );
                assert!((end_s - out_m).abs() < 1e-4, "{what}: {end_s} m, {out_m}");
            }
        }
    }

    #[test]
    fn all_instructions_come_to_the_same_bits() {
        // The last courses and speeds do not fill their lanes.
        let grid = Grid::new(362, 37, 3.5);
        let mut lowered = 0;
        for seed in 0..200 {
            let mut stream = primitives::stream::Stream::new(seed, "op_region");
            let heading_rad = stream.between(-4.0, 4.0);
            let edges = [0.0, 1.6, 3.1, -1.6].map(|rad| {
                let (sin, cos) = math::sin_cos(rad);
                (
                    Ned {
                        north: cos,
                        east: sin,
                    },
                    stream.between(-2.0, 60.0),
                )
            });
            let surge_m_s = stream.between(0.0, 4.0);
            let drift = Ned {
                north: stream.between(-1.0, 1.0),
                east: 0.3,
            };
            let bits = |instructions: &Instructions| {
                let mut table = Table::default();
                table.clear(&grid);
                instructions.run(Clearance {
                    table: &mut table,
                    grid: &grid,
                    edges: &edges,
                    reach_m: 50.0,
                    heading_rad,
                    surge_m_s,
                    drift,
                    handling: HANDLING,
                    lookahead_s: 9.0,
                    save_m: 6.0,
                    bend: 0.4,
                });
                grid.points()
                    .map(|(k, j)| table.utility(k, j).to_bits())
                    .collect::<Vec<u32>>()
            };
            let all: Vec<Vec<u32>> = Instructions::of_this_machine().iter().map(bits).collect();
            assert!(all.iter().all(|bits| *bits == all[0]), "seed {seed}");
            lowered += all[0]
                .iter()
                .filter(|bits| **bits != 100.0_f32.to_bits())
                .count();
        }
        assert!(lowered > 100_000, "{lowered} points");
    }

    #[test]
    fn a_course_that_is_left_out_is_clear_at_every_speed() {
        let save_m = 6.0;
        let fastest_m_s = 3.5_f32;
        let mut left_out = 0;
        for seed in 0..20_000 {
            let mut stream = primitives::stream::Stream::new(seed, "op_region");
            let old_m_s = stream.between(0.0, 4.0);
            let mut lanes = |least, most| Lanes::splat(stream.between(least, most) as f32);
            let out_s = lanes(0.0, 9.0);
            let back_s = lanes(0.0, 9.0);
            let straight_s = lanes(-9.0, 9.0);
            let start_m = stream.between(0.0, 80.0) as f32;
            let drift_m = stream.between(-9.0, 9.0) as f32;
            let within = [0; 3].map(|_| reached(old_m_s, stream.between(0.0, 9.0), &HANDLING));
            let slowest_m_s = within.map(|(slowest_m_s, _)| Lanes::splat(slowest_m_s));
            let fastest = within.map(|(_, fastest_m_s)| Lanes::splat(fastest_m_s));
            let ways = Ways {
                start_m,
                drift_m,
                out_s,
                back_s,
                straight_s,
                slowest_m_s,
                fastest_m_s: fastest,
            };
            if ways.low(fastest_m_s.max(old_m_s as f32), save_m) != 0 {
                continue;
            }
            left_out += 1;
            for j in 0..36 {
                let utility =
                    ways.at(3)
                        .utility(old_m_s as f32, 0.1 * j as f32, (50.0 / save_m, 0.4));
                assert_eq!(utility, 100.0, "seed {seed}, speed {j}");
            }
        }
        assert!(left_out > 2_000, "only {left_out} courses left out");
    }
}
