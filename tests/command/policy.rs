//! `squall policy` from the command line: describes a model and explains a choice with a known
//! reason.

use crate::program::{only_file, printed, project, refusal, scenario, words};
use messages::helm::{PolicyReport, PolicyWords};
use onnx::{Head, Layer, Perceptron};
use scenario::Overrides;
use scenario::action::ActionSpace;
use scenario::observation::ObservationSpace;
use scenario::policy::PolicySpec;
use std::collections::BTreeMap;
use tempfile::TempDir;

const SPEC: PolicySpec = PolicySpec {
    observation: ObservationSpace::Squall {
        mates: 0,
        enemies: 1,
        frames: 1,
    },
    action: ActionSpace::Pyquaticus,
    period_s: 0.5,
};
/// Straight ahead at full speed: its logit is 3 plus twice the input [`MATTERS`]; all other logits
/// are 0.
const ACTION: usize = 4;
const MATTERS: &str = "goal_ahead";

fn model() -> Vec<u8> {
    let names = SPEC.observation.names(0, 1);
    let inputs = names.len();
    let outputs = SPEC.action.outputs();
    let mut layer = Layer {
        inputs,
        outputs,
        weights: vec![0.0; inputs * outputs],
        biases: vec![0.0; outputs],
    };
    layer.biases[ACTION] = 3.0;
    layer.weights[ACTION * inputs + names.iter().position(|name| name == MATTERS).unwrap()] = 2.0;
    let network = Perceptron {
        hidden: vec![],
        heads: vec![Head {
            name: "logits".to_owned(),
            layer,
        }],
        bounded: false,
        metadata: BTreeMap::from(SPEC.metadata()),
    };
    network.onnx().unwrap()
}

/// A folder with this model, and a strategy that uses it.
fn known() -> TempDir {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("known.onnx"), model()).unwrap();
    let base = scenario("strategies/policy.toml");
    let strategy = format!("base = {base:?}\n[behaviour.learned]\nmodel = \"known.onnx\"\n");
    std::fs::write(dir.path().join("known.toml"), strategy).unwrap();
    dir
}

/// The probability of [`ACTION`], per cent.
fn percent(input: f64) -> f64 {
    let part = primitives::math::exp(3.0 + 2.0 * input);
    100.0 * part / (part + 16.0)
}

#[test]
fn a_decision_of_a_recorded_game_is_explained() {
    let dir = known();
    let here = dir.path();
    let game = scenario("games/attack_1v1.toml");
    printed(
        here,
        &[
            "run",
            &game,
            "--in-process",
            "--blue",
            "known.toml",
            "--record",
            "runs",
        ],
    );
    let recording = only_file(here.join("runs"));
    let explain = |vehicle: &str, at: &str| {
        format!("policy known.onnx --game {recording} --vehicle {vehicle} --at {at} --inputs 1")
    };
    let text = printed(here, &words(&explain("blue_one", "20.5")));
    assert!(
        text.contains("one of 17 turns and speeds") && text.contains("every 0.5 s"),
        "{text}"
    );
    let row: Vec<&str> = text.lines().last().unwrap().split_whitespace().collect();
    let [name, value, then, "%"] = row[..] else {
        panic!("{text}")
    };
    let [value, then] = [value, then].map(|number| number.parse::<f64>().unwrap());
    assert!(
        name == MATTERS && value != 0.0 && (then - percent(0.0)).abs() < 0.051,
        "{text}"
    );
    let first = text
        .lines()
        .find(|line| line.contains("full speed, straight on"))
        .unwrap();
    let is: f64 = first.split_whitespace().next().unwrap().parse().unwrap();
    assert!(
        (is - percent(value)).abs() < 0.15,
        "{is} is not {}: {text}",
        percent(value)
    );

    for (vehicle, at, said) in [
        ("red_one", "20", "red_one uses no policy"),
        ("blue_one", "99999", "no decision by blue_one at 99999 s"),
        ("blue_one", "-1", "expected a number from 0 to 1000000 s"),
        ("nobody", "20", "nobody"),
    ] {
        let why = refusal(here, &words(&explain(vehicle, at)));
        assert!(why.contains(said), "{why}");
    }
}

#[test]
fn what_a_helm_reports_of_a_policy_is_told_in_words() {
    let dir = known();
    let strategies = BTreeMap::from([("blue".to_owned(), dir.path().join("known.toml"))]);
    let overrides = Overrides {
        strategies,
        ..Overrides::default()
    };
    let game = scenario::load_with(scenario("games/attack_1v1.toml").as_ref(), &overrides).unwrap();
    let blue = game.vehicle_named("blue_one").unwrap();
    let names = SPEC.observation.names(0, 1);
    let observed: Vec<f32> = (0..names.len()).map(|i| i as f32).collect();
    let mut probabilities = vec![0.0; 17];
    (probabilities[ACTION], probabilities[0]) = (0.75, 0.25);
    let model = game.strategy_of(blue).models().next().unwrap().name.clone();
    let course_deg = Some(0.0);
    let speed_m_s = Some(1.0);
    let fault = None;
    let behaviour = "learned".to_owned();
    let mut report = PolicyReport {
        behaviour,
        model,
        course_deg,
        speed_m_s,
        option: None,
        fault,
        probabilities,
        observed,
    };
    let words = report.words(&game, blue);
    let [first, second] = [0, 1].map(|i: usize| (words.actions[i].0.as_str(), words.actions[i].1));
    assert_eq!(
        (first, second),
        (
            ("full speed, straight on", 0.75),
            ("full speed, about", 0.25)
        )
    );
    let goal = names.iter().position(|name| name == MATTERS).unwrap();
    assert_eq!(words.observed[goal], (MATTERS.to_owned(), goal as f32));
    // If an agent reports a model that its boat does not have, the report is rejected.
    report.model = "other.onnx".to_owned();
    assert_eq!(report.words(&game, blue), PolicyWords::default());
}

#[test]
fn a_model_that_says_nothing_of_itself_is_described() {
    let text = printed(
        project(),
        &["policy", "crates/onnx/tests/network/sb3_dynamo.onnx"],
    );
    assert!(
        text.contains("obs (45) -> logits (17)") && text.contains("the strategy must declare it"),
        "{text}"
    );
}
