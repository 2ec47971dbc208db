//! Cells of the decision grid: blocks of neighbouring courses and speeds that share one bound of a
//! function.
//!
//! The velocities of a cell form a ring segment. It lies within a polygon with four corners: on the
//! first and last courses, at the slowest and fastest speeds, where the fast corners are moved
//! outwards until the side between them touches the outer arc. For a wide segment, the square
//! around all speeds is used instead.

use super::grid::Grid;
use super::lanes::{LANES, Lanes, SIDE};
use std::f64::consts::{FRAC_PI_3, TAU};

/// Half-angle above which a ring segment counts as a whole disc, rad.
const WIDEST_RAD: f64 = FRAC_PI_3;

#[derive(Clone, Copy)]
pub(super) struct Cell {
    /// The first and the last course, unit vectors.
    pub(super) first: (f32, f32),
    pub(super) last: (f32, f32),
    /// The middle course, a unit vector.
    pub(super) north: f32,
    pub(super) east: f32,
    /// The largest angle between the middle course and any other course of the cell, rad.
    pub(super) half: f32,
    pub(super) slow: f32,
    pub(super) fast: f32,
    pub(super) mean: f32,
    /// The factor by which the outer corners exceed the fastest speed; 1 for a whole disc.
    stretch: f32,
    /// Whether the cell counts as a whole disc.
    pub(super) is_disc: bool,
}

impl Cell {
    /// The corners as velocities, north and east, m/s. Their polygon contains all velocities of the
    /// cell.
    #[inline(always)]
    pub(super) fn corners(&self) -> [(f32, f32); 4] {
        let at = |(north, east): (f32, f32), speed: f32| (speed * north, speed * east);
        // For a disc the corners lie on both sides of the middle: the square uses the same four
        // products as a ring segment, so that no lane branches.
        let slow = if self.is_disc { -self.slow } else { self.slow };
        let fast = self.stretch * self.fast;
        [
            at(self.first, slow),
            at(self.last, slow),
            at(self.first, fast),
            at(self.last, fast),
        ]
    }
}

/// The courses of a group of cells.
#[derive(Clone, Debug)]
pub(super) struct CourseSpans {
    first_north: Lanes<f32>,
    first_east: Lanes<f32>,
    last_north: Lanes<f32>,
    last_east: Lanes<f32>,
    /// The middle courses, unit vectors.
    pub(super) north: Lanes<f32>,
    pub(super) east: Lanes<f32>,
    half: f32,
    stretch: f32,
    is_disc: bool,
}

/// The speeds of a group of cells.
#[derive(Clone, Debug)]
pub(super) struct SpeedSpans {
    slow: Lanes<f32>,
    fast: Lanes<f32>,
    pub(super) mean: Lanes<f32>,
}

/// The number of courses and speeds of a cell, which defines its shape.
#[derive(Clone, Copy)]
pub(super) struct CellSize {
    side: usize,
    /// Half of the angle between its first and last course; `None` for a disc.
    half_rad: Option<f64>,
}

impl CellSize {
    /// A cell of `side` courses by `side` speeds.
    pub(super) fn new(grid: &Grid, side: usize) -> CellSize {
        let half_rad = 0.5 * (side - 1) as f64 * TAU / grid.courses() as f64;
        CellSize {
            side,
            half_rad: (half_rad <= WIDEST_RAD).then_some(half_rad),
        }
    }

    /// The courses of a group of cells; `number` maps each lane to a cell index along the courses.
    pub(super) fn courses(self, grid: &Grid, number: impl Fn(usize) -> usize) -> CourseSpans {
        let spans: [[f32; 6]; LANES] = std::array::from_fn(|i| self.course(grid, number(i)));
        let part = |part: usize| Lanes::each(|i| spans[i][part]);
        CourseSpans {
            first_north: part(0),
            first_east: part(1),
            last_north: part(2),
            last_east: part(3),
            north: part(4),
            east: part(5),
            half: self.half_rad.unwrap_or(std::f64::consts::PI) as f32,
            // The chord between two corners at the fastest speed lies inside the arc by this
            // factor. With this extension, the polygon contains every velocity of the cell.
            stretch: self
                .half_rad
                .map_or(1.0, |half_rad| 1.0 / primitives::math::sin_cos(half_rad).1)
                as f32,
            is_disc: self.half_rad.is_none(),
        }
    }

    /// The speeds of a group of cells; `number` maps each lane to a cell index along the speeds.
    pub(super) fn speeds(self, grid: &Grid, number: impl Fn(usize) -> usize) -> SpeedSpans {
        let spans: [[f32; 3]; LANES] = std::array::from_fn(|i| self.speed(grid, number(i)));
        let part = |part: usize| Lanes::each(|i| spans[i][part]);
        SpeedSpans {
            slow: part(0),
            fast: part(1),
            mean: part(2),
        }
    }

    /// First, last and middle course; beyond the grid, its last course.
    fn course(self, grid: &Grid, number: usize) -> [f32; 6] {
        // The grid size need not be a multiple of the cell size. Lanes beyond it repeat the last
        // course, which keeps all bounds valid, and their sums mark them as absent.
        let of = |i: usize| (self.side * number + i).min(grid.courses() - 1);
        let first = of(0);
        let last = of(self.side - 1);
        if self.half_rad.is_none() {
            // The square around all speeds; `speed` gives half a side.
            return [1.0, 1.0, 1.0, -1.0, 1.0, 0.0];
        }
        let (east, north) =
            primitives::math::sin_cos(0.5 * (grid.course_rad(first) + grid.course_rad(last)));
        let first = grid.direction(first);
        let last = grid.direction(last);
        [first.0, first.1, last.0, last.1, north as f32, east as f32]
    }

    /// The slowest, the fastest and the mean speed, m/s; beyond the grid, its last speed.
    fn speed(self, grid: &Grid, number: usize) -> [f32; 3] {
        let of = |i: usize| grid.speed_m_s((self.side * number + i).min(grid.speeds() - 1)) as f32;
        let slow = of(0);
        let fast = of(self.side - 1);
        if self.half_rad.is_some() {
            [slow, fast, 0.5 * (slow + fast)]
        } else {
            [fast, fast, 0.0]
        }
    }
}

#[inline(always)]
pub(super) fn cell(courses: &CourseSpans, speeds: &SpeedSpans, i: usize) -> Cell {
    Cell {
        first: (courses.first_north.0[i], courses.first_east.0[i]),
        last: (courses.last_north.0[i], courses.last_east.0[i]),
        north: courses.north.0[i],
        east: courses.east.0[i],
        half: courses.half,
        slow: speeds.slow.0[i],
        fast: speeds.fast.0[i],
        mean: speeds.mean.0[i],
        stretch: courses.stretch,
        is_disc: courses.is_disc,
    }
}

/// The grid in cells: tiles of [`SIDE`] by [`SIDE`] points, and sectors of [`SIDE`] by [`SIDE`]
/// tiles.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    /// Number of sectors along the courses.
    pub(super) sector_courses: usize,
    /// Number of sectors along the speeds.
    pub(super) sector_speeds: usize,
    /// Groups of sectors, speeds varying fastest, so that a group that leads away from the best
    /// courses can be excluded as a whole.
    pub(super) sectors: Vec<(CourseSpans, SpeedSpans)>,
    /// For the tiles of a sector, by the sector's index along the courses; courses vary fastest.
    pub(super) tile_courses: Vec<CourseSpans>,
    /// For the tiles of a sector, by the sector's index along the speeds.
    pub(super) tile_speeds: Vec<SpeedSpans>,
    /// Courses of a tile's points, by the tile's index along the courses: north, east.
    pub(super) points: Vec<(Lanes<f32>, Lanes<f32>)>,
    /// Speeds of a tile's points, by the tile's index along the speeds, m/s.
    pub(super) point_speeds: Vec<Lanes<f32>>,
}

impl Cells {
    pub(super) fn new(grid: &Grid) -> Cells {
        let sector_courses = grid.courses().div_ceil(LANES);
        let sector_speeds = grid.speeds().div_ceil(LANES);
        let tile = CellSize::new(grid, SIDE);
        let sector = CellSize::new(grid, SIDE * SIDE);
        let chunks = (sector_courses * sector_speeds).div_ceil(LANES);
        let sectors = |chunk: usize| {
            let number = move |i: usize| LANES * chunk + i;
            let courses = sector.courses(grid, |i| number(i) / sector_speeds);
            (courses, sector.speeds(grid, |i| number(i) % sector_speeds))
        };
        let direction = |tile: usize, i: usize| {
            grid.direction((SIDE * tile + i / SIDE).min(grid.courses() - 1))
        };
        let speed = |tile: usize, i: usize| {
            grid.speed_m_s((SIDE * tile + i % SIDE).min(grid.speeds() - 1)) as f32
        };
        let points = |tile| {
            (
                Lanes::each(|i| direction(tile, i).0),
                Lanes::each(|i| direction(tile, i).1),
            )
        };
        Cells {
            sectors: (0..chunks).map(sectors).collect(),
            tile_courses: (0..sector_courses)
                .map(|at| tile.courses(grid, |i| SIDE * at + i % SIDE))
                .collect(),
            tile_speeds: (0..sector_speeds)
                .map(|at| tile.speeds(grid, |i| SIDE * at + i / SIDE))
                .collect(),
            points: (0..SIDE * sector_courses).map(points).collect(),
            point_speeds: (0..SIDE * sector_speeds)
                .map(|tile| Lanes::each(|i| speed(tile, i)))
                .collect(),
            sector_courses,
            sector_speeds,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::closest::{Approach, Closest, Side};
    use super::super::closing::Closing;
    use super::super::objective::{Field, Objective, Parts};
    use super::*;
    use crate::ivp::Lag;
    use primitives::Ned;
    use primitives::stream::Stream;

    fn within(stream: &mut Stream, most: f64) -> Ned {
        Ned {
            north: stream.between(-most, most),
            east: stream.between(-most, most),
        }
    }

    /// A random formula of either kind.
    fn field(stream: &mut Stream, grid: &Grid) -> Field {
        let fastest_m_s = grid.speed_max_m_s();
        let range_m = [3.0, 30.0, 400.0][stream.below(3) as usize];
        let offset = within(stream, range_m);
        let velocity = within(stream, fastest_m_s);
        let lag = |stream: &mut Stream| Lag {
            velocity: within(stream, fastest_m_s),
            heading: Ned::toward_deg(stream.between(0.0, 360.0)),
            reaction_s: stream.between(0.0, 2.0),
            turn_rad_s: stream.between(0.1, 2.0),
            acceleration_m_s2: stream.between(0.1, 3.0),
            deceleration_m_s2: stream.between(0.1, 3.0),
        };
        let objective = match stream.below(5) {
            0 => Objective::Closing(Closing { offset, velocity }),
            kind => Objective::Closest(Closest {
                offset,
                velocity,
                horizon_s: [0.0, 8.0, 15.0, 120.0][stream.below(4) as usize],
                min_m: 0.1 * range_m,
                max_m: [0.3, 1.5][stream.below(2) as usize] * range_m,
                touch_m: 0.0,
                approach: if kind < 3 {
                    Approach::Seek
                } else {
                    Approach::Avoid {
                        at_min: 50.0,
                        leave_to: [None, Some(Side::Port), Some(Side::Starboard)]
                            [stream.below(3) as usize],
                    }
                },
                lag: (kind % 2 == 0).then(|| lag(stream)),
            }),
        };
        let Parts::Field(field) = objective.parts(grid) else {
            panic!("{objective:?} is a formula")
        };
        field
    }

    /// Upper and lower bounds of the function over a cell.
    fn bounds(field: &Field, cell: &Cell) -> (f32, f32) {
        match field {
            Field::Closest(ready) => {
                let ways = ready.ways(&ready.turning.fan(cell), cell);
                let least_m = ready.least(&ways);
                let most_m = ready.most(&ways);
                if ready.seek {
                    (ready.worth(least_m), ready.worth(most_m))
                } else {
                    (ready.worth(most_m), ready.worth(least_m))
                }
            }
            Field::Closing(ready) => (ready.bound(cell), 0.0),
        }
    }

    #[test]
    fn no_point_of_a_cell_is_outside_of_its_bounds() {
        let mut clear = 0;
        for seed in 0..2_000 {
            let mut stream = Stream::new(seed, "ivp/cell");
            let courses = [5, 12, 36, 47, 90, 360][stream.below(6) as usize];
            let grid = Grid::new(
                courses,
                [2, 9, 21, 36][stream.below(4) as usize],
                stream.between(0.5, 8.0),
            );
            let cells = Cells::new(&grid);
            let field = field(&mut stream, &grid);
            for (k, j) in grid.points() {
                let across = k / LANES;
                let along = j / LANES;
                let sector = across * cells.sector_speeds + along;
                let (of_courses, of_speeds) = &cells.sectors[sector / LANES];
                let tile = SIDE * (j / SIDE % SIDE) + k / SIDE % SIDE;
                let (north, east) = grid.direction(k);
                let utility = field.utility(north, east, grid.speed_m_s(j) as f32);
                for (what, cell) in [
                    ("sector", cell(of_courses, of_speeds, sector % LANES)),
                    (
                        "tile",
                        cell(&cells.tile_courses[across], &cells.tile_speeds[along], tile),
                    ),
                ] {
                    let (most, least) = bounds(&field, &cell);
                    let is_within = (least..=most).contains(&utility);
                    assert!(
                        is_within,
                        "seed {seed}, {what} of {k}, {j}: {utility}, {least} to {most}: {field:?}"
                    );
                    clear += u32::from(least > 0.0);
                }
            }
        }
        assert!(
            clear > 1000,
            "only {clear} points in cells far from contacts"
        );
    }
}
