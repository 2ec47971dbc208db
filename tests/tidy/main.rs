//! The house rules that a compiler does not check: who imports whom, how long files are, what documents promise.
//!
//! Every rule reads a [`Tree`] of texts and gives its breaches. The first test holds the repository to all
//! of them; the second breaks each in turn, so that a rule which has stopped looking is noticed too.

mod breaker;
mod rule;
mod text;
mod tree;

use breaker::{breakers, sound_tree};
use rule::{Breaches, RULES};
use std::path::PathBuf;
use text::joined;
use tree::Tree;

#[test]
fn the_repository_keeps_the_house_rules() {
    let tree = Tree::of(&root());
    assert!(
        tree.files.len() > 50,
        "only {} files under {}: is this the repository?",
        tree.files.len(),
        root().display()
    );
    let breaches: Vec<String> = RULES.iter().flat_map(|(name, rule)| report(name, rule(&tree))).collect();
    assert!(breaches.is_empty(), "\n{}\n", breaches.join("\n"));
}

#[test]
fn every_rule_notices_its_breach() {
    for (rule, path, text, said) in breakers() {
        let mut tree = sound_tree();
        assert_eq!(breaches_of(&tree, rule), Breaches::new(), "the sound tree, by {rule:?}");
        tree.files.insert(path.to_owned(), text);
        let found = breaches_of(&tree, rule).join("\n");
        assert!(found.contains(said), "{rule:?} with this {path} should say {said:?}, but says {found:?}");
    }
    let untested = RULES.iter().find(|(name, _)| breakers().iter().all(|breaker| breaker.0 != *name));
    assert_eq!(untested.map(|(name, _)| name), None, "a rule that no breaker tries");
}

#[test]
fn what_is_allowed_is_not_reported() {
    let mut tree = sound_tree();
    for (path, text) in [
        ("sim/src/node/server.rs", "//! Game server.\nuse bus::Bus;\n".to_owned()),
        ("agent/src/node.rs", "//! Node.\nuse bus::Bus;\n".to_owned()),
        ("sim/src/tide.rs", format!("//! Tide, not {}.\nfn f() {{}} // {}\n", joined(["zen", "oh::"]), "x.unwrap()")),
        ("sim/src/wave.rs", "//! Waves.\n#[cfg(test)]\nmod tests {\n    fn f() { g().unwrap() }\n}\n".to_owned()),
        ("sim/tests/wave.rs", "//! Waves.\nfn f() { g().unwrap() }\n".to_owned()),
        ("benches/lockstep.rs", format!("//! Bench.\nuse {}Session;\n", joined(["zen", "oh::"]))),
        ("src/main.rs", "//! Squall.\nfn main() { println!(\"ahoy\") }\n".to_owned()),
    ] {
        tree.files.insert(path.to_owned(), text);
    }
    for (name, rule) in RULES {
        assert_eq!(rule(&tree), Breaches::new(), "{name}");
    }
}

fn report(rule: &str, breaches: Breaches) -> Breaches {
    breaches.into_iter().map(|breach| format!("{breach}\n    rule: {rule}")).collect()
}

fn breaches_of(tree: &Tree, rule: &str) -> Breaches {
    let (_, find) = RULES.iter().find(|(name, _)| *name == rule).unwrap_or_else(|| panic!("no rule {rule:?}"));
    find(tree)
}

fn root() -> PathBuf {
    let told = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    told.or_else(|| option_env!("CARGO_MANIFEST_DIR").map(PathBuf::from)).unwrap_or_else(|| PathBuf::from("."))
}
