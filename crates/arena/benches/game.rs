//! Whole games in one process, minds and referee included: ticks per second.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::path::Path;

fn game(c: &mut Criterion) {
    let mut group = c.benchmark_group("game");
    for name in ["pav01_vs_pav01", "swarm_20v20"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join(format!("../../scenarios/games/{name}.toml"));
        let scenario = scenario::load(&path).unwrap_or_else(|e| panic!("{e}"));
        let play = || {
            arena::play(&scenario, agent::minds_of(&scenario), 1).unwrap_or_else(|e| panic!("{e}"))
        };
        group
            .throughput(Throughput::Elements(play().ticks))
            .sample_size(10);
        group.bench_function(name, |b| b.iter(play));
    }
    group.finish();
}

criterion_group!(benches, game);
criterion_main!(benches);
