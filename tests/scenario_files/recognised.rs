//! How the program recognises the kind of a file.

use crate::kinds::KINDS;
use experiment::sweep::Sweep;
use experiment::tournament::Tournament;
use gateway::config::Gateway;
use learn::rewards::Rewards;
use learn::training::Training;
use scenario::Kind;
use std::collections::BTreeSet;
use std::path::Path;

#[test]
fn a_file_outside_of_the_folders_is_told_by_its_keys() {
    for (keys, want) in [
        (vec!["field", "team"], Kind::GAME),
        (vec!["width_m", "depth_m"], Kind::FIELD),
        (vec!["points"], Kind::RULES),
        (vec!["hull", "typo"], Kind::BOAT),
        (vec!["current"], Kind::SEA),
        (vec!["roles", "base"], Kind::STRATEGY),
        (
            vec!["game", "entry", "sea", "seed"],
            Kind::of::<Tournament>(),
        ),
        (
            vec!["order_ttl_s", "fence", "limits"],
            Kind::of::<Gateway>(),
        ),
        (vec!["boat", "enemy", "potential"], Kind::of::<Rewards>()),
        (vec!["stage", "observation", "seed"], Kind::of::<Training>()),
        (vec!["game", "opponent", "axis"], Kind::of::<Sweep>()),
        (vec!["base"], Kind::GAME),
        (vec![], Kind::GAME),
    ] {
        let keys = keys.into_iter().map(str::to_owned).collect();
        assert_eq!(Kind::by_keys(KINDS, &keys), want, "{keys:?}");
    }
    let keys = |keys: &[&str]| {
        keys.iter()
            .map(|key| (*key).to_owned())
            .collect::<BTreeSet<String>>()
    };
    assert_eq!(
        Kind::GAME.other_by_keys(KINDS, &keys(&["about", "game", "opponent", "axis"])),
        Some(Kind::of::<Sweep>())
    );
    assert_eq!(
        Kind::GAME.other_by_keys(KINDS, &keys(&["field", "team", "typo"])),
        None
    );
    assert_eq!(
        Kind::SEA.other_by_keys(KINDS, &keys(&["typo", "other"])),
        None
    );
    assert_eq!(
        Kind::by_folder(KINDS, Path::new("x/seas/calm.toml")),
        Some(Kind::SEA)
    );
    assert_eq!(Kind::by_folder(KINDS, Path::new("calm.toml")), None);
}
