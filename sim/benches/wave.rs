//! The cost of the waves at one boat, by number of components: forces in the horizontal plane,
//! attitude, and surface alone. The first two are also measured by instruction set.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use primitives::frame::{Ned, Pose};
use primitives::instructions::Instructions;
use scenario::sea::{Spreading, Waves};
use sim::sea::{HullWaves, WaveField, WaveResponse};
use std::hint::black_box;
use std::path::Path;

fn waves(components: u32) -> Waves {
    let spreading = Spreading::CosineSquared;
    Waves {
        hs_m: 0.5,
        tp_s: 3.0,
        gamma: 3.3,
        from_rad: 0.6,
        spreading,
        components,
        drift_factor: 1.0,
    }
}

/// Poses all over a field, on all headings, as in a large fleet.
fn poses() -> Vec<Pose> {
    let pose = |i: u32| Pose {
        at: Ned {
            north: f64::from(i * 37 % 160),
            east: f64::from(i * 53 % 80),
        },
        psi_rad: f64::from(i) * 1.7 - 300.0,
    };
    (0..256).map(pose).collect()
}

fn one_boat(c: &mut Criterion) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/games/pav01_vs_pav01.toml");
    let scenario = scenario::load(&path).unwrap_or_else(|e| panic!("{e}"));
    let boat = &scenario.boats[0];
    let poses = poses();
    let mut group = c.benchmark_group("wave");
    for components in [16, 64, 256] {
        let field = WaveField::new(&waves(components), None, 1);
        let hull = HullWaves::new(&field, boat, 1000.0);
        let response = WaveResponse::new(&field, boat);
        let velocity_m_s = Ned {
            north: 1.0,
            east: 0.5,
        };
        let mut i = 0;
        let mut next = || {
            i = (i + 1) % poses.len();
            (black_box(poses[i]), black_box(3000.0 + 0.05 * i as f64))
        };
        group.bench_function(BenchmarkId::new("hull", components), |b| {
            b.iter(|| {
                let (pose, time_s) = next();
                hull.at(pose, time_s)
            });
        });
        group.bench_function(BenchmarkId::new("response", components), |b| {
            b.iter(|| {
                let (pose, time_s) = next();
                response.at(pose, velocity_m_s, 0.1, time_s)
            });
        });
        group.bench_function(BenchmarkId::new("surface", components), |b| {
            b.iter(|| {
                let (pose, time_s) = next();
                field.surface(pose.at, time_s)
            });
        });
    }
    for set in Instructions::of_this_machine() {
        let field = WaveField::new(&waves(64), None, 1).with_instructions(set);
        let hull = HullWaves::new(&field, boat, 1000.0);
        let response = WaveResponse::new(&field, boat);
        let mut i = 0;
        group.bench_function(
            BenchmarkId::new("hull_and_response_64", format!("{set:?}")),
            |b| {
                b.iter(|| {
                    i = (i + 1) % poses.len();
                    let pose = black_box(poses[i]);
                    let time_s = black_box(3000.0 + 0.05 * i as f64);
                    (
                        hull.at(pose, time_s),
                        response.at(
                            pose,
                            Ned {
                                north: 1.0,
                                east: 0.5,
                            },
                            0.1,
                            time_s,
                        ),
                    )
                });
            },
        );
    }
    group.bench_function("start_64", |b| {
        b.iter(|| {
            HullWaves::new(
                &WaveField::new(black_box(&waves(64)), None, 1),
                boat,
                1000.0,
            )
        });
    });
    group.finish();
}

criterion_group!(benches, one_boat);
criterion_main!(benches);
