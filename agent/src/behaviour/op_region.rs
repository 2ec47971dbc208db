//! Operation region: keeps the boat on the field, and brings it back slowly if it got out.

use super::{BehaviourLogic, BehaviourOutput};
use crate::ivp::{Instructions, Kernel, Objective, Peak};
use crate::own_motion::Handling;
use crate::situation::Situation;
use game::angle::wrap_pi;
use game::strategy::{BeyondHalt, OpRegion};
use game::{Ned, SimTime, math};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// How far inside of the edge a boat steers for that comes back, m.
const WELL_IN_M: f64 = 5.0;
/// A boat keeps off the edges by so many seconds of the drift's spread more: waves and gusts push it about, and hold up its
/// turns. In a gale over a lake the spread is 0.5 m/s.
const GUST_S: f64 = 12.0;
/// What single precision may take from a bound on a distance, m, with room to spare.
const ROUNDING_M: f64 = 0.01;
/// So many speeds are worked out side by side.
const SIDE_BY_SIDE: usize = 16;
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
    instructions: Instructions,
}

impl OpRegionBehaviour {
    pub(super) fn new(task: OpRegion) -> OpRegionBehaviour {
        let (table, speeds, instructions) = (Vec::new(), Vec::new(), Instructions::best());
        OpRegionBehaviour { task, side: Side::In, crossed: None, table, speeds, instructions }
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
            if self.task.beyond_halt == BeyondHalt::Stops && -inside_m > self.task.halt_m.value(situation) {
                output.stop();
                return;
            }
            // Over the ground, so that it comes back however fast it drifts.
            let (heading_rad, speed_m_s) = situation.motion.steer(
                situation.at.bearing_rad(region.nearest_inside(situation)),
                self.task.recovery_speed_m_s.value(situation),
            );
            output.add(&Objective::Coupled {
                course: Peak::tent(heading_rad, PI),
                speed: Peak::tent(speed_m_s, RECOVERY_BASE_M_S),
                course_share: 0.5,
            });
            return;
        }
        let (lookahead_s, save_m) = (self.task.lookahead_s.value(situation), self.task.save_m.value(situation));
        let save_m = save_m + GUST_S * situation.motion.spread_m_s();
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
        let (nav, handling) = (&situation.own.nav, &region.handling);
        let heading_rad = nav.psi_rad;
        // Through the water, as the candidates are.
        let surge_m_s = (nav.surge_m_s - region.drift.dot(nav.pose().rotation().ahead())).max(0.0);
        let near = |edge: &&(Ned, f64)| edge.1 <= region.reach_m(situation, lookahead_s, save_m);
        let per_m = (50.0 / save_m) as f32;
        self.table.clear();
        self.table.resize(grid.courses() * grid.speeds(), 100.0);
        self.speeds.clear();
        self.speeds.extend((0..grid.speeds()).map(|j| grid.speed_m_s(j) as f32));
        for (normal, inside_m) in region.edges.iter().filter(near) {
            let from_rad = wrap_pi(heading_rad - math::atan2(normal.east, normal.north));
            let (sin_from, cos_from) = math::sin_cos(from_rad);
            let start_m = inside_m - handling.reaction_s * surge_m_s * cos_from;
            let drift_m = lookahead_s * region.drift.dot(*normal);
            for (k, row) in self.table.chunks_mut(grid.speeds()).enumerate() {
                let (north, east) = grid.direction(k);
                let course = Ned { north: f64::from(north), east: f64::from(east) };
                // The sine and cosine of its angle to the normal.
                let to = (normal.north * course.east - normal.east * course.north, course.dot(*normal));
                let turn = Turn::new((from_rad, sin_from), wrap_pi(grid.course_rad(k) - heading_rad), to, handling);
                let straight_s = (lookahead_s - handling.reaction_s - turn.duration_s).max(0.0);
                let ramp = Ramp::new(surge_m_s, &turn, straight_s, handling);
                let (out_s, back_s) = (turn.farthest_s as f32, (turn.farthest_s - turn.end_s) as f32);
                let straight_s = (straight_s * turn.outward_last) as f32;
                let (start_m, drift_m) = (start_m as f32, drift_m as f32);
                let way = Way { start_m, drift_m, out_s, back_s, straight_s, ramp };
                if way.least_m(surge_m_s, grid.speed_max_m_s()) < save_m {
                    self.instructions.run(LowerRow { row, speeds: &self.speeds, way, per_m });
                }
            }
        }
    }
}

/// A way on a course, as seen from an edge, as it depends on the new speed.
#[derive(Clone, Copy)]
struct Way {
    /// How far inside of the edge the turn begins, m.
    start_m: f32,
    /// How much of that drift takes in the end, m.
    drift_m: f32,
    /// The way out to the farthest point of the turn, and back from there, s times its speed.
    out_s: f32,
    back_s: f32,
    /// The way out on the straight run, s times its speed.
    straight_s: f32,
    ramp: Ramp,
}

impl Way {
    /// What is kept of the least distance to the edge and of the one in the end.
    #[inline(always)]
    fn utility(&self, speed_m_s: f32, per_m: f32) -> f32 {
        let [out_m_s, back_m_s, straight_m_s] = self.ramp.means(speed_m_s);
        let farthest_m = self.start_m - self.out_s * out_m_s;
        let end_m = farthest_m - self.drift_m + self.back_s * back_m_s - self.straight_s * straight_m_s;
        let least_m = least(farthest_m, end_m);
        kept(least_m * per_m) + kept(end_m * per_m)
    }

    /// No new speed comes nearer to the edge, m.
    fn least_m(&self, old_m_s: f64, fastest_m_s: f64) -> f64 {
        // Mean speeds are not negative, and not more than the larger of the old and the new one.
        let out_s = self.out_s + greatest(self.straight_s, 0.0);
        let out_m = f64::from(out_s) * old_m_s.max(fastest_m_s);
        f64::from(self.start_m) - f64::from(self.drift_m).max(0.0) - out_m - ROUNDING_M
    }
}

/// Lowers the utilities of a course to what is kept of the distance to an edge.
struct LowerRow<'a> {
    row: &'a mut [f32],
    speeds: &'a [f32],
    way: Way,
    /// Half of the utility for each m.
    per_m: f32,
}

impl Kernel for LowerRow<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let LowerRow { row, speeds, way, per_m } = self;
        let (rows, last_row) = row.as_chunks_mut::<SIDE_BY_SIDE>();
        let (speeds, last_speeds) = speeds.as_chunks::<SIDE_BY_SIDE>();
        for (row, speeds) in rows.iter_mut().zip(speeds) {
            for (utility, speed_m_s) in row.iter_mut().zip(speeds) {
                *utility = least(*utility, way.utility(*speed_m_s, per_m));
            }
        }
        for (utility, speed_m_s) in last_row.iter_mut().zip(last_speeds) {
            *utility = least(*utility, way.utility(*speed_m_s, per_m));
        }
    }
}

/// The lesser of two numbers, without the care that `min` takes of those that are none.
#[inline(always)]
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater of two numbers, likewise.
#[inline(always)]
fn greatest(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// A speed held within two others.
#[inline(always)]
fn held(speed_m_s: f32, (slowest, fastest): (f32, f32)) -> f32 {
    least(greatest(speed_m_s, slowest), fastest)
}

/// Half of the utility, as far as a distance in parts of it reaches: 0 to 50.
#[inline(always)]
fn kept(utility: f32) -> f32 {
    let kept = least(utility, 50.0);
    if kept > 0.0 { kept } else { 0.0 }
}

/// How the speed goes over from the old to the new one while the boat turns out to the farthest point and back, and then
/// runs straight: as fast as the boat gains and loses speed, but not faster than evenly on the way out.
#[derive(Clone, Copy)]
struct Ramp {
    old_m_s: f32,
    /// The least and the most of the mean speed on each part of the way, m/s.
    within: [(f32, f32); 3],
}

impl Ramp {
    fn new(old_m_s: f64, turn: &Turn, straight_s: f64, handling: &Handling) -> Ramp {
        let within = |after_s: f64| {
            let slowest_m_s = old_m_s - handling.deceleration_m_s2 * after_s;
            (slowest_m_s as f32, (old_m_s + handling.acceleration_m_s2 * after_s) as f32)
        };
        let (out_s, turn_s) = (turn.farthest_after_s, turn.duration_s);
        let within = [within(0.5 * out_s), within(0.5 * (out_s + turn_s)), within(turn_s + 0.5 * straight_s)];
        Ramp { old_m_s: old_m_s as f32, within }
    }

    /// The mean speeds on the way out, back and straight on, m/s.
    #[inline(always)]
    fn means(self, new_m_s: f32) -> [f32; 3] {
        let [out, back, straight] = self.within;
        [held(0.5 * (self.old_m_s + new_m_s), out), held(new_m_s, back), held(new_m_s, straight)]
    }
}

/// A turn, as seen from an edge: distances outwards for each m/s of speed.
struct Turn {
    /// How much of the way is outwards in the end: the cosine of the angle to the normal.
    outward_last: f64,
    /// How long the turn takes, s.
    duration_s: f64,
    /// The farthest out that the boat gets while it turns, s times its speed.
    farthest_s: f64,
    /// When it gets there, s.
    farthest_after_s: f64,
    /// How far out it is when it has turned, s times its speed.
    end_s: f64,
}

impl Turn {
    /// From an angle to the edge's outward normal (and its sine), by another angle, rad, to a third (its sine and cosine).
    ///
    /// The way outwards is the integral of the cosine: the sine, divided by the rate of turn, whose extremes are at right
    /// angles to the normal.
    fn new((from_rad, sin_from): (f64, f64), by_rad: f64, (sin_to, cos_to): (f64, f64), handling: &Handling) -> Turn {
        let turn_rad_s = handling.mean_turn_rad_s(by_rad);
        let side = if by_rad < 0.0 { -1.0 } else { 1.0 };
        let end_s = side * (sin_to - sin_from) / turn_rad_s;
        let duration_s = by_rad.abs() / turn_rad_s;
        let to_parallel_rad = (side * FRAC_PI_2 - from_rad) * side;
        // Both angles are within half a turn: no division is needed.
        let to_parallel_rad = if to_parallel_rad < 0.0 { to_parallel_rad + TAU } else { to_parallel_rad };
        let parallel_s = (1.0 - side * sin_from) / turn_rad_s;
        let (farthest_s, farthest_after_s) = if to_parallel_rad < by_rad.abs() && parallel_s > end_s {
            (parallel_s, to_parallel_rad / turn_rad_s)
        } else if end_s > 0.0 {
            (end_s, duration_s)
        } else {
            (0.0, 0.0)
        };
        Turn { outward_last: cos_to, duration_s, farthest_s, farthest_after_s, end_s }
    }
}

/// The region about the boat.
struct Region {
    /// By edge: outward normal, and how far inside of it the boat is, m.
    edges: [(Ned, f64); 4],
    /// What wind and current add to the boat's way, m/s.
    drift: Ned,
    handling: Handling,
    /// How far the region is inside of the field, m.
    margin_m: f64,
}

impl Region {
    fn new(situation: &Situation, margin_m: f64) -> Region {
        let field = &situation.model.field;
        let (x, y) = field.along_across(situation.at);
        let (width_m, depth_m) = (field.plan.width_m, field.plan.depth_m);
        let minus = |v: Ned| v.scaled(-1.0);
        Region {
            edges: [
                (minus(field.along), x - margin_m),
                (field.along, width_m - margin_m - x),
                (minus(field.across), y - margin_m),
                (field.across, depth_m - margin_m - y),
            ],
            drift: situation.motion.drift_now(&situation.own.nav),
            handling: situation.motion.handling(),
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
        let turn_s = 2.0 / self.handling.mean_turn_rad_s(PI);
        save_m + (lookahead_s.max(turn_s) + self.handling.reaction_s) * (fastest_m_s + self.drift.length())
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

    /// A boat that always turns alike.
    const HANDLING: Handling = Handling::evenly(0.35);

    /// The farthest and the last distance outwards of a boat that turns at a speed of 1 m/s, by small steps, m.
    fn stepped(from_rad: f64, by_rad: f64) -> (f64, f64) {
        let steps = 100_000;
        let dt_s = by_rad.abs() / HANDLING.turn_rad_s / f64::from(steps);
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
                let turn = Turn::new(
                    (from_rad, math::sin_cos(from_rad).0),
                    by_rad,
                    math::sin_cos(from_rad + by_rad),
                    &HANDLING,
                );
                let (farthest_m, out_m) = stepped(from_rad, by_rad);
                assert!((0.0..=turn.duration_s + 1e-9).contains(&turn.farthest_after_s), "{}", turn.farthest_after_s);
                let what = format!("from {from_deg} by {by_deg} degrees");
                assert!((turn.farthest_s - farthest_m).abs() < 1e-4, "{what}: {} m, {farthest_m}", turn.farthest_s);
                assert!((turn.end_s - out_m).abs() < 1e-4, "{what}: {} m, {out_m}", turn.end_s);
            }
        }
    }

    #[test]
    fn a_course_that_is_left_out_is_clear_at_every_speed() {
        let (save_m, fastest_m_s) = (6.0, 3.5);
        let mut left_out = 0;
        for seed in 0..20_000 {
            let mut stream = game::stream::Stream::new(seed, "op_region");
            let old_m_s = stream.between(0.0, 4.0);
            let (duration_s, straight_s) = (stream.between(0.0, 9.0), stream.between(0.0, 9.0));
            let (farthest_s, back_s) = (stream.between(0.0, 9.0), stream.between(0.0, 9.0));
            let farthest_after_s = stream.between(0.0, duration_s);
            let end_s = farthest_s - back_s;
            let turn = Turn { outward_last: 0.0, duration_s, farthest_s, farthest_after_s, end_s };
            let way = Way {
                start_m: stream.between(0.0, 80.0) as f32,
                drift_m: stream.between(-9.0, 9.0) as f32,
                out_s: farthest_s as f32,
                back_s: back_s as f32,
                straight_s: stream.between(-9.0, 9.0) as f32,
                ramp: Ramp::new(old_m_s, &turn, straight_s, &HANDLING),
            };
            if way.least_m(old_m_s, fastest_m_s) < save_m {
                continue;
            }
            left_out += 1;
            for j in 0..36 {
                let utility = way.utility(0.1 * j as f32, (50.0 / save_m) as f32);
                assert_eq!(utility, 100.0, "seed {seed}, speed {j}");
            }
        }
        assert!(left_out > 2_000, "{left_out} left out");
    }
}
