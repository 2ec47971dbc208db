//! Mistakes in boats.

use crate::{Case, assert_reported};

const BOATS: &[Case] = &[
    (
        "two thrusts",
        "boats/x.toml",
        &[("boats/x.toml", "base = \"b.toml\"\n[thruster]\npropeller = { k_ahead = 0.1, n_max_rad_s = 20 }\n")],
        &["boats/x.toml:3:13: thruster has both, expected either propeller or table_pct_newton"],
    ),
    (
        "a table that falls",
        "boats/x.toml",
        &[(
            "boats/x.toml",
            "base = \"b.toml\"\n[thruster]\ntable_pct_newton = [[-100, -9], [0, 0], [50, 20], [90, 19]]\n",
        )],
        &[
            "boats/x.toml:3:20: table_pct_newton does not span the settings, expected -100 first and 100 last",
            "boats/x.toml:3:51: table_pct_newton has [90, 19] here, expected both to rise",
        ],
    ),
    (
        "a centre of gravity outside",
        "boats/x.toml",
        &[("boats/x.toml", "base = \"b.toml\"\nhull.x_g_m = 1.5\n")],
        &["boats/x.toml:2:14: x_g_m is 1.5, expected -1 to 1, within the hull"],
    ),
    (
        "a mass matrix that is not positive definite",
        "boats/x.toml",
        &[("boats/x.toml", "base = \"b.toml\"\nhull.added_sway_yaw_kg_m = 90\n")],
        &[
            "boats/x.toml:2:28: added_sway_yaw_kg_m is 90, expected a mass matrix that is positive definite: (m + A22)(I + A66) more than (m x_g + A26)²",
        ],
    ),
    (
        "too little inertia",
        "boats/x.toml",
        &[("boats/x.toml", "base = \"b.toml\"\nhull.x_g_m = 0.5\nhull.yaw_inertia_kg_m2 = 5\n")],
        &["boats/x.toml:3:26: yaw_inertia_kg_m2 is 5, expected more than m x_g² = 12.5"],
    ),
    (
        "resistance that is stiff",
        "boats/x.toml",
        &[("boats/x.toml", "base = \"b.toml\"\nhull.sway_linear_kg_s = 5000\n")],
        &[
            "boats/x.toml:2:25: hull: sway dies out at 50.0 1/s, expected at most 40 1/s (2 a tick of 0.05 s); its resistance is too large for its inertia",
        ],
    ),
    (
        "cross-flow without draught",
        "boats/x.toml",
        &[("boats/x.toml", "base = \"b.toml\"\nhull.crossflow_coefficient = 0.8\n")],
        &["boats/x.toml:2:1: hull.crossflow_draught_m is missing, expected 0 to 20 with a crossflow_coefficient"],
    ),
];

#[test]
fn boats_are_checked() {
    assert_reported(BOATS);
}
