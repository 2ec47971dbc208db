//! Mistakes in strategies.

mod behaviour;
mod expression;
mod guard;
mod mode;
mod reach;
mod role;
mod safety;
mod shape;
mod variable;

use crate::{abridged, problems};

/// What a file says that is laid over a sound one.
const BASE: &str = "base = \"s.toml\"\n";

/// The same, with variables.
const VARIABLES: &str = r#"base = "s.toml"
variables.alarmed = false
variables.laps = 0
variables.phase = { values = ["go", "return"], shared = true }
"#;

/// Checks that broken files are reported as they say themselves.
///
/// A case is `## `, a name, and from the next line the file `strategies/x.toml`, which begins with `head`. After a line
/// `--- PATH` follows another file; where the case begins with one, it is the file to check. What must be reported for a
/// line stands behind it: `#~ COLUMN: MESSAGE`, after the name `#~ LINE:COLUMN: MESSAGE`. Nothing else may be reported.
fn assert_broken(head: &str, cases: &str) {
    let mut failures = vec![];
    for case in cases.split("\n## ").skip(1) {
        let (title, text) = case.split_once('\n').expect("a case has a text");
        let mut title = title.split(" #~ ");
        let name = title.next().unwrap_or_default();
        let mut want: Vec<_> = title.map(|said| expected("strategies/x.toml", said)).collect();
        let mut files = vec![("strategies/x.toml", head.to_owned())];
        for line in text.lines().filter(|line| !line.is_empty()) {
            if let Some(path) = line.strip_prefix("--- ") {
                files.retain(|(_, text)| !text.is_empty());
                files.push((path, String::new()));
                continue;
            }
            let mut parts = line.split(" #~ ");
            let (path, text) = files.last_mut().expect("a case has a file");
            text.push_str(parts.next().unwrap_or_default());
            text.push('\n');
            let number = text.lines().count();
            want.extend(parts.map(|said| expected(path, &format!("{number}:{said}"))));
        }
        want.sort();
        let files: Vec<(&str, &[u8])> = files.iter().map(|(path, text)| (*path, text.as_bytes())).collect();
        let got: Vec<String> = problems(files[0].0, &files).iter().map(|line| abridged(line)).collect();
        let want: Vec<String> =
            want.into_iter().map(|(path, line, column, what)| format!("{path}:{line}:{column}: {what}")).collect();
        failures.extend((got != want).then(|| format!("{name}\n   is: {got:#?}\n want: {want:#?}")));
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// A problem, from `LINE:COLUMN: MESSAGE`.
fn expected<'a>(path: &'a str, said: &str) -> (&'a str, usize, usize, String) {
    let mut parts = said.splitn(3, ':');
    let mut number = || parts.next().and_then(|number| number.parse().ok()).expect("a line and a column");
    let (line, column) = (number(), number());
    (path, line, column, parts.next().unwrap_or_default().trim_start().to_owned())
}
