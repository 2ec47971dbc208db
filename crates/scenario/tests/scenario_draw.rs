//! Randomised values: distributions in place of numbers.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use scenario::Scenario;
use std::path::{Path, PathBuf};

fn shipped(file: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../scenarios")
        .join(file)
        .display()
        .to_string()
}

/// A game with two boats from the file `boat` on the sea `sea`, with `more` appended.
fn written(dir: &Path, boat: &str, sea: &str, more: &str) -> PathBuf {
    for folder in ["games", "boats", "seas"] {
        std::fs::create_dir_all(dir.join(folder)).unwrap();
    }
    let boat = format!("base = \"{}\"\n{boat}", shipped("boats/surveyor_m1_8.toml"));
    std::fs::write(dir.join("boats/drawn.toml"), boat).unwrap();
    std::fs::write(dir.join("seas/drawn.toml"), sea).unwrap();
    let game = format!(
        "base = \"{}\"\nboat = \"../boats/drawn.toml\"\nsea = \"../seas/drawn.toml\"\n{more}",
        shipped("games/attack_1v1.toml")
    );
    let path = dir.join("games/drawn.toml");
    std::fs::write(&path, game).unwrap();
    path
}

const BOAT: &str = "[hull]\nmass_kg = { uniform = [0.9, 1.1], times = 52.3 }\nmunk_factor = { choice = [0.2, 0.4] }\n\
                    [thruster]\nlag_s = { log_normal = [0.25, 0.2] }\n";
const SEA: &str = "current = { speed_m_s = { normal = [0.3, 0.05] }, toward_deg = 90 }\n";

fn value(scenario: &Scenario, parameter: &str) -> f64 {
    let drawn = scenario
        .drawn
        .iter()
        .find(|drawn| drawn.parameter == parameter);
    drawn
        .unwrap_or_else(|| panic!("no {parameter} in {:?}", scenario.drawn))
        .value
}

#[test]
fn each_vehicle_and_each_seed_draws_its_own_numbers_and_the_model_takes_them() {
    let dir = tempfile::tempdir().unwrap();
    let first = scenario::load(&written(
        dir.path(),
        BOAT,
        SEA,
        "link = { delay_s = { uniform = [0.1, 0.2] } }",
    ))
    .unwrap();
    // The files are no longer needed.
    std::fs::remove_dir_all(dir.path()).unwrap();
    let recorded: Scenario = serde_json::from_str(&serde_json::to_string(&first).unwrap()).unwrap();

    for seed in 1..=50 {
        let game = first.of_seed(seed).unwrap();
        assert_eq!(game, first.of_seed(seed).unwrap(), "seed {seed}");
        assert_eq!(
            game,
            recorded.of_seed(seed).unwrap(),
            "seed {seed}: the same when the texts are read again"
        );
        assert_eq!(game.drawn.len(), 2 * 3 + 1 + 1, "{:?}", game.drawn);
        let mass_kg = value(&game, "blue_one/hull.mass_kg");
        assert!(
            (0.9 * 52.3..1.1 * 52.3).contains(&mass_kg),
            "seed {seed}: {mass_kg}"
        );
        assert_eq!(
            game.boat_of(game.vehicle_by_name("blue_one").unwrap())
                .hull
                .mass_kg,
            mass_kg
        );
        // Omitted values follow from the drawn ones.
        let red = game.boat_of(game.vehicle_by_name("red_one").unwrap());
        assert_eq!(red.hull.mass_kg, value(&game, "red_one/hull.mass_kg"));
        assert_ne!(red.hull.mass_kg, mass_kg);
        assert!([0.2, 0.4].contains(&red.hull.munk_factor));
        let speed_m_s = value(&game, "sea/current.speed_m_s");
        assert!(
            (0.15..=0.45).contains(&speed_m_s)
                && (game.sea.current.mean_m_s.east - speed_m_s).abs() < 1e-12
        );
        assert_eq!(
            game.link.as_ref().unwrap().delay_s,
            value(&game, "link/delay_s")
        );
    }
    assert_ne!(
        first.of_seed(1).unwrap().drawn,
        first.of_seed(2).unwrap().drawn
    );
}

#[test]
fn a_new_distribution_does_not_shift_the_numbers_of_the_others() {
    let dir = tempfile::tempdir().unwrap();
    let before = scenario::load(&written(dir.path(), BOAT, SEA, "")).unwrap();
    let more = format!("length_m = {{ uniform = [1.7, 1.9] }}\n{BOAT}");
    let after = scenario::load(&written(dir.path(), &more, SEA, "")).unwrap();
    for key in ["blue_one/hull.mass_kg", "sea/current.speed_m_s"] {
        assert_eq!(value(&before, key), value(&after, key), "{key}");
    }
}

#[test]
fn whole_numbers_are_drawn_by_choice_and_a_lone_file_by_its_seed() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("sea.toml");
    let sea = "[waves]\nhs_m = { uniform = [0.2, 0.4] }\ntp_s = 3\nfrom_deg = 0\ncomponents = { choice = [16, 32] }\n";
    std::fs::write(&path, sea).unwrap();
    let mut heights = vec![];
    for seed in 1..=20 {
        let (sea, drawn) = scenario::draw_file::<scenario::sea::Sea>(&path, seed).unwrap();
        let waves = sea.waves.unwrap();
        assert!([16, 32].contains(&waves.components));
        let named = |key: &str| drawn.iter().find(|one| one.parameter == key).unwrap().value;
        assert_eq!(named("sea/waves.hs_m"), waves.hs_m);
        assert_eq!(named("sea/waves.components"), f64::from(waves.components));
        heights.push(waves.hs_m);
    }
    heights.dedup();
    assert_eq!(heights.len(), 20);
    let broken = sea.replace("choice = [16, 32]", "normal = [24, 3.5]");
    std::fs::write(&path, broken).unwrap();
    let said = scenario::draw_file::<scenario::sea::Sea>(&path, 1).unwrap_err();
    let said = said.to_string();
    for part in ["components", "expected a whole number"] {
        assert!(said.contains(part), "{said}");
    }
}

#[test]
fn the_numbers_have_the_distribution_that_was_asked_for() {
    let dir = tempfile::tempdir().unwrap();
    let game = scenario::load(&written(dir.path(), BOAT, SEA, "")).unwrap();
    let n = 1000;
    let games: Vec<Scenario> = (0..n).map(|seed| game.of_seed(seed).unwrap()).collect();
    let mean = |f: &dyn Fn(&Scenario) -> f64| games.iter().map(f).sum::<f64>() / n as f64;
    // Within five standard errors; a normal number truncated at three sigma has 0.973 of the
    // variance.
    let root = (n as f64).sqrt();
    let is_near = |found: f64, want: f64, sigma: f64| {
        assert!(
            (found - want).abs() < 5.0 * sigma / root,
            "{found}, expected {want}"
        );
    };
    let mass = mean(&|game| value(game, "blue_one/hull.mass_kg"));
    is_near(mass, 52.3, 0.2 * 52.3 / 12_f64.sqrt());
    let speed = mean(&|game| value(game, "sea/current.speed_m_s"));
    is_near(speed, 0.3, 0.05);
    let variance = mean(&|game| {
        let off = value(game, "sea/current.speed_m_s") - 0.3;
        off * off
    });
    is_near(variance / (0.973 * 0.05 * 0.05), 1.0, 2_f64.sqrt());
    let share = |key: &str, is_it: &dyn Fn(f64) -> bool| {
        mean(&|game| f64::from(u8::from(is_it(value(game, key)))))
    };
    let below = share("blue_one/thruster.lag_s", &|lag_s| lag_s < 0.25);
    is_near(below, 0.5, 0.5);
    let fours = share("red_one/hull.munk_factor", &|factor| factor == 0.4);
    is_near(fours, 0.5, 0.5);
}

#[test]
fn a_distribution_that_reaches_where_a_number_may_not_is_refused_with_its_place() {
    let dir = tempfile::tempdir().unwrap();
    let none = "boats/drawn.toml:2:12: length_m is not a valid distribution";
    for (boat, sea, want) in [
        (
            "length_m = { uniform = [0.05, 2] }\n",
            "",
            "boats/drawn.toml:2:12: length_m is 0.05, expected 0.1 to 100",
        ),
        (
            "[hull]\nmunk_factor = { uniform = [0.5, 1.5] }\n",
            "",
            "boats/drawn.toml:3:15: munk_factor is 1.5, expected 0 to 1",
        ),
        (
            "",
            "depth_m = { normal = [10, 4] }\n",
            "seas/drawn.toml:1:11: depth_m is -2, expected 0.5 to 12000",
        ),
        (
            "length_m = { uniform = [2, 1] }\n",
            "",
            "boats/drawn.toml:2:12: length_m is not a valid distribution, expected one of { uniform",
        ),
        ("length_m = { normal = [2] }\n", "", none),
        ("length_m = { choice = [] }\n", "", none),
        ("length_m = { uniform = [1, 2], tims = 3 }\n", "", none),
        ("length_m = { log_normal = [-1, 0.1] }\n", "", none),
    ] {
        let problems = scenario::load(&written(dir.path(), boat, sea, "")).unwrap_err();
        let told = problems.to_string();
        assert!(told.contains(want), "{want}\n{told}");
    }
    // A value that all boats share cannot be randomised.
    let path = written(dir.path(), "", "", "duration_s = { uniform = [100, 200] }");
    let told = scenario::load(&path).unwrap_err().to_string();
    assert!(told.contains("duration_s is a table, expected a number"));
}

#[test]
fn the_size_of_each_fleet_is_drawn_for_every_game_as_a_whole_number() {
    let dir = tempfile::tempdir().unwrap();
    let fleets = "[[fleet]]\nteam = \"blue\"\ncount = { uniform = [1, 3] }\n\
                  [[fleet]]\nteam = \"red\"\ncount = { choice = [2, 5] }\n";
    let first = scenario::load(&written(dir.path(), "", "", fleets)).unwrap();
    assert!(first.draws_fleets() && first.is_random());
    let mut seen = [[0; 6]; 2];
    for seed in 1..=200 {
        let game = first.of_seed(seed).unwrap();
        let count = |team: usize| {
            let vehicles = game.vehicles.iter();
            let fleet = vehicles.filter(|one| one.team.index() == team && one.name.len() < 7);
            fleet.count()
        };
        for (team, fleet) in ["game/fleet.0.count", "game/fleet.1.count"]
            .iter()
            .enumerate()
        {
            assert_eq!(value(&game, fleet), count(team) as f64);
            seen[team][count(team)] += 1;
        }
        assert_eq!(first.of_seed(seed).unwrap(), game);
    }
    // Both fleets draw on their own, and all sizes are equally likely.
    assert!(seen[0][1..4].iter().all(|times| *times > 45), "{seen:?}");
    assert!(seen[1][2] > 75 && seen[1][5] > 75, "{seen:?}");
}

#[test]
fn a_fleet_of_half_a_boat_is_refused() {
    for count in ["uniform = [1.5, 3]", "uniform = [0, 3]", "normal = [3, 1]"] {
        let dir = tempfile::tempdir().unwrap();
        let fleet = format!("fleet = [{{ team = \"red\", count = {{ {count} }} }}]");
        let error = scenario::load(&written(dir.path(), "", "", &fleet)).unwrap_err();
        assert!(error.to_string().contains("count is "), "{count}: {error}");
    }
}
