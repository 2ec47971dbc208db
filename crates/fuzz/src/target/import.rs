//! Logs from other programs: each is read or rejected, whichever format it is taken for.

use super::{Target, check_shown, mutations};
use ::import::{Input, read, table};
use std::path::Path;

pub(super) const TARGET: Target = Target {
    name: "import",
    seeds,
    change: mutations,
    check,
    // Chunks of bags are compressed.
    allocated_max: (2 << 30, 5000),
};

fn seeds() -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../import/tests/logs");
    let files = std::fs::read_dir(folder).expect("logs of other programs");
    let files = files.map(|file| std::fs::read(file.expect("a file").path()).expect("a log"));
    let table = b"t,lat,lon,sog_kn,hdg\n1777636800,42.3584,-71.0874,3.9,0\n1777636801,42.3585,-71.0874,3.9,0\n";
    files.chain([table.to_vec()]).collect()
}

fn check(bytes: &[u8]) {
    let file = tempfile::NamedTempFile::new().expect("a file");
    std::fs::write(file.path(), bytes).expect("it is written");
    let input = Input {
        path: file.path().to_owned(),
        boat: None,
    };
    match read(&[input], None, None) {
        Ok(imported) => {
            for boat in imported.logs.boats() {
                table(&imported.logs, &boat);
            }
        }
        Err(error) => check_shown(&error),
    }
}
