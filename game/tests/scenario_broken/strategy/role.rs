//! Mistakes in roles, and in the files that they name.

use crate::{Case, assert_reported};

const ROLES: &[Case] = &[
    (
        "no roles",
        "strategies/x.toml",
        &[("strategies/x.toml", "roles = []\n")],
        &["strategies/x.toml:1:9: roles has 0 entries, expected 1 to 1000"],
    ),
    (
        "roles that are no files",
        "strategies/x.toml",
        &[("strategies/x.toml", "roles = [\"s.toml\", \"easy_defender\"]\n")],
        &[
            "strategies/x.toml:1:20: strategies/easy_defender cannot be read (No such file or directory (os error 2)), expected a file",
        ],
    ),
    (
        "a number for a role",
        "strategies/x.toml",
        &[("strategies/x.toml", "roles = [\"s.toml\", 3]\n")],
        &["strategies/x.toml:1:20: roles is 3, expected a string"],
    ),
    (
        "an unknown way to deal",
        "strategies/x.toml",
        &[("strategies/x.toml", "roles = [\"s.toml\"]\nassignment = \"seed\"\n")],
        &[r#"strategies/x.toml:2:14: assignment is "seed", expected one of fixed, seeded (did you mean seeded?)"#],
    ),
    (
        "roles that deal roles",
        "strategies/x.toml",
        &[("strategies/x.toml", "roles = [\"y.toml\"]\n"), ("strategies/y.toml", "roles = [\"s.toml\"]\n")],
        &[
            r#"strategies/x.toml:1:10: roles names "y.toml", which deals roles itself, expected the file of one program"#,
        ],
    ),
    (
        "roles that are the file itself",
        "strategies/x.toml",
        &[("strategies/x.toml", "roles = [\"x.toml\"]\n")],
        &[
            r#"strategies/x.toml:1:10: roles names "x.toml", which deals roles itself, expected the file of one program"#,
        ],
    ),
    (
        "roles and a program",
        "strategies/x.toml",
        &[(
            "strategies/x.toml",
            "base = \"s.toml\"\nroles = [\"s.toml\"]\nhelm = {}\nmode = []\n[variables]\na = 1\n[[rule]]\nwhen = \"tagged\"\nset = { a = 2 }\n",
        )],
        &[
            "strategies/s.toml:1:12: behaviour.stay_in is given with roles, expected in the files that roles names",
            "strategies/s.toml:3:12: behaviour.keep_clear is given with roles, expected in the files that roles names",
            "strategies/x.toml:3:8: helm is given with roles, expected in the files that roles names",
            "strategies/x.toml:4:8: mode is given with roles, expected in the files that roles names",
            "strategies/x.toml:5:1: variables is given with roles, expected in the files that roles names",
            "strategies/x.toml:7:1: rule is given with roles, expected in the files that roles names",
        ],
    ),
    (
        "a way to deal nothing",
        "strategies/x.toml",
        &[("strategies/x.toml", "base = \"s.toml\"\nassignment = \"fixed\"\n")],
        &["strategies/x.toml:2:14: assignment is given without roles, expected with them only"],
    ),
    (
        "a mistake in the file of a role that occurs twice",
        "strategies/x.toml",
        &[
            ("strategies/x.toml", "roles = [\"y.toml\", \"s.toml\", \"y.toml\"]\n"),
            (
                "strategies/y.toml",
                "base = \"s.toml\"\n[[mode]]\nname = \"a\"\nwhen = \"taged\"\n[[mode]]\nname = \"b\"\n",
            ),
        ],
        &[
            r#"strategies/y.toml:4:9: when has "taged" here, which is unknown, expected a variable, a fact such as tagged or time_s, or a call such as distance(own_flag) (did you mean tagged?)"#,
        ],
    ),
    (
        "a mistake in the base of a role",
        "games/x.toml",
        &[
            ("games/x.toml", "base = \"g.toml\"\n"),
            ("strategies/p.toml", "roles = [\"y.toml\"]\n"),
            ("strategies/y.toml", "base = \"z.toml\"\n[behaviour.go]\nspeed_m_s = 70\n"),
            ("strategies/z.toml", "base = \"s.toml\"\n[behaviour.go]\nkind = \"waypoint\"\npoints = [\"CG\"]\n"),
        ],
        &[
            "strategies/y.toml:3:13: speed_m_s is 70, expected 0 to 60",
            r#"strategies/z.toml:4:11: points is "CG", expected [x, y], {places} (did you mean CB?)"#,
        ],
    ),
    (
        "a role laid over a base of another kind",
        "strategies/x.toml",
        &[
            ("strategies/x.toml", "base = \"s.toml\"\n[behaviour.keep_clear]\nkind = \"full_stop\"\n"),
            (
                "strategies/s.toml",
                "[behaviour.stay_in]\nkind = \"op_region\"\n[behaviour.keep_clear]\nkind = \"avoid_collision\"\nouter_m = 20\n",
            ),
        ],
        &[
            "strategies/s.toml:5:1: outer_m is unknown, expected one of kind, {keys of all}",
            "strategies/x.toml:1:1: mode active has no avoid_collision on guard, expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
        ],
    ),
];

#[test]
fn roles_are_checked() {
    assert_reported(ROLES);
}
