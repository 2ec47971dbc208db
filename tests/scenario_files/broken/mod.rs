//! Broken scenario files: every mistake is reported at its place with the allowed values.
//!
//! The cases are data: `README.md` in this folder explains how to read and add them.

use crate::kinds::KINDS;
use crate::written;
use std::fs;
use std::path::{Path, PathBuf};

fn beside(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/scenario_files/broken")
        .join(path)
}

/// The files in a folder of this test, in order.
fn files_in(folder: &str) -> Vec<PathBuf> {
    let mut files: Vec<_> = fs::read_dir(beside(folder))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    files
}

/// Paths and contents of the valid files, some of which a case replaces.
fn sound() -> Vec<(String, String)> {
    let folders = [
        "boats",
        "fields",
        "games",
        "rules",
        "seas",
        "strategies",
        "tournaments",
        "rewards",
    ];
    let files = folders
        .into_iter()
        .flat_map(|folder| files_in(&format!("sound/{folder}")));
    let file = |path: PathBuf| {
        let name = path
            .strip_prefix(beside("sound"))
            .unwrap()
            .display()
            .to_string();
        (name, fs::read_to_string(path).unwrap())
    };
    files.map(file).collect()
}

/// The problems, line by line, of `asked` if `files` override the valid files.
fn problems(asked: &str, files: &[(String, String)]) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    for (path, text) in sound().iter().chain(files) {
        written(folder.path(), path, text);
    }
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/onnx/tests/network");
    fs::create_dir(folder.path().join("models")).unwrap();
    for model in ["sb3_dynamo.onnx", "two_inputs.onnx"] {
        fs::copy(models.join(model), folder.path().join("models").join(model)).unwrap();
    }
    let Err(found) = scenario::check_file(KINDS, &folder.path().join(asked)) else {
        return vec![];
    };
    let root = format!("{}/", folder.path().display());
    found
        .to_string()
        .lines()
        .map(|line| line.replace(&root, ""))
        .collect()
}

/// Long lists of allowed values: their beginning, end, and short form in the cases.
const LISTS: [(&str, &str, &str); 10] = [
    ("PPB PPF", "SSBX", "{points}"),
    ("base, boundary", "win_score", "{keys of rules}"),
    ("added_surge_kg,", "yaw_quadratic_kg_m2", "{keys of hulls}"),
    (
        "about, assignment, base",
        "variables",
        "{keys of strategies}",
    ),
    ("waypoint, loiter,", "policy", "{kinds}"),
    ("nearest_enemy, nearest", "mate_carrier", "{boats}"),
    ("own_flag, enemy_flag,", "such as CH", "{places}"),
    ("i, mate, enemy, then", "collides", "{events}"),
    (
        "numbers, strings, true,",
        "mates_nearer()",
        "{CEL that is allowed}",
    ),
    ("min(), max(),", "mates_nearer()", "{calls}"),
];

/// `line` with long lists of allowed values shortened.
fn abridged(line: &str) -> String {
    LISTS
        .into_iter()
        .fold(line.to_owned(), |line, (first, last, short)| {
            let from = line.find(first);
            let to = from.and_then(|from| Some(from + line[from..].find(last)? + last.len()));
            match (from, to) {
                (Some(from), Some(to)) => format!("{}{short}{}", &line[..from], &line[to..]),
                _ => line,
            }
        })
}

/// Checks the cases in `text`, laid out as in `README.md`; returns their number and the failures.
fn check(text: &str) -> (usize, Vec<String>) {
    let mut cases = text.split("\n## ");
    let head = cases.next().unwrap_or_default();
    let head = head
        .split_once("\n--- ")
        .map(|(_, head)| format!("--- {head}"))
        .expect("a line `--- PATH` at the top");
    let (before, after) = head.split_once("\n{case}").unwrap_or((&head, ""));
    let cases: Vec<&str> = cases.collect();
    let failures = cases.iter().filter_map(|case| {
        let (title, own) = case.split_once('\n').unwrap_or((case, ""));
        let whole = if own.starts_with("--- ") {
            own.to_owned()
        } else {
            format!("{before}\n{own}\n{after}")
        };
        failure(title, &whole)
    });
    (cases.len(), failures.collect())
}

/// The failure of one case, if any: `title`, which may name the expected problem, and its files.
fn failure(title: &str, text: &str) -> Option<String> {
    let mut title = title.split(" #~ ");
    let name = title.next().unwrap_or_default();
    let mut said: Vec<String> = title.map(str::to_owned).collect();
    let mut files: Vec<(String, String)> = vec![];
    for line in text.lines().filter(|line| !line.is_empty()) {
        if let Some(path) = line.strip_prefix("--- ") {
            files.push((path.to_owned(), String::new()));
            continue;
        }
        let mut parts = line.split(" #~ ");
        let (path, text) = files.last_mut()?;
        let line = parts.next().unwrap_or_default();
        assert!(
            !line.contains("#~") && !line.starts_with("##"),
            "{name}: not a case and not a report: {line}"
        );
        text.push_str(line);
        text.push('\n');
        let number = text.lines().count();
        said.extend(parts.map(|said| format!("{path}:{number}:{said}")));
    }
    let asked = &files[0].0;
    let mut want: Vec<_> = said.iter().map(|said| expected(asked, said)).collect();
    want.sort();
    let want: Vec<String> = want
        .into_iter()
        .map(|(path, line, column, what)| format!("{path}:{line}:{column}: {what}"))
        .collect();
    let got: Vec<String> = problems(asked, &files)
        .iter()
        .map(|line| abridged(line))
        .collect();
    (got != want || want.is_empty()).then(|| format!("{name}\n   is: {got:#?}\n want: {want:#?}"))
}

/// The expected problem: `PATH:LINE:COLUMN: MESSAGE`, or `LINE:COLUMN: MESSAGE` in the file at
/// `path`.
fn expected<'a>(path: &'a str, said: &'a str) -> (&'a str, usize, usize, &'a str) {
    let (path, said) = match said.split_once(".toml:") {
        Some((stem, rest)) if !stem.contains(' ') => (&said[..stem.len() + ".toml".len()], rest),
        _ => (path, said),
    };
    let mut parts = said.splitn(3, ':');
    let mut number = || {
        parts
            .next()
            .and_then(|number| number.parse().ok())
            .expect("a line and a column")
    };
    let line = number();
    let column = number();
    (
        path,
        line,
        column,
        parts.next().unwrap_or_default().trim_start(),
    )
}

#[test]
fn every_mistake_is_reported_at_its_place() {
    let mut failures = vec![];
    for path in files_in("cases") {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        assert!(name.ends_with(".toml"), "{name} is not a file of cases");
        let text = fs::read_to_string(&path).unwrap();
        let (read, wrong) = check(&text);
        assert!(read > 0, "{name} has no cases");
        assert_eq!(
            read,
            text.lines().filter(|line| line.starts_with("##")).count(),
            "{name}: cases read, and present"
        );
        failures.extend(
            wrong
                .into_iter()
                .map(|failure| format!("cases/{name}: {failure}")),
        );
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn mates_hear_so_many_variables_and_no_more() {
    let shared: String = (0..257)
        .map(|i| format!("v{i} = {{ initial = 0, shared = true }}\n"))
        .collect();
    let variables = "[variables] #~ 1: variables has 257 shared entries, expected at most 256";
    let text = format!("--- strategies/x.toml\nbase = \"s.toml\"\n{variables}\n{shared}");
    assert_eq!(failure("more than mates hear", &text), None);
}

#[test]
fn the_sound_files_are_sound() {
    let sound = sound();
    assert_eq!(sound.len(), 10);
    for (path, _) in sound {
        assert_eq!(problems(&path, &[]), [""; 0], "{path}");
    }
    // A path in a base file is relative to the base, wherever the extending file is.
    let elsewhere = (
        "mine/of/today/x.toml".to_owned(),
        "base = \"../../../games/g.toml\"\nseed = 7\n".to_owned(),
    );
    assert_eq!(
        problems(&elsewhere.0, std::slice::from_ref(&elsewhere)),
        [""; 0]
    );
}

#[test]
fn a_file_that_is_not_there_is_reported() {
    let want = "games/none.toml:1:1: cannot read this file: no such file";
    assert_eq!(problems("games/none.toml", &[]), [want]);
}
