//! No content of a scenario file crashes the program.

use crate::kinds::KINDS;
use crate::{files, written};
use proptest::prelude::*;
use std::path::PathBuf;

/// Checks `bytes` as every kind of file. Any result is allowed, but problems must have places.
fn check_as_all_kinds(bytes: &[u8]) {
    let folder = tempfile::tempdir().unwrap();
    let in_folders = KINDS.iter().map(|kind| format!("{}/x.toml", kind.folder()));
    for name in in_folders.chain(["x.toml".to_owned()]) {
        let path = written(folder.path(), &name, bytes);
        if let Err(problems) = scenario::check_file(KINDS, &path) {
            assert!(!problems.0.is_empty());
            assert!(
                problems
                    .0
                    .iter()
                    .all(|problem| problem.line > 0 && problem.column > 0)
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_bytes_are_refused_or_read(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        check_as_all_kinds(&bytes);
    }

    #[test]
    fn arbitrary_lines_are_refused_or_read(
        text in r#"(((base|roles|hull|field|at|team|\[\[team\]\]|\[hull\]|"\\u00e9")( = |\.|\n)("x\.toml"|-1e400|nan|\[\[1, 2\], 3\]|\{ a = 1|\[|'|1979-05-27)?\n?){0,12})"#
    ) {
        check_as_all_kinds(text.as_bytes());
    }

    #[test]
    fn a_shipped_file_with_a_wrong_byte_is_refused_or_read(
        which in any::<prop::sample::Index>(),
        place in any::<prop::sample::Index>(),
        byte in any::<u8>(),
    ) {
        let paths: Vec<PathBuf> = KINDS.iter().flat_map(|kind| files(*kind)).collect();
        let path = which.get(&paths);
        let mut bytes = std::fs::read(path).unwrap();
        *place.get_mut(&mut bytes) = byte;
        check_as_all_kinds(&bytes);
    }
}

#[test]
fn deep_and_large_files_are_refused() {
    let deep = |open: &str, count: usize| format!("x = {}", open.repeat(count));
    for text in [
        deep("[", 100_000),
        deep("{a=", 100_000),
        format!("{} = 1", vec!["a"; 50_000].join(".")),
        "x".repeat(5 << 20),
    ] {
        check_as_all_kinds(text.as_bytes());
    }
}

/// Keys of strategy files, and valid and invalid values for them, one per line.
const KEYS: &str = include_str!("hostile_keys.txt");
const VALUES: &str = include_str!("hostile_values.txt");

fn lines(of: &'static str) -> impl Strategy<Value = &'static str> {
    prop::sample::select(of.lines().collect::<Vec<_>>())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_values_in_a_strategy_are_refused_or_read(
        entries in prop::collection::vec((lines(KEYS), lines(VALUES)), 0..6)
    ) {
        let line = |(key, value): &(&str, &str)| format!("{key} = {value}\n");
        let text: String = entries.iter().map(line).collect();
        check_as_all_kinds(text.as_bytes());
    }
}
