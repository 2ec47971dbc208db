//! Broken scenario files: every mistake is reported, at its place, with what is allowed.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod boats;
mod files;
mod games;
mod strategy;
mod tournaments;
mod values;

use game::scenario;

/// A sound set of files; each case replaces some of them.
const SOUND: [(&str, &str); 9] = [
    (
        "games/g.toml",
        r#"field = "../fields/f.toml"
rules = "../rules/r.toml"
sea = "../seas/s.toml"
boat = "../boats/b.toml"
team = [{ name = "blue", strategy = "../strategies/p.toml" }, { name = "red", strategy = "../strategies/p.toml" }]
vehicle = [{ name = "blue_one", team = "blue" }, { name = "red_one", team = "red" }]
"#,
    ),
    ("fields/f.toml", "datum = { lat_deg = 41.0, lon_deg = -74.0 }\nwidth_m = 160\ndepth_m = 80\n"),
    ("rules/r.toml", ""),
    ("seas/s.toml", ""),
    (
        "boats/b.toml",
        r#"length_m = 2
beam_m = 1
[hull]
mass_kg = 50
[thruster]
arm_m = 0.4
table_pct_newton = [[-100, -20], [0, 0], [100, 40]]
[autopilot]
speed_max_m_s = 2
"#,
    ),
    ("strategies/p.toml", "roles = [\"s.toml\"]\n"),
    (
        "strategies/unsafe.toml",
        "unsafe_i_know = true\nunsafe_because = \"a test\"\n[behaviour.stop]\nkind = \"full_stop\"\n",
    ),
    (
        "strategies/s.toml",
        "[behaviour.stay_in]\nkind = \"op_region\"\n[behaviour.keep_clear]\nkind = \"avoid_collision\"\n",
    ),
    (
        "tournaments/t.toml",
        r#"game = "../games/g.toml"
entry = [{ name = "a", strategy = "../strategies/p.toml" }, { name = "b", strategy = "../strategies/p.toml" }]
"#,
    ),
];

/// What is wrong with `asked` when the files are the sound ones with `files` over them, line by line.
fn problems(asked: &str, files: &[(&str, &[u8])]) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let sound = SOUND.iter().map(|(path, text)| (*path, text.as_bytes()));
    for (path, text) in sound.chain(files.iter().copied()) {
        let path = folder.path().join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    let Err(found) = scenario::check_file(&folder.path().join(asked)) else { return vec![] };
    let root = format!("{}/", folder.path().display());
    found.to_string().lines().map(|line| line.replace(&root, "")).collect()
}

/// Long lists of what is allowed: how they begin and end, and what stands for them here.
const LISTS: [(&str, &str, &str); 10] = [
    ("PPB PPF", "SSBX", "{points}"),
    ("base, boundary", "win_score", "{keys of rules}"),
    ("added_surge_kg,", "yaw_quadratic_kg_m2", "{keys of hulls}"),
    ("about, assignment, base", "variables", "{keys of strategies}"),
    ("waypoint, loiter,", "policy", "{kinds}"),
    ("nearest_enemy, nearest", "mate_carrier", "{boats}"),
    ("own_flag, enemy_flag,", "such as CH", "{places}"),
    ("i, mate, enemy, then", "collides", "{events}"),
    ("numbers, texts, true,", "on_own_side()", "{CEL that is allowed}"),
    ("min(), max(),", "on_own_side()", "{calls}"),
];

/// `line` with the long lists of what is allowed cut short.
fn abridged(line: &str) -> String {
    LISTS.into_iter().fold(line.to_owned(), |line, (first, last, short)| {
        let from = line.find(first);
        let to = from.and_then(|from| Some(from + line[from..].find(last)? + last.len()));
        match (from, to) {
            (Some(from), Some(to)) => format!("{}{short}{}", &line[..from], &line[to..]),
            _ => line,
        }
    })
}

/// Checks that broken files are reported as they say themselves.
///
/// A case is `## `, a name, and from the next line the file at `path`, which begins with `head`. After a line `--- PATH`
/// follows another file; where the case begins with one, it is the file to check. What must be reported for a line
/// stands behind it: `#~ COLUMN: MESSAGE`, after the name `#~ LINE:COLUMN: MESSAGE` or `#~ PATH:LINE:COLUMN: MESSAGE`.
/// Nothing else may be reported.
fn assert_broken(path: &str, head: &str, cases: &str) {
    let mut failures = vec![];
    for case in cases.split("\n## ").skip(1) {
        let (title, text) = case.split_once('\n').expect("a case has a text");
        let mut title = title.split(" #~ ");
        let name = title.next().unwrap_or_default();
        let mut said: Vec<String> = title.map(str::to_owned).collect();
        let mut files = vec![(path, head.to_owned())];
        for (i, line) in text.lines().filter(|line| !line.is_empty()).enumerate() {
            if let Some(path) = line.strip_prefix("--- ") {
                files.truncate(if i == 0 { 0 } else { files.len() });
                files.push((path, String::new()));
                continue;
            }
            let mut parts = line.split(" #~ ");
            let (path, text) = files.last_mut().expect("a case has a file");
            text.push_str(parts.next().unwrap_or_default());
            text.push('\n');
            let number = text.lines().count();
            said.extend(parts.map(|said| format!("{path}:{number}:{said}")));
        }
        let mut want: Vec<_> = said.iter().map(|said| expected(files[0].0, said)).collect();
        want.sort();
        let want: Vec<String> =
            want.into_iter().map(|(path, line, column, what)| format!("{path}:{line}:{column}: {what}")).collect();
        let texts: Vec<(&str, &[u8])> = files.iter().map(|(path, text)| (*path, text.as_bytes())).collect();
        let got: Vec<String> = problems(files[0].0, &texts).iter().map(|line| abridged(line)).collect();
        failures.extend((got != want).then(|| format!("{name}\n   is: {got:#?}\n want: {want:#?}")));
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// A problem, from `PATH:LINE:COLUMN: MESSAGE`, or in the file at `path` from `LINE:COLUMN: MESSAGE`.
fn expected<'a>(path: &'a str, said: &'a str) -> (&'a str, usize, usize, &'a str) {
    let (path, said) = match said.split_once(".toml:") {
        Some((stem, rest)) if !stem.contains(' ') => (&said[..stem.len() + ".toml".len()], rest),
        _ => (path, said),
    };
    let mut parts = said.splitn(3, ':');
    let mut number = || parts.next().and_then(|number| number.parse().ok()).expect("a line and a column");
    let (line, column) = (number(), number());
    (path, line, column, parts.next().unwrap_or_default().trim_start())
}

#[test]
fn the_sound_files_are_sound() {
    for (path, _) in SOUND {
        assert_eq!(problems(path, &[]), [""; 0], "{path}");
    }
    // What a base names stays where the base says, wherever the file that builds on it lies.
    let elsewhere = ("mine/of/today/x.toml", b"base = \"../../../games/g.toml\"\nseed = 7\n".as_slice());
    assert_eq!(problems(elsewhere.0, &[elsewhere]), [""; 0]);
}

#[test]
fn a_file_that_is_not_there_is_reported() {
    let want = "games/none.toml:1:1: cannot be read (No such file or directory (os error 2)), expected a file";
    assert_eq!(problems("games/none.toml", &[]), [want]);
}
