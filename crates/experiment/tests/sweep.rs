//! A sweep in a folder, complete or interrupted and resumed, on any number of threads. Errors are
//! reported before any game.

use experiment::sweep::Sweep;
use experiment::sweep::{self, Plan, Study, StudyError};
use scenario::{Overrides, load_file, load_with};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

fn shipped(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../scenarios")
        .join(file)
        .canonicalize()
        .expect("it can be")
}

/// A sweep of two entries over two axes with short games, plus `more` lines.
fn text(more: &str) -> String {
    let [game, two, easy, pav01] = [
        "games/surveyor_2v2.toml",
        "strategies/strategy_2.toml",
        "strategies/easy_attackers.toml",
        "strategies/pav01.toml",
    ]
    .map(shipped);
    format!(
        "game = {game:?}\nopponent = {pav01:?}\ngames = 4\nseed = 5\n[[entry]]\nname = \"two\"\nstrategy = {two:?}\n\
         [[entry]]\nname = \"easy\"\nstrategy = {easy:?}\n[[axis]]\nkey = \"game.duration_s\"\nvalues = [30]\n{more}"
    )
}

const WIND: &str = "[[axis]]\nkey = \"sea.wind.speed_m_s\"\nrange = [1, 9]\ncount = 3\n";

fn plan_of(folder: &Path, text: &str) -> Plan {
    let path = folder.join("tried.toml");
    std::fs::write(&path, text).expect("it can be");
    Plan::new(&load_file::<Sweep>(&path).unwrap_or_else(|problems| panic!("{problems}")))
        .expect("it can be")
}

/// Plays a study from its current game up to, but not including, `to`.
fn go_on(study: &mut Study, plan: &Plan, to: usize, jobs: usize) {
    let from = study.done();
    let jobs = NonZeroUsize::new(jobs).expect("it can be");
    sweep::play(plan, (from, to), jobs, &AtomicBool::new(false), |played| {
        study.add(plan, &played)
    })
    .expect("it can be");
}

/// Every file of a study.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<(String, Vec<u8>)> = std::fs::read_dir(folder)
        .expect("it can be")
        .map(|entry| entry.expect("it can be"))
        .map(|entry| {
            (
                entry.file_name().into_string().expect("it can be"),
                std::fs::read(entry.path()).expect("it can be"),
            )
        })
        .collect();
    files.sort();
    files
}

#[test]
fn a_study_that_was_cut_anywhere_and_taken_up_again_is_the_same_bytes_on_any_number_of_threads() {
    let dir = tempfile::tempdir().unwrap();
    let plan = plan_of(dir.path(), &text(WIND));
    assert_eq!((plan.points().len(), plan.games()), (3, 24));
    let whole = dir.path().join("whole");
    let mut study = Study::begin(&whole, &plan).unwrap();
    go_on(&mut study, &plan, 24, 2);
    study.report(&plan).unwrap();
    let want = files(&whole);
    let names: Vec<&str> = want.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names,
        [
            "boats.csv",
            "games.csv",
            "games.parquet",
            "plan.json",
            "plan.txt",
            "report.json",
            "sums.txt"
        ]
    );
    let packed = serde_json::from_slice(&want[3].1).expect("a packed plan");
    assert_eq!(
        Plan::unpack(packed).expect("it is this version's").digest(),
        plan.digest()
    );

    // Any number of bytes may be missing from the last line of either table, and from lines before
    // it.
    let cut = dir.path().join("cut");
    for (games, boats) in [(0, 0), (1, 0), (40, 0), (0, 1), (0, 700), (900, 100)] {
        let _ = std::fs::remove_dir_all(&cut);
        let mut study = Study::begin(&cut, &plan).unwrap();
        go_on(&mut study, &plan, 11, 1);
        drop(study);
        for (name, bytes) in [("games.csv", games), ("boats.csv", boats)] {
            let path = cut.join(name);
            let length = std::fs::metadata(&path).unwrap().len();
            std::fs::OpenOptions::new()
                .write(true)
                .open(&path)
                .unwrap()
                .set_len(length - bytes)
                .unwrap();
        }
        let mut study = Study::resume(&cut, &plan).unwrap();
        assert_eq!(
            study.done() < 11,
            games + boats > 0,
            "{games} {boats}: {}",
            study.done()
        );
        go_on(&mut study, &plan, 24, 3);
        study.report(&plan).unwrap();
        assert!(
            files(&cut) == want,
            "truncated by {games} and {boats} bytes"
        );
    }

    // A full disk leaves files empty or missing, and any digit may change.
    let lines = |name: &str| {
        std::fs::read_to_string(whole.join(name))
            .unwrap()
            .lines()
            .count()
    };
    for name in ["games.csv", "boats.csv", "sums.txt", "plan.json"] {
        for damage in ["empty", "none", "a digit", "no head"] {
            let path = cut.join(name);
            let text = std::fs::read_to_string(&path).unwrap();
            let digit = text.rfind(|c: char| c.is_ascii_digit()).unwrap();
            let other = if &text[digit..=digit] == "1" {
                "2"
            } else {
                "1"
            };
            match damage {
                "empty" => std::fs::write(&path, "").unwrap(),
                "none" => std::fs::remove_file(&path).unwrap(),
                "a digit" => std::fs::write(
                    &path,
                    format!("{}{other}{}", &text[..digit], &text[digit + 1..]),
                )
                .unwrap(),
                _ => std::fs::write(&path, text.split_once('\n').unwrap().1).unwrap(),
            }
            let mut study = Study::resume(&cut, &plan).unwrap();
            let done = match (name, damage) {
                ("plan.json", _) => 24,
                (_, "a digit") => 23,
                _ => 0,
            };
            assert_eq!(study.done(), done, "{name}: {damage}");
            go_on(&mut study, &plan, 24, 3);
            study.report(&plan).unwrap();
            assert!(files(&cut) == want, "{name}: {damage}");
        }
    }
    assert_eq!(lines("sums.txt"), 24);
}

#[test]
fn a_game_of_the_report_is_the_one_that_its_command_plays() {
    let dir = tempfile::tempdir().unwrap();
    let plan = plan_of(dir.path(), &text(WIND));
    let job = plan.job(22);
    let mut played = None;
    sweep::play(
        &plan,
        (22, 23),
        NonZeroUsize::MIN,
        &AtomicBool::new(false),
        |one| {
            played = Some(one.row);
            Ok::<(), StudyError>(())
        },
    )
    .unwrap();
    let played = played.expect("a game");
    assert_eq!((job.point, job.entry, job.seed, job.side), (2, 1, 6, 0));
    let command = plan.command(&job);
    // These words in parsed form: the same files, values and seed.
    let setting = |key: &str, value: &str| format!("--set '{key}={value}'");
    for part in [
        setting("sea.wind.speed_m_s", "9"),
        setting("game.duration_s", "30"),
        "--seed 6".to_owned(),
    ] {
        assert!(command.contains(&part), "{command}");
    }
    assert!(
        command.starts_with("squall run surveyor_2v2 --blue easy_attackers --red pav01 --set"),
        "{command}"
    );
    let settings = ["game.duration_s=30", "sea.wind.speed_m_s=9"];
    let overrides = Overrides {
        settings: settings
            .map(|text| scenario::Setting::parse(text).unwrap())
            .to_vec(),
        strategies: [
            ("blue", "strategies/easy_attackers.toml"),
            ("red", "strategies/pav01.toml"),
        ]
        .map(|(team, file)| (team.to_owned(), shipped(file)))
        .into(),
        ..Overrides::default()
    };
    let scenario = load_with(&shipped("games/surveyor_2v2.toml"), &overrides)
        .unwrap()
        .of_seed(6)
        .unwrap();
    let outcome = arena::play(&scenario, agent::minds_of(&scenario), 6).unwrap();
    assert_eq!(outcome.digest, played.digest);
    let score = played.result.unwrap().of("score");
    assert_eq!(score, f64::from(outcome.score.teams["blue"]));
}

#[test]
fn all_points_play_the_same_seeds_and_designs_cover_the_space() {
    let dir = tempfile::tempdir().unwrap();
    let two = format!("{WIND}[[axis]]\nkey = \"boat.gps.noise_m\"\nvalues = [0.1, 1, 4]\n");
    let grid = plan_of(dir.path(), &text(&two));
    assert_eq!(grid.points().len(), 9);
    let seeds = |point: usize| {
        (0..8)
            .map(|i| grid.job(8 * point + i).seed)
            .collect::<Vec<u64>>()
    };
    assert_eq!(seeds(0), [5, 5, 5, 5, 6, 6, 6, 6]);
    assert_eq!(seeds(8), seeds(0));
    let with = |design: &str| {
        plan_of(
            dir.path(),
            &format!("design = {design:?}\npoints = 30\n{}", text(&two)),
        )
    };
    let winds = |plan: &Plan| {
        plan.points()
            .iter()
            .map(|point| point[1].number().unwrap())
            .collect::<Vec<f64>>()
    };
    let one = with("one_at_a_time");
    // The nominal point (wind 5, noise 1), two more winds and two more noises.
    assert_eq!(one.points().len(), 5);
    assert_eq!(winds(&one), [5.0, 1.0, 9.0, 5.0, 5.0]);
    for design in ["latin_hypercube", "sobol"] {
        let mut winds = winds(&with(design));
        winds.sort_by(f64::total_cmp);
        // One value in each of 30 intervals of a Latin hypercube; a Sobol sequence is about as
        // even.
        let piece = |wind: &f64| ((wind - 1.0) / 8.0 * 30.0) as usize;
        let spare = if design == "sobol" { 2 } else { 0 };
        for (i, wind) in winds.iter().enumerate() {
            assert!(piece(wind).abs_diff(i) <= spare, "{design}: {winds:?}");
        }
    }
}

#[test]
#[cfg(unix)]
fn a_named_pipe_in_place_of_a_table_is_refused_and_not_waited_for() {
    let dir = tempfile::tempdir().unwrap();
    let plan = plan_of(dir.path(), &text(WIND));
    let folder = dir.path().join("study");
    for name in ["games.csv", "boats.csv", "sums.txt", "plan.txt"] {
        drop(Study::begin(&folder, &plan).unwrap());
        std::fs::remove_file(folder.join(name)).unwrap();
        assert!(
            std::process::Command::new("mkfifo")
                .arg(folder.join(name))
                .status()
                .unwrap()
                .success()
        );
        let why = Study::resume(&folder, &plan).err().expect(name).to_string();
        assert!(
            why.contains(name) && why.contains("it is not a file"),
            "{why}"
        );
        std::fs::remove_dir_all(&folder).unwrap();
    }
    for name in ["report.json", "games.parquet"] {
        let study = Study::begin(&folder, &plan).unwrap();
        assert!(
            std::process::Command::new("mkfifo")
                .arg(folder.join(name))
                .status()
                .unwrap()
                .success()
        );
        let why = study.report(&plan).expect_err(name).to_string();
        assert!(
            why.contains(name) && why.contains("it is a pipe without a reader"),
            "{why}"
        );
        std::fs::remove_dir_all(&folder).unwrap();
    }
}

#[test]
fn what_is_wrong_is_said_before_a_game_with_its_place() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("wrong.toml");
    for (axis, want) in [
        (
            "key = \"sea.wind.speed_m_s\"\nrange = [1, 900]",
            "wrong.toml:15:24: speed_m_s is 900, expected 0 to",
        ),
        (
            "key = \"sea.winds.speed_m_s\"\nvalues = [1]",
            "winds is unknown",
        ),
        (
            "key = \"weather.wind\"\nvalues = [1]",
            "wrong.toml:15:7: key is \"weather.wind\", expected sea, boat",
        ),
        (
            "key = \"sea\"\nvalues = [\"nonesuch.toml\"]",
            "nonesuch.toml",
        ),
        (
            "key = \"sea\"\nrange = [0, 1]",
            "sea has no values, expected files",
        ),
        (
            "key = \"boat.gps.noise_m\"\nnormal = [1, 0.5]",
            "noise_m is -0.5, expected 0 to",
        ),
        (
            "key = \"boat.gps.noise_m\"",
            "has none, expected one of values, range, normal, log_normal",
        ),
        (
            "key = \"boat.gps.noise_m\"\nvalues = [1, \"two\"]",
            "different types",
        ),
        (
            "key = \"boat.gps.noise_m\"\nrange = [0, 1]\nlog = true",
            "expected more than 0 with log",
        ),
        (
            "key = \"game.duration_s\"\nvalues = [40]",
            "the key \"game.duration_s\" is used twice",
        ),
    ] {
        std::fs::write(&path, text(&format!("[[axis]]\n{axis}\n"))).unwrap();
        let said = load_file::<Sweep>(&path)
            .and_then(|sweep| Plan::new(&sweep).map(drop))
            .expect_err(axis)
            .to_string();
        assert!(said.contains(want), "{axis}: {said}");
    }
}

#[test]
fn a_folder_keeps_one_sweep_and_says_so() {
    let dir = tempfile::tempdir().unwrap();
    let plan = plan_of(dir.path(), &text(WIND));
    let folder = dir.path().join("out");
    assert!(matches!(
        Study::resume(&folder, &plan),
        Err(StudyError::Missing { .. })
    ));
    let mut study = Study::begin(&folder, &plan).unwrap();
    go_on(&mut study, &plan, 2, 1);
    assert!(matches!(
        Study::begin(&folder, &plan),
        Err(StudyError::Exists { games: 2, .. })
    ));
    let other = plan_of(dir.path(), &text(WIND).replace("[1, 9]", "[1, 8]"));
    assert!(matches!(
        Study::resume(&folder, &other),
        Err(StudyError::Other { .. })
    ));
}
