//! Scenario files of every kind (TOML): a line with the folder of that kind, then the file. Bases
//! and references are files in the tree.

use super::{Target, check_shown, mutations};
use crate::played::scenarios;
use experiment::sweep::Sweep;
use experiment::tournament::Tournament;
use gateway::bridge::{Bridge, Plan, Preflight, Site};
use gateway::config::Gateway;
use primitives::VehicleId;
use scenario::{Kind, Problems, Scenario};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use tempfile::TempDir;

/// Generous limits: an accepted game, which may have eighty boats, is also played briefly.
pub(super) const TARGET: Target = Target {
    name: "scenario",
    seeds,
    change: mutations,
    check,
    allocated_max: (1 << 30, 10_000),
};

const KINDS: &[Kind] = &[
    Kind::GAME,
    Kind::FIELD,
    Kind::RULES,
    Kind::BOAT,
    Kind::SEA,
    Kind::STRATEGY,
    Kind::of::<Tournament>(),
    Kind::of::<Gateway>(),
    Kind::of::<learn::rewards::Rewards>(),
    Kind::of::<learn::training::Training>(),
    Kind::of::<Sweep>(),
];

/// A copy of the files in the tree, to which each input is added.
static FOLDER: LazyLock<TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a folder");
    for (path, text) in files() {
        let path = folder.path().join(path);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        std::fs::write(path, text).expect("a file");
    }
    folder
});

/// The files in the tree, by folder and name.
fn files() -> Vec<(PathBuf, Vec<u8>)> {
    let in_folder = |kind: Kind| {
        let folder = std::fs::read_dir(scenarios().join(kind.folder())).expect("the folder exists");
        let mut paths: Vec<PathBuf> = folder.map(|entry| entry.expect("a file").path()).collect();
        paths.retain(|path| {
            path.extension()
                .is_some_and(|extension| extension == "toml")
        });
        paths.sort();
        paths.into_iter().map(move |path| {
            let text = std::fs::read(&path).expect("a file");
            (
                Path::new(kind.folder()).join(path.file_name().expect("a name")),
                text,
            )
        })
    };
    KINDS.iter().copied().flat_map(in_folder).collect()
}

fn seeds() -> Vec<Vec<u8>> {
    let broken = include_str!("../../../../tests/scenario_files/hostile_values.txt");
    // A game of a thousand boats takes as long as all the others together.
    let files = files()
        .into_iter()
        .filter(|(path, _)| !path.ends_with("swarm_500v500.toml"));
    let seed = |(path, text): (PathBuf, Vec<u8>)| {
        let folder = path.parent().expect("a folder").display().to_string();
        [folder.as_bytes(), b"\n", &text].concat()
    };
    files
        .map(seed)
        .chain([
            format!("strategies\n# {broken}").into_bytes(),
            wide_sweep().into_bytes(),
        ])
        .collect()
}

/// A short sweep file that describes three thousand games.
fn wide_sweep() -> String {
    let axis = |key: &str, range: &str| {
        format!("[[axis]]\nkey = \"{key}\"\nrange = {range}\ncount = 1000\n")
    };
    [
        "sweeps\ngame = \"../games/surveyor_2v2.toml\"\nopponent = \"../strategies/strategy_3.toml\"\n".to_owned(),
        "[[entry]]\nname = \"strategy_4\"\nstrategy = \"../strategies/strategy_4.toml\"\n".to_owned(),
        axis("sea.wind.speed_m_s", "[1, 16]"),
        axis("sea.waves.hs_m", "[0.1, 1]"),
        axis("strategy.behaviour.avoid_boats.weight", "[50, 200]"),
    ]
    .concat()
}

fn check(bytes: &[u8]) {
    let end = bytes.iter().position(|byte| *byte == b'\n').unwrap_or(0);
    let (first, text) = bytes.split_at(end);
    let kind = KINDS
        .iter()
        .copied()
        .find(|kind| kind.folder().as_bytes() == first);
    let folder = FOLDER.path().join(kind.map_or("games", Kind::folder));
    let path = folder.join("fuzzed.toml");
    std::fs::write(&path, text.get(1..).unwrap_or_default()).expect("a file");
    match scenario::check_file(KINDS, &path) {
        Ok(kind) => accepted(kind, &path),
        Err(problems) => refused(&problems),
    }
}

/// Every problem refers to a place in an existing file and can be displayed.
fn refused(problems: &Problems) {
    assert!(!problems.0.is_empty());
    for problem in &problems.0 {
        assert!(
            problem.path.starts_with(FOLDER.path()),
            "{}",
            problem.path.display()
        );
        let bytes = std::fs::read(&problem.path).unwrap_or_default();
        let lines = bytes.iter().filter(|byte| **byte == b'\n').count() + 1;
        assert!(
            (1..=lines).contains(&problem.line) && problem.column > 0,
            "{problem}"
        );
        check_shown(problem);
    }
}

/// An accepted file can be used.
fn accepted(kind: Kind, path: &Path) {
    match kind.name() {
        "game" => playable(&scenario::load(path).expect("the file was accepted")),
        "strategy" => {
            let strategy = scenario::load_file::<scenario::strategy::Strategy>(path)
                .expect("the file was accepted");
            let json = serde_json::to_string(&strategy).expect("JSON");
            assert_eq!(
                serde_json::from_str::<scenario::strategy::Strategy>(&json).expect("JSON"),
                strategy
            );
            for role in &strategy.roles {
                let conditions = role.modes.iter().filter_map(|mode| mode.when.as_ref());
                conditions
                    .for_each(|condition| assert!(!role.condition_text(condition).is_empty()));
            }
        }
        "gateway" => {
            let gateway = scenario::load_file::<Gateway>(path).expect("the file was accepted");
            let field =
                scenario::load_file::<rules::Field>(&scenarios().join("fields/open_800x400.toml"))
                    .expect("a field");
            let vehicle = "blue_one".to_owned();
            let site = Some(Site {
                field,
                length_m: 2.0,
                declination_rad: 0.1,
                coasting: None,
            });
            let plan = Plan {
                vehicle,
                gateway,
                site,
                arms_itself: false,
                dry_run: false,
                preflight: Preflight::NotRequired,
            };
            drop(Bridge::new(plan));
        }
        "tournament" => {
            let tournament =
                scenario::load_file::<Tournament>(path).expect("the file was accepted");
            if let Err(problems) = experiment::tournament::Plan::new(&tournament) {
                check_shown(&problems);
            }
        }
        "sweep" => drop(scenario::load_file::<Sweep>(path).expect("the file was accepted")),
        _ => {}
    }
}

/// An accepted game can be sent unchanged, and either starts or reports why not. Minds can play it.
fn playable(scenario: &Scenario) {
    let json = serde_json::to_string(scenario).expect("JSON");
    assert_eq!(
        serde_json::from_str::<Scenario>(&json).expect("JSON"),
        *scenario,
        "the game changes in transit"
    );
    assert_eq!(scenario.check_received(), Ok(()));
    if scenario.vehicles.len() > 40 {
        return;
    }
    let mut contest = match sim::Contest::new(scenario, scenario.seed) {
        Ok(contest) => contest,
        Err(error) => return check_shown(&error),
    };
    let mut runner = arena::runner_of(agent::minds_of(contest.scenario()));
    for _ in 0..2 {
        arena::decide(&mut contest, &mut runner);
        contest.advance();
    }
    let frame = contest.frame(&mut rules::event::EventCursor::default());
    for (i, truth) in frame.vehicles.iter().enumerate() {
        let name = &scenario.vehicles[VehicleId::at(i).index()].name;
        assert!(
            truth.nav.north_m.is_finite() && truth.nav.east_m.is_finite(),
            "{name} is at {:?}",
            truth.nav
        );
    }
}
