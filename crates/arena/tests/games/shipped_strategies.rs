//! Shipped strategies: their documented behaviour.

use crate::files::{loaded, played, shipped};
use agent::Mind;
use messages::helm::HelmReport;
use primitives::VehicleId;
use rules::count::Counts;
use rules::event::EventCursor;
use scenario::Scenario;
use std::collections::BTreeMap;

/// The game with this seed and this many boats per side.
fn game(boats: u32, blue: &str, red: &str, seed: u64) -> Scenario {
    let spawn = "spawn = { along_m = [10, 70], across_m = [10, 70], gap_m = 10 }";
    let team = |team: &str, strategy: &str| {
        format!(
            "[[team]]\nname = \"{team}\"\nstrategy = \"SCENARIOS/strategies/{strategy}.toml\"\n\
             [[fleet]]\nteam = \"{team}\"\ncount = {boats}\n{spawn}\n"
        )
    };
    let game = format!(
        "base = \"SCENARIOS/games/surveyor_2v2.toml\"\n{}{}",
        team("blue", blue),
        team("red", red)
    );
    loaded(&[("game.toml", game)])
        .of_seed(seed)
        .unwrap_or_else(|e| panic!("{e}"))
}

/// The final report of the first boat's helm, and the modes it was in.
fn watched(scenario: &Scenario) -> (HelmReport, Vec<String>) {
    let mut last = None;
    let mut modes = vec![];
    arena::play_observed(
        scenario,
        agent::minds_of(scenario),
        scenario.seed,
        |_, runner| {
            let report = runner
                .mind(VehicleId(0))
                .and_then(Mind::report)
                .expect("a helm");
            if modes.last() != Some(&report.mode) {
                modes.push(report.mode.clone());
            }
            last = Some(report);
            true
        },
    )
    .unwrap_or_else(|e| panic!("{e}"));
    (last.expect("there were decisions"), modes)
}

#[test]
fn each_of_the_four_kinds_of_opponent_is_known_and_gets_its_own_response() {
    const GAMES: usize = 8;
    for (red, offensive, aggressive, response) in [
        (
            "easy_attacker",
            true,
            true,
            ["pursuing", "punishing:awaiting", "punishing:raiding"].as_slice(),
        ),
        (
            "medium_attacker",
            true,
            false,
            &["pursuing", "driving_out:slipping_in"],
        ),
        ("medium_defender", false, true, &["luring:feinting"]),
        ("easy_defender", false, false, &["stealing:grabbing"]),
    ] {
        let games: Vec<_> = (1..=GAMES as u64)
            .map(|seed| watched(&game(1, "observer", red, seed)))
            .collect();
        let is = |report: &HelmReport, name: &str, want: bool| {
            report
                .variables
                .iter()
                .any(|variable| variable.name == name && variable.value == want.to_string())
        };
        let is_offensive =
            |(report, _): &&(HelmReport, Vec<String>)| is(report, "offensive", offensive);
        assert_eq!(
            games.iter().filter(is_offensive).count(),
            GAMES,
            "{red}: whether it crosses midfield is easy to see"
        );
        let right: Vec<_> = games
            .iter()
            .filter(|(report, _)| {
                is(report, "classified", true) && is(report, "aggressive", aggressive)
            })
            .collect();
        assert!(
            4 * right.len() >= 3 * GAMES,
            "{red}: right in {} of {GAMES} games",
            right.len()
        );
        let responds = |modes: &[String]| {
            response
                .iter()
                .all(|mode| modes.iter().any(|was| was == mode))
        };
        let silent: Vec<_> = right.iter().filter(|(_, modes)| !responds(modes)).collect();
        // An opponent need not provide the opportunity in every game.
        assert!(silent.len() <= 1, "{red}: {silent:?}");
    }
}

#[test]
fn two_teams_that_watch_each_other_play_a_game() {
    for seed in 1..=4 {
        let outcome = played(&game(2, "observer", "observer", seed));
        for team in ["blue", "red"] {
            assert!(
                outcome.counts.teams[team].grabs > 0,
                "seed {seed}: {team} grabs nothing: {:?}",
                outcome.counts
            );
        }
    }
}

#[test]
fn our_strategies_beat_those_of_the_paper_from_either_side() {
    const SEEDS: u64 = 12;
    for (ours, other) in [("strategy_5", "strategy_4"), ("strategy_6", "strategy_3")] {
        let mut won = 0;
        let mut lost = 0;
        for seed in 1..=SEEDS {
            for (blue, red, own, opponent) in
                [(ours, other, "blue", "red"), (other, ours, "red", "blue")]
            {
                let points = played(&game(2, blue, red, seed)).score.teams;
                won += u64::from(points[own] > points[opponent]);
                lost += u64::from(points[own] < points[opponent]);
            }
        }
        // Over hundreds of games, each of ours wins about three quarters of those that are not
        // drawn.
        assert!(
            won > lost && 2 * won > SEEDS,
            "{ours}: {won} won, {lost} lost"
        );
    }
}

#[test]
fn twenty_boats_a_side_grab_and_capture() {
    let fleet = scenario::load(&shipped("games/fleet_20v20.toml")).and_then(|game| game.of_seed(1));
    let scenario = fleet.unwrap_or_else(|e| panic!("{e}"));
    let counts = played(&scenario).counts;
    let all = |count: fn(&Counts) -> u32| counts.teams.values().map(count).sum::<u32>();
    assert!(
        counts.teams.values().all(|team| team.grabs > 0) && all(|team| team.captures) > 0,
        "{counts:?}"
    );
}

#[test]
fn a_tagged_boat_does_not_lie_at_an_edge() {
    // In this game, a boat once took 258 s to get home. For most of that time it lay 10 m from an
    // edge with no boat near, because the helm's hysteresis bonus outweighed the way home.
    const HOME_S: f64 = 150.0;
    let game =
        scenario::load(&shipped("games/strategy_4_vs_3.toml")).and_then(|game| game.of_seed(1));
    let outcome = played(&game.unwrap_or_else(|e| panic!("{e}")));
    let mut tagged_at_s = BTreeMap::new();
    let mut came_home = 0;
    for event in &outcome.events {
        match event.event.as_str() {
            "tagged" => {
                tagged_at_s.insert(&event.vehicle, event.at_s);
            }
            "untagged" => {
                let since_s = tagged_at_s.remove(&event.vehicle).expect("it was tagged");
                assert!(
                    event.at_s - since_s < HOME_S,
                    "{event:?}: tagged at {since_s} s"
                );
                came_home += 1;
            }
            _ => {}
        }
    }
    assert!(came_home > 3, "only {came_home} boats came home");
}

#[test]
fn nobody_stands_still_in_a_game_of_point_boats() {
    // A defender once stood in its corner for 125 s: the weights of the edges made the helm's
    // hysteresis outweigh its task, and at low speed a point boat cannot turn away.
    const STILL_S: f64 = 20.0;
    let game = scenario::load(&shipped("games/mctf_2026.toml")).unwrap_or_else(|e| panic!("{e}"));
    for seed in 1..=6 {
        let scenario = game.of_seed(seed).unwrap_or_else(|e| panic!("{e}"));
        let mut moved_at_s = vec![0.0; scenario.vehicles.len()];
        let minds = agent::minds_of(&scenario);
        arena::play_watched(&scenario, minds, seed, |contest| {
            let now_s = contest.now().as_s();
            let frame = contest.frame(&mut EventCursor::default());
            for (i, (boat, moved_at_s)) in frame.vehicles.iter().zip(&mut moved_at_s).enumerate() {
                if boat.nav.surge_m_s > 0.2 || boat.tagged || boat.disabled {
                    *moved_at_s = now_s;
                }
                assert!(
                    now_s - *moved_at_s < STILL_S,
                    "seed {seed}: boat {i} has stood still since {moved_at_s} s"
                );
            }
            true
        })
        .unwrap_or_else(|e| panic!("{e}"));
    }
}
