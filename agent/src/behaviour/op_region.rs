//! Operation region: keeps the boat on the field, and brings it back slowly if it got out.

use super::steering::{REACTION_S, TURN_RAD_S};
use super::{BehaviourLogic, BehaviourOutput};
use crate::ivp::{Objective, Peak};
use crate::situation::Situation;
use game::angle::wrap_pi;
use game::strategy::OpRegion;
use game::{Ned, SimTime, math};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// How far inside of the edge a boat steers for that comes back, m.
const WELL_IN_M: f64 = 5.0;
/// From the recovery speed down to nothing, m/s: it comes back as slowly as said.
const RECOVERY_BASE_M_S: f64 = 0.5;

/// Where the boat counts as being.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    In,
    Out,
}

pub(super) struct OpRegionBehaviour {
    task: OpRegion,
    side: Side,
    /// Since when the boat has been on the other side of the edge than it counts.
    crossed: Option<SimTime>,
    /// Utilities of all courses and speeds.
    table: Vec<f32>,
    /// The speeds, m/s.
    speeds: Vec<f32>,
}

impl OpRegionBehaviour {
    pub(super) fn new(task: OpRegion) -> OpRegionBehaviour {
        OpRegionBehaviour { task, side: Side::In, crossed: None, table: Vec::new(), speeds: Vec::new() }
    }

    /// A boat counts as out, or in again, when it has been so for a while.
    fn debounce(&mut self, situation: &Situation, inside_m: f64) {
        let (is_other, wait_s) = match self.side {
            Side::In => (inside_m < 0.0, self.task.exit_s.value(situation)),
            Side::Out => (inside_m > 0.0, self.task.entry_s.value(situation)),
        };
        if !is_other {
            self.crossed = None;
            return;
        }
        let since = *self.crossed.get_or_insert(situation.now);
        if (situation.now - since).as_s() + 1e-9 >= wait_s {
            self.side = if self.side == Side::In { Side::Out } else { Side::In };
            self.crossed = None;
        }
    }
}

impl BehaviourLogic for OpRegionBehaviour {
    fn begin(&mut self, _situation: &Situation) {
        (self.side, self.crossed) = (Side::In, None);
    }

    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let region = Region::new(situation, self.task.margin_m.value(situation));
        let inside_m = region.inside_m();
        self.debounce(situation, inside_m);
        if self.side == Side::Out {
            if -inside_m > self.task.halt_m.value(situation) {
                output.stop();
                return;
            }
            let speed_m_s = self.task.recovery_speed_m_s.value(situation).min(situation.model.speed_max_m_s);
            output.add(&Objective::Coupled {
                course: Peak::tent(situation.at.bearing_rad(region.nearest_inside(situation)), PI),
                speed: Peak::tent(speed_m_s, RECOVERY_BASE_M_S),
                course_share: 0.5,
            });
            return;
        }
        let (lookahead_s, save_m) = (self.task.lookahead_s.value(situation), self.task.save_m.value(situation));
        if inside_m > region.reach_m(situation, lookahead_s, save_m) {
            return;
        }
        self.fill(situation, output, &region, (lookahead_s, save_m.max(0.1)));
        output.add(&Objective::Table(&self.table));
    }
}

impl OpRegionBehaviour {
    /// Fills the table with how well each candidate keeps clear of the edges.
    ///
    /// A candidate is worth as much as it keeps of `save_m`: half of it for the least distance to an edge on the way, half
    /// for the distance at the end of the look-ahead; the worst edge counts. On the way the boat goes on for its reaction
    /// time, then turns the shorter way at its rate, then goes straight.
    fn fill(
        &mut self,
        situation: &Situation,
        output: &BehaviourOutput<'_>,
        region: &Region,
        (lookahead_s, save_m): (f64, f64),
    ) {
        let grid = output.grid();
        let (heading_rad, surge_m_s) = (situation.own.nav.psi_rad, situation.own.nav.surge_m_s.max(0.0));
        let near = |edge: &&(Ned, f64)| edge.1 <= region.reach_m(situation, lookahead_s, save_m);
        let per_m = (50.0 / save_m) as f32;
        self.table.clear();
        self.table.resize(grid.courses() * grid.speeds(), 100.0);
        self.speeds.clear();
        self.speeds.extend((0..grid.speeds()).map(|j| grid.speed_m_s(j) as f32));
        for (normal, inside_m) in region.edges.iter().filter(near) {
            let from_rad = wrap_pi(heading_rad - math::atan2(normal.east, normal.north));
            let (sin_from, cos_from) = math::sin_cos(from_rad);
            let start_m = inside_m - REACTION_S * surge_m_s * cos_from;
            let drift_m = lookahead_s * region.drift.dot(*normal);
            for (k, row) in self.table.chunks_mut(grid.speeds()).enumerate() {
                let (north, east) = grid.direction(k);
                let course = Ned { north: f64::from(north), east: f64::from(east) };
                // The sine and cosine of its angle to the normal.
                let to = (normal.north * course.east - normal.east * course.north, course.dot(*normal));
                let turn = Turn::new((from_rad, sin_from), wrap_pi(grid.course_rad(k) - heading_rad), to);
                let straight_s = (lookahead_s - turn.duration_s).max(0.0);
                // Everything is linear in the new speed; while the boat turns it has half of the old one still.
                let turned = Line::new(start_m, -turn.end_s).at_half(surge_m_s);
                let farthest = Line::new(start_m, -turn.farthest_s).at_half(surge_m_s);
                let end = turned.and(-drift_m, -straight_s * turn.outward_last);
                let start_m = start_m as f32;
                let clear_m = |speed_m_s: f32| {
                    let end_m = end.at(speed_m_s);
                    (least(least(farthest.at(speed_m_s), start_m), end_m), end_m)
                };
                // What is clear at the slowest speed and at the fastest is so at those between.
                let is_clear = |j: usize| clear_m(self.speeds[j]).0 >= save_m as f32;
                if is_clear(0) && is_clear(row.len() - 1) {
                    continue;
                }
                for (utility, speed_m_s) in row.iter_mut().zip(&self.speeds) {
                    let (least_m, end_m) = clear_m(*speed_m_s);
                    *utility = least(*utility, kept(least_m * per_m) + kept(end_m * per_m));
                }
            }
        }
    }
}

/// The lesser of two numbers, without the care that `min` takes of those that are none.
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Half of the utility, as far as a distance in parts of it reaches: 0 to 50.
fn kept(utility: f32) -> f32 {
    let kept = least(utility, 50.0);
    if kept > 0.0 { kept } else { 0.0 }
}

/// A distance, m, that depends on the new speed: what it is at rest, and how much more it is for each m/s.
#[derive(Clone, Copy)]
struct Line(f32, f32);

impl Line {
    fn new(at_rest_m: f64, per_speed_s: f64) -> Line {
        Line(at_rest_m as f32, per_speed_s as f32)
    }

    /// As long as the speed is the mean of this and the new one.
    fn at_half(self, old_m_s: f64) -> Line {
        let half = 0.5 * self.1;
        Line(self.0 + half * old_m_s as f32, half)
    }

    /// At a speed, m.
    fn at(self, speed_m_s: f32) -> f32 {
        self.0 + self.1 * speed_m_s
    }

    fn and(self, at_rest_m: f64, per_speed_s: f64) -> Line {
        Line(self.0 + at_rest_m as f32, self.1 + per_speed_s as f32)
    }
}

/// A turn, as seen from an edge: distances outwards for each m/s of speed.
struct Turn {
    /// How much of the way is outwards in the end: the cosine of the angle to the normal.
    outward_last: f64,
    /// How long the turn takes, with the reaction, s.
    duration_s: f64,
    /// The farthest out that the boat gets while it turns, s times its speed.
    farthest_s: f64,
    /// How far out it is when it has turned, s times its speed.
    end_s: f64,
}

impl Turn {
    /// From an angle to the edge's outward normal (and its sine), by another angle, rad, to a third (its sine and cosine).
    ///
    /// The way outwards is the integral of the cosine: the sine, divided by the rate of turn, whose extremes are at right
    /// angles to the normal.
    fn new((from_rad, sin_from): (f64, f64), by_rad: f64, (sin_to, cos_to): (f64, f64)) -> Turn {
        let side = if by_rad < 0.0 { -1.0 } else { 1.0 };
        let end_s = side * (sin_to - sin_from) / TURN_RAD_S;
        let to_parallel_rad = (side * FRAC_PI_2 - from_rad) * side;
        let passes = to_parallel_rad.rem_euclid(TAU) < by_rad.abs();
        let parallel_s = (1.0 - side * sin_from) / TURN_RAD_S;
        Turn {
            outward_last: cos_to,
            duration_s: REACTION_S + by_rad.abs() / TURN_RAD_S,
            farthest_s: if passes { parallel_s.max(end_s) } else { end_s.max(0.0) },
            end_s,
        }
    }
}

/// The region about the boat.
struct Region {
    /// By edge: outward normal, and how far inside of it the boat is, m.
    edges: [(Ned, f64); 4],
    /// What wind and current add to the boat's way, m/s: what it moves sideways.
    drift: Ned,
    /// How far the region is inside of the field, m.
    margin_m: f64,
}

impl Region {
    fn new(situation: &Situation, margin_m: f64) -> Region {
        let field = &situation.model.field;
        let (x, y) = field.along_across(situation.at);
        let (width_m, depth_m) = (field.plan.width_m, field.plan.depth_m);
        let minus = |v: Ned| v.scaled(-1.0);
        let (sin, cos) = math::sin_cos(situation.own.nav.psi_rad);
        let starboard = Ned { north: -sin, east: cos };
        Region {
            edges: [
                (minus(field.along), x - margin_m),
                (field.along, width_m - margin_m - x),
                (minus(field.across), y - margin_m),
                (field.across, depth_m - margin_m - y),
            ],
            drift: starboard.scaled(situation.own.nav.sway_m_s),
            margin_m,
        }
    }

    /// How far inside the boat is, m; negative outside.
    fn inside_m(&self) -> f64 {
        self.edges.iter().map(|(_, inside_m)| *inside_m).fold(f64::INFINITY, f64::min)
    }

    /// Farther inside than this no candidate comes near an edge, m.
    fn reach_m(&self, situation: &Situation, lookahead_s: f64, save_m: f64) -> f64 {
        let fastest_m_s = situation.model.speed_max_m_s.max(situation.own.nav.surge_m_s);
        // The widest turn there is goes out by twice its radius.
        save_m + (lookahead_s.max(2.0 / TURN_RAD_S) + REACTION_S) * (fastest_m_s + self.drift.length())
    }

    /// The nearest point well inside.
    fn nearest_inside(&self, situation: &Situation) -> Ned {
        let field = &situation.model.field;
        let (x, y) = field.along_across(situation.at);
        let within = |v: f64, extent_m: f64| {
            let in_m = (self.margin_m + WELL_IN_M).min(0.5 * extent_m);
            v.clamp(in_m, extent_m - in_m)
        };
        field.at(within(x, field.plan.width_m), within(y, field.plan.depth_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The farthest and the last distance outwards of a boat that turns at a speed of 1 m/s, by small steps, m.
    fn stepped(from_rad: f64, by_rad: f64) -> (f64, f64) {
        let steps = 100_000;
        let dt_s = by_rad.abs() / TURN_RAD_S / f64::from(steps);
        let (mut out_m, mut farthest_m) = (0.0, 0.0_f64);
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
                let (from_rad, by_rad) = (f64::from(from_deg).to_radians(), f64::from(by_deg).to_radians());
                let turn = Turn::new((from_rad, math::sin_cos(from_rad).0), by_rad, math::sin_cos(from_rad + by_rad));
                let (farthest_m, out_m) = stepped(from_rad, by_rad);
                let what = format!("from {from_deg} by {by_deg} degrees");
                assert!((turn.farthest_s - farthest_m).abs() < 1e-4, "{what}: {} m, {farthest_m}", turn.farthest_s);
                assert!((turn.end_s - out_m).abs() < 1e-4, "{what}: {} m, {out_m}", turn.end_s);
            }
        }
    }
}
