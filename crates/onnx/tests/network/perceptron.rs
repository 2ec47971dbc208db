//! Perceptrons as files: those written can be read, and inconsistent ones are not written.

use crate::assert_close;
use onnx::{Head, Layer, Network, Perceptron};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::PathBuf;

fn between(random: &mut ChaCha8Rng, least: f32, most: f32) -> f32 {
    least + (most - least) * (random.next_u32() >> 8) as f32 / (1 << 24) as f32
}

fn layer(random: &mut ChaCha8Rng, inputs: usize, outputs: usize) -> Layer {
    let mut numbers = |count| (0..count).map(|_| between(random, -0.5, 0.5)).collect();
    Layer {
        inputs,
        outputs,
        weights: numbers(inputs * outputs),
        biases: numbers(outputs),
    }
}

fn perceptron() -> Perceptron {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let hidden = vec![layer(&mut random, 9, 20), layer(&mut random, 20, 13)];
    let heads = [("logits", 17), ("value", 1)];
    let heads = heads.map(|(name, outputs)| Head {
        name: name.to_owned(),
        layer: layer(&mut random, 13, outputs),
    });
    let metadata =
        [("layout", "1"), ("actions", "17")].map(|(key, value)| (key.to_owned(), value.to_owned()));
    Perceptron {
        hidden,
        heads: heads.to_vec(),
        bounded: false,
        metadata: BTreeMap::from(metadata),
    }
}

fn rows() -> Vec<Vec<f32>> {
    let mut random = ChaCha8Rng::seed_from_u64(6);
    (0..5)
        .map(|_| (0..9).map(|_| between(&mut random, -3.0, 3.0)).collect())
        .collect()
}

/// A layer in double precision, straight from its definition.
fn plain(layer: &Layer, input: &[f64]) -> Vec<f64> {
    let output = |j: usize| {
        let weights = &layer.weights[j * layer.inputs..(j + 1) * layer.inputs];
        f64::from(layer.biases[j])
            + weights
                .iter()
                .zip(input)
                .map(|(w, x)| f64::from(*w) * x)
                .sum::<f64>()
    };
    (0..layer.outputs).map(output).collect()
}

fn plain_outputs(policy: &Perceptron, row: &[f32]) -> Vec<Vec<f32>> {
    let mut last: Vec<f64> = row.iter().map(|x| f64::from(*x)).collect();
    for layer in &policy.hidden {
        last = plain(layer, &last).into_iter().map(libm::tanh).collect();
    }
    policy
        .heads
        .iter()
        .map(|head| {
            plain(&head.layer, &last)
                .into_iter()
                .map(|x| x as f32)
                .collect()
        })
        .collect()
}

#[test]
fn what_is_written_is_read_again_with_the_same_outputs() {
    let policy = perceptron();
    let mut network = Network::read(&policy.onnx().unwrap()).unwrap();
    assert_eq!(network.metadata(), &policy.metadata);
    assert_eq!(network.inputs()[0].name, "observation");
    for row in rows() {
        network.evaluate(&row);
        for (i, want) in plain_outputs(&policy, &row).iter().enumerate() {
            assert_eq!(network.outputs()[i].name, policy.heads[i].name);
            assert_close(network.output(i), want, &policy.heads[i].name);
        }
    }
}

/// Writes files for `crates/onnx/crosscheck/network_check.py`, which checks them with third-party
/// packages.
#[test]
fn the_same_perceptron_is_written_as_the_same_bytes() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("network");
    std::fs::create_dir_all(&folder).unwrap();
    let bytes = perceptron().onnx().unwrap();
    assert_eq!(bytes, perceptron().onnx().unwrap());
    let mut network = Network::read(&bytes).unwrap();
    let case = |row: Vec<f32>| {
        network.evaluate(&row);
        json!({ "input": row, "logits": network.output(0), "value": network.output(1) })
    };
    let cases: Vec<serde_json::Value> = rows().into_iter().map(case).collect();
    std::fs::write(folder.join("tanh.onnx"), bytes).unwrap();
    std::fs::write(
        folder.join("tanh.json"),
        serde_json::to_vec(&cases).unwrap(),
    )
    .unwrap();
}

#[test]
fn a_perceptron_without_hidden_layers_is_its_head() {
    let Perceptron { mut heads, .. } = perceptron();
    heads.truncate(1);
    let policy = Perceptron {
        hidden: vec![],
        heads,
        ..perceptron()
    };
    let mut network = Network::read(&policy.onnx().unwrap()).unwrap();
    network.evaluate(&[0.0; 13]);
    assert_eq!(network.output(0), policy.heads[0].layer.biases);
}

#[test]
fn what_follows_an_output_is_applied_to_it_alone() {
    let plain = perceptron();
    let mut network = Network::read(&plain.onnx().unwrap()).unwrap();
    let mut bounded = Network::read(
        &Perceptron {
            bounded: true,
            ..plain
        }
        .onnx()
        .unwrap(),
    )
    .unwrap();
    for row in rows() {
        network.evaluate(&row);
        bounded.evaluate(&row);
        for i in [0, 1] {
            let want: Vec<f32> = network.output(i).iter().copied().map(onnx::tanh).collect();
            assert_eq!(bounded.output(i), want);
        }
    }
}

#[test]
fn what_does_not_fit_together_is_not_written() {
    type Change = fn(&mut Perceptron);
    let cases: [(Change, &str); 6] = [
        (
            |p| _ = p.hidden[1].weights.pop(),
            "tensor `hidden.1.weight`: found 259 numbers, expected 260 for the shape 13 x 20",
        ),
        (
            |p| _ = p.hidden[0].biases.pop(),
            "tensor `hidden.0.bias`: found 19 numbers, expected 20",
        ),
        (
            |p| _ = p.hidden.remove(1),
            "node `head.0` (Gemm): found the shape 1 x 20 with 13 x 17 weights",
        ),
        (
            |p| p.heads.clear(),
            "the model: found no output, expected at least one",
        ),
        (
            |p| p.heads[1].name = "logits".to_owned(),
            "tensor `logits`: found a second definition",
        ),
        (
            |p| p.heads[0].layer.weights[3] = f32::NAN,
            "tensor `head.0.weight`: found NaN, expected numbers",
        ),
    ];
    for (change, want) in cases {
        let mut policy = perceptron();
        change(&mut policy);
        let error = policy.onnx().unwrap_err().to_string();
        assert!(error.contains(want), "{error:?}, expected {want:?}");
    }
}
