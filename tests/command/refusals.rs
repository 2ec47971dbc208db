//! Commands that must be refused: `refusals.txt` has them, and what they must say.

use crate::program::{project, refusal};

/// Runs the commands of one case; what is missing in what they say.
fn missing(case: &str) -> Vec<String> {
    let dir = tempfile::tempdir().unwrap();
    let (mut file, mut commands, mut missing, mut looked_for) = (None, vec![], vec![], 0);
    for line in case.lines().filter(|line| !line.is_empty()) {
        let line = line.replace("SCENARIOS", &project().join("scenarios").display().to_string());
        if let Some(path) = line.strip_prefix("--- ") {
            file = Some((dir.path().join(path), String::new()));
        } else if let Some(command) = line.strip_prefix("$ squall ") {
            file = None;
            let said = refusal(&dir, &command.split(' ').collect::<Vec<_>>());
            commands.push((command.to_owned(), said));
        } else if let Some((_, text)) = &mut file {
            *text += &format!("{line}\n");
        } else {
            looked_for += commands.len();
            let silent = commands.iter().filter(|(_, said)| !said.contains(&line));
            missing.extend(silent.map(|(command, said)| format!("{command} should say {line:?}, but says {said}")));
        }
        if let Some((path, text)) = &file {
            std::fs::write(path, text).unwrap();
        }
    }
    assert!(looked_for > 0, "nothing is looked for: {case}");
    missing
}

#[test]
fn every_mistake_is_refused_and_explained() {
    let text = include_str!("refusals.txt");
    let cases: Vec<_> = text.split("\n## ").skip(1).map(|case| case.split_once('\n').unwrap_or((case, ""))).collect();
    assert_eq!(cases.len(), text.lines().filter(|line| line.starts_with("##")).count());
    assert!(cases.len() >= 39, "only {} cases", cases.len());
    let wrong =
        cases.iter().flat_map(|(name, case)| missing(case).into_iter().map(move |why| format!("{name}: {why}")));
    let wrong: Vec<String> = wrong.collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
