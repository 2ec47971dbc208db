//! Mistakes in single values and in shapes.

use crate::{Case, assert_reported};

const VALUES: &[Case] = &[
    (
        "a gateway beyond what is allowed",
        "gateways/x.toml",
        &[(
            "gateways/x.toml",
            "drive = \"sails\"\norder_ttl_s = 60\n[nav]\nquality_min = 0\n[loops]\nthrust_map = [[0, 0], [50, 2], [40, 3]]\n",
        )],
        &[
            "gateways/x.toml:1:9: drive is \"sails\", expected one of thrust, speed",
            "gateways/x.toml:2:15: order_ttl_s is 60, expected 0.1 to 10",
            "gateways/x.toml:4:15: quality_min is 0, expected 1 to 8",
            "gateways/x.toml:6:32: thrust_map has [40, 3] here, expected both to rise",
        ],
    ),
    (
        "a number for text",
        "strategies/x.toml",
        &[("strategies/x.toml", "base = \"p.toml\"\nabout = 3\n")],
        &["strategies/x.toml:2:9: about is 3, expected a string"],
    ),
    (
        "an unknown key",
        "rules/x.toml",
        &[("rules/x.toml", "tag_radius = 10\n")],
        &["rules/x.toml:1:1: tag_radius is unknown, expected one of {keys of rules} (did you mean tag_radius_m?)"],
    ),
    (
        "an unknown key in a table",
        "boats/x.toml",
        &[("boats/x.toml", "base = \"b.toml\"\n[hull]\nmas_kg = 3\n")],
        &["boats/x.toml:3:1: mas_kg is unknown, expected one of {keys of hulls} (did you mean mass_kg?)"],
    ),
    (
        "text for a number",
        "rules/x.toml",
        &[("rules/x.toml", "\ntag_radius_m = \"far\"\n")],
        &["rules/x.toml:2:16: tag_radius_m is the string \"far\", expected a number"],
    ),
    (
        "a fraction for a whole number",
        "rules/x.toml",
        &[("rules/x.toml", "win_score = 2.5\n")],
        &["rules/x.toml:1:13: win_score is 2.5, expected a whole number"],
    ),
    (
        "a number for a table",
        "boats/x.toml",
        &[("boats/x.toml", "base = \"b.toml\"\nhull = 3\n")],
        &["boats/x.toml:2:8: hull is 3, expected a table"],
    ),
    (
        "not a number",
        "boats/x.toml",
        &[("boats/x.toml", "base = \"b.toml\"\nautopilot.speed_max_m_s = nan\n")],
        &["boats/x.toml:2:27: speed_max_m_s is nan, expected 0.1 to 60"],
    ),
    (
        "infinity",
        "boats/x.toml",
        &[("boats/x.toml", "base = \"b.toml\"\nlength_m = inf\n")],
        &["boats/x.toml:2:12: length_m is inf, expected 0.1 to 100"],
    ),
    (
        "out of range",
        "seas/x.toml",
        &[(
            "seas/x.toml",
            "# Too thick.\nwater_density_kg_m3 = 13600\ncurrent = { speed_m_s = -1, toward_deg = 400 }\n",
        )],
        &[
            "seas/x.toml:2:23: water_density_kg_m3 is 13600, expected 900 to 1300",
            "seas/x.toml:3:25: speed_m_s is -1, expected 0 to 10",
            "seas/x.toml:3:42: toward_deg is 400, expected -360 to 360",
        ],
    ),
    (
        "an unknown choice",
        "rules/x.toml",
        &[("rules/x.toml", "capture_at = \"own_flags\"\n")],
        &[
            "rules/x.toml:1:14: capture_at is \"own_flags\", expected one of own_flag, own_side, own_corners (did you mean own_flag?)",
        ],
    ),
    (
        "a bad file name",
        "seas/Dead-Sea.toml",
        &[("seas/Dead-Sea.toml", "")],
        &["seas/Dead-Sea.toml:1:1: the file's name is \"Dead-Sea\", expected 1 to 40 of a-z, 0-9 and _"],
    ),
    (
        "everything missing",
        "fields/x.toml",
        &[("fields/x.toml", "# Nothing.\n")],
        &[
            "fields/x.toml:1:1: datum.lat_deg is missing, expected -90 to 90",
            "fields/x.toml:1:1: datum.lon_deg is missing, expected -180 to 180",
            "fields/x.toml:1:1: depth_m is missing, expected 10 to 20000",
            "fields/x.toml:1:1: width_m is missing, expected 10 to 20000",
        ],
    ),
    (
        "a flag kept from its own boats",
        "rules/x.toml",
        &[(
            "rules/x.toml",
            "flag_keepout_m = 10\nuntag_radius_m = 10\ncapture_radius_m = 8\nuntag_at = \"own_flag\"\ncapture_at = \"own_flag\"\n",
        )],
        &[
            "rules/x.toml:1:18: flag_keepout_m is 10, expected less than capture_radius_m, which is 8",
            "rules/x.toml:1:18: flag_keepout_m is 10, expected less than untag_radius_m, which is 10",
        ],
    ),
    (
        "a flag at the scrimmage line",
        "fields/x.toml",
        &[("fields/x.toml", "base = \"f.toml\"\nflag_inset_m = 80\n")],
        &["fields/x.toml:2:16: flag_inset_m is 80, expected more than 0 and less than 80"],
    ),
];

#[test]
fn single_values_are_checked_where_they_stand() {
    assert_reported(VALUES);
}

const SHAPES: &[Case] = &[
    (
        "two corners",
        "fields/x.toml",
        &[("fields/x.toml", "base = \"f.toml\"\n[[obstacle]]\npolygon = [[50, 50], [60, 50]]\n")],
        &["fields/x.toml:3:11: polygon has 2 entries, expected 3 to 1000"],
    ),
    (
        "a bow tie",
        "fields/x.toml",
        &[("fields/x.toml", "base = \"f.toml\"\n[[obstacle]]\npolygon = [[50, 50], [60, 60], [60, 50], [50, 60]]\n")],
        &["fields/x.toml:3:32: polygon's side 1 meets its side 3, expected no crossing"],
    ),
    (
        "a corner of three numbers",
        "fields/x.toml",
        &[("fields/x.toml", "base = \"f.toml\"\ncorner = [1, 2, 3]\n")],
        &["fields/x.toml:2:10: corner has 3 entries, expected a pair of numbers [a, b]"],
    ),
    (
        "an obstacle far away",
        "fields/x.toml",
        &[("fields/x.toml", "base = \"f.toml\"\n[[obstacle]]\ncircle = { centre = [-200, 0], radius_m = 3 }\n")],
        &["fields/x.toml:2:1: obstacle is off the field, expected at most 50 m outside of it"],
    ),
    (
        "an obstacle on a flag",
        "fields/x.toml",
        &[("fields/x.toml", "base = \"f.toml\"\n[[obstacle]]\ncircle = { centre = [21, 40], radius_m = 3 }\n")],
        &["fields/x.toml:2:1: obstacle stands on a flag, expected open water there"],
    ),
    (
        "an obstacle of no shape",
        "fields/x.toml",
        &[("fields/x.toml", "base = \"f.toml\"\n[[obstacle]]\n[[obstacle]]\ncircle = { radius_m = 1 }\n")],
        &[
            "fields/x.toml:2:1: obstacle says neither or both, expected either circle or polygon",
            "fields/x.toml:4:10: circle.centre is missing, expected a pair of numbers [a, b]",
        ],
    ),
    (
        "an extra flag outside",
        "fields/x.toml",
        &[("fields/x.toml", "base = \"f.toml\"\nflag = [{ team = \"first\", at = [-1, 40] }, { at = [30, 30] }]\n")],
        &[
            "fields/x.toml:2:32: at is [-1, 40], expected a position inside the field: it is -1.00 m along (of 160) and 40.00 m across (of 80)",
            "fields/x.toml:2:44: flag.team is missing, expected one of first, second",
        ],
    ),
];

#[test]
fn shapes_are_checked() {
    assert_reported(SHAPES);
}
