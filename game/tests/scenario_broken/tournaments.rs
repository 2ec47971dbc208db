//! Mistakes in who enters a tournament, and in the files it names.

use crate::{Case, assert_reported};

const TOURNAMENTS: &[Case] = &[
    (
        "nothing named",
        "tournaments/x.toml",
        &[("tournaments/x.toml", "\n")],
        &[
            "tournaments/x.toml:1:1: entry has 0 entries, expected 2 to 100",
            "tournaments/x.toml:1:1: game is missing, expected the path of a file",
        ],
    ),
    (
        "one entry",
        "tournaments/x.toml",
        &[("tournaments/x.toml", "base = \"t.toml\"\n[[entry]]\nname = \"a\"\nstrategy = \"../strategies/p.toml\"\n")],
        &["tournaments/x.toml:2:1: entry has 1 entries, expected 2 to 100"],
    ),
    (
        "entries without names and strategies",
        "tournaments/x.toml",
        &[(
            "tournaments/x.toml",
            "base = \"t.toml\"\n[[entry]]\nstrategy = \"../strategies/p.toml\"\n[[entry]]\nname = \"b\"\n[[entry]]\nname = \"C c\"\nstrategy = \"../strategies/p.toml\"\n",
        )],
        &[
            "tournaments/x.toml:2:1: entry.name is missing, expected 1 to 40 of a-z, 0-9 and _",
            "tournaments/x.toml:4:1: entry.strategy is missing, expected the path of a file",
            "tournaments/x.toml:7:8: name is \"C c\", expected 1 to 40 of a-z, 0-9 and _",
        ],
    ),
    (
        "names twice",
        "tournaments/x.toml",
        &[(
            "tournaments/x.toml",
            "base = \"t.toml\"\n[[entry]]\nname = \"a\"\nstrategy = \"../strategies/p.toml\"\n[[entry]]\nname = \"a\"\nstrategy = \"../strategies/p.toml\"\n",
        )],
        &["tournaments/x.toml:6:8: name is \"a\" again, expected a different one for each entry"],
    ),
    (
        "numbers out of range, and a value of another type",
        "tournaments/x.toml",
        &[("tournaments/x.toml", "base = \"t.toml\"\ngames = 1\nseed = -1\nself_play = 3\n")],
        &[
            "tournaments/x.toml:2:9: games is 1, expected 2 to 1000000",
            "tournaments/x.toml:3:8: seed is -1, expected 0 to 9223372036854775807",
            "tournaments/x.toml:4:13: self_play is 3, expected true or false",
        ],
    ),
    (
        "mistakes in files that are named",
        "tournaments/x.toml",
        &[
            ("tournaments/x.toml", "base = \"t.toml\"\nsea = \"../seas/none.toml\"\nround = 3\n"),
            ("games/g.toml", "base = \"../games/h.toml\"\nseed = -1\n"),
            (
                "games/h.toml",
                "field = \"../fields/f.toml\"\nrules = \"../rules/r.toml\"\nboat = \"../boats/b.toml\"\nteam = [{ name = \"blue\", strategy = \"../strategies/p.toml\" }, { name = \"red\", strategy = \"../strategies/p.toml\" }]\nvehicle = [{ name = \"a\", team = \"blue\" }]\n",
            ),
            ("strategies/p.toml", "roles = []\n"),
        ],
        &[
            "games/g.toml:2:8: seed is -1, expected 0 to 9223372036854775807",
            "strategies/p.toml:1:9: roles has 0 entries, expected 1 to 1000",
            "tournaments/x.toml:2:7: seas/none.toml cannot be read (No such file or directory (os error 2)), expected a file",
            "tournaments/x.toml:3:1: round is unknown, expected one of base, entry, game, games, sea, seed, self_play",
        ],
    ),
];

#[test]
fn tournaments_are_checked() {
    assert_reported(TOURNAMENTS);
}
