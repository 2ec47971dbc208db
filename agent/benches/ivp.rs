//! The cost of a helm decision, including its functions, compared with evaluating every point.

use agent::ivp::{Approach, Closest, Grid, Objective, Peak, Preference, Problem};
use criterion::{Criterion, criterion_group, criterion_main};
use primitives::Ned;
use primitives::stream::Stream;
use std::f64::consts::{PI, TAU};
use std::hint::black_box;

/// Decisions evaluated in turn, so that branch predictors and caches cannot learn them.
const SCENES: usize = 64;

/// A waypoint, and contacts within 80 m, as in real helm decisions.
fn scenes(contacts: usize) -> Vec<(Vec<(f64, Objective<'static>)>, Preference)> {
    let mut stream = Stream::new(1, "bench/ivp");
    let scene = |_| {
        let (bearing_rad, course_rad) = (stream.between(0.0, TAU), stream.between(0.0, TAU));
        let waypoint = Objective::Coupled {
            course: Peak::tent(bearing_rad, PI),
            speed: Peak { peak_width: 1.25, summit_delta: 20.0, ..Peak::tent(2.5, 1.6) },
            course_share: 0.5,
        };
        let mut functions = vec![(100.0, waypoint)];
        for _ in 0..contacts {
            let mut within = |most: f64| Ned { north: stream.between(-most, most), east: stream.between(-most, most) };
            let closest = Closest {
                offset: within(80.0),
                velocity: within(2.0),
                horizon_s: 120.0,
                min_m: 10.0,
                max_m: 75.0,
                touch_m: 0.0,
                approach: Approach::Avoid { at_min: 25.0, leave_to: None },
                lag: None,
            };
            functions.push((300.0, Objective::Closest(closest)));
        }
        (functions, Preference { course_rad, speed_m_s: 2.0 })
    };
    (0..SCENES).map(scene).collect()
}

fn decide(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("ivp 360x36");
    for contacts in [0, 1, 3] {
        let scenes = scenes(contacts);
        let mut problem = Problem::new(Grid::new(360, 36, 3.5));
        let mut next = 0;
        group.bench_function(format!("functions {}", contacts + 1), |bencher| {
            bencher.iter(|| {
                let (functions, preference) = black_box(&scenes[next % SCENES]);
                next += 1;
                problem.clear();
                functions.iter().for_each(|(weight, objective)| problem.add(*weight, objective));
                problem.solve(*preference)
            });
        });
    }
    group.finish();
}

/// The naive baseline: the closed form at every point of the grid, in double precision and without
/// bounds. The waypoint's two lists are built once, as in the solver.
fn every_point(criterion: &mut Criterion) {
    let grid = Grid::new(360, 36, 3.5);
    let scenes = scenes(3);
    let mut next = 0;
    criterion.bench_function("ivp 360x36/functions 4, every point", |bencher| {
        bencher.iter(|| {
            let (functions, _) = black_box(&scenes[next % SCENES]);
            next += 1;
            best_of_all(&grid, functions)
        });
    });
}

fn best_of_all(grid: &Grid, functions: &[(f64, Objective)]) -> (f64, usize, usize) {
    let Objective::Coupled { course, speed, course_share } = functions[0].1 else {
        panic!("expected a waypoint first")
    };
    let speeds: Vec<f64> = (0..grid.speeds()).map(|j| f64::from(speed.of_speed(grid, j))).collect();
    let mut best = (f64::NEG_INFINITY, 0, 0);
    for k in 0..grid.courses() {
        let (north, east) = grid.direction(k);
        let of_course = f64::from(course.of_course(grid, k));
        for (j, of_speed) in speeds.iter().enumerate() {
            let own = Ned { north: north.into(), east: east.into() }.scaled(grid.speed_m_s(j));
            let waypoint = functions[0].0 * (of_course * course_share + of_speed * (1.0 - course_share));
            let contacts: f64 = functions[1..].iter().map(|(weight, f)| weight * plain(f, own)).sum();
            if waypoint + contacts > best.0 {
                best = (waypoint + contacts, k, j);
            }
        }
    }
    best
}

/// Utility of the distance at the closest point of approach.
fn plain(objective: &Objective, own: Ned) -> f64 {
    let Objective::Closest(c) = objective else { return 0.0 };
    let w = c.velocity - own;
    let t = (-c.offset.dot(w) / w.dot(w).max(1e-20)).clamp(0.0, c.horizon_s);
    let distance_m = (c.offset + w.scaled(t)).length();
    let rise = 75.0 * (distance_m - c.min_m) / (c.max_m - c.min_m);
    if distance_m > c.min_m { (25.0 + rise).min(100.0) } else { 0.0 }
}

criterion_group!(benches, decide, every_point);
criterion_main!(benches);
