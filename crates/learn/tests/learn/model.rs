//! A trained policy acts in a strategy as it did in training.

use super::fixture::{game, strategy};
use agent::{Action, ActionSpace, HelmMind, Mind, ObservationSpace, Pilot, Spaces};
use learn::nn::Perceptron;
use messages::{Order, Picture};
use onnx::Network;
use primitives::VehicleId;
use scenario::Scenario;
use scenario::policy::{PartialSpec, PolicyModel, PolicySpec};
use scenario::strategy::{Policy, Program, Strategy, Task};
use std::collections::BTreeMap;

const SPEC: PolicySpec = PolicySpec {
    observation: ObservationSpace::Squall {
        mates: 1,
        enemies: 2,
        frames: 2,
    },
    action: ActionSpace::Pyquaticus,
    period_s: 0.7,
};

/// A policy with random weights, large enough to vary its actions.
fn model(spec: PolicySpec) -> PolicyModel {
    let mut stream = primitives::stream::Stream::new(8, "test/model");
    let inputs = spec.observation.size(1, 2);
    let outputs = spec.action.outputs();
    model_of(
        &Perceptron::new(&[inputs, 32, outputs], 3.0, &mut stream),
        spec,
    )
}

fn model_of(network: &Perceptron, spec: PolicySpec) -> PolicyModel {
    let bytes = network.onnx("logits", false, BTreeMap::from(spec.metadata()));
    let bytes = bytes.unwrap();
    PolicyModel::read("test.onnx", &bytes, PartialSpec::default()).unwrap()
}

fn with_model(mut strategy: Strategy, model: &PolicyModel) -> Strategy {
    let behaviours = strategy
        .roles
        .iter_mut()
        .flat_map(|role| &mut role.behaviours);
    for behaviour in behaviours {
        if let Task::Policy(policy) = &mut behaviour.task {
            policy.model = Some(model.clone());
        }
    }
    strategy
}

fn program(scenario: &Scenario, strategy: &Strategy, vehicle: VehicleId) -> Program {
    agent::roles::role_in(scenario, vehicle, strategy).clone()
}

/// A mind whose actions come from the same network outside the helm, as in training.
struct Driven {
    pilot: Pilot,
    network: Network,
    decisions: u32,
}

impl Mind for Driven {
    fn decide(&mut self, picture: &Picture) -> Order {
        // Every 0.7 s.
        if self.decisions.is_multiple_of(7) {
            self.network.evaluate(self.pilot.observe(picture));
            self.pilot.act(Action::likeliest(self.network.output(0)));
        }
        self.decisions += 1;
        self.pilot.decide(picture)
    }
}

#[test]
fn a_model_in_a_strategy_plays_the_game_that_it_was_trained_in() {
    let scenario = game("surveyor_2v2");
    let model = model(SPEC);
    let strategy = *strategy("policy");
    let loaded = with_model(strategy.clone(), &model);
    let played = |is_loaded: bool| {
        let mind = |vehicle: VehicleId| -> Box<dyn Mind> {
            if is_loaded {
                return Box::new(HelmMind::new(
                    &scenario,
                    vehicle,
                    &program(&scenario, &loaded, vehicle),
                ));
            }
            let spaces = Spaces {
                observation: SPEC.observation,
                action: SPEC.action,
            };
            let pilot = Pilot::helm(
                &scenario,
                vehicle,
                &program(&scenario, &strategy, vehicle),
                spaces,
            );
            Box::new(Driven {
                pilot,
                network: model.network(),
                decisions: 0,
            })
        };
        let minds = (0..4).map(|i| mind(VehicleId::at(i))).collect();
        arena::play_watched(&scenario, minds, 3, |contest| contest.decision() < 2000).unwrap()
    };
    let boat = played(true);
    let training = played(false);
    assert_eq!(boat.digest, training.digest);
    let still = with_model(strategy.clone(), &model_of_nan());
    let minds = (0..4)
        .map(|i| agent::mind_by(&scenario, VehicleId::at(i), &still))
        .collect();
    let held =
        arena::play_watched(&scenario, minds, 3, |contest| contest.decision() < 2000).unwrap();
    assert_ne!(held.digest, boat.digest);
}

/// The strategy `policy` with a model, changed by `change`.
fn changed(change: impl Fn(&mut Policy)) -> Strategy {
    let mut strategy = with_model(*strategy("policy"), &model(SPEC));
    for behaviour in strategy
        .roles
        .iter_mut()
        .flat_map(|role| &mut role.behaviours)
    {
        if let Task::Policy(policy) = &mut behaviour.task {
            change(policy);
        }
    }
    strategy
}

#[test]
fn sampled_actions_are_drawn_by_the_seed() {
    let played = |strategy: &Strategy, draws: u64| {
        // The boats, the sea and the starts stay the same: only the minds use this seed.
        let mut scenario = game("surveyor_2v2").of_seed(3).unwrap();
        scenario.seed = draws;
        let minds = (0..4).map(|i| agent::mind_by(&scenario, VehicleId::at(i), strategy));
        let minds = minds.collect();
        let outcome = arena::play_watched(&scenario, minds, 3, |c| c.decision() < 500);
        outcome.unwrap().digest
    };
    for direct in [false, true] {
        let [likeliest, drawn] = [false, true]
            .map(|sampled| changed(|policy| (policy.direct, policy.sampled) = (direct, sampled)));
        assert_eq!(played(&likeliest, 1), played(&likeliest, 2));
        assert_eq!(played(&drawn, 1), played(&drawn, 1));
        assert_ne!(played(&drawn, 1), played(&drawn, 2));
    }
}

#[test]
fn a_direct_model_steers_without_a_helm() {
    let scenario = game("surveyor_2v2");
    let direct = changed(|policy| policy.direct = true);
    let by_strategy = |i| agent::mind_by(&scenario, VehicleId::at(i), &direct);
    let by_network = |i| -> Box<dyn Mind> {
        let spaces = Spaces {
            observation: SPEC.observation,
            action: SPEC.action,
        };
        Box::new(Driven {
            pilot: Pilot::direct(&scenario, VehicleId::at(i), spaces),
            network: model(SPEC).network(),
            decisions: 0,
        })
    };
    let played = |minds: Vec<Box<dyn Mind>>| {
        let outcome = arena::play_watched(&scenario, minds, 3, |c| c.decision() < 500);
        outcome.unwrap().digest
    };
    assert_eq!(
        played((0..4).map(by_strategy).collect()),
        played((0..4).map(by_network).collect())
    );
}

/// A network with non-finite outputs: its weights add up to more than single precision can hold.
fn model_of_nan() -> PolicyModel {
    let mut stream = primitives::stream::Stream::new(8, "test/model");
    let mut network = Perceptron::new(&[SPEC.observation.size(1, 2), 4, 17], 1.0, &mut stream);
    network
        .parameters_mut()
        .iter_mut()
        .for_each(|number| *number = 3e38);
    model_of(&network, SPEC)
}

#[test]
fn what_a_policy_cannot_do_its_helm_says_and_safety_is_left() {
    let scenario = game("surveyor_2v2");
    let for_one = model(PolicySpec {
        observation: ObservationSpace::Pyquaticus,
        ..SPEC
    });
    let large = game("fleet_20v20");
    for (scenario, model, want) in [
        (
            &scenario,
            model_of_nan(),
            "the model returned a non-finite value",
        ),
        (
            &large,
            for_one,
            "the model has 45 inputs, but a boat in this game has 333 values: it was trained for a different team size",
        ),
    ] {
        let vehicle = VehicleId::at(0);
        let without = *strategy("policy");
        let with = with_model(*strategy("policy"), &model);
        let mut mind = agent::mind_by(scenario, vehicle, &with);
        let mut contest = sim::Contest::new(scenario, 1).unwrap();
        contest.pictures();
        let order = mind.decide(contest.picture_of(vehicle));
        let safety_alone =
            agent::mind_by(scenario, vehicle, &without).decide(contest.picture_of(vehicle));
        assert_eq!(order, safety_alone);
        let report = mind.report().expect("it has a helm");
        assert_eq!(report.policies[0].fault.as_deref(), Some(want));
        assert_eq!(report.policies[0].course_deg, None);
    }
}

#[test]
fn a_model_goes_to_agents_with_the_scenario() {
    let strategy = with_model(*strategy("policy"), &model(SPEC));
    let text = serde_json::to_string(&strategy).unwrap();
    let back: Strategy = serde_json::from_str(&text).unwrap();
    assert_eq!(back, strategy);
    let damaged = text.replacen("\"onnx\":\"", "\"onnx\":\"AAAA", 1);
    let error = serde_json::from_str::<Strategy>(&damaged)
        .unwrap_err()
        .to_string();
    assert!(error.contains("not an ONNX file"), "{error}");
}
