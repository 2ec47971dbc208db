//! Mistakes in who plays, and from where.

use crate::assert_broken;

const GAMES: &str = r##"
## a tick that does not divide the decision
tick_s = 0.03 #~ 10: decision_s is 0.1, expected a multiple of tick_s, 0.03

## a tick that a boat does not bear
tick_s = 0.2 #~ 10: tick_s is 0.2, expected at most 0.1000: the sway of boat x dies out at 20.0 1/s
decision_s = 0.2
boat = "../boats/x.toml"
--- boats/x.toml
base = "b.toml"
hull.sway_linear_kg_s = 2000

## one team
team = [{ name = "blue", strategy = "../strategies/p.toml" }] #~ 8: team has 1 entries, expected exactly two [[team]] for now
vehicle = [{ name = "a", team = "blue" }]

## three teams
team = [{ name = "blue", strategy = "../strategies/p.toml" }, { name = "red", strategy = "../strategies/p.toml" },
    { name = "green" }] #~ 5: team has 3 entries, expected exactly two [[team]] for now

## names twice
[[vehicle]]
name = "red_2"
team = "blue"
[[vehicle]]
name = "Red Two" #~ 8: name is "Red Two", expected 1 to 40 of a-z, 0-9 and _
team = "red"
[[fleet]] #~ 1: name is "red_2" again, expected a different one for each vehicle
team = "red"
count = 3

## an unknown team
[[fleet]]
team = "green" #~ 8: team is "green", expected one of blue, red
count = 2
name = "g_{}"

## teams of one name
[[team]]
name = "red"
strategy = "../strategies/p.toml"
[[team]]
name = "red" #~ 8: name is "red" again, expected a different one for each team
strategy = "../strategies/p.toml"
[[vehicle]]
name = "a"
team = "red"

## nobody #~ 1:1: vehicle is missing, expected at least one [[vehicle]] or [[fleet]]
vehicle = []

## too many
fleet = [{ team = "red", count = 9999, name = "r_{}" }] #~ 10: vehicles are 10001 with this one, expected at most 10000

## no strategy #~ games/g.toml:6:12: vehicle.strategy is missing, expected the path of a strategy file here or for the team
team = [{ name = "blue" }, { name = "red", strategy = "../strategies/p.toml" }]

## an unknown source
vehicle = [{ name = "a", team = "red", source = "real" }] #~ 49: source is "real", expected one of simulated, external

## a fleet of real boats, which are named one by one
vehicle = []
fleet = [{ team = "red", count = 2, source = "external" }] #~ 37: source is unknown, expected one of boat, count, name, spawn, strategy, team

## a fleet without a number in its name
vehicle = []
fleet = [{ team = "red", count = 2, name = "r" }] #~ 44: name is "r", expected {} in it, where the number goes
"##;

#[test]
fn games_are_checked() {
    assert_broken("games/x.toml", "base = \"g.toml\"\n", GAMES);
}

const START_POSITIONS: &str = r##"
## an unknown point
vehicle = [{ name = "a", team = "red", at = "QH" }] #~ 45: at is "QH", expected a named point, one of {points} (did you mean CH?)

## a point on the edge
vehicle = [{ name = "a", team = "red", at = "PPB" }] #~ 45: at is [160, 0], expected a position inside the field: it is 160.00 m along (of 160) and 0.00 m across (of 80)

## a place outside
vehicle = [{ name = "a", team = "red", at = [10, 81], heading_deg = 720 }] #~ 45: at is [10, 81], expected a position inside the field: it is 10.00 m along (of 160) and 81.00 m across (of 80) #~ 69: heading_deg is 720, expected -360 to 360

## a place of three numbers
vehicle = [{ name = "a", team = "red", at = [10, 8, 1] }] #~ 45: at has 3 entries, expected a pair of numbers [a, b]

## two boats in one place
vehicle = [
    { name = "a", team = "red", at = [100, 40] },
    { name = "b", team = "blue", at = [101, 41] }, #~ 39: b starts 1.41 m from a, expected a boat's length, 2 m
]

## a line too crowded
[[fleet]] #~ 1: b_1 starts 1.29 m from blue_one, expected a boat's length, 2 m
team = "blue"
count = 60
name = "b_{}"

## a boat on an obstacle
field = "../fields/x.toml"
[[vehicle]]
name = "a"
team = "blue"
at = [80, 41] #~ 6: a starts at [80, 41], on an obstacle, expected open water
--- fields/x.toml
base = "f.toml"
[[obstacle]]
polygon = [[79, 40], [79, 42], [82, 42], [82, 40]]

## both ways to start
vehicle = [{ name = "a", team = "red", at = "CH", heading_deg = 3, spawn = {} }] #~ 45: vehicle has at and spawn, expected one of them #~ 65: heading_deg is given with spawn, expected with at only

## a rectangle the wrong way round
vehicle = [{ name = "a", team = "red", spawn = { along_m = [9, 3], across_m = [0, 90] } }] #~ 60: along_m is [9, 3], expected the smaller one first #~ 79: across_m is 90, expected 0 to 80

## a rectangle too small
fleet = [{ team = "red", count = 40, name = "r_{}", spawn = { along_m = [10, 20] } }] #~ 61: spawn has 760 m² for 40 boats with gap_m 5, expected at least 2000 m²
"##;

#[test]
fn start_positions_are_checked() {
    assert_broken("games/x.toml", "base = \"g.toml\"\n", START_POSITIONS);
}
