//! Commands that must be refused: `refusals.txt` lists them with the required messages.

use crate::program::{command, project, refusal, scenario, words};

/// Runs the commands of one case; returns the strings missing from their output.
fn missing(case: &str) -> Vec<String> {
    let dir = tempfile::tempdir().unwrap();
    let mut file = None;
    let mut commands = vec![];
    let mut missing = vec![];
    let mut looked_for = 0;
    for line in case.lines().filter(|line| !line.is_empty()) {
        let line = line.replace(
            "SCENARIOS",
            &project().join("scenarios").display().to_string(),
        );
        if let Some(path) = line.strip_prefix("--- ") {
            file = Some((dir.path().join(path), String::new()));
        } else if let Some(command) = line.strip_prefix("$ squall ") {
            file = None;
            let said = refusal(&dir, &words(command));
            commands.push((command.to_owned(), said));
        } else if let Some((_, text)) = &mut file {
            *text += &format!("{line}\n");
        } else {
            looked_for += commands.len();
            let silent = commands.iter().filter(|(_, said)| !said.contains(&line));
            missing.extend(silent.map(|(command, said)| {
                format!("{command} should print {line:?}, but prints {said}")
            }));
        }
        if let Some((path, text)) = &file {
            std::fs::write(path, text).unwrap();
        }
    }
    assert!(looked_for > 0, "no text is expected: {case}");
    missing
}

#[test]
fn every_mistake_is_refused_and_explained() {
    let text = include_str!("refusals.txt");
    let cases: Vec<_> = text
        .split("\n## ")
        .skip(1)
        .map(|case| case.split_once('\n').unwrap_or((case, "")))
        .collect();
    assert_eq!(
        cases.len(),
        text.lines().filter(|line| line.starts_with("##")).count()
    );
    assert!(cases.len() >= 70, "only {} cases", cases.len());
    let wrong = cases.iter().flat_map(|(name, case)| {
        missing(case)
            .into_iter()
            .map(move |why| format!("{name}: {why}"))
    });
    let wrong: Vec<String> = wrong.collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn mistakes_in_the_command_line_exit_with_2_and_name_the_next_step() {
    let dir = tempfile::tempdir().unwrap();
    let utf_16: Vec<u8> = "\u{feff}fild = 1\r\n"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    std::fs::write(dir.path().join("game.mcap"), "").unwrap();
    std::fs::write(dir.path().join("wide.toml"), utf_16).unwrap();
    std::fs::write(dir.path().join("Mine.TOML"), "").unwrap();
    let cases = include_str!("mistakes.txt")
        .lines()
        .filter(|line| !line.starts_with('#'));
    let wrong = cases.filter_map(|case| {
        let [code, line, want] = case.split(" | ").collect::<Vec<_>>()[..] else {
            panic!("{case}")
        };
        let output = command(&dir, &words(line)).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let is_right = output.status.code() == code.parse().ok()
            && said.contains(want)
            && !said.contains("os error")
            && !said.contains("as a value, use '--");
        (!is_right).then(|| {
            format!(
                "{line}: expected {code} and {want:?}, found {} and {said}",
                output.status
            )
        })
    });
    let wrong: Vec<String> = wrong.collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(
        std::fs::read_dir(&dir).unwrap().count() == 3,
        "a mistake leaves no files"
    );
}

#[test]
fn errors_show_the_line_with_a_caret_and_colours_where_they_are_wanted() {
    let dir = tempfile::tempdir().unwrap();
    let game = "base = \"GAME\"\nduration_s = \"12\"\nsea = ../gale.toml\n";
    let base = scenario("games/pav01_vs_pav01.toml");
    std::fs::write(dir.path().join("a.toml"), game.replace("GAME", &base)).unwrap();
    let said = |more: &[&str], no_colour: Option<&str>| {
        let mut command = command(&dir, &[&["check", "a.toml"], more].concat());
        command.envs(no_colour.map(|value| ("NO_COLOR", value)));
        String::from_utf8(command.output().unwrap().stdout).unwrap()
    };
    let plain = said(&[], None);
    let want = "a.toml:2:14: duration_s is the string \"12\", expected a number\n  |\n2 | duration_s = \"12\"\n  |              ^^^^\n\
                a.toml:3:7: ../gale.toml is not in quotes, expected \"../gale.toml\"\n  |\n3 | sea = ../gale.toml\n  |       ^^^^^^^^^^^^\n";
    assert_eq!(plain, want);
    assert_eq!(said(&["--color", "never"], None), plain);
    // The values of an axis are settings that share one mistake, whose line is in no file.
    let sweep = format!(
        "base = {:?}\n[[axis]]\nkey = \"sea.wind.sped_m_s\"\nvalues = [1, 2]\n",
        scenario("sweeps/wind.toml")
    );
    std::fs::write(dir.path().join("s.toml"), sweep).unwrap();
    let checked = command(&dir, &["check", "s.toml"]).output().unwrap().stdout;
    let checked = String::from_utf8(checked).unwrap();
    assert!(
        checked.matches("sped_m_s").count() == 1 && checked.starts_with("s.toml:3:"),
        "{checked}"
    );
    let coloured = said(&["--color", "always"], Some("1"));
    assert!(
        coloured.contains("\u{1b}[1;31ma.toml:2:14:\u{1b}[0m"),
        "{coloured:?}"
    );
    assert!(!said(&[], Some("1")).contains('\u{1b}'));
}
