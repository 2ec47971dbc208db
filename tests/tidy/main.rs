//! House rules that a compiler does not check: imports between crates, file lengths, promises in
//! documents.
//!
//! Every rule reads a [`Tree`] of file contents and returns its breaches. The first test checks the
//! repository against all rules. The second breaks each rule in turn, as listed in `breaches.txt`,
//! so that a rule that no longer works is detected.

mod language;
mod rule;
mod shown_by;
mod text;
mod tree;

use rule::{Breaches, LINES_MAX, RULES};
use std::path::PathBuf;
use tree::Tree;

/// The files described in the file `text`: each begins with a line with its path.
fn files_of(text: &str) -> Vec<(String, String)> {
    let text =
        std::fs::read_to_string(root().join("tests/tidy").join(text)).expect("it can be read");
    let files = text.strip_prefix("---- ").expect("a file").split("\n---- ");
    let file = |file: &str| {
        let (path, text) = file.split_once('\n').expect("a text");
        (path.to_owned(), format!("{}\n", text.trim_end()))
    };
    files.map(file).collect()
}

/// The smallest tree that complies with every rule.
fn sound_tree() -> Tree {
    Tree {
        root: PathBuf::new(),
        files: files_of("sound.txt").into_iter().collect(),
    }
}

#[test]
fn the_repository_keeps_the_house_rules() {
    let tree = Tree::of(&root());
    assert!(
        tree.files.len() > 50,
        "only {} files under {}: is this the repository?",
        tree.files.len(),
        root().display()
    );
    let breaches: Vec<String> = RULES
        .iter()
        .flat_map(|(name, rule)| report(name, rule(&tree)))
        .collect();
    assert!(breaches.is_empty(), "\n{}\n", breaches.join("\n"));
}

#[test]
fn every_rule_notices_its_breach() {
    let mut tried = vec![];
    for (path, case) in files_of("breaches.txt") {
        let case = case.replace("{650 empty lines}\n", &"\n".repeat(LINES_MAX));
        let mut parts = case.splitn(3, '\n');
        let mut line = |begin: &str| {
            parts
                .next()
                .and_then(|line| line.strip_prefix(begin))
                .expect(begin)
                .to_owned()
        };
        let rule = line("rule: ");
        let said = line("says: ");
        let mut tree = sound_tree();
        assert_eq!(
            breaches_of(&tree, &rule),
            Breaches::new(),
            "the valid tree breaks {rule:?}"
        );
        tree.files
            .insert(path.clone(), parts.next().expect("a text").to_owned());
        let found = breaches_of(&tree, &rule).join("\n");
        assert!(
            found.contains(&said),
            "{rule:?} with this {path} should report {said:?}, but reports {found:?}"
        );
        tried.push(rule);
    }
    let untested = RULES
        .iter()
        .find(|(name, _)| tried.iter().all(|rule| rule != name));
    assert_eq!(
        untested.map(|(name, _)| name),
        None,
        "a rule that no breach tests"
    );
}

#[test]
fn what_is_allowed_is_not_reported() {
    let mut tree = sound_tree();
    tree.files.extend(files_of("allowed.txt"));
    for (name, rule) in RULES {
        assert_eq!(rule(&tree), Breaches::new(), "{name}");
    }
}

fn report(rule: &str, breaches: Breaches) -> Breaches {
    breaches
        .into_iter()
        .map(|breach| format!("{breach}\n    rule: {rule}"))
        .collect()
}

fn breaches_of(tree: &Tree, rule: &str) -> Breaches {
    let (_, find) = RULES
        .iter()
        .find(|(name, _)| *name == rule)
        .unwrap_or_else(|| panic!("no rule {rule:?}"));
    find(tree)
}

fn root() -> PathBuf {
    let told = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    told.or_else(|| option_env!("CARGO_MANIFEST_DIR").map(PathBuf::from))
        .unwrap_or_else(|| PathBuf::from("."))
}
