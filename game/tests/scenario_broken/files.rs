//! Mistakes in files, in those they name, and in their syntax.

use crate::{Case, assert_reported};

const FILES: &[Case] = &[
    (
        "many mistakes in one file",
        "boats/x.toml",
        &[(
            "boats/x.toml",
            "length_m = \"long\"\nbeam_m = -1\nwings = 2\n[hull]\nmass_kg = nan\nmunk_factor = 2\n[thruster]\narm_m = 0.4\n",
        )],
        &[
            "boats/x.toml:1:1: autopilot is missing, expected it, or kinematic in place of thruster and autopilot",
            "boats/x.toml:1:12: length_m is the string \"long\", expected a number",
            "boats/x.toml:2:10: beam_m is -1, expected 0.05 to 50",
            "boats/x.toml:3:1: wings is unknown, expected one of autopilot, base, beam_m, compass, draught_m, gps, hull, imu, kinematic, length_m, thruster, windage",
            "boats/x.toml:5:11: mass_kg is nan, expected 0.1 to 1000000",
            "boats/x.toml:6:15: munk_factor is 2, expected 0 to 1",
            "boats/x.toml:7:1: thruster.propeller is missing, expected it or table_pct_newton",
        ],
    ),
    (
        "a mistake in a base",
        "boats/x.toml",
        &[
            ("boats/x.toml", "base = \"y.toml\"\nbeam_m = 0\n"),
            ("boats/y.toml", "base = \"b.toml\"\n\nlength_m = 0\nbeam_m = -1\n"),
        ],
        &[
            "boats/x.toml:2:10: beam_m is 0, expected 0.05 to 50",
            "boats/y.toml:3:12: length_m is 0, expected 0.1 to 100",
        ],
    ),
    (
        "mistakes in files that are named",
        "games/x.toml",
        &[
            ("games/x.toml", "base = \"g.toml\"\nseed = -1\n"),
            ("fields/f.toml", "width_m = 160\ndepth_m = 1\n"),
            ("strategies/p.toml", "roles = [\"none.toml\"]\n"),
            ("boats/b.toml", "length_m = \n"),
        ],
        &[
            "boats/b.toml:1:12: string values must be quoted, expected literal string",
            "fields/f.toml:1:1: datum.lat_deg is missing, expected -90 to 90",
            "fields/f.toml:1:1: datum.lon_deg is missing, expected -180 to 180",
            "fields/f.toml:2:11: depth_m is 1, expected 10 to 20000",
            "games/x.toml:2:8: seed is -1, expected 0 to 9223372036854775807",
            "strategies/p.toml:1:10: strategies/none.toml cannot be read (No such file or directory (os error 2)), expected a file",
        ],
    ),
    (
        "a missing file",
        "games/x.toml",
        &[("games/x.toml", "base = \"g.toml\"\nfield = \"../fields/none.toml\"\nsea = \"../seas\"\n")],
        &[
            "games/x.toml:2:9: fields/none.toml cannot be read (No such file or directory (os error 2)), expected a file",
            "games/x.toml:3:7: seas is not a file, expected one",
        ],
    ),
    (
        "no file at all",
        "games/none.toml",
        &[],
        &["games/none.toml:1:1: cannot be read (No such file or directory (os error 2)), expected a file"],
    ),
    (
        "a missing base",
        "seas/x.toml",
        &[("seas/x.toml", "\nbase = \"none.toml\"\n")],
        &["seas/x.toml:2:8: seas/none.toml cannot be read (No such file or directory (os error 2)), expected a file"],
    ),
    (
        "a base that is itself",
        "seas/x.toml",
        &[("seas/x.toml", "base = \"../seas/x.toml\"\n")],
        &["seas/x.toml:1:8: base refers back to itself (seas/x.toml on seas/x.toml), expected an end"],
    ),
    (
        "bases that refer to each other",
        "seas/x.toml",
        &[("seas/x.toml", "base = \"y.toml\"\n"), ("seas/y.toml", "# On.\nbase = \"x.toml\"\n")],
        &["seas/y.toml:2:8: base refers back to itself (seas/x.toml on seas/y.toml on seas/x.toml), expected an end"],
    ),
    (
        "a base that is no path",
        "seas/x.toml",
        &[("seas/x.toml", "base = 3\n")],
        &["seas/x.toml:1:8: base is 3, expected a string"],
    ),
    (
        "nothing named",
        "games/x.toml",
        &[("games/x.toml", "\n")],
        &[
            "games/x.toml:1:1: field is missing, expected the path of a file",
            "games/x.toml:1:1: rules is missing, expected the path of a file",
            "games/x.toml:1:1: team has 0 entries, expected exactly two [[team]] for now",
            "games/x.toml:1:1: vehicle is missing, expected at least one [[vehicle]] or [[fleet]]",
        ],
    ),
    (
        "a sea file for rules",
        "games/x.toml",
        &[
            ("games/x.toml", "base = \"g.toml\"\nrules = \"../seas/x.toml\"\n"),
            ("seas/x.toml", "water_density_kg_m3 = 1000\n"),
        ],
        &["seas/x.toml:1:1: water_density_kg_m3 is unknown, expected one of {keys of rules}"],
    ),
    (
        "two files of one name",
        "games/x.toml",
        &[
            (
                "games/x.toml",
                "base = \"g.toml\"\nvehicle = [{ name = \"a\", team = \"red\" }, { name = \"c\", team = \"red\", boat = \"b.toml\" }]\n",
            ),
            ("games/b.toml", "base = \"../boats/b.toml\"\n"),
        ],
        &["games/x.toml:2:77: b.toml is the second file named \"b\", expected different names"],
    ),
];

#[test]
fn several_files_are_reported_at_once() {
    assert_reported(FILES);
}

const SYNTAX: &[Case] = &[
    (
        "no value",
        "seas/x.toml",
        &[("seas/x.toml", "# A sea.\nwater_density_kg_m3 =\ncurrent = { speed_m_s = 99 }\n")],
        &[
            "seas/x.toml:2:22: string values must be quoted, expected literal string",
            "seas/x.toml:3:25: speed_m_s is 99, expected 0 to 10",
        ],
    ),
    (
        "a key twice",
        "seas/x.toml",
        &[("seas/x.toml", "water_density_kg_m3 = 1000\nwater_density_kg_m3 = 1025\n")],
        &["seas/x.toml:2:1: duplicate key"],
    ),
    (
        "a string without an end",
        "strategies/x.toml",
        &[("strategies/x.toml", "roles = [\"idle]\nassignment = \"fixed\"\n")],
        &[
            "strategies/x.toml:1:16: invalid basic string, expected `\"`",
            "strategies/x.toml:2:1: missing comma between array elements, expected `,`",
            "strategies/x.toml:2:1: string values must be quoted, expected literal string",
            "strategies/x.toml:2:12: unexpected `=` in array, expected value, `]`",
            "strategies/x.toml:2:14: missing comma between array elements, expected `,`",
            "strategies/x.toml:2:21: unclosed array, expected `]`",
        ],
    ),
    (
        "a broken table head",
        "boats/x.toml",
        &[("boats/x.toml", "base = \"b.toml\"\n[hull\nmass_kg = -5\n")],
        &["boats/x.toml:2:6: unclosed table, expected `]`"],
    ),
    (
        "a key of too many parts",
        "seas/x.toml",
        &[(
            "seas/x.toml",
            "a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a = 1\n",
        )],
        &["seas/x.toml:1:202: found a key of more than 100 parts, expected at most 3"],
    ),
];

#[test]
fn syntax_is_reported_with_the_rest() {
    assert_reported(SYNTAX);
}
