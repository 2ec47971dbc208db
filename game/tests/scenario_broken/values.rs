//! Mistakes in single values and in shapes.

use crate::assert_broken;

const VALUES: &str = r##"
## a gateway beyond what is allowed
--- gateways/x.toml
drive = "sails" #~ 9: drive is "sails", expected one of thrust, speed
order_ttl_s = 60 #~ 15: order_ttl_s is 60, expected 0.1 to 10
[nav]
quality_min = 0 #~ 15: quality_min is 0, expected 1 to 8
[loops]
thrust_map = [[0, 0], [50, 2], [40, 3]] #~ 32: thrust_map has [40, 3] here, expected both to rise

## a number for text
--- strategies/x.toml
base = "p.toml"
about = 3 #~ 9: about is 3, expected a string

## an unknown key
--- rules/x.toml
tag_radius = 10 #~ 1: tag_radius is unknown, expected one of {keys of rules} (did you mean tag_radius_m?)

## an unknown key in a table
--- boats/x.toml
base = "b.toml"
[hull]
mas_kg = 3 #~ 1: mas_kg is unknown, expected one of {keys of hulls} (did you mean mass_kg?)

## text for a number
--- rules/x.toml
tag_radius_m = "far" #~ 16: tag_radius_m is the string "far", expected a number

## a fraction for a whole number
--- rules/x.toml
win_score = 2.5 #~ 13: win_score is 2.5, expected a whole number

## a number for a table
--- boats/x.toml
base = "b.toml"
hull = 3 #~ 8: hull is 3, expected a table

## not a number
--- boats/x.toml
base = "b.toml"
autopilot.speed_max_m_s = nan #~ 27: speed_max_m_s is nan, expected 0.1 to 60

## infinity
--- boats/x.toml
base = "b.toml"
length_m = inf #~ 12: length_m is inf, expected 0.1 to 100

## out of range
--- seas/x.toml
# Too thick.
water_density_kg_m3 = 13600 #~ 23: water_density_kg_m3 is 13600, expected 900 to 1300
current = { speed_m_s = -1, toward_deg = 400 } #~ 25: speed_m_s is -1, expected 0 to 10 #~ 42: toward_deg is 400, expected -360 to 360

## an unknown choice
--- rules/x.toml
capture_at = "own_flags" #~ 14: capture_at is "own_flags", expected one of own_flag, own_side, own_corners (did you mean own_flag?)

## a bad file name #~ 1:1: the file's name is "Dead-Sea", expected 1 to 40 of a-z, 0-9 and _
--- seas/Dead-Sea.toml

## everything missing
# Nothing. #~ 1: datum.lat_deg is missing, expected -90 to 90 #~ 1: datum.lon_deg is missing, expected -180 to 180 #~ 1: depth_m is missing, expected 10 to 20000 #~ 1: width_m is missing, expected 10 to 20000

## a flag kept from its own boats
--- rules/x.toml
flag_keepout_m = 10 #~ 18: flag_keepout_m is 10, expected less than capture_radius_m, which is 8 #~ 18: flag_keepout_m is 10, expected less than untag_radius_m, which is 10
untag_radius_m = 10
capture_radius_m = 8
untag_at = "own_flag"
capture_at = "own_flag"

## a flag at the scrimmage line
base = "f.toml"
flag_inset_m = 80 #~ 16: flag_inset_m is 80, expected more than 0 and less than 80
"##;

#[test]
fn single_values_are_checked_where_they_stand() {
    assert_broken("fields/x.toml", "", VALUES);
}

const SHAPES: &str = r##"
## two corners
base = "f.toml"
[[obstacle]]
polygon = [[50, 50], [60, 50]] #~ 11: polygon has 2 entries, expected 3 to 1000

## a bow tie
base = "f.toml"
[[obstacle]]
polygon = [[50, 50], [60, 60], [60, 50], [50, 60]] #~ 32: polygon's side 1 meets its side 3, expected no crossing

## a corner of three numbers
base = "f.toml"
corner = [1, 2, 3] #~ 10: corner has 3 entries, expected a pair of numbers [a, b]

## an obstacle far away
base = "f.toml"
[[obstacle]] #~ 1: obstacle is off the field, expected at most 50 m outside of it
circle = { centre = [-200, 0], radius_m = 3 }

## an obstacle on a flag
base = "f.toml"
[[obstacle]] #~ 1: obstacle stands on a flag, expected open water there
circle = { centre = [21, 40], radius_m = 3 }

## an obstacle of no shape
base = "f.toml"
[[obstacle]] #~ 1: obstacle says neither or both, expected either circle or polygon
[[obstacle]]
circle = { radius_m = 1 } #~ 10: circle.centre is missing, expected a pair of numbers [a, b]

## an extra flag outside
base = "f.toml"
flag = [{ team = "first", at = [-1, 40] }, { at = [30, 30] }] #~ 32: at is [-1, 40], expected a position inside the field: it is -1.00 m along (of 160) and 40.00 m across (of 80) #~ 44: flag.team is missing, expected one of first, second
"##;

#[test]
fn shapes_are_checked() {
    assert_broken("fields/x.toml", "", SHAPES);
}
