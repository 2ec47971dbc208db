//! Mistakes in who plays, and from where.

use crate::{Case, assert_reported};

const GAMES: &[Case] = &[
    (
        "a tick that does not divide the decision",
        "games/x.toml",
        &[("games/x.toml", "base = \"g.toml\"\ntick_s = 0.03\n")],
        &["games/x.toml:2:10: decision_s is 0.1, expected a multiple of tick_s, 0.03"],
    ),
    (
        "a tick that a boat does not bear",
        "games/x.toml",
        &[
            ("games/x.toml", "base = \"g.toml\"\ntick_s = 0.2\ndecision_s = 0.2\nboat = \"../boats/x.toml\"\n"),
            ("boats/x.toml", "base = \"b.toml\"\nhull.sway_linear_kg_s = 2000\n"),
        ],
        &["games/x.toml:2:10: tick_s is 0.2, expected at most 0.1000: the sway of boat x dies out at 20.0 1/s"],
    ),
    (
        "one team",
        "games/x.toml",
        &[(
            "games/x.toml",
            "base = \"g.toml\"\nteam = [{ name = \"blue\", strategy = \"../strategies/p.toml\" }]\nvehicle = [{ name = \"a\", team = \"blue\" }]\n",
        )],
        &["games/x.toml:2:8: team has 1 entries, expected exactly two [[team]] for now"],
    ),
    (
        "three teams",
        "games/x.toml",
        &[(
            "games/x.toml",
            "base = \"g.toml\"\nteam = [{ name = \"blue\", strategy = \"../strategies/p.toml\" }, { name = \"red\", strategy = \"../strategies/p.toml\" },\n    { name = \"green\" }]\n",
        )],
        &["games/x.toml:3:5: team has 3 entries, expected exactly two [[team]] for now"],
    ),
    (
        "names twice",
        "games/x.toml",
        &[(
            "games/x.toml",
            "base = \"g.toml\"\n[[vehicle]]\nname = \"red_2\"\nteam = \"blue\"\n[[vehicle]]\nname = \"Red Two\"\nteam = \"red\"\n[[fleet]]\nteam = \"red\"\ncount = 3\n",
        )],
        &[
            "games/x.toml:6:8: name is \"Red Two\", expected 1 to 40 of a-z, 0-9 and _",
            "games/x.toml:8:1: name is \"red_2\" again, expected a different one for each vehicle",
        ],
    ),
    (
        "an unknown team",
        "games/x.toml",
        &[("games/x.toml", "base = \"g.toml\"\n[[fleet]]\nteam = \"green\"\ncount = 2\nname = \"g_{}\"\n")],
        &["games/x.toml:3:8: team is \"green\", expected one of blue, red"],
    ),
    (
        "teams of one name",
        "games/x.toml",
        &[(
            "games/x.toml",
            "base = \"g.toml\"\n[[team]]\nname = \"red\"\nstrategy = \"../strategies/p.toml\"\n[[team]]\nname = \"red\"\nstrategy = \"../strategies/p.toml\"\n[[vehicle]]\nname = \"a\"\nteam = \"red\"\n",
        )],
        &["games/x.toml:6:8: name is \"red\" again, expected a different one for each team"],
    ),
    (
        "nobody",
        "games/x.toml",
        &[("games/x.toml", "base = \"g.toml\"\nvehicle = []\n")],
        &["games/x.toml:1:1: vehicle is missing, expected at least one [[vehicle]] or [[fleet]]"],
    ),
    (
        "too many",
        "games/x.toml",
        &[("games/x.toml", "base = \"g.toml\"\nfleet = [{ team = \"red\", count = 9999, name = \"r_{}\" }]\n")],
        &["games/x.toml:2:10: vehicles are 10001 with this one, expected at most 10000"],
    ),
    (
        "no strategy",
        "games/x.toml",
        &[(
            "games/x.toml",
            "base = \"g.toml\"\nteam = [{ name = \"blue\" }, { name = \"red\", strategy = \"../strategies/p.toml\" }]\n",
        )],
        &["games/g.toml:6:12: vehicle.strategy is missing, expected the path of a strategy file here or for the team"],
    ),
    (
        "a source that is none",
        "games/x.toml",
        &[("games/x.toml", "base = \"g.toml\"\nvehicle = [{ name = \"a\", team = \"red\", source = \"real\" }]\n")],
        &["games/x.toml:2:49: source is \"real\", expected one of simulated, external"],
    ),
    (
        "a fleet of real boats, which are named one by one",
        "games/x.toml",
        &[(
            "games/x.toml",
            "base = \"g.toml\"\nvehicle = []\nfleet = [{ team = \"red\", count = 2, source = \"external\" }]\n",
        )],
        &["games/x.toml:3:37: source is unknown, expected one of boat, count, name, spawn, strategy, team"],
    ),
    (
        "a fleet without a number in its name",
        "games/x.toml",
        &[("games/x.toml", "base = \"g.toml\"\nvehicle = []\nfleet = [{ team = \"red\", count = 2, name = \"r\" }]\n")],
        &["games/x.toml:3:44: name is \"r\", expected {} in it, where the number goes"],
    ),
];

#[test]
fn games_are_checked() {
    assert_reported(GAMES);
}

const START_POSITIONS: &[Case] = &[
    (
        "an unknown point",
        "games/x.toml",
        &[("games/x.toml", "base = \"g.toml\"\nvehicle = [{ name = \"a\", team = \"red\", at = \"QH\" }]\n")],
        &["games/x.toml:2:45: at is \"QH\", expected a named point, one of {points} (did you mean CH?)"],
    ),
    (
        "a point on the edge",
        "games/x.toml",
        &[("games/x.toml", "base = \"g.toml\"\nvehicle = [{ name = \"a\", team = \"red\", at = \"PPB\" }]\n")],
        &[
            "games/x.toml:2:45: at is [160, 0], expected a position inside the field: it is 160.00 m along (of 160) and 0.00 m across (of 80)",
        ],
    ),
    (
        "a place outside",
        "games/x.toml",
        &[(
            "games/x.toml",
            "base = \"g.toml\"\nvehicle = [{ name = \"a\", team = \"red\", at = [10, 81], heading_deg = 720 }]\n",
        )],
        &[
            "games/x.toml:2:45: at is [10, 81], expected a position inside the field: it is 10.00 m along (of 160) and 81.00 m across (of 80)",
            "games/x.toml:2:69: heading_deg is 720, expected -360 to 360",
        ],
    ),
    (
        "a place of three numbers",
        "games/x.toml",
        &[("games/x.toml", "base = \"g.toml\"\nvehicle = [{ name = \"a\", team = \"red\", at = [10, 8, 1] }]\n")],
        &["games/x.toml:2:45: at has 3 entries, expected a pair of numbers [a, b]"],
    ),
    (
        "two boats in one place",
        "games/x.toml",
        &[(
            "games/x.toml",
            "base = \"g.toml\"\nvehicle = [\n    { name = \"a\", team = \"red\", at = [100, 40] },\n    { name = \"b\", team = \"blue\", at = [101, 41] },\n]\n",
        )],
        &["games/x.toml:4:39: b starts 1.41 m from a, expected a boat's length, 2 m"],
    ),
    (
        "a line too crowded",
        "games/x.toml",
        &[("games/x.toml", "base = \"g.toml\"\n[[fleet]]\nteam = \"blue\"\ncount = 60\nname = \"b_{}\"\n")],
        &["games/x.toml:2:1: b_1 starts 1.29 m from blue_one, expected a boat's length, 2 m"],
    ),
    (
        "a boat on an obstacle",
        "games/x.toml",
        &[
            (
                "games/x.toml",
                "base = \"g.toml\"\nfield = \"../fields/x.toml\"\n[[vehicle]]\nname = \"a\"\nteam = \"blue\"\nat = [80, 41]\n",
            ),
            ("fields/x.toml", "base = \"f.toml\"\n[[obstacle]]\npolygon = [[79, 40], [79, 42], [82, 42], [82, 40]]\n"),
        ],
        &["games/x.toml:6:6: a starts at [80, 41], on an obstacle, expected open water"],
    ),
    (
        "both ways to start",
        "games/x.toml",
        &[(
            "games/x.toml",
            "base = \"g.toml\"\nvehicle = [{ name = \"a\", team = \"red\", at = \"CH\", heading_deg = 3, spawn = {} }]\n",
        )],
        &[
            "games/x.toml:2:45: vehicle has at and spawn, expected one of them",
            "games/x.toml:2:65: heading_deg is given with spawn, expected with at only",
        ],
    ),
    (
        "a rectangle the wrong way round",
        "games/x.toml",
        &[(
            "games/x.toml",
            "base = \"g.toml\"\nvehicle = [{ name = \"a\", team = \"red\", spawn = { along_m = [9, 3], across_m = [0, 90] } }]\n",
        )],
        &[
            "games/x.toml:2:60: along_m is [9, 3], expected the smaller one first",
            "games/x.toml:2:79: across_m is 90, expected 0 to 80",
        ],
    ),
    (
        "a rectangle too small",
        "games/x.toml",
        &[(
            "games/x.toml",
            "base = \"g.toml\"\nfleet = [{ team = \"red\", count = 40, name = \"r_{}\", spawn = { along_m = [10, 20] } }]\n",
        )],
        &["games/x.toml:2:61: spawn has 760 m² for 40 boats with gap_m 5, expected at least 2000 m²"],
    ),
];

#[test]
fn start_positions_are_checked() {
    assert_reported(START_POSITIONS);
}
