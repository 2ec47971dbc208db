//! The cost of a helm decision, including its functions.

use agent::ivp::{Approach, Closest, Grid, Objective, Peak, Preference, Problem};
use criterion::{Criterion, criterion_group, criterion_main};
use primitives::Ned;
use primitives::stream::Stream;
use std::f64::consts::{PI, TAU};
use std::hint::black_box;

/// Number of different decisions, evaluated in turn so that branch predictors and caches cannot
/// learn them.
const SCENES: usize = 64;

/// A waypoint, and contacts within 80 m, as in real helm decisions.
fn scenes(contacts: usize) -> Vec<(Vec<(f64, Objective<'static>)>, Preference)> {
    let mut stream = Stream::new(1, "bench/ivp");
    let scene = |_| {
        let bearing_rad = stream.between(0.0, TAU);
        let course_rad = stream.between(0.0, TAU);
        let waypoint = Objective::Coupled {
            course: Peak::tent(bearing_rad, PI),
            speed: Peak {
                peak_width: 1.25,
                summit_delta: 20.0,
                ..Peak::tent(2.5, 1.6)
            },
            course_share: 0.5,
        };
        let mut functions = vec![(100.0, waypoint)];
        for _ in 0..contacts {
            let mut within = |most: f64| Ned {
                north: stream.between(-most, most),
                east: stream.between(-most, most),
            };
            let closest = Closest {
                offset: within(80.0),
                velocity: within(2.0),
                horizon_s: 120.0,
                min_m: 10.0,
                max_m: 75.0,
                touch_m: 0.0,
                approach: Approach::Avoid {
                    at_min: 25.0,
                    leave_to: None,
                },
                lag: None,
            };
            functions.push((300.0, Objective::Closest(closest)));
        }
        (
            functions,
            Preference {
                course_rad,
                speed_m_s: 2.0,
            },
        )
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
                functions
                    .iter()
                    .for_each(|(weight, objective)| problem.add(*weight, objective));
                problem.solve(*preference)
            });
        });
    }
    group.finish();
}

criterion_group!(benches, decide);
criterion_main!(benches);
