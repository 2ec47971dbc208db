//! The shipped policy plays, and wins against strategy 4.

use super::fixture::{file, game, strategy};
use primitives::{TeamId, VehicleId};
use scenario::strategy::Task;

#[test]
fn the_shipped_policy_scores_more_than_strategy_4() {
    let scenario = game("surveyor_2v2");
    let [learned, other] = ["learned", "strategy_4"].map(strategy);
    let mut points = [0, 0];
    for seed in 40_001..40_005 {
        for side in 0..2_u8 {
            let mind = |vehicle: VehicleId| {
                let is_learned = scenario.team_of(vehicle) == TeamId(side);
                agent::mind_by(
                    &scenario,
                    vehicle,
                    if is_learned { &learned } else { &other },
                )
            };
            let outcome = arena::play(
                &scenario,
                (0..4).map(|i| mind(VehicleId::at(i))).collect(),
                seed,
            );
            let score = outcome
                .unwrap_or_else(|error| panic!("seed {seed}: {error}"))
                .score
                .teams;
            points[0] += score[&scenario.teams[usize::from(side)].name];
            points[1] += score[&scenario.teams[usize::from(1 - side)].name];
        }
    }
    assert!(
        points[0] > points[1],
        "points of the policy and strategy 4 in eight games: {points:?}"
    );
}

#[test]
fn the_shipped_policy_says_where_it_comes_from() {
    let learned = strategy("learned");
    let model = learned.roles[0]
        .behaviours
        .iter()
        .find_map(|behaviour| match &behaviour.task {
            Task::Policy(policy) => policy.model.as_ref(),
            _ => None,
        });
    let model = model.expect("a model");
    assert_eq!(
        model
            .network()
            .metadata()
            .get("squall.training")
            .map(String::as_str),
        Some("options")
    );
    let bytes = std::fs::metadata(file("policies/options.onnx")).map(|file| file.len());
    assert!(bytes.is_ok_and(|bytes| bytes < 1_000_000));
}
