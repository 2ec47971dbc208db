//! Outline: the boat's closest distance to a polygon, for each course and speed.
//!
//! After a decision the boat keeps its motion while it turns, then moves straight over the ground.
//! Without drift, a run at a higher speed contains those at lower speeds, so its pass distance is
//! at most theirs.

use super::steering::CPA_MIN_UTILITY;
use crate::ivp::{Courses, Grid, LANES, Lag, Lanes, Table, larger, smaller};
use primitives::Ned;
use primitives::instructions::Kernel;
use rules::field::{is_within, sides};

/// Maximum rounding error of a bound, with a margin, m.
const ROUNDING_M: f64 = 1e-6;

/// A polygon with lower bounds on the distance to it.
#[derive(Clone)]
pub(super) struct Outline {
    corners: Vec<Ned>,
    sides: Vec<Side>,
    /// Half planes that contain the polygon.
    half_planes: Vec<HalfPlane>,
    /// The half planes that do not contain the boat.
    facing: Vec<HalfPlane>,
    /// Where the current run passes each corner.
    feet: Vec<Foot>,
    /// Utilities of a group of courses by speed, from the first speed that matters.
    utilities: Vec<Lanes<f32>>,
}

/// A side, from one corner to the next.
#[derive(Clone, Copy)]
struct Side {
    corner: Ned,
    along: Ned,
    /// Reciprocal of the squared length, 1/m².
    per_m2: f64,
}

/// The points that are at most this far (m) along an outward unit normal.
#[derive(Clone, Copy)]
struct HalfPlane {
    normal: Ned,
    reach_m: f64,
}

impl HalfPlane {
    /// How far a place is outside the half plane, m.
    #[inline(always)]
    fn out_m(&self, north: f64, east: f64) -> f64 {
        self.normal.north * north + self.normal.east * east - self.reach_m
    }
}

/// Places or velocities of a group of courses.
#[derive(Clone, Copy)]
struct Places {
    north: Lanes<f64>,
    east: Lanes<f64>,
}

impl Places {
    #[inline(always)]
    fn splat(place: Ned) -> Places {
        Places {
            north: Lanes::splat(place.north),
            east: Lanes::splat(place.east),
        }
    }

    /// The places reached after this time at a velocity.
    #[inline(always)]
    fn after(&self, along: &Places, after_s: &Lanes<f64>) -> Places {
        let mut places = *self;
        for i in 0..LANES {
            places.north.0[i] += along.north.0[i] * after_s.0[i];
            places.east.0[i] += along.east.0[i] * after_s.0[i];
        }
        places
    }
}

/// The points of a group of straight runs that are nearest to a corner.
#[derive(Clone)]
struct Foot {
    /// Time, s; negative if before the start of the run.
    after_s: Lanes<f64>,
    /// Squared distance, m²; infinite if before the start of the run.
    squared_m2: Lanes<f64>,
}

/// A group of straight runs.
#[derive(Clone)]
struct Runs {
    from: Places,
    along: Places,
    /// Time of the first crossing of a side, s; infinite if never.
    crossing_s: Lanes<f64>,
}

impl Outline {
    pub(super) fn new(corners: &[Ned]) -> Outline {
        let side = |(corner, next): (Ned, Ned)| {
            let along = next - corner;
            let squared_m2 = along.dot(along);
            Side {
                corner,
                along,
                per_m2: if squared_m2 > 0.0 {
                    1.0 / squared_m2
                } else {
                    0.0
                },
            }
        };
        let sides: Vec<Side> = sides(corners).map(side).collect();
        let mut half_planes: Vec<HalfPlane> = Vec::new();
        for side in &sides {
            let unit = side.along.scaled(side.per_m2.sqrt());
            // A half plane that contains all corners is a valid bound, whichever way it faces from
            // the line through the side, and even for a concave polygon.
            for out in [1.0, -1.0] {
                let normal = Ned {
                    north: out * unit.east,
                    east: -out * unit.north,
                };
                // Parallel sides share a half plane, because each half plane is tested for all
                // courses.
                if half_planes
                    .iter()
                    .all(|known| known.normal.dot(normal) < 1.0 - 1e-9)
                {
                    let reach_m = corners
                        .iter()
                        .map(|corner| corner.dot(normal))
                        .fold(f64::NEG_INFINITY, f64::max);
                    half_planes.push(HalfPlane { normal, reach_m });
                }
            }
        }
        let facing = Vec::new();
        let feet = Vec::new();
        let utilities = Vec::new();
        Outline {
            corners: corners.to_vec(),
            sides,
            half_planes,
            facing,
            feet,
            utilities,
        }
    }

    /// The smallest squared distance to any side, m².
    #[inline(always)]
    fn squared_m2(&self, places: &Places) -> Lanes<f64> {
        let mut least = Lanes::splat(f64::INFINITY);
        for side in &self.sides {
            for i in 0..LANES {
                let north = places.north.0[i] - side.corner.north;
                let east = places.east.0[i] - side.corner.east;
                let share = (north * side.along.north + east * side.along.east) * side.per_m2;
                let share = smaller(larger(share, 0.0), 1.0);
                let north = north - share * side.along.north;
                let east = east - share * side.along.east;
                least.0[i] = smaller(least.0[i], north * north + east * east);
            }
        }
        least
    }

    /// Computes where runs pass the corners and when they cross a side.
    #[inline(always)]
    fn runs(&mut self, from: Places, along: Places) -> Runs {
        let mut per_m2_s2 = Lanes::splat(0.0);
        let mut crossing_s = Lanes::splat(f64::INFINITY);
        for i in 0..LANES {
            let squared = along.north.0[i] * along.north.0[i] + along.east.0[i] * along.east.0[i];
            per_m2_s2.0[i] = if squared > 0.0 { 1.0 / squared } else { 0.0 };
        }
        self.feet.clear();
        for side in &self.sides {
            let mut foot = Foot {
                after_s: per_m2_s2,
                squared_m2: per_m2_s2,
            };
            for i in 0..LANES {
                let run_north = along.north.0[i];
                let run_east = along.east.0[i];
                let north = side.corner.north - from.north.0[i];
                let east = side.corner.east - from.east.0[i];
                let after_s = (north * run_north + east * run_east) * per_m2_s2.0[i];
                let off_north = north - after_s * run_north;
                let off_east = east - after_s * run_east;
                let squared_m2 = off_north * off_north + off_east * off_east;
                foot.after_s.0[i] = after_s;
                // A run never passes a corner that is astern of it, however long it is.
                foot.squared_m2.0[i] = if after_s >= 0.0 {
                    squared_m2
                } else {
                    f64::INFINITY
                };
                // Line intersection by Cramer's rule; for parallel lines the corners suffice.
                let per = 1.0 / (run_north * side.along.east - run_east * side.along.north);
                let when_s = (north * side.along.east - east * side.along.north) * per;
                let share = (north * run_east - east * run_north) * per;
                let crosses = (0.0..=1.0).contains(&share) & (when_s >= 0.0);
                crossing_s.0[i] = smaller(
                    if crosses { when_s } else { f64::INFINITY },
                    crossing_s.0[i],
                );
            }
            self.feet.push(foot);
        }
        Runs {
            from,
            along,
            crossing_s,
        }
    }

    /// The smallest squared distance of runs of this duration, or `before_m2` if that is less, m².
    /// Points other than the corners and ends considered are farther away.
    #[inline(always)]
    fn passed_m2(&self, runs: &Runs, after_s: &Lanes<f64>, before_m2: &Lanes<f64>) -> Lanes<f64> {
        let mut least = self.squared_m2(&runs.from.after(&runs.along, after_s));
        for foot in &self.feet {
            for i in 0..LANES {
                let squared_m2 = smaller(foot.squared_m2.0[i], least.0[i]);
                least.0[i] = if foot.after_s.0[i] <= after_s.0[i] {
                    squared_m2
                } else {
                    least.0[i]
                };
            }
        }
        for i in 0..LANES {
            let squared_m2 = if runs.crossing_s.0[i] <= after_s.0[i] {
                0.0
            } else {
                least.0[i]
            };
            least.0[i] = smaller(squared_m2, before_m2.0[i]);
        }
        least
    }
}

/// Lowers the utilities of an empty table to those of passing a polygon.
pub(super) struct Passes<'a> {
    pub(super) table: &'a mut Table,
    pub(super) grid: &'a Grid,
    pub(super) outline: &'a mut Outline,
    pub(super) at: Ned,
    /// Over the ground, m/s.
    pub(super) velocity: Ned,
    /// Velocity that wind and current add to the boat's, m/s.
    pub(super) drift: Ned,
    pub(super) lag: Lag,
    /// Duration of the straight run, s.
    pub(super) horizon_s: f64,
    /// Pass distances that give half and full utility, m.
    pub(super) min_m: f64,
    pub(super) max_m: f64,
}

impl Kernel for Passes<'_> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        // Inside the polygon there is no distance to keep: all courses are equally bad, and other
        // behaviours decide how to get out.
        if is_within(&self.outline.corners, self.at) {
            for k in 0..self.grid.courses() {
                self.table.lowered_mut(k).fill(Lanes::splat(0.0));
            }
            return;
        }
        let at = self.at;
        let Outline {
            half_planes,
            facing,
            ..
        } = &mut *self.outline;
        facing.clear();
        facing.extend(
            half_planes
                .iter()
                .filter(|half_plane| half_plane.out_m(at.north, at.east) > 0.0),
        );
        for (block, courses) in self.grid.courses_side_by_side().iter().enumerate() {
            self.pass(LANES * block, courses);
        }
    }
}

impl Passes<'_> {
    /// Lowers the utilities of a group of courses.
    #[inline(always)]
    fn pass(&mut self, first: usize, courses: &Courses) {
        let along = Places {
            north: courses.north,
            east: courses.east,
        };
        let duration_s = self.turns_s(courses);
        let horizon_s = Lanes::splat(self.horizon_s);
        let velocity = Places::splat(self.velocity);
        let start = Places::splat(self.at).after(&velocity, &duration_s);
        let begin = start.after(&Places::splat(self.drift), &horizon_s);
        let fastest_m = self.grid.speed_max_m_s() * self.horizon_s;
        let end = begin.after(&along, &Lanes::splat(fastest_m));
        let mut before_m2 = Lanes::splat(f64::INFINITY);
        // Near an obstacle, a helm spent two thirds of its time on distances between a polygon and
        // each of 36 legs on each of 360 courses. Half planes rule out most courses at once: with
        // them, games with obstacles take 0.34 to 0.53 times as long and have the same digests.
        match self.clear_of(&start, &begin, &end) {
            Clear::AllTheWay => return,
            Clear::WhileItTurns => {}
            Clear::No => {
                let turning = self.outline.runs(Places::splat(self.at), velocity);
                let from_m2 = self.outline.squared_m2(&turning.from);
                before_m2 = self.outline.passed_m2(&turning, &duration_s, &from_m2);
            }
        }
        let before = self.worth(&before_m2);
        let least = self.run_straight((start, begin), along, &before_m2);
        for i in 0..LANES.min(self.grid.courses() - first) {
            let last = self
                .outline
                .utilities
                .last()
                .map_or(before.0[i], |last| last.0[i]);
            let utilities = self.outline.utilities.iter();
            if utilities.fold(before.0[i], |least, by_course| {
                smaller(least, by_course.0[i])
            }) < 100.0
            {
                let row = self.table.lowered_mut(first + i);
                row.fill(Lanes::splat(last));
                // Fill the row by ascending speed: first the speeds that come no nearer than the
                // turn, then the computed ones, then the last value for all higher speeds.
                let known = std::iter::repeat_n(before.0[i], least);
                let known = known.chain(
                    self.outline
                        .utilities
                        .iter()
                        .map(|by_course| by_course.0[i]),
                );
                for (j, utility) in known.enumerate() {
                    row[j / LANES].0[j % LANES] = utility;
                }
            }
        }
    }

    /// How long the boat keeps its motion, s.
    #[inline(always)]
    fn turns_s(&self, courses: &Courses) -> Lanes<f64> {
        let mut duration_s = Lanes::splat(0.0);
        for i in 0..LANES {
            duration_s.0[i] = self.lag.duration_s(Ned {
                north: courses.north.0[i],
                east: courses.east.0[i],
            });
        }
        duration_s
    }

    /// How much of the paths a single half plane proves clear of the polygon, given the start of
    /// each path and the start and end of its straight run.
    #[inline(always)]
    fn clear_of(&self, start: &Places, begin: &Places, end: &Places) -> Clear {
        let most_m = self.max_m + ROUNDING_M;
        let mut clear = Clear::No;
        for half_plane in &self.outline.facing {
            let mut turn_m = Lanes::splat(0.0);
            let mut end_m = Lanes::splat(0.0);
            for i in 0..LANES {
                let start_m = half_plane.out_m(start.north.0[i], start.east.0[i]);
                turn_m.0[i] = smaller(start_m, half_plane.out_m(begin.north.0[i], begin.east.0[i]));
                end_m.0[i] = half_plane.out_m(end.north.0[i], end.east.0[i]);
            }
            let least_m = turn_m.reduced(smaller);
            if smaller(least_m, half_plane.out_m(self.at.north, self.at.east)) > most_m {
                clear = Clear::WhileItTurns;
                if end_m.reduced(smaller) > most_m {
                    return Clear::AllTheWay;
                }
            }
        }
        clear
    }

    /// Computes the utilities of straight runs by speed, from the first speed that matters to the
    /// last. Returns the index of the first. Each run leads from `start` to a point along the
    /// course from `begin`.
    #[inline(always)]
    fn run_straight(
        &mut self,
        (start, begin): (Places, Places),
        along: Places,
        before_m2: &Lanes<f64>,
    ) -> usize {
        let drifts = self.drift != Ned::default();
        let speeds_m_s = self.grid.speeds_m_s();
        let max_m2 = self.max_m * self.max_m;
        let clear_m = self.clear_m(
            (&start, &begin),
            &along,
            smaller(before_m2.reduced(larger), max_m2).sqrt() + ROUNDING_M,
        );
        let first = speeds_m_s
            .partition_point(|speed_m_s| speed_m_s * self.horizon_s <= clear_m)
            .max(usize::from(!drifts));
        self.outline.utilities.clear();
        if first >= speeds_m_s.len() {
            return first;
        }
        if drifts {
            // With drift, the direction over the ground depends on the speed. Applying all drift
            // before the run brought every course near the obstacle, and boats stayed in front of
            // it.
            for speed_m_s in &speeds_m_s[first..] {
                let over_ground =
                    Places::splat(self.drift).after(&along, &Lanes::splat(*speed_m_s));
                let runs = self.outline.runs(start, over_ground);
                let horizon_s = Lanes::splat(self.horizon_s);
                let least_m2 = self.outline.passed_m2(&runs, &horizon_s, before_m2);
                self.outline.utilities.push(self.worth(&least_m2));
            }
            return first;
        }
        let runs = self.outline.runs(begin, along);
        let mut last_m = f64::NEG_INFINITY;
        for foot in &self.outline.feet {
            last_m = larger(last_m, foot.after_s.reduced(larger));
        }
        for speed_m_s in &speeds_m_s[first..] {
            let run_m = speed_m_s * self.horizon_s;
            let least_m2 = self
                .outline
                .passed_m2(&runs, &Lanes::splat(run_m), before_m2);
            self.outline.utilities.push(self.worth(&least_m2));
            // All corners are astern, so a longer run changes nothing: all higher speeds have the
            // last utility.
            if run_m >= last_m {
                break;
            }
        }
        first
    }

    /// The distance that all straight runs can cover through the water before any may come within
    /// `near_m`, m.
    #[inline(always)]
    fn clear_m(&self, (start, begin): (&Places, &Places), along: &Places, near_m: f64) -> f64 {
        let mut most_m = f64::NEG_INFINITY;
        for half_plane in &self.outline.half_planes {
            let mut clear_m = Lanes::splat(0.0);
            for i in 0..LANES {
                let start_m = half_plane.out_m(start.north.0[i], start.east.0[i]);
                let out_m = half_plane.out_m(begin.north.0[i], begin.east.0[i]) - near_m;
                let nearing = -(half_plane.normal.north * along.north.0[i]
                    + half_plane.normal.east * along.east.0[i]);
                let until_m = if nearing > 0.0 {
                    out_m / nearing
                } else {
                    f64::INFINITY
                };
                clear_m.0[i] = if smaller(start_m - near_m, out_m) > 0.0 {
                    until_m
                } else {
                    f64::NEG_INFINITY
                };
            }
            most_m = larger(most_m, clear_m.reduced(smaller));
        }
        most_m - ROUNDING_M
    }

    /// Utility of passes, as for contacts: from 0 at zero distance to 100 at the largest distance.
    #[inline(always)]
    fn worth(&self, squared_m2: &Lanes<f64>) -> Lanes<f32> {
        let low_per_m = CPA_MIN_UTILITY / larger(self.min_m, f64::MIN_POSITIVE);
        let high_per_m =
            (100.0 - CPA_MIN_UTILITY) / larger(self.max_m - self.min_m, f64::MIN_POSITIVE);
        let mut utilities = Lanes::splat(0.0);
        for i in 0..LANES {
            let pass_m = squared_m2.0[i].sqrt();
            let low = low_per_m * pass_m;
            let high = smaller(CPA_MIN_UTILITY + high_per_m * (pass_m - self.min_m), 100.0);
            utilities.0[i] = (if pass_m <= self.min_m { low } else { high }) as f32;
        }
        utilities
    }
}

/// How far paths are clear of a polygon.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Clear {
    No,
    WhileItTurns,
    AllTheWay,
}

#[cfg(test)]
mod tests {
    use super::*;
    use primitives::instructions::Instructions;
    use primitives::stream::Stream;
    use rules::field::distance_to_line;

    const MIN_M: f64 = 1.0;
    const MAX_M: f64 = 4.0;
    const HORIZON_S: f64 = 12.0;

    fn within(stream: &mut Stream, most: f64) -> Ned {
        Ned {
            north: stream.between(-most, most),
            east: stream.between(-most, most),
        }
    }

    /// A boat near a polygon of any shape, even a self-intersecting one; the drift may be zero.
    struct Scene {
        corners: Vec<Ned>,
        at: Ned,
        velocity: Ned,
        drift: Ned,
        lag: Lag,
    }

    impl Scene {
        fn new(seed: u64) -> Scene {
            let stream = &mut Stream::new(seed, "obstacle");
            let velocity = within(stream, 2.0);
            Scene {
                corners: (0..3 + seed % 4).map(|_| within(stream, 8.0)).collect(),
                at: within(stream, [8.0, 40.0][seed as usize % 2]),
                velocity,
                drift: within(stream, [0.0, 0.4][seed as usize / 2 % 2]),
                lag: Lag {
                    velocity,
                    heading: Ned::toward_deg(stream.between(0.0, 360.0)),
                    reaction_s: stream.between(0.0, 2.0),
                    turn_rad_s: stream.between(0.2, 2.0),
                    acceleration_m_s2: 1.0,
                    deceleration_m_s2: 1.0,
                },
            }
        }

        fn table(&self, grid: &Grid, instructions: Instructions) -> Table {
            let mut table = Table::default();
            table.clear(grid);
            instructions.run(Passes {
                table: &mut table,
                grid,
                outline: &mut Outline::new(&self.corners),
                at: self.at,
                velocity: self.velocity,
                drift: self.drift,
                lag: self.lag,
                horizon_s: HORIZON_S,
                min_m: MIN_M,
                max_m: MAX_M,
            });
            table
        }

        /// The utilities of a course by speed, each for the turn and a straight line to the end.
        fn worth(&self, grid: &Grid, k: usize) -> Vec<f64> {
            let course = Ned {
                north: grid.direction(k).0.into(),
                east: grid.direction(k).1.into(),
            };
            let start = self.at + self.velocity.scaled(self.lag.duration_s(course));
            let turning_m = distance_to_line(&self.corners, (self.at, start));
            let leg = |speed_m_s: &f64| {
                let to =
                    start + self.drift.scaled(HORIZON_S) + course.scaled(speed_m_s * HORIZON_S);
                let pass_m = turning_m.min(distance_to_line(&self.corners, (start, to)));
                match pass_m {
                    _ if pass_m <= MIN_M => CPA_MIN_UTILITY * pass_m / MIN_M,
                    _ if pass_m >= MAX_M => 100.0,
                    _ => {
                        CPA_MIN_UTILITY
                            + (100.0 - CPA_MIN_UTILITY) * (pass_m - MIN_M) / (MAX_M - MIN_M)
                    }
                }
            };
            grid.speeds_m_s().iter().map(leg).collect()
        }
    }

    #[test]
    fn ways_are_worth_what_they_are_leg_by_leg_with_the_same_bits_from_all_instructions() {
        // The last courses and speeds do not fill their lanes.
        let grid = Grid::new(45, 20, 2.0);
        let mut clear = 0;
        let mut near = 0;
        for seed in 0..2_000 {
            let scene = Scene::new(seed);
            let tables = Instructions::of_this_machine()
                .into_iter()
                .map(|set| scene.table(&grid, set));
            let tables: Vec<Table> = tables.collect();
            for k in 0..grid.courses() {
                for (j, want) in scene.worth(&grid, k).into_iter().enumerate() {
                    let got = tables[0].utility(k, j);
                    assert!(
                        (f64::from(got) - want).abs() < 1e-5,
                        "seed {seed}, {k}, {j}: {got}, want {want}"
                    );
                    assert!(
                        tables
                            .iter()
                            .all(|table| table.utility(k, j).to_bits() == got.to_bits()),
                        "seed {seed}"
                    );
                    (clear, near) = (
                        clear + usize::from(want == 100.0),
                        near + usize::from(want < 100.0),
                    );
                }
            }
        }
        assert!(
            clear > 300_000 && near > 300_000,
            "{clear} points clear, {near} near"
        );
    }
}
