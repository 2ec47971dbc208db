//! The functions themselves, at points that were worked out by hand or by another way.

use agent::ivp::{Approach, Closest, Closing, Combine, Grid, Lag, Objective, Peak, Peaks, SpeedLimit};
use game::stream::Stream;

/// Single precision over some hundred metres, in points of utility.
const TOLERANCE: f64 = 0.01;

fn near(got: f32, want: f64, what: &str) {
    assert!((f64::from(got) - want).abs() < TOLERANCE, "{what}: {got}, not {want}");
}

#[test]
fn a_peak_falls_to_its_edge_and_then_to_nothing() {
    let grid = Grid::new(360, 36, 3.5);
    let deg = f64::to_radians;
    let peak =
        Peak { summit: deg(350.0), peak_width: deg(10.0), base_width: deg(170.0), summit_delta: 25.0, height: 100.0 };
    let course = Peaks::one(peak);
    for (k, want) in [(350, 100.0), (355, 87.5), (0, 75.0), (340, 75.0), (85, 37.5), (170, 0.0), (171, 75.0 / 170.0)] {
        near(course.of_course(&grid, k), want, &format!("course {k}"));
    }
    let two = course.and(Peak { height: 20.0, ..Peak::tent(deg(170.0), deg(40.0)) });
    for (k, want) in [(170, 20.0), (180, 15.0), (150, 10.0), (120, 75.0 * 50.0 / 170.0), (0, 75.0)] {
        near(two.of_course(&grid, k), want, &format!("the higher at {k}"));
    }
    let sum = two.combined(Combine::Sum);
    for (k, want) in [(170, 20.0), (180, 15.0 + 75.0 * 10.0 / 170.0), (350, 100.0)] {
        near(sum.of_course(&grid, k), want, &format!("both at {k}"));
    }
    let flat = Peaks::one(Peak::tent(0.0, deg(60.0))).and(Peak::tent(0.0, deg(120.0))).combined(Combine::Sum);
    near(flat.of_course(&grid, 10), 100.0, "no more than 100");
    let speed = Peaks::one(Peak { peak_width: 1.0, summit_delta: 20.0, ..Peak::tent(2.0, 0.5) });
    for (j, want) in [(20, 100.0), (25, 90.0), (30, 80.0), (32, 48.0), (35, 0.0), (5, 0.0), (10, 80.0)] {
        near(speed.of_speed(&grid, j), want, &format!("speed {j}"));
    }
}

#[test]
fn a_limit_is_flat_within_and_falls_outside() {
    let grid = Grid::new(4, 36, 3.5);
    let cases = [
        (SpeedLimit::at_most(1.0, 0.5), [(0, 100.0), (10, 100.0), (12, 60.0), (15, 0.0), (35, 0.0)]),
        (SpeedLimit::at_least(2.0, 1.0), [(0, 0.0), (10, 0.0), (15, 50.0), (20, 100.0), (35, 100.0)]),
        (SpeedLimit::between(1.0, 2.0, 1.0), [(0, 0.0), (5, 50.0), (10, 100.0), (20, 100.0), (25, 50.0)]),
        (SpeedLimit::at_most(1.0, 0.0), [(0, 100.0), (10, 100.0), (11, 0.0), (20, 0.0), (35, 0.0)]),
    ];
    for (limit, points) in cases {
        for (j, want) in points {
            near(limit.of_speed(&grid, j), want, &format!("{limit:?}, speed {j}"));
        }
    }
}

/// The distance at the closest point of approach, by looking at many times.
fn searched_m(closest: &Closest, grid: &Grid, k: usize, j: usize) -> f64 {
    const TIMES: usize = 40_000;
    let (sin, cos) = game::math::sin_cos(grid.course_rad(k));
    let speed_m_s = grid.speed_m_s(j);
    // From a place, with a velocity, for a time.
    let least = |(north_m, east_m): (f64, f64), (north_m_s, east_m_s): (f64, f64), time_s: f64| {
        let times = (0..=TIMES).map(|i| time_s * i as f64 / TIMES as f64);
        times.map(|t| game::math::length(north_m + north_m_s * t, east_m + east_m_s * t)).fold(f64::INFINITY, f64::min)
    };
    let (north_m, east_m) = (closest.north_m, closest.east_m);
    let decided = (closest.velocity_north_m_s - speed_m_s * cos, closest.velocity_east_m_s - speed_m_s * sin);
    let Some(lag) = closest.lag else { return least((north_m, east_m), decided, closest.horizon_s) };
    let present =
        (closest.velocity_north_m_s - lag.velocity_north_m_s, closest.velocity_east_m_s - lag.velocity_east_m_s);
    let chord = game::math::length(cos - lag.heading_north, sin - lag.heading_east);
    let lag_s = lag.reaction_s + 0.5 * 1.15 * chord / lag.turn_rad_s;
    let then = (north_m + present.0 * lag_s, east_m + present.1 * lag_s);
    least((north_m, east_m), present, lag_s).min(least(then, decided, closest.horizon_s))
}

#[test]
fn the_closest_point_of_approach_is_the_one_a_search_of_times_finds() {
    let grid = Grid::new(36, 8, 4.0);
    for seed in 0..40 {
        let mut stream = Stream::new(seed, "ivp/cpa");
        let mut within = |x: f64| stream.between(-x, x);
        let closest = Closest {
            north_m: within(120.0),
            east_m: within(120.0),
            velocity_north_m_s: within(3.0),
            velocity_east_m_s: within(3.0),
            horizon_s: 60.0,
            min_m: 10.0,
            max_m: 75.0,
            touch_m: 0.0,
            approach: Approach::Avoid { at_min: 25.0 },
            lag: (seed % 2 == 0).then(|| Lag {
                velocity_north_m_s: within(3.0),
                velocity_east_m_s: within(3.0),
                heading_north: 0.6,
                heading_east: -0.8,
                reaction_s: 1.5,
                turn_rad_s: 0.5,
            }),
        };
        let seek = Closest { approach: Approach::Seek, ..closest };
        for (k, j) in (0..36).flat_map(|k| [(k, 0), (k, 3), (k, 7)]) {
            let distance_m = searched_m(&closest, &grid, k, j);
            let part = ((distance_m - 10.0) / 65.0).clamp(0.0, 1.0);
            let what = format!("seed {seed}, course {k}, speed {j}, {distance_m} m");
            let avoid = if distance_m > 10.0 { 25.0 + 75.0 * part } else { 2.5 * distance_m };
            near(Objective::Closest(closest).utility(&grid, k, j), avoid, &what);
            near(Objective::Closest(seek).utility(&grid, k, j), 100.0 - 100.0 * part, &what);
        }
    }
}

#[test]
fn closing_in_is_worth_100_at_most_and_drawing_away_nothing() {
    let grid = Grid::new(36, 5, 4.0);
    let ahead = Closing { north_m: 50.0, east_m: 0.0, velocity_north_m_s: 0.0, velocity_east_m_s: 0.0, flee: false };
    let moving = Closing { velocity_north_m_s: -1.0, ..ahead };
    let here = Closing { north_m: 0.0, ..ahead };
    let cases = [
        (ahead, 0, 4, 100.0),
        (ahead, 0, 2, 75.0),
        (ahead, 9, 4, 50.0),
        (ahead, 18, 4, 0.0),
        (ahead, 5, 0, 50.0),
        (Closing { flee: true, ..ahead }, 0, 4, 0.0),
        (Closing { flee: true, ..ahead }, 18, 2, 75.0),
        (moving, 0, 4, 100.0),
        (moving, 18, 4, 50.0 - 50.0 * 3.0 / 5.0),
        (here, 0, 4, 50.0),
    ];
    for (closing, k, j, want) in cases {
        near(Objective::Closing(closing).utility(&grid, k, j), want, &format!("{closing:?} at {k}, {j}"));
    }
}

#[test]
fn numbers_outside_of_a_grid_find_their_nearest_point() {
    let grid = Grid::new(360, 36, 3.5);
    let deg = f64::to_radians;
    for (course_deg, want) in [(0.0, 0), (359.6, 0), (-1.0, 359), (725.4, 5), (f64::NAN, 0), (179.6, 180)] {
        assert_eq!(grid.nearest_course(deg(course_deg)), want, "{course_deg} deg");
    }
    for (speed_m_s, want) in [(-1.0, 0), (0.04, 0), (0.06, 1), (9.0, 35), (f64::NAN, 0), (f64::INFINITY, 35)] {
        assert_eq!(grid.nearest_speed(speed_m_s), want, "{speed_m_s} m/s");
    }
}
