//! The reference pages of scenario files match the program's types.

use crate::kinds::KINDS;
use std::path::Path;

#[test]
fn the_pages_beside_the_files_are_those_of_the_types() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    for (page, want) in
        [("REFERENCE.md", scenario::file_reference(KINDS)), ("strategies/REFERENCE.md", scenario::reference())]
    {
        let path = folder.join(page);
        if std::env::var_os("SQUALL_BLESS").is_some() {
            std::fs::write(&path, &want).unwrap();
        }
        let found = std::fs::read_to_string(&path).unwrap_or_default();
        assert_eq!(found, want, "{} is behind: run this test with SQUALL_BLESS=1", path.display());
    }
}
