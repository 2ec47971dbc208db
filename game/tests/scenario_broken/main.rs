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

/// A name for the case, the file to check, the files to replace, and what must be reported.
type Case = (&'static str, &'static str, &'static [(&'static str, &'static str)], &'static [&'static str]);

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

fn assert_reported(cases: &[Case]) {
    let mut differences = vec![];
    for (name, asked, files, want) in cases {
        let files: Vec<(&str, &[u8])> = files.iter().map(|(path, text)| (*path, text.as_bytes())).collect();
        let got = problems(asked, &files);
        let got: Vec<String> = got.iter().map(|line| abridged(line)).collect();
        if got != *want {
            differences.push(format!("{name}:\n  got  {got:#?}\n  want {want:#?}"));
        }
    }
    assert!(differences.is_empty(), "{}", differences.join("\n"));
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
