//! Models of policies: their metadata counts, and must not contradict other specifications.

use onnx::{Head, Layer, Perceptron};
use scenario::action::ActionSpace;
use scenario::observation::ObservationSpace;
use scenario::policy::{PartialSpec, PolicyModel, PolicySpec};
use std::collections::BTreeMap;
use std::path::Path;

const SPEC: PolicySpec = PolicySpec {
    observation: ObservationSpace::Squall {
        mates: 1,
        enemies: 2,
        frames: 1,
    },
    action: ActionSpace::Pyquaticus,
    period_s: 0.5,
};

fn layer(inputs: usize, outputs: usize) -> Layer {
    Layer {
        inputs,
        outputs,
        weights: vec![0.25; inputs * outputs],
        biases: vec![0.5; outputs],
    }
}

/// A model with this metadata and outputs of these names and sizes.
fn file(metadata: &BTreeMap<String, String>, outputs: &[(&str, usize)]) -> Vec<u8> {
    let inputs = SPEC.observation.size(1, 2);
    let head = |(name, size): &(&str, usize)| Head {
        name: (*name).to_owned(),
        layer: layer(inputs, *size),
    };
    let network = Perceptron {
        hidden: vec![],
        heads: outputs.iter().map(head).collect(),
        bounded: false,
        metadata: metadata.clone(),
    };
    network.onnx().expect("sizes that fit")
}

fn read(metadata: &BTreeMap<String, String>, said: PartialSpec) -> Result<PolicySpec, String> {
    let model = PolicyModel::read("x.onnx", &file(metadata, &[("logits", 17)]), said);
    model
        .map(|model| model.spec)
        .map_err(|error| error.to_string())
}

#[test]
fn metadata_say_what_a_model_is() {
    let metadata = BTreeMap::from(SPEC.metadata());
    assert_eq!(
        metadata["squall.observation"],
        r#"{"kind":"squall","mates":1,"enemies":2,"frames":1}"#
    );
    assert_eq!(metadata["squall.action"], "pyquaticus");
    assert_eq!(read(&metadata, PartialSpec::default()), Ok(SPEC));
    let said = PartialSpec {
        period_s: Some(1.5),
        ..PartialSpec::default()
    };
    assert_eq!(
        read(&metadata, said),
        Ok(PolicySpec {
            period_s: 1.5,
            ..SPEC
        })
    );
    let said = PartialSpec {
        observation: Some(SPEC.observation),
        action: Some(SPEC.action),
        period_s: Some(0.5),
    };
    assert_eq!(read(&BTreeMap::new(), said), Ok(SPEC));
}

#[test]
fn what_metadata_leave_open_or_contradict_is_refused() {
    let full = BTreeMap::from(SPEC.metadata());
    let without = |key: &str| {
        let mut metadata = full.clone();
        metadata.remove(key);
        metadata
    };
    let with = |key: &str, value: &str| {
        let mut metadata = full.clone();
        metadata.insert(key.to_owned(), value.to_owned());
        metadata
    };
    let nothing = PartialSpec::default();
    let other = PartialSpec {
        action: Some(ActionSpace::Continuous),
        ..nothing
    };
    for (metadata, said, want) in [
        (
            without("squall.observation"),
            nothing,
            "no squall.observation, expected it there, or observation here",
        ),
        (
            without("squall.action"),
            nothing,
            "no squall.action, expected it there, or action here",
        ),
        (
            without("squall.period_s"),
            nothing,
            "no squall.period_s, expected it there, or period_s here",
        ),
        (
            with("squall.observation", "moos"),
            nothing,
            "squall.observation = \"moos\", expected an observation space such as",
        ),
        (
            with("squall.observation_version", "2"),
            nothing,
            "observation_version = \"2\", expected 1, which is this program's",
        ),
        (
            with("squall.action", "moos"),
            nothing,
            "squall.action = \"moos\", expected an action space (unknown variant",
        ),
        (
            with("squall.period_s", "NaN"),
            nothing,
            "squall.period_s = \"NaN\", expected 0.01 to 10 s",
        ),
        (
            full.clone(),
            other,
            "squall.action = \"pyquaticus\", expected \"continuous\", as stated here",
        ),
    ] {
        let error = read(&metadata, said).expect_err(want);
        assert!(error.contains(want), "{error}\n{want}");
    }
}

#[test]
fn of_several_outputs_the_one_that_fits_makes_the_action() {
    let metadata = BTreeMap::from(SPEC.metadata());
    let output = |outputs: &[(&str, usize)]| {
        let model = PolicyModel::read("x.onnx", &file(&metadata, outputs), PartialSpec::default());
        model
            .map(|model| model.output())
            .map_err(|error| error.to_string())
    };
    assert_eq!(output(&[("value", 1), ("logits", 17)]), Ok(1));
    assert_eq!(output(&[("action", 1), ("features", 64)]), Ok(0));
    for outputs in [
        &[("value", 1), ("action", 1)][..],
        &[("logits", 17), ("others", 17)],
        &[("logits", 16)],
    ] {
        let error = output(outputs).expect_err("no single one");
        assert!(
            error.contains("expected one output of 17 numbers"),
            "{error}"
        );
    }
}

/// A policy trained by Stable-Baselines3 on the observations of Pyquaticus and exported by PyTorch:
/// entirely third-party.
#[test]
fn a_model_of_another_trainer_loads() {
    let said = PartialSpec {
        observation: Some(ObservationSpace::Pyquaticus),
        action: Some(ActionSpace::Pyquaticus),
        period_s: Some(0.1),
    };
    // The whole policy has a value and a probability beside the action.
    for name in ["sb3_dynamo.onnx", "sb3_full.onnx"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../onnx/tests/network")
            .join(name);
        let bytes = std::fs::read(path).expect("the model");
        let model = PolicyModel::read(name, &bytes, said).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(
            (model.input_size(), model.output()),
            (ObservationSpace::Pyquaticus.size(1, 2), 0)
        );
    }
}
