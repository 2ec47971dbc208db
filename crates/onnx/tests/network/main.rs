//! Networks compared with ONNX Runtime, and modified files.
//!
//! `models.py` in this folder creates the models and the numbers.

mod change;
mod perceptron;

use onnx::Network;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Absolute and relative tolerance against ONNX Runtime, whose sums are in a different order.
const ERROR_MAX: f32 = 1e-5;

const MODELS: [&str; 9] = [
    "operators",
    "old_operators",
    "two_inputs",
    "sb3_torchscript",
    "sb3_dynamo",
    "activations",
    "normalisations",
    "wide_numbers",
    "sb3_full",
];

#[derive(Deserialize)]
struct Case {
    input: Vec<f32>,
    outputs: BTreeMap<String, Vec<f32>>,
}

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/network")
}

fn file(model: &str) -> Vec<u8> {
    std::fs::read(folder().join(format!("{model}.onnx"))).expect("the model can be read")
}

fn cases(model: &str) -> Vec<Case> {
    let text = std::fs::read(folder().join(format!("{model}.json")))
        .expect("the expected values can be read");
    serde_json::from_slice(&text).expect("the expected values are valid")
}

/// The numbers of all outputs.
fn numbers(network: &Network) -> Vec<f32> {
    (0..network.outputs().len())
        .flat_map(|i| network.output(i).to_vec())
        .collect()
}

fn is_finite(network: &Network) -> bool {
    numbers(network).iter().all(|number| number.is_finite())
}

#[track_caller]
fn assert_close(got: &[f32], want: &[f32], of: &str) {
    assert_eq!(got.len(), want.len(), "numbers of {of}");
    for (i, (got, want)) in got.iter().zip(want).enumerate() {
        assert!(
            (got - want).abs() <= ERROR_MAX * (1.0 + want.abs()),
            "{of}, number {i}: got {got}, want {want}"
        );
    }
}

#[test]
fn every_output_is_that_of_onnx_runtime() {
    for model in MODELS {
        let mut network =
            Network::read(&file(model)).unwrap_or_else(|error| panic!("{model}: {error}"));
        let cases = cases(model);
        assert!(!cases.is_empty(), "{model}");
        for (i, case) in cases.iter().enumerate() {
            network.evaluate(&case.input);
            assert!(is_finite(&network));
            assert_eq!(
                network.outputs().len(),
                case.outputs.len(),
                "outputs of {model}"
            );
            for (j, port) in network.outputs().iter().enumerate() {
                let want = case
                    .outputs
                    .get(&port.name)
                    .unwrap_or_else(|| panic!("{model} has {}", port.name));
                assert_close(
                    network.output(j),
                    want,
                    &format!("{model}, row {i}, {}", port.name),
                );
            }
        }
    }
}

#[test]
fn a_network_says_what_it_takes_and_gives_and_what_its_file_says() {
    let network = Network::read(&file("two_inputs")).unwrap();
    let sizes = |ports: &[onnx::Port]| -> Vec<(String, usize)> {
        ports
            .iter()
            .map(|port| (port.name.clone(), port.size))
            .collect()
    };
    assert_eq!(
        sizes(network.inputs()),
        [("own".to_owned(), 5), ("boats".to_owned(), 12)]
    );
    assert_eq!(
        sizes(network.outputs()),
        [("logits".to_owned(), 7), ("value".to_owned(), 1)]
    );
    assert_eq!(network.input_size(), 17);
    let metadata: Vec<(&str, &str)> = network
        .metadata()
        .iter()
        .map(|(k, v)| (k.as_str(), v.as_str()))
        .collect();
    assert_eq!(metadata, [("layout", "test"), ("made by", "models.py")]);
    assert_eq!(
        network.digest(),
        xxhash_rust::xxh3::xxh3_128(&file("two_inputs"))
    );
}

/// The bits of each model's outputs are the same on every machine and with every compiler.
#[test]
fn a_network_gives_the_same_bits_everywhere() {
    let mut digests = vec![];
    for model in MODELS {
        let mut network = Network::read(&file(model)).unwrap();
        let mut bytes = vec![];
        for case in cases(model) {
            network.evaluate(&case.input);
            bytes.extend(numbers(&network).into_iter().flat_map(f32::to_le_bytes));
        }
        digests.push(format!(
            "{model} {:016x}",
            xxhash_rust::xxh3::xxh3_64(&bytes)
        ));
    }
    assert_eq!(digests.join("\n"), include_str!("digests.txt").trim_end());
}

#[test]
fn an_evaluation_depends_on_its_row_alone() {
    for model in MODELS {
        let cases = cases(model);
        let mut network = Network::read(&file(model)).unwrap();
        let fresh = network.clone();
        let bits = |network: &Network| {
            numbers(network)
                .into_iter()
                .map(f32::to_bits)
                .collect::<Vec<u32>>()
        };
        for case in &cases {
            network.evaluate(&case.input);
            // Evaluate on another thread, as during training.
            let mut other = fresh.clone();
            let input = case.input.clone();
            let thread = std::thread::spawn(move || {
                other.evaluate(&input);
                other
            });
            assert_eq!(bits(&network), bits(&thread.join().unwrap()), "{model}");
        }
    }
}

#[test]
fn a_number_that_is_not_finite_comes_out_as_such() {
    let mut network = Network::read(&file("sb3_dynamo")).unwrap();
    let mut input = vec![0.0; network.input_size()];
    network.evaluate(&input);
    assert!(is_finite(&network));
    input[3] = f32::NAN;
    network.evaluate(&input);
    assert!(!is_finite(&network));
    input[3] = 0.0;
    network.evaluate(&input);
    assert!(is_finite(&network));
}

#[test]
#[should_panic(expected = "length of the network's input")]
fn a_row_of_another_size_is_a_mistake() {
    Network::read(&file("sb3_dynamo"))
        .unwrap()
        .evaluate(&[0.0; 44]);
}
