//! Mistakes in files, in those they name, and in their syntax.

use crate::assert_broken;

const FILES: &str = r##"
## many mistakes in one file
--- boats/x.toml
length_m = "long" #~ 1: autopilot is missing, expected it, or kinematic in place of thruster and autopilot #~ 12: length_m is the string "long", expected a number
beam_m = -1 #~ 10: beam_m is -1, expected 0.05 to 50
wings = 2 #~ 1: wings is unknown, expected one of autopilot, base, beam_m, compass, draught_m, gps, hull, imu, kinematic, length_m, thruster, windage
[hull]
mass_kg = nan #~ 11: mass_kg is nan, expected 0.1 to 1000000
munk_factor = 2 #~ 15: munk_factor is 2, expected 0 to 1
[thruster] #~ 1: thruster.propeller is missing, expected it or table_pct_newton
arm_m = 0.4

## a mistake in a base
--- boats/x.toml
base = "y.toml"
beam_m = 0 #~ 10: beam_m is 0, expected 0.05 to 50
--- boats/y.toml
base = "b.toml"
length_m = 0 #~ 12: length_m is 0, expected 0.1 to 100
beam_m = -1

## mistakes in files that are named
--- games/x.toml
base = "g.toml"
seed = -1 #~ 8: seed is -1, expected 0 to 9223372036854775807
--- fields/f.toml
width_m = 160 #~ 1: datum.lat_deg is missing, expected -90 to 90 #~ 1: datum.lon_deg is missing, expected -180 to 180
depth_m = 1 #~ 11: depth_m is 1, expected 10 to 20000
--- strategies/p.toml
roles = ["none.toml"] #~ 10: strategies/none.toml cannot be read (No such file or directory (os error 2)), expected a file
--- boats/b.toml
length_m =  #~ 12: string values must be quoted, expected literal string

## a missing file
--- games/x.toml
base = "g.toml"
field = "../fields/none.toml" #~ 9: fields/none.toml cannot be read (No such file or directory (os error 2)), expected a file
sea = "../seas" #~ 7: seas is not a file, expected one

## a missing base
base = "none.toml" #~ 8: seas/none.toml cannot be read (No such file or directory (os error 2)), expected a file

## a base that is itself
base = "../seas/x.toml" #~ 8: base refers back to itself (seas/x.toml on seas/x.toml), expected an end

## bases that refer to each other
base = "y.toml"
--- seas/y.toml
# On.
base = "x.toml" #~ 8: base refers back to itself (seas/x.toml on seas/y.toml on seas/x.toml), expected an end

## a base that is no path
base = 3 #~ 8: base is 3, expected a string

## nothing named #~ 1:1: field is missing, expected the path of a file #~ 1:1: rules is missing, expected the path of a file #~ 1:1: team has 0 entries, expected exactly two [[team]] for now #~ 1:1: vehicle is missing, expected at least one [[vehicle]] or [[fleet]]
--- games/x.toml

## a sea file for rules
--- games/x.toml
base = "g.toml"
rules = "../seas/x.toml"
--- seas/x.toml
water_density_kg_m3 = 1000 #~ 1: water_density_kg_m3 is unknown, expected one of {keys of rules}

## two files of one name
--- games/x.toml
base = "g.toml"
vehicle = [{ name = "a", team = "red" }, { name = "c", team = "red", boat = "b.toml" }] #~ 77: b.toml is the second file named "b", expected different names
--- games/b.toml
base = "../boats/b.toml"
"##;

#[test]
fn several_files_are_reported_at_once() {
    assert_broken("seas/x.toml", "", FILES);
}

const SYNTAX: &str = r##"
## no value
# A sea.
water_density_kg_m3 = #~ 22: string values must be quoted, expected literal string
current = { speed_m_s = 99 } #~ 25: speed_m_s is 99, expected 0 to 10

## a key twice
water_density_kg_m3 = 1000
water_density_kg_m3 = 1025 #~ 1: duplicate key

## a string without an end
--- strategies/x.toml
roles = ["idle] #~ 16: invalid basic string, expected `"`
assignment = "fixed" #~ 1: missing comma between array elements, expected `,` #~ 1: string values must be quoted, expected literal string #~ 12: unexpected `=` in array, expected value, `]` #~ 14: missing comma between array elements, expected `,` #~ 21: unclosed array, expected `]`

## a broken table head
--- boats/x.toml
base = "b.toml"
[hull #~ 6: unclosed table, expected `]`
mass_kg = -5

## a key of too many parts
a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a = 1 #~ 1: found a key of very many parts, expected at most 3
"##;

#[test]
fn syntax_is_reported_with_the_rest() {
    assert_broken("seas/x.toml", "", SYNTAX);
}
