//! The functions themselves, at points computed by hand or by a different method.

use crate::scene::within;
use agent::ivp::{Approach, Closest, Closing, Grid, Lag, Objective, Peak, Side};
use primitives::Ned;
use primitives::stream::Stream;

/// Single-precision error over a few hundred metres, in points of utility.
const TOLERANCE: f64 = 0.01;

fn near(got: f32, want: f64, what: &str) {
    assert!(
        (f64::from(got) - want).abs() < TOLERANCE,
        "{what}: {got}, want {want}"
    );
}

#[test]
fn a_peak_falls_to_its_edge_and_then_to_nothing() {
    let grid = Grid::new(360, 36, 3.5);
    let deg = f64::to_radians;
    let peak = Peak {
        summit: deg(350.0),
        peak_width: deg(10.0),
        base_width: deg(170.0),
        summit_delta: 25.0,
        height: 100.0,
    };
    for (k, want) in [
        (350, 100.0),
        (355, 87.5),
        (0, 75.0),
        (340, 75.0),
        (85, 37.5),
        (170, 0.0),
        (171, 75.0 / 170.0),
    ] {
        near(
            Objective::course(peak).utility(&grid, k, 0),
            want,
            &format!("course {k}"),
        );
    }
    let low = Peak {
        height: 20.0,
        ..Peak::tent(deg(170.0), deg(40.0))
    };
    for (k, want) in [(170, 20.0), (180, 15.0), (150, 10.0), (120, 0.0), (0, 0.0)] {
        near(
            Objective::course(low).utility(&grid, k, 0),
            want,
            &format!("the low peak at {k}"),
        );
    }
    let speed = Peak {
        peak_width: 1.0,
        summit_delta: 20.0,
        ..Peak::tent(2.0, 0.5)
    };
    for (j, want) in [
        (20, 100.0),
        (25, 90.0),
        (30, 80.0),
        (32, 48.0),
        (35, 0.0),
        (5, 0.0),
        (10, 80.0),
    ] {
        near(
            Objective::speed(speed).utility(&grid, 0, j),
            want,
            &format!("speed {j}"),
        );
    }
    // A limit at 1 m/s: half of a peak at zero speed, with and without a tolerance.
    for (base_m_s, points) in [
        (
            0.5,
            [(0, 100.0), (10, 100.0), (12, 60.0), (15, 0.0), (35, 0.0)],
        ),
        (
            0.0,
            [(0, 100.0), (10, 100.0), (11, 0.0), (20, 0.0), (35, 0.0)],
        ),
    ] {
        let limit = Peak {
            peak_width: 1.0,
            ..Peak::tent(0.0, base_m_s)
        };
        for (j, want) in points {
            near(
                Objective::speed(limit).utility(&grid, 0, j),
                want,
                &format!("{limit:?}, speed {j}"),
            );
        }
    }
}

/// The distance at the closest point of approach, by sampling many times.
fn searched_m(closest: &Closest, grid: &Grid, k: usize, j: usize) -> f64 {
    const TIMES: usize = 40_000;
    let (sin, cos) = primitives::math::sin_cos(grid.course_rad(k));
    let course = Ned {
        north: cos,
        east: sin,
    };
    // The closest distance from a position, with a velocity, for a duration.
    let least = |from: Ned, velocity: Ned, time_s: f64| {
        let times = (0..=TIMES).map(|i| time_s * i as f64 / TIMES as f64);
        times
            .map(|t| (from + velocity.scaled(t)).length())
            .fold(f64::INFINITY, f64::min)
    };
    let speed_m_s = grid.speed_m_s(j);
    let straight = |speed_m_s: f64| closest.velocity - course.scaled(speed_m_s);
    let Some(lag) = closest.lag else {
        return least(closest.offset, straight(speed_m_s), closest.horizon_s);
    };
    let present = closest.velocity - lag.velocity;
    let start = closest.offset + present.scaled(lag.reaction_s);
    let ahead_m_s = lag.velocity.dot(lag.heading).max(0.0);
    let x = 0.5 * (course - lag.heading).length();
    let x2 = x * x;
    let x4 = x * x * x * x;
    let angle_rad = 2.0 * x * (1.0 + x2 / 6.0 + 0.36 * x4 * x4);
    let turn_s = angle_rad / lag.turn_rad_s;
    let middle = course + lag.heading;
    let chord_m = ahead_m_s / lag.turn_rad_s * 2.0 * x;
    let then = start + closest.velocity.scaled(turn_s)
        - middle.scaled(chord_m / middle.length().max(1e-3));
    // The mean speed until the boats would meet at constant velocities.
    let rate_m2_s = present.dot(present);
    let meeting_s = (-closest.offset.dot(present) / rate_m2_s)
        .clamp(0.0, closest.horizon_s)
        .max(1.0);
    let change_m_s2 = if speed_m_s > ahead_m_s {
        lag.acceleration_m_s2
    } else {
        lag.deceleration_m_s2
    };
    let change_s = (speed_m_s - ahead_m_s).abs() / change_m_s2;
    let mean_m_s = if change_s < meeting_s {
        speed_m_s - 0.5 * (speed_m_s - ahead_m_s) * change_s / meeting_s
    } else {
        ahead_m_s + 0.5 * change_m_s2 * meeting_s * (speed_m_s - ahead_m_s).signum()
    };
    least(closest.offset, present, lag.reaction_s)
        .min(least(
            start,
            (then - start).scaled(1.0 / turn_s.max(1e-9)),
            turn_s,
        ))
        .min(least(then, straight(mean_m_s), closest.horizon_s))
}

#[test]
fn the_closest_point_of_approach_is_the_one_a_search_of_times_finds() {
    let grid = Grid::new(36, 8, 4.0);
    for seed in 0..40 {
        let mut stream = Stream::new(seed, "ivp/cpa");
        let closest = Closest {
            offset: within(&mut stream, 120.0),
            velocity: within(&mut stream, 3.0),
            horizon_s: 60.0,
            min_m: 10.0,
            max_m: 75.0,
            touch_m: 0.0,
            approach: Approach::Avoid {
                at_min: 25.0,
                leave_to: None,
            },
            lag: (seed % 2 == 0).then(|| Lag {
                velocity: within(&mut stream, 3.0),
                heading: Ned {
                    north: 0.6,
                    east: -0.8,
                },
                reaction_s: 1.5,
                turn_rad_s: 0.5,
                acceleration_m_s2: 0.4,
                deceleration_m_s2: 0.2,
            }),
        };
        let seek = Closest {
            approach: Approach::Seek,
            ..closest
        };
        for (k, j) in (0..36).flat_map(|k| [(k, 0), (k, 3), (k, 7)]) {
            let distance_m = searched_m(&closest, &grid, k, j);
            let part = ((distance_m - 10.0) / 65.0).clamp(0.0, 1.0);
            let what = format!("seed {seed}, course {k}, speed {j}, {distance_m} m");
            let avoid = if distance_m > 10.0 {
                25.0 + 75.0 * part
            } else {
                2.5 * distance_m
            };
            near(
                Objective::Closest(closest).utility(&grid, k, j),
                avoid,
                &what,
            );
            near(
                Objective::Closest(seek).utility(&grid, k, j),
                100.0 - 100.0 * part,
                &what,
            );
        }
    }
}

#[test]
fn a_contact_on_the_other_side_counts_a_fifth() {
    let grid = Grid::new(36, 8, 4.0);
    let closest = |north_m: f64, leave_to| {
        Objective::Closest(Closest {
            offset: Ned {
                north: north_m,
                east: 0.0,
            },
            velocity: Ned::default(),
            horizon_s: 60.0,
            min_m: 0.0,
            max_m: 100.0,
            touch_m: 0.0,
            approach: Approach::Avoid {
                at_min: 0.0,
                leave_to,
            },
            lag: None,
        })
    };
    // The contact is 40 m ahead: a course 20 degrees to starboard leaves it to port.
    let passes_m = 40.0 * primitives::math::sin_cos(20_f64.to_radians()).0;
    for (course, to_port, to_starboard) in [
        (2, passes_m, 0.2 * passes_m),
        (34, 0.2 * passes_m, passes_m),
    ] {
        let utility = |leave_to| closest(40.0, leave_to).utility(&grid, course, 7);
        near(utility(None), passes_m, &format!("course {course}, either"));
        near(
            utility(Some(Side::Port)),
            to_port,
            &format!("course {course}, to port"),
        );
        near(
            utility(Some(Side::Starboard)),
            to_starboard,
            &format!("course {course}, to starboard"),
        );
    }
}

#[test]
fn closing_in_is_worth_100_at_most_and_drawing_away_nothing() {
    let grid = Grid::new(36, 5, 4.0);
    let ahead = Closing {
        offset: Ned {
            north: 50.0,
            east: 0.0,
        },
        velocity: Ned::default(),
    };
    let moving = Closing {
        velocity: Ned {
            north: -1.0,
            east: 0.0,
        },
        ..ahead
    };
    let here = Closing {
        offset: Ned::default(),
        ..ahead
    };
    let cases = [
        (ahead, 0, 4, 100.0),
        (ahead, 0, 2, 75.0),
        (ahead, 9, 4, 50.0),
        (ahead, 18, 4, 0.0),
        (ahead, 5, 0, 50.0),
        (moving, 0, 4, 100.0),
        (moving, 18, 4, 50.0 - 50.0 * 3.0 / 5.0),
        (here, 0, 4, 50.0),
    ];
    for (closing, k, j, want) in cases {
        near(
            Objective::Closing(closing).utility(&grid, k, j),
            want,
            &format!("{closing:?} at {k}, {j}"),
        );
    }
}
