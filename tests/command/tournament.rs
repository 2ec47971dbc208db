//! `squall tournament` and strategies, from the command line.

use crate::program::{command, only_file, printed, project, scenario, squall, words};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

const GAME: &str = "scenarios/games/pav01_vs_pav01.toml";
const SEA: &str = "scenarios/seas/moderate_breeze.toml";
const TOURNAMENT: &str = "scenarios/tournaments/simple.toml";

/// Runs the program in the project folder to its end.
pub(crate) fn output(args: &[&str]) -> Output {
    squall(project(), args)
}

/// A path in a temporary folder, as an argument.
pub(crate) fn place(dir: &TempDir, name: &str) -> String {
    dir.path().join(name).display().to_string()
}

pub(crate) fn json(path: &str) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Runs a tournament of the shipped strategies in short games.
fn short_tournament(dir: &TempDir, more: &str) -> String {
    let scenarios = project().join("scenarios");
    let game = format!(
        "base = {:?}\nduration_s = 60\n",
        scenarios.join("games/pav01_vs_pav01.toml")
    );
    std::fs::write(dir.path().join("short.toml"), game).unwrap();
    let base = scenarios.join("tournaments/simple.toml");
    let path = place(dir, "tournament.toml");
    std::fs::write(
        &path,
        format!("base = {base:?}\ngame = \"short.toml\"\n{more}\n"),
    )
    .unwrap();
    path
}

/// Like [`short_tournament`], with these settings and with entries by name and strategy.
pub(crate) fn tournament_of(dir: &TempDir, settings: &str, entries: &[(&str, &str)]) -> String {
    let path = short_tournament(dir, "");
    let entry = |(name, file): &(&str, &str)| {
        let strategy = scenario(&format!("strategies/{file}.toml"));
        format!("[[entry]]\nname = {name:?}\nstrategy = {strategy:?}\n")
    };
    let entries: String = entries.iter().map(entry).collect();
    let sea = project().join(SEA);
    std::fs::write(
        &path,
        format!("game = \"short.toml\"\nsea = {sea:?}\n{settings}\n{entries}"),
    )
    .unwrap();
    path
}

fn keys(value: &Value) -> Vec<&str> {
    let mut keys: Vec<&str> = value
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect();
    keys.sort_unstable();
    keys
}

#[test]
fn a_game_of_a_tournament_is_played_again_by_run_byte_for_byte() {
    let dir = tempfile::tempdir().unwrap();
    let report = place(&dir, "report.json");
    let result = place(&dir, "result.json");
    let how = format!("tournament {TOURNAMENT} --games 2 --seed 11 --jobs 2 --json {report}");
    let text = printed(project(), &words(&how));
    let how =
        "squall run pav01_vs_pav01 --sea moderate_breeze --blue A --red B --seed 11 --in-process";
    assert!(
        text.contains(how) && text.contains("too few for confidence intervals"),
        "{text}"
    );
    assert_eq!(text.matches("too few seeds").count(), 3, "{text}");

    let report = json(&report);
    let matches = report["matches"].as_array().unwrap();
    assert_eq!(matches.len(), 6, "three pairings, both sides, one seed");
    let strategy = |name: &Value| {
        let row = report["entries"]
            .as_array()
            .unwrap()
            .iter()
            .find(|row| row["name"] == *name)
            .unwrap();
        row["strategy"].as_str().unwrap().to_owned()
    };
    for game in matches {
        let blue = strategy(&game["blue"]);
        let red = strategy(&game["red"]);
        let seed = game["seed"].to_string();
        let how = format!(
            "--sea {SEA} --blue {blue} --red {red} --seed {seed} --in-process --json {result}"
        );
        printed(project(), &words(&format!("run {GAME} --no-record {how}")));
        let played = json(&result);
        assert_eq!(played["digest"], game["digest"], "{game}");
        assert_eq!(played["score"]["teams"]["blue"], game["score"][0], "{game}");
        assert_eq!(played["score"]["teams"]["red"], game["score"][1], "{game}");
    }
}

#[test]
fn a_challenger_is_told_against_whom_it_won_how_many_of_the_decided_games() {
    let dir = tempfile::tempdir().unwrap();
    let tournament = short_tournament(&dir, "challenger = \"pav01\"");
    let path = place(&dir, "report.json");
    let text = printed(
        project(),
        &["tournament", &tournament, "--games", "10", "--json", &path],
    );
    let report = json(&path);
    let cells: Vec<&Value> = report["matrix"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|cell| cell["row"] == "pav01")
        .collect();
    assert_eq!((cells.len(), &report["challenger"]), (2, &"pav01".into()));
    for cell in cells {
        let line = text
            .lines()
            .rfind(|line| line.starts_with(cell["column"].as_str().unwrap()))
            .unwrap();
        let numbers: Vec<&str> = line.split_whitespace().skip(1).take(3).collect();
        assert_eq!(
            numbers,
            ["wins", "draws", "losses"].map(|of| cell[of].to_string()),
            "{text}"
        );
        assert!(
            line.contains(if cell["won_of_decided"].is_null() {
                " - "
            } else {
                " % ("
            }),
            "{text}"
        );
    }
}

#[test]
fn the_report_has_every_number_and_is_the_same_on_one_thread_and_on_four() {
    let dir = tempfile::tempdir().unwrap();
    let tournament = short_tournament(&dir, "self_play = true");
    let path = place(&dir, "report.json");
    let table = place(&dir, "table.csv");
    let play = |jobs: &str| {
        let how =
            format!("tournament {tournament} --games 10 --jobs {jobs} --json {path} --csv {table}");
        let text = printed(project(), &words(&how));
        let mut report = json(&path);
        assert!(report["rate"].as_f64().unwrap() > 0.0);
        report["rate"] = Value::Null;
        (text, report, std::fs::read_to_string(&table).unwrap())
    };
    let (text, report, csv) = play("1");
    assert_eq!(
        (&text, &report, &csv),
        (&play("4").0, &play("4").1, &play("4").2)
    );

    let wanted = "challenger commit cycles entries failures game games_left_out games_per_pairing \
                  games_unplayed history matches matrix plan rate sea seas seed seeds_counted teams tournament version";
    assert_eq!(keys(&report).join(" "), wanted);
    assert_eq!(
        (&report["tournament"], &report["seed"]),
        (&"tournament".into(), &1.into())
    );
    assert_eq!(
        (&report["games_per_pairing"], &report["seeds_counted"]),
        (&10.into(), &5.into())
    );
    let commit = report["commit"].as_str().unwrap();
    let hash = commit.trim_end_matches("-dirty");
    assert!(
        commit == "unknown" || hash.len() == 12 && hash.chars().all(|c| c.is_ascii_hexdigit()),
        "{commit}"
    );
    assert!(printed(project(), &["--version"]).contains(commit));

    let entries = report["entries"].as_array().unwrap();
    let ratings: Vec<f64> = entries
        .iter()
        .map(|row| row["rating"]["elo"].as_f64().unwrap())
        .collect();
    assert!(
        ratings.len() == 3 && ratings.is_sorted_by(|a, b| a >= b),
        "{ratings:?}"
    );
    for row in entries {
        assert_eq!(
            row["games"], 30,
            "five seeds, two sides, three opponents including itself"
        );
        for key in [
            "score",
            "grabs",
            "captures",
            "tags",
            "tagged",
            "out_of_bounds",
            "collisions",
        ] {
            let [low, mean, high] =
                ["low", "mean", "high"].map(|of| row[key][of].as_f64().unwrap());
            assert!(
                low <= mean && mean <= high && ((low + high) / 2.0 - mean).abs() < 1e-9,
                "{key}: {row}"
            );
        }
        assert_eq!(
            ["wins", "draws", "losses"]
                .map(|of| row[of].as_u64().unwrap())
                .iter()
                .sum::<u64>(),
            30
        );
    }
    let matrix = report["matrix"].as_array().unwrap();
    assert_eq!(matrix.len(), 9);
    let of_cell = [
        "column",
        "draws",
        "games",
        "losses",
        "row",
        "score",
        "score_difference",
        "seeds",
        "share",
        "wins",
        "won_of_decided",
    ];
    assert_eq!(keys(&matrix[0]), of_cell);
    assert_eq!(
        matrix[0]["seeds"],
        serde_json::json!({ "first": 1, "last": 5 })
    );
    check_table(&csv, &text, entries);
}

/// Checks the table of entries, as a file and on the terminal.
fn check_table(csv: &str, text: &str, entries: &[Value]) {
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!((lines.len(), lines[0].len()), (4, 6 + 7 * 3), "{csv}");
    assert!(
        csv.starts_with("name,strategy,games,wins,draws,losses,score,score_low,score_high,grabs,"),
        "{csv}"
    );
    for (line, row) in lines[1..].iter().zip(entries) {
        assert_eq!((line.len(), line[0]), (27, row["name"].as_str().unwrap()));
        assert_eq!(
            line[6].parse::<f64>().unwrap(),
            row["score"]["mean"].as_f64().unwrap()
        );
        assert!(
            text.contains(&format!("{:.2} ± ", row["score"]["mean"].as_f64().unwrap())),
            "{text}"
        );
    }
}

#[test]
fn the_quality_of_a_tournament_is_that_of_its_recorded_games() {
    let dir = tempfile::tempdir().unwrap();
    let settings = "games = 2\nseed = 5\nself_play = false";
    let tournament = tournament_of(
        &dir,
        settings,
        &[("strategy_4", "strategy_4"), ("pav01", "pav01")],
    );
    let game = place(&dir, "short.toml");
    let report = place(&dir, "report.json");
    let quality = place(&dir, "quality.json");
    let said = printed(
        project(),
        &[
            "tournament",
            &tournament,
            "--quality",
            "--jobs",
            "2",
            "--json",
            &report,
        ],
    );

    let mut recordings = vec![];
    for (i, sides) in [["strategy_4", "pav01"], ["pav01", "strategy_4"]]
        .into_iter()
        .enumerate()
    {
        let runs = place(&dir, &format!("runs{i}"));
        let [blue, red] = sides;
        let how =
            format!("--sea {SEA} --blue {blue} --red {red} --seed 5 --in-process --record {runs}");
        printed(project(), &words(&format!("run {game} {how}")));
        recordings.push(only_file(&runs));
    }
    let told = printed(
        project(),
        &[
            "log",
            &recordings[0],
            &recordings[1],
            "--quality",
            "--json",
            &quality,
        ],
    );
    assert!(
        said.ends_with(&told) && told.starts_with("quality of play in 2 games"),
        "{said}\n{told}"
    );
    let quality = json(&quality);
    assert_eq!(json(&report)["quality"], quality);
    let roles = &quality["strategies"]["pav01"]["roles"];
    assert!(
        roles["easy_defender"]["modes"]["defending"]["time_s"]
            .as_f64()
            .unwrap()
            > 60.0,
        "{quality}"
    );
    assert!(
        roles["unknown"].is_null() && quality["strategies"]["strategy_4"]["teams"] == 2,
        "{quality}"
    );
}

#[test]
fn an_odd_number_of_games_is_rounded_up_with_a_note() {
    let dir = tempfile::tempdir().unwrap();
    let tournament = short_tournament(&dir, "games = 5\nseed = 9");
    let report = place(&dir, "report.json");
    let output = output(&["tournament", &tournament, "--json", &report]);
    let note = String::from_utf8(output.stderr).unwrap();
    assert!(
        output.status.success() && note.contains("rounding 5 games per pairing up to 6"),
        "{note}"
    );
    assert!(
        note.contains("18 games in") && note.contains("games/s"),
        "{note}"
    );
    let report = json(&report);
    assert_eq!(
        (&report["games_per_pairing"], &report["matrix"][0]["games"]),
        (&6.into(), &6.into())
    );
    assert_eq!(
        report["matrix"][0]["seeds"],
        serde_json::json!({ "first": 9, "last": 11 })
    );
}

#[test]
fn games_that_cannot_start_are_explained() {
    let dir = tempfile::tempdir().unwrap();
    short_tournament(&dir, "");
    let crowd = place(&dir, "crowd.toml");
    // Two boats occupy the area in which a third must keep clear of them.
    let game = "[[vehicle]]\nname = \"a\"\nteam = \"blue\"\nat = [20.5, 50]\n\
                [[vehicle]]\nname = \"b\"\nteam = \"blue\"\nat = [22.4, 50]\n\
                [[fleet]]\nteam = \"red\"\ncount = 1\n\
                spawn = { along_m = [137.1, 140.0], across_m = [48.5, 51.5], gap_m = 2 }\n";
    std::fs::write(
        dir.path().join("full.toml"),
        format!("base = \"short.toml\"\n{game}"),
    )
    .unwrap();
    std::fs::write(&crowd, "base = \"tournament.toml\"\ngame = \"full.toml\"\n").unwrap();
    let output = output(&["tournament", &crowd, "--games", "2"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(
        text.contains("6 games could not start")
            && text.contains("no free start position for red_1"),
        "{text}"
    );
}

#[test]
fn an_interrupted_tournament_tells_what_was_finished() {
    let dir = tempfile::tempdir().unwrap();
    let tournament = short_tournament(&dir, "");
    let mut command = command(
        project(),
        &[
            "tournament",
            &tournament,
            "--games",
            "1000000",
            "--jobs",
            "2",
        ],
    );
    let mut process = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut error = BufReader::new(process.stderr.take().unwrap());
    let mut line = String::new();
    error.read_line(&mut line).unwrap();
    assert_eq!(line, "3000000 games to play\n");
    let killed = Command::new("kill")
        .args(["-INT", &process.id().to_string()])
        .status()
        .unwrap();
    assert!(killed.success());
    let mut text = String::new();
    process
        .stdout
        .take()
        .unwrap()
        .read_to_string(&mut text)
        .unwrap();
    assert_eq!(process.wait().unwrap().code(), Some(130), "{text}");
    assert!(
        text.contains("CUT SHORT: ") && text.contains(" games were not played"),
        "{text}"
    );
    assert!(text.contains("tournament: "), "{text}");
}

#[test]
fn run_gives_teams_other_strategies_in_one_process_and_across_processes() {
    let dir = tempfile::tempdir().unwrap();
    let result = place(&dir, "result.json");
    let game = "scenarios/games/attack_1v1.toml";
    let digest = |args: &[&str]| {
        printed(
            project(),
            &[&["run", game, "--no-record"], args, &["--json", &result]].concat(),
        );
        json(&result)["digest"].as_str().unwrap().to_owned()
    };
    let path = "scenarios/strategies/easy_defenders.toml";
    let own = digest(&["--in-process"]);
    let other = digest(&["--red", path, "--in-process"]);
    assert_ne!(own, other);
    for args in [
        &["--red", "easy_defenders", "--in-process"][..],
        &[
            "--strategy",
            "red=easy_defenders",
            "--strategy",
            "blue=easy_attackers",
            "--in-process",
        ],
        &["--red", "easy_defenders"],
    ] {
        assert_eq!(digest(args), other, "{args:?}");
    }
    assert_eq!(
        digest(&["--blue", "easy_attackers", "--red", "idle", "--in-process"]),
        own
    );
}

#[test]
fn a_game_from_both_sides_is_the_two_games_of_the_tournament_and_their_sum() {
    let dir = tempfile::tempdir().unwrap();
    let result = place(&dir, "result.json");
    let game = "scenarios/games/attack_1v1.toml";
    let run = |args: &[&str]| {
        let text = printed(
            project(),
            &[
                &["run", game, "--no-record", "--in-process"],
                args,
                &["--json", &result],
            ]
            .concat(),
        );
        (text, json(&result))
    };
    let (text, both) = run(&["--both-sides"]);
    assert!(
        text.contains("both games: easy_attackers (first as blue) "),
        "{text}"
    );
    // A tournament swaps the two teams' strategies in the same way.
    let (_, first) = run(&[]);
    let (_, second) = run(&["--blue", "idle", "--red", "easy_attackers"]);
    assert_eq!(
        [&both["games"][0]["digest"], &both["games"][1]["digest"]],
        [&first["digest"], &second["digest"]]
    );
    let points = |game: &Value, team: &str| game["score"]["teams"][team].as_u64().unwrap();
    for (i, (team, other)) in [("blue", "red"), ("red", "blue")].into_iter().enumerate() {
        assert_eq!(
            both["sum"][i]["score"].as_u64().unwrap(),
            points(&first, team) + points(&second, other),
            "{team}"
        );
    }
    assert!(points(&first, "blue") > 0, "a team scores");
    assert!(
        text.contains("nothing in this game is random") && first["random"] == false,
        "{text}"
    );
    assert!(
        !text.contains("--both-sides") && first["ends_differ"] == false,
        "{text}"
    );
    // Equal strategies gain nothing from playing both ends.
    for (red, is_advised) in [("strategy_3", true), ("strategy_4", false)] {
        let args = [
            "run",
            "strategy_4_vs_3",
            "--red",
            red,
            "--set",
            "game.duration_s=5",
            "--no-record",
            "--in-process",
        ];
        assert_eq!(
            printed(&dir, &args).contains("add --both-sides"),
            is_advised,
            "{red}"
        );
    }
}
