//! The shipped scenario files are all valid and contain what they should.

use crate::kinds::KINDS;
use crate::{files, shipped, written};
use experiment::sweep::Sweep;
use experiment::tournament::Tournament;
use gateway::config::Gateway;
use primitives::Ned;
use primitives::id::{TeamId, VehicleId};
use rules::field::Walls;
use scenario::{Kind, Scenario, StartPosition};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

fn game(name: &str) -> Scenario {
    scenario::load(&shipped(&format!("games/{name}.toml")))
        .unwrap_or_else(|problems| panic!("{problems}"))
}

fn field(name: &str) -> rules::Field {
    scenario::load_file::<rules::Field>(&shipped(&format!("fields/{name}.toml")))
        .unwrap_or_else(|problems| panic!("{problems}"))
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap().to_str().unwrap().to_owned()
}

/// The name in a file that must match its file name.
fn name_of(kind: Kind, path: &Path) -> Option<String> {
    let name = match kind.name() {
        "game" => scenario::load(path).map(|game| game.name),
        "field" => scenario::load_file::<rules::Field>(path).map(|field| field.plan.name),
        "boat" => scenario::load_file::<scenario::Boat>(path).map(|boat| boat.name),
        "sea" => scenario::draw_file::<scenario::sea::Sea>(path, 1).map(|(sea, _)| sea.name),
        "strategy" => {
            scenario::load_file::<scenario::strategy::Strategy>(path).map(|strategy| strategy.name)
        }
        "tournament" => scenario::load_file::<Tournament>(path).map(|tournament| tournament.name),
        "sweep" => scenario::load_file::<Sweep>(path).map(|sweep| sweep.name),
        "gateway" => scenario::load_file::<Gateway>(path).map(|gateway| gateway.name),
        _ => return None,
    };
    Some(name.unwrap_or_else(|problems| panic!("{problems}")))
}

#[test]
fn every_shipped_file_is_sound_and_says_what_it_is_for() {
    for &kind in KINDS {
        let files = files(kind);
        assert!(!files.is_empty(), "no {kind}");
        for path in files {
            let checked =
                scenario::check_file(KINDS, &path).unwrap_or_else(|problems| panic!("{problems}"));
            assert_eq!(checked, kind, "{}", path.display());
            assert_eq!(name_of(kind, &path).unwrap_or(stem(&path)), stem(&path));
            assert!(
                std::fs::read_to_string(&path).unwrap().starts_with("# "),
                "{}",
                path.display()
            );
        }
    }
}

#[test]
fn a_file_is_recognised_wherever_it_lies() {
    let folder = tempfile::tempdir().unwrap();
    for &kind in KINDS {
        if ["game", "tournament", "training", "sweep"].contains(&kind.name()) {
            continue; // Relative references would break in another folder.
        }
        for path in files(kind) {
            let text = std::fs::read_to_string(&path).unwrap();
            if text.contains("base = ") || text.contains("roles = ") {
                continue;
            }
            let copy = folder.path().join(path.file_name().unwrap());
            std::fs::write(&copy, text).unwrap();
            assert_eq!(
                scenario::check_file(KINDS, &copy),
                Ok(kind),
                "{}",
                path.display()
            );
        }
    }
}

#[test]
fn published_fields_come_out_where_they_were_sailed() {
    type Published = (&'static str, [(f64, f64); 2], &'static [(f64, f64)]);
    let table: [Published; 4] = [
        (
            "aquaticus_160x80",
            [(20.0, 40.0), (140.0, 40.0)],
            &[(0.0, 0.0), (0.0, 80.0), (160.0, 80.0), (160.0, 0.0)],
        ),
        (
            "popolopen_2025",
            [(194.71, 74.76), (235.75, 187.53)],
            &[
                (225.46, 42.29),
                (150.28, 69.65),
                (205.0, 220.0),
                (280.18, 192.64),
            ],
        ),
        // The fourth published corner is 0.3 m off; see the file.
        (
            "popolopen_2022",
            [(225.83, 79.67), (254.89, 154.21)],
            &[(246.00, 55.70), (194.76, 75.68), (234.72, 178.16)],
        ),
        (
            "jervis_bay_2023",
            [(76.4, 130.6), (14.59, 233.46)],
            &[
                (120.98, 134.05),
                (52.41, 92.85),
                (-30.0, 230.0),
                (38.57, 271.2),
            ],
        ),
    ];
    for (name, flags, corners) in table {
        let field = field(name);
        let published_m = 0.05;
        let pairs = flags
            .iter()
            .zip(field.flags.iter().map(|flag| flag.start))
            .chain(corners.iter().zip(field.corners));
        for ((x, y), got) in pairs {
            let apart_m = got.distance(Ned::from_xy(*x, *y));
            assert!(
                apart_m < published_m,
                "{name}: ({}, {}) is not ({x}, {y})",
                got.east,
                got.north
            );
        }
    }
    assert_eq!(field("harbour").plan.walls, Walls::AllRound);
    assert_eq!(field("harbour").plan.obstacles.len(), 5);
}

#[test]
fn every_rule_book_has_a_game_and_newcomers_begin_with_a_random_one() {
    let played: Vec<String> = files(Kind::GAME)
        .iter()
        .map(|path| scenario::load(path).unwrap().rules.name)
        .collect();
    for book in files(Kind::RULES) {
        assert!(
            played.contains(&stem(&book)),
            "no game is played by {}",
            book.display()
        );
    }
    let readme = std::fs::read_to_string(shipped("../README.md")).unwrap();
    let (_, rest) = readme.split_once("run scenarios/games/").unwrap();
    let first = rest.split_once(".toml").unwrap().0;
    assert!(
        game(first).is_random(),
        "{first} is the same game for every seed"
    );
    assert!(!game("pav01_vs_pav01").is_random());
}

#[test]
fn a_scenario_survives_json_exactly() {
    for path in files(Kind::GAME) {
        let before = scenario::load(&path).unwrap();
        let text = serde_json::to_string(&before).unwrap();
        let after: Scenario = serde_json::from_str(&text).unwrap();
        assert_eq!(before, after, "{}", path.display());
        assert_eq!(text, serde_json::to_string(&after).unwrap());
    }
}

#[test]
fn boats_without_a_start_position_lie_in_line_and_mirror_each_other() {
    let game = self::game("pav01_vs_pav01");
    let poses: Vec<_> = game
        .vehicles
        .iter()
        .map(|vehicle| match &vehicle.start_position {
            StartPosition::At(pose) => (
                pose.at.east,
                pose.at.north,
                pose.psi_rad.to_degrees().round(),
            ),
            StartPosition::Somewhere { .. } => panic!("{} has no place", vehicle.name),
        })
        .collect();
    let third_m = 80.0 / 3.0;
    let want = [
        (50.0, 80.0 - third_m, 90.0),
        (50.0, 80.0 - 2.0 * third_m, 90.0),
        (110.0, third_m, -90.0),
        (110.0, 2.0 * third_m, -90.0),
    ];
    assert_eq!(poses, want);
    let game = self::game("pav01_4v4");
    assert_eq!(game.vehicles.len(), 8);
    for i in 0..4 {
        let (StartPosition::At(blue), StartPosition::At(red)) = (
            &game.vehicles[i].start_position,
            &game.vehicles[4 + i].start_position,
        ) else {
            panic!("no places");
        };
        // A half turn about the middle of the field maps one team to the other.
        assert_eq!(
            (blue.at.east, blue.at.north),
            (160.0 - red.at.east, 80.0 - red.at.north),
            "{i}"
        );
    }
}

#[test]
fn a_scenario_knows_its_vehicles() {
    let game = game("attack_1v1");
    let red = game.vehicle_by_name("red_one").unwrap();
    assert_eq!((red, game.team_of(red)), (VehicleId(1), TeamId(1)));
    assert_eq!(game.vehicle_by_name("green_one"), None);
    assert_eq!(game.boat_of(red).name, "surveyor_m1_8");
    assert_eq!(game.strategy_of(red).name, "idle");
    assert_eq!(game.rules.time_limit.as_s(), 300.0);
    let swarm = self::game("swarm_500v500");
    assert_eq!(
        (
            swarm.vehicles.len(),
            swarm.boats.len(),
            swarm.strategies.len()
        ),
        (1000, 1, 1)
    );
    assert_eq!(swarm.vehicles[999].name, "red_500");
}

#[test]
fn boats_reach_the_speed_they_are_named_for() {
    for (name, want_m_s) in [("otter", 3.086), ("surveyor_m1_8", 3.0), ("heron", 2.0)] {
        let boat =
            scenario::load_file::<scenario::Boat>(&shipped(&format!("boats/{name}.toml"))).unwrap();
        let scenario::boat::Drive::Thrusters { thruster, .. } = &boat.drive else {
            panic!("{name} has no thrusters")
        };
        let thrust_newton = 2.0
            * match &thruster.curve {
                scenario::boat::ThrustCurve::Propeller(p) => {
                    p.k_ahead * p.n_max_rad_s * p.n_max_rad_s
                }
                scenario::boat::ThrustCurve::Table { points } => points.last().unwrap().1,
            };
        let a = boat.hull.surge_quadratic_kg_m;
        let b = boat.hull.surge_linear_kg_s;
        // The positive root of a u² + b u = T, in the form that also holds for a = 0.
        let u_m_s = 2.0 * thrust_newton / (b + (b * b + 4.0 * a * thrust_newton).sqrt());
        assert!((u_m_s - want_m_s).abs() < 0.01, "{name}: {u_m_s} m/s");
    }
}

#[test]
fn the_schemas_and_pages_beside_the_files_are_those_of_the_types() {
    let schema = |kind: &Kind| {
        let schema = serde_json::to_string_pretty(&scenario::schema(*kind)).unwrap();
        (format!("schema/{kind}.schema.json"), format!("{schema}\n"))
    };
    let pages = [
        ("REFERENCE.md", scenario::file_reference(KINDS)),
        ("strategies/REFERENCE.md", scenario::reference()),
    ];
    for (path, want) in KINDS
        .iter()
        .map(schema)
        .chain(pages.map(|(page, want)| (page.to_owned(), want)))
    {
        let path = shipped(&path);
        if std::env::var_os("SQUALL_BLESS").is_some() {
            std::fs::write(&path, &want).unwrap();
        }
        let found = std::fs::read_to_string(&path).unwrap_or_default();
        assert_eq!(
            found,
            want,
            "{} is behind: run this test with SQUALL_BLESS=1",
            path.display()
        );
    }
}

/// Every number with a range in a schema: its path in the file, its type, and the range.
fn ranges(at: &Value, path: &str, found: &mut Vec<(String, bool, [Value; 2])>) {
    for (key, about) in at["properties"].as_object().into_iter().flatten() {
        let path = format!("{path}{key}");
        ranges(about, &format!("{path}."), found);
        for about in [about, &about["anyOf"][0]] {
            if let (Some(low), Some(high)) = (about.get("minimum"), about.get("maximum")) {
                found.push((
                    path.clone(),
                    about["type"] == "integer",
                    [low.clone(), high.clone()],
                ));
            }
        }
    }
}

#[test]
fn a_number_beyond_the_range_of_its_schema_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let bases = [
        "games/pav01_vs_pav01",
        "fields/harbour",
        "rules/pyquaticus",
        "boats/otter",
        "seas/calm_salt",
        "strategies/easy_attacker",
        "tournaments/paper_2023",
        "gateways/surveyor",
    ];
    for (kind, base) in KINDS.iter().copied().zip(bases) {
        let schema = scenario::schema(kind);
        let mut found = vec![];
        ranges(&schema, "", &mut found);
        assert!(!found.is_empty(), "{kind}");
        for (path, is_whole, [low, high]) in found {
            let base = shipped(&format!("{base}.toml")).canonicalize().unwrap();
            let number = |bound: &Value| bound.as_f64().unwrap();
            for value in [number(&low) - 1.0, number(&high) + 1.0] {
                let value = match (is_whole, value > 1e18) {
                    (true, true) => continue, // TOML cannot represent such a large integer.
                    (true, false) => format!("{value:.0}"),
                    (false, _) => format!("{value:?}"),
                };
                let text = format!(
                    "base = {:?}\n{path} = {value}\n",
                    base.display().to_string()
                );
                let file = written(folder.path(), &format!("{}/x.toml", kind.folder()), &text);
                let problems = scenario::check_file(KINDS, &file).unwrap_err().to_string();
                let expected = format!("expected {} to {}", number(&low), number(&high));
                assert!(
                    is_whole || problems.contains(&expected),
                    "{kind} {path} = {value}: {problems}"
                );
            }
        }
    }
}

/// The values in lists, as strings; all numbers in the same format.
fn flat(value: &Value) -> Vec<String> {
    match value {
        Value::Array(values) => values.iter().flat_map(flat).collect(),
        value => vec![
            value
                .as_f64()
                .map_or(value.to_string(), |number| number.to_string()),
        ],
    }
}

/// Checks that a line of an example gives the default of its key, unless its comment says
/// otherwise.
fn assert_shows_defaults(schema: &Value, text: &str) {
    let mut table = schema;
    for line in text.lines() {
        let (said, comment) = line.split_once('#').unwrap_or((line, ""));
        if let Some(key) = said.trim().strip_prefix('[') {
            let about = &schema["properties"][key.trim_matches(['[', ']'])];
            table = about.get("items").unwrap_or(about);
        } else if let Some((key, value)) = said.split_once(" = ") {
            let default = &table["properties"][key]["default"];
            let is_other = ["example", "required", "default"]
                .iter()
                .any(|word| comment.contains(word));
            if !default.is_null() && !default.is_object() && !is_other {
                let shown: BTreeMap<String, Value> =
                    toml::from_str(&format!("x = {value}")).unwrap();
                assert_eq!(flat(&shown["x"]), flat(default), "{line}");
            }
        }
    }
}

/// The keys of a table and of all nested tables.
fn keys(schema: &Value) -> Vec<String> {
    match schema {
        Value::Object(object) => {
            let own = schema["properties"]
                .as_object()
                .into_iter()
                .flatten()
                .map(|(key, _)| key.clone());
            let inner = object.iter().filter(|(key, _)| *key != "definitions");
            own.chain(inner.flat_map(|(_, value)| keys(value)))
                .collect()
        }
        Value::Array(items) => items.iter().flat_map(keys).collect(),
        _ => vec![],
    }
}

/// A folder with the files that examples extend, and the model named by one of them.
fn folder_of_bases() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (from, to) in [
        ("strategies/safety.toml", "strategies/safety.toml"),
        ("strategies/policy.toml", "strategies/policy.toml"),
        ("strategies/options.toml", "strategies/options.toml"),
        (
            "strategies/medium_attacker.toml",
            "strategies/medium_attacker.toml",
        ),
        (
            "strategies/easy_attacker.toml",
            "strategies/easy_attacker.toml",
        ),
        (
            "../crates/onnx/tests/network/sb3_dynamo.onnx",
            "policies/learned.onnx",
        ),
    ] {
        std::fs::create_dir_all(folder.path().join(to).parent().unwrap()).unwrap();
        std::fs::copy(shipped(from), folder.path().join(to)).unwrap();
    }
    folder
}

#[test]
fn the_examples_of_every_key_are_sound_and_show_the_defaults() {
    let folder = folder_of_bases();
    let mut examples = vec![];
    for &kind in KINDS {
        let from = shipped("../tests/scenario_files/every_key").join(kind.folder());
        for entry in std::fs::read_dir(from).unwrap() {
            let path = entry.unwrap().path();
            let text = std::fs::read_to_string(&path).unwrap();
            let name = format!("{}/{}.toml", kind.folder(), stem(&path));
            examples.push((kind, written(folder.path(), &name, &text), text));
        }
    }
    // Join all contents for a kind: there are two kinds of boat.
    let mut texts = BTreeMap::<&str, String>::new();
    for (kind, path, text) in &examples {
        let checked =
            scenario::check_file(KINDS, path).unwrap_or_else(|problems| panic!("{problems}"));
        assert_eq!(checked, *kind, "{}", path.display());
        assert_shows_defaults(&scenario::schema(checked), text);
        texts.entry(checked.name()).or_default().push_str(text);
    }
    for &kind in KINDS {
        // Every key of the schema is shown.
        let schema = scenario::schema(kind);
        let text = &texts[kind.name()];
        for key in keys(&schema) {
            assert!(
                key == "base" || text.contains(&key),
                "{key} is not in the example of a {kind}"
            );
        }
    }
}

#[test]
fn the_examples_of_the_handbook_are_sound() {
    let handbook = std::fs::read_to_string(shipped("README.md")).unwrap();
    // The examples are written next to the shipped files that they name.
    let folder = tempfile::tempdir().unwrap();
    for path in KINDS.iter().flat_map(|kind| files(*kind)) {
        let text = std::fs::read_to_string(&path).unwrap();
        written(
            folder.path(),
            path.strip_prefix(shipped("")).unwrap().to_str().unwrap(),
            &text,
        );
    }
    let blocks = handbook
        .split("```toml\n")
        .skip(1)
        .map(|block| block.split("```").next().unwrap());
    let named = blocks.filter_map(|text| Some((text.lines().next()?.strip_prefix("# ")?, text)));
    let paths: Vec<PathBuf> = named
        .map(|(name, text)| written(folder.path(), name, text))
        .collect();
    assert!(!paths.is_empty());
    for path in paths {
        scenario::check_file(KINDS, &path).unwrap_or_else(|problems| panic!("{problems}"));
    }
}
