//! Files that are named from different folders.

use crate::program::printed;

/// Built-in files stand in for missing ones of a folder `scenarios`, also if its name is not typed.
#[test]
fn a_file_in_scenarios_is_the_same_from_every_folder() {
    let dir = tempfile::tempdir().unwrap();
    let games = dir.path().join("scenarios/games");
    std::fs::create_dir_all(&games).unwrap();
    let text = "base = \"mixed_2v2.toml\"\nduration_s = 60\nfield = \"../fields/aquaticus_160x80.toml\"\n";
    std::fs::write(games.join("mine.toml"), text).unwrap();
    for (folder, path) in [
        ("", "scenarios/games/mine.toml"),
        ("scenarios", "games/mine.toml"),
        ("scenarios/games", "mine.toml"),
        ("scenarios/games", "../games/mine.toml"),
    ] {
        let said = printed(dir.path().join(folder), &["check", path]);
        assert_eq!(said.trim_end(), format!("{path}: valid game"));
    }
}
