//! Trained policies (ONNX): a file is rejected, or its network responds to any input, always in the
//! same way.

use super::{Target, check_shown, mutations};
use onnx::{Head, Layer, Network, Perceptron};
use scenario::action::ActionSpace;
use scenario::observation::ObservationSpace;
use scenario::policy::{PartialSpec, PolicyModel, PolicySpec};
use std::collections::BTreeMap;
use std::path::Path;

/// This target tests limits on weights and computed numbers, not on the file's length.
pub(super) const TARGET: Target = Target {
    name: "model",
    seeds,
    change: mutations,
    check,
    allocated_max: (256 << 20, 1000),
};

/// A strategy's declaration of a model without metadata.
const SAID: PartialSpec = PartialSpec {
    observation: Some(ObservationSpace::Pyquaticus),
    action: Some(ActionSpace::Pyquaticus),
    period_s: Some(0.1),
};

/// Inputs of a network: zero, and values of a faulty sensor.
const GIVEN: [f32; 4] = [0.0, -1.0, f32::MAX, f32::NAN];

fn seeds() -> Vec<Vec<u8>> {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("../onnx/tests/network");
    let names = [
        "old_operators",
        "operators",
        "sb3_dynamo",
        "sb3_torchscript",
        "two_inputs",
    ];
    let read = |name: &str| {
        let file = tests.join(name).with_extension("onnx");
        std::fs::read(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()))
    };
    names.into_iter().map(read).chain([own()]).collect()
}

/// A model as written by a training run.
fn own() -> Vec<u8> {
    let spec = PolicySpec {
        observation: ObservationSpace::Squall {
            mates: 0,
            enemies: 1,
            frames: 1,
        },
        action: ActionSpace::Pyquaticus,
        period_s: 0.5,
    };
    let layer = |inputs: usize, outputs: usize| Layer {
        inputs,
        outputs,
        weights: (0..inputs * outputs)
            .map(|i| (i % 7) as f32 / 7.0 - 0.5)
            .collect(),
        biases: vec![0.1; outputs],
    };
    let network = Perceptron {
        hidden: vec![layer(spec.observation.size(0, 1), 4)],
        heads: vec![Head {
            name: "logits".to_owned(),
            layer: layer(4, spec.action.outputs()),
        }],
        bounded: false,
        metadata: BTreeMap::from(spec.metadata()),
    };
    network.onnx().expect("the sizes match")
}

fn check(bytes: &[u8]) {
    for said in [PartialSpec::default(), SAID] {
        match PolicyModel::read("in.onnx", bytes, said) {
            Ok(model) => {
                let PolicySpec {
                    observation,
                    action,
                    period_s,
                } = model.spec;
                assert!(said.observation.is_none_or(|given| given == observation));
                assert!(said.action.is_none_or(|given| given == action));
                assert!(said.period_s.is_none_or(|given| given == period_s));
                assert_eq!(model.input_size(), model.network().input_size());
                let mut network = model.network();
                network.evaluate(&vec![0.0; model.input_size()]);
                assert_eq!(
                    network.output(model.output()).len(),
                    model.spec.action.outputs()
                );
            }
            Err(error) => check_shown(&error),
        }
    }
    let mut network = match Network::read(bytes) {
        Ok(network) => network,
        Err(error) => return check_shown(&error),
    };
    for given in GIVEN {
        let input = vec![given; network.input_size()];
        let mut once = || -> Vec<u32> {
            network.evaluate(&input);
            let outputs = 0..network.outputs().len();
            outputs
                .flat_map(|i| network.output(i).iter().map(|number| number.to_bits()))
                .collect()
        };
        assert_eq!(once(), once(), "the same input gave another output");
    }
}
