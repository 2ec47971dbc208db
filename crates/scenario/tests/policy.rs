//! Policy models: their metadata applies, and must not contradict values given elsewhere.

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
    model.map(|model| model.spec)
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
    let period_s = 1.5;
    assert_eq!(read(&metadata, said), Ok(PolicySpec { period_s, ..SPEC }));
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
    let absent = |key: &str, said_by: &str| {
        let want = format!("no squall.{key}, expected it there or {said_by} here");
        (without(&format!("squall.{key}")), nothing, want)
    };
    let wrong = |key: &str, value: &str, expected: &str| {
        let key = format!("squall.{key}");
        let want = format!("{key} = {value:?}, expected {expected}");
        (with(&key, value), nothing, want)
    };
    let stated = "squall.action = \"pyquaticus\", expected \"continuous\", as stated here";
    for (metadata, said, want) in [
        absent("observation", "observation"),
        absent("action", "action"),
        absent("period_s", "period_s"),
        wrong("observation", "moos", "an observation space such as"),
        wrong("observation_version", "2", "1, which is this program's"),
        wrong("action", "moos", "an action space (unknown variant"),
        wrong("period_s", "NaN", "0.01 to 10 s"),
        (full.clone(), other, stated.to_owned()),
    ] {
        let error = read(&metadata, said).expect_err(&want);
        assert!(error.contains(&want), "{error}\n{want}");
    }
}

#[test]
fn of_several_outputs_the_one_that_fits_makes_the_action() {
    let metadata = BTreeMap::from(SPEC.metadata());
    let output = |outputs: &[(&str, usize)]| {
        let model = PolicyModel::read("x.onnx", &file(&metadata, outputs), PartialSpec::default());
        model.map(|model| model.output())
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
/// an entirely third-party file.
#[test]
fn a_model_of_another_trainer_loads() {
    let said = PartialSpec {
        observation: Some(ObservationSpace::Pyquaticus),
        action: Some(ActionSpace::Pyquaticus),
        period_s: Some(0.1),
    };
    // The whole policy outputs a value and a probability besides the action.
    for name in ["sb3_dynamo.onnx", "sb3_full.onnx"] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../onnx/tests/network");
        let bytes = std::fs::read(folder.join(name)).expect("the model");
        let model = PolicyModel::read(name, &bytes, said).unwrap_or_else(|error| panic!("{error}"));
        let size = ObservationSpace::Pyquaticus.size(1, 2);
        assert_eq!((model.input_size(), model.output()), (size, 0));
    }
}
