//! The strategy tutorial: extracts its files from its text, and checks that its commands print the
//! output that it shows.

use crate::program::{self, project};

/// The code blocks of a page: language and text.
fn blocks(page: &str) -> Vec<(&str, String)> {
    let mut blocks = Vec::new();
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        if let Some(language) = line.strip_prefix("```") {
            let text: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
            blocks.push((language, text.join("\n") + "\n"));
        }
    }
    blocks
}

#[test]
fn the_tutorial_holds_what_it_promises() {
    let scenarios = project().join("scenarios");
    let page = std::fs::read_to_string(scenarios.join("strategies/TUTORIAL.md")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("scenarios");
    for kind in ["boats", "fields", "games", "rules", "seas", "strategies", "tournaments"] {
        std::fs::create_dir_all(own.join(kind)).unwrap();
        for file in std::fs::read_dir(scenarios.join(kind)).unwrap() {
            let file = file.unwrap();
            std::fs::copy(file.path(), own.join(kind).join(file.file_name())).unwrap();
        }
    }
    let squall = |args: &[&str]| {
        let output = program::squall(&folder, args);
        (output.status.success(), String::from_utf8([output.stdout, output.stderr].concat()).unwrap())
    };
    let mut files = Vec::new();
    let mut shown = 0;
    let mut command = None;
    for (language, text) in blocks(&page) {
        match language {
            "toml" => {
                let name = text.lines().next().unwrap().strip_prefix("# ").unwrap();
                let path = if name.contains('/') { name.into() } else { format!("strategies/{name}") };
                std::fs::write(own.join(&path), &text).unwrap();
                files.push(format!("scenarios/{path}"));
            }
            "sh" => command = Some(text),
            "text" => {
                let command = command.take().unwrap();
                let words: Vec<&str> = command.split_whitespace().skip(1).collect();
                if words[0] == "strategy" {
                    assert_eq!(squall(&words).1, text, "{command}");
                    shown += 1;
                }
            }
            other => panic!("a block of {other:?}"),
        }
    }
    assert_eq!((files.len(), shown), (6, 2), "{files:?}");
    // The first file lacks safety and must be refused; all others are valid.
    for file in &files {
        let (good, said) = squall(&["check", file]);
        assert_eq!(good, !file.ends_with("mine_1.toml"), "{said}");
    }
    let (good, said) = squall(&["tournament", "scenarios/tournaments/mine.toml", "--games", "2"]);
    assert!(good && said.contains("mine_5"), "{said}");
    // The error for the mistake in the third file.
    let third = own.join("strategies/mine_3.toml");
    let text = std::fs::read_to_string(&third).unwrap();
    std::fs::write(&third, text.replace("\"has_flag\"", "\"has_flagg\"")).unwrap();
    let (good, said) = squall(&["strategy", "scenarios/strategies/mine_3.toml"]);
    assert!(!good && said.contains("did you mean has_flag?"), "{said}");
}
