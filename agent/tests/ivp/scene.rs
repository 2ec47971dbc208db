//! Random decisions, with functions of every kind and plenty of equal values.

use agent::ivp::{Approach, Choice, Closest, Closing, Combine, Decision, Grid, Lag, Objective, Peak, Peaks};
use agent::ivp::{Problem, SpeedLimit, Wish};
use game::stream::Stream;

/// Numbers that functions refer to.
pub(crate) struct Tables {
    points: Vec<f32>,
    courses: Vec<f32>,
    speeds: Vec<f32>,
}

impl Tables {
    pub(crate) fn random(stream: &mut Stream, grid: &Grid) -> Tables {
        // Whole tens, so that there are ties.
        let mut numbers = |count: usize| (0..count).map(|_| 10.0 * stream.below(11) as f32).collect();
        Tables {
            points: numbers(grid.courses() * grid.speeds()),
            courses: numbers(grid.courses()),
            speeds: numbers(grid.speeds()),
        }
    }

    /// The same tables with course `k` taken from `from(k)`.
    pub(crate) fn turned(&self, grid: &Grid, from: impl Fn(usize) -> usize) -> Tables {
        let rows = (0..grid.courses()).flat_map(|k| &self.points[from(k) * grid.speeds()..][..grid.speeds()]);
        Tables {
            points: rows.copied().collect(),
            courses: (0..grid.courses()).map(|k| self.courses[from(k)]).collect(),
            speeds: self.speeds.clone(),
        }
    }

    /// The same function, with its numbers from here.
    pub(crate) fn of<'a>(&'a self, objective: &Objective) -> Objective<'a> {
        match *objective {
            Objective::Course(peaks) => Objective::Course(peaks),
            Objective::Speed(peaks) => Objective::Speed(peaks),
            Objective::Coupled { course, speed, course_share } => Objective::Coupled { course, speed, course_share },
            Objective::Limit(limit) => Objective::Limit(limit),
            Objective::Closest(closest) => Objective::Closest(closest),
            Objective::Closing(closing) => Objective::Closing(closing),
            Objective::Table(_) => Objective::Table(&self.points),
            Objective::CourseTable(_) => Objective::CourseTable(&self.courses),
            Objective::SpeedTable(_) => Objective::SpeedTable(&self.speeds),
        }
    }
}

/// A small grid, of any shape.
pub(crate) fn grid(stream: &mut Stream) -> Grid {
    const COURSES: [usize; 8] = [4, 7, 12, 24, 30, 36, 72, 90];
    const SPEEDS: [usize; 5] = [2, 7, 8, 9, 21];
    let courses = COURSES[stream.below(COURSES.len() as u64) as usize];
    let speeds = SPEEDS[stream.below(SPEEDS.len() as u64) as usize];
    Grid::new(courses, speeds, stream.between(0.5, 12.0))
}

/// One to five functions with their weights.
pub(crate) fn functions<'a>(stream: &mut Stream, grid: &Grid, tables: &'a Tables) -> Vec<(f64, Objective<'a>)> {
    let count = 1 + stream.below(5);
    let weight = |stream: &mut Stream| match stream.below(8) {
        0 => 0.0,
        1 => 1000.0,
        2 | 3 => 100.0,
        _ => stream.between(0.01, 900.0),
    };
    (0..count).map(|_| (weight(stream), function(stream, grid, tables))).collect()
}

fn function<'a>(stream: &mut Stream, grid: &Grid, tables: &'a Tables) -> Objective<'a> {
    match stream.below(14) {
        0 => Objective::Course(course_peaks(stream)),
        1 => Objective::Speed(speed_peaks(stream, grid)),
        2 | 3 => Objective::Coupled {
            course: course_peaks(stream),
            speed: speed_peaks(stream, grid),
            course_share: [0.0, 0.3, 0.5, 1.0][stream.below(4) as usize],
        },
        4 => Objective::Limit(limit(stream, grid)),
        5..=8 => Objective::Closest(closest(stream, grid)),
        9 | 10 => Objective::Closing(closing(stream)),
        11 => Objective::Table(&tables.points),
        12 => Objective::CourseTable(&tables.courses),
        _ => Objective::SpeedTable(&tables.speeds),
    }
}

fn course_peaks(stream: &mut Stream) -> Peaks {
    let mut peak = |height: f64| Peak {
        summit: stream.between(-7.0, 7.0),
        peak_width: stream.between(0.0, 1.0),
        base_width: stream.between(0.0, 3.0),
        summit_delta: stream.between(0.0, 60.0),
        height,
    };
    let one = Peaks::one(peak(100.0));
    let peaks = [one, one.and(peak(60.0)), one.and(peak(50.0)).and(peak(20.0))][stream.below(3) as usize];
    peaks.combined([Combine::Max, Combine::Sum][stream.below(2) as usize])
}

fn speed_peaks(stream: &mut Stream, grid: &Grid) -> Peaks {
    let fastest = grid.speed_max_m_s();
    let mut peak = || Peak {
        summit: stream.between(-0.2, 1.2) * fastest,
        peak_width: stream.between(0.0, 0.5) * fastest,
        base_width: stream.between(0.0, 1.0) * fastest,
        summit_delta: stream.between(0.0, 60.0),
        height: 100.0,
    };
    let one = Peaks::one(peak());
    if stream.below(2) == 0 { one } else { one.and(Peak { height: 40.0, ..one.peaks()[0] }) }
}

fn limit(stream: &mut Stream, grid: &Grid) -> SpeedLimit {
    let mut speed = || stream.between(0.0, 1.1) * grid.speed_max_m_s();
    let (a, b, base) = (speed(), speed(), speed());
    match stream.below(4) {
        0 => SpeedLimit::at_most(a, base),
        1 => SpeedLimit::at_least(a, base),
        2 => SpeedLimit::at_most(a, 0.0),
        _ => SpeedLimit::between(a.min(b), a.max(b), base),
    }
}

pub(crate) fn closest(stream: &mut Stream, grid: &Grid) -> Closest {
    let range = [3.0, 60.0, 400.0, 5000.0][stream.below(4) as usize];
    let speed = [0.0, 1.0, 3.0][stream.below(3) as usize] * grid.speed_max_m_s();
    let mut within = |x: f64| stream.between(-x, x);
    let (north_m, east_m) = (within(range), within(range));
    let (velocity_north_m_s, velocity_east_m_s) = (within(speed), within(speed));
    let min_m = stream.between(0.0, 0.5) * range;
    Closest {
        north_m,
        east_m,
        velocity_north_m_s,
        velocity_east_m_s,
        horizon_s: [0.0, 15.0, 120.0][stream.below(3) as usize],
        min_m,
        max_m: min_m + [0.0, 0.3, 1.0][stream.below(3) as usize] * range,
        touch_m: 0.0,
        approach: [Approach::Avoid { at_min: 25.0 }, Approach::Avoid { at_min: 0.0 }, Approach::Seek]
            [stream.below(3) as usize],
        lag: (stream.below(2) == 0).then(|| lag(stream, grid)),
    }
}

fn lag(stream: &mut Stream, grid: &Grid) -> Lag {
    let (heading_east, heading_north) = game::math::sin_cos(stream.between(-4.0, 4.0));
    Lag {
        velocity_north_m_s: stream.between(-1.0, 1.0) * grid.speed_max_m_s(),
        velocity_east_m_s: stream.between(-1.0, 1.0) * grid.speed_max_m_s(),
        heading_north,
        heading_east,
        reaction_s: stream.between(0.0, 2.0),
        turn_rad_s: stream.between(0.1, 2.0),
    }
}

fn closing(stream: &mut Stream) -> Closing {
    let mut within = |x: f64| stream.between(-x, x);
    Closing {
        north_m: within(300.0),
        east_m: within(300.0),
        velocity_north_m_s: within(3.0),
        velocity_east_m_s: within(3.0),
        flee: stream.below(2) == 0,
    }
}

/// What the own ship is doing.
pub(crate) fn wish(stream: &mut Stream, grid: &Grid) -> Wish {
    Wish {
        course_rad: stream.between(-7.0, 7.0),
        speed_m_s: stream.between(-0.1, 1.1) * grid.speed_max_m_s(),
        keep: None,
    }
}

/// What the solver says.
pub(crate) fn solved(grid: &Grid, functions: &[(f64, Objective)], wish: Wish) -> Choice {
    let mut problem = Problem::new(grid.clone());
    for (weight, objective) in functions {
        problem.add(*weight, objective);
    }
    problem.solve(wish)
}

/// All points of the grid.
pub(crate) fn points(grid: &Grid) -> impl Iterator<Item = (usize, usize)> + use<> {
    let speeds = grid.speeds();
    (0..grid.courses()).flat_map(move |k| (0..speeds).map(move |j| (k, j)))
}

/// A point of the grid.
pub(crate) fn decision(k: usize, j: usize) -> Decision {
    Decision { course: k as u16, speed: j as u16 }
}
