//! Mistakes in boats.

use crate::assert_broken;

const BOATS: &str = r##"
## two thrusts
[thruster]
propeller = { k_ahead = 0.1, n_max_rad_s = 20 } #~ 13: thruster has both, expected either propeller or table_pct_newton

## a table that falls
[thruster]
table_pct_newton = [[-100, -9], [0, 0], [50, 20], [90, 19]] #~ 20: table_pct_newton does not span the settings, expected -100 first and 100 last #~ 51: table_pct_newton has [90, 19] here, expected both to rise

## a centre of gravity outside
hull.x_g_m = 1.5 #~ 14: x_g_m is 1.5, expected -1 to 1, within the hull

## a mass matrix that is not positive definite
hull.added_sway_yaw_kg_m = 90 #~ 28: added_sway_yaw_kg_m is 90, expected a mass matrix that is positive definite: (m + A22)(I + A66) more than (m x_g + A26)²

## too little inertia
hull.x_g_m = 0.5
hull.yaw_inertia_kg_m2 = 5 #~ 26: yaw_inertia_kg_m2 is 5, expected more than m x_g² = 12.5

## resistance that is stiff
hull.sway_linear_kg_s = 5000 #~ 25: hull: sway dies out at 50.0 1/s, expected at most 40 1/s (2 a tick of 0.05 s); its resistance is too large for its inertia

## cross-flow without draught
hull.crossflow_coefficient = 0.8 #~ 1: hull.crossflow_draught_m is missing, expected 0 to 20 with a crossflow_coefficient
"##;

#[test]
fn boats_are_checked() {
    assert_broken("boats/x.toml", "base = \"b.toml\"\n", BOATS);
}
