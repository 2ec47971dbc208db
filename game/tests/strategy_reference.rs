//! The reference page of strategy files is that of the program's types.

use game::scenario;
use std::path::Path;

#[test]
fn the_page_beside_the_strategies_is_that_of_the_types() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/strategies/REFERENCE.md");
    let want = scenario::reference();
    if std::env::var_os("SQUALL_BLESS").is_some() {
        std::fs::write(&path, &want).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(found, want, "{} is behind: run this test with SQUALL_BLESS=1", path.display());
}
