//! The cost of one row for a policy of typical size.

use criterion::{Criterion, criterion_group, criterion_main};
use onnx::{Head, Layer, Network, Perceptron};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::collections::BTreeMap;
use std::hint::black_box;

const INPUTS: usize = 45;
const ACTIONS: usize = 17;
/// Rows evaluated in turn, so that the branch predictor cannot learn them.
const ROWS: usize = 64;

fn between(random: &mut ChaCha8Rng, least: f32, most: f32) -> f32 {
    least + (most - least) * (random.next_u32() >> 8) as f32 / (1 << 24) as f32
}

fn layer(random: &mut ChaCha8Rng, inputs: usize, outputs: usize) -> Layer {
    // The sums are about one, where activations are neither saturated nor linear.
    let most = (3.0 / inputs as f32).sqrt();
    let weights = (0..inputs * outputs)
        .map(|_| between(random, -most, most))
        .collect();
    Layer {
        inputs,
        outputs,
        weights,
        biases: vec![0.1; outputs],
    }
}

fn network(random: &mut ChaCha8Rng, width: usize) -> Network {
    let hidden = vec![layer(random, INPUTS, width), layer(random, width, width)];
    let heads = vec![Head {
        name: "logits".to_owned(),
        layer: layer(random, width, ACTIONS),
    }];
    let policy = Perceptron {
        hidden,
        heads,
        bounded: false,
        metadata: BTreeMap::new(),
    };
    Network::read(&policy.onnx().expect("the sizes match")).expect("a valid network")
}

fn evaluate(criterion: &mut Criterion) {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let rows: Vec<[f32; INPUTS]> = (0..ROWS)
        .map(|_| std::array::from_fn(|_| between(&mut random, -1.7, 1.7)))
        .collect();
    let mut group = criterion.benchmark_group("network 45-n-n-17");
    for width in [128, 256] {
        let mut network = network(&mut random, width);
        let mut next = 0;
        group.bench_function(format!("n = {width}"), |bencher| {
            bencher.iter(|| {
                next += 1;
                network.evaluate(black_box(&rows[next % ROWS]));
                black_box(network.output(0)[0])
            });
        });
    }
    group.finish();
}

criterion_group!(benches, evaluate);
criterion_main!(benches);
