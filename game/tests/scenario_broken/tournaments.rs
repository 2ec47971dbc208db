//! Mistakes in who enters a tournament, and in the files it names.

use crate::assert_broken;

const TOURNAMENTS: &str = r##"
## nothing named #~ 1:1: entry has 0 entries, expected 2 to 100 #~ 1:1: game is missing, expected the path of a file
--- tournaments/x.toml

## one entry
[[entry]] #~ 1: entry has 1 entries, expected 2 to 100
name = "a"
strategy = "../strategies/p.toml"

## entries without names and strategies
[[entry]] #~ 1: entry.name is missing, expected 1 to 40 of a-z, 0-9 and _
strategy = "../strategies/p.toml"
[[entry]] #~ 1: entry.strategy is missing, expected the path of a file
name = "b"
[[entry]]
name = "C c" #~ 8: name is "C c", expected 1 to 40 of a-z, 0-9 and _
strategy = "../strategies/p.toml"

## names twice
[[entry]]
name = "a"
strategy = "../strategies/p.toml"
[[entry]]
name = "a" #~ 8: name is "a" again, expected a different one for each entry
strategy = "../strategies/p.toml"

## numbers out of range, and a value of another type
games = 1 #~ 9: games is 1, expected 2 to 1000000
seed = -1 #~ 8: seed is -1, expected 0 to 9223372036854775807
self_play = 3 #~ 13: self_play is 3, expected true or false

## mistakes in files that are named
sea = "../seas/none.toml" #~ 7: seas/none.toml cannot be read (No such file or directory (os error 2)), expected a file
round = 3 #~ 1: round is unknown, expected one of base, entry, game, games, sea, seed, self_play
--- games/g.toml
base = "../games/h.toml"
seed = -1 #~ 8: seed is -1, expected 0 to 9223372036854775807
--- games/h.toml
field = "../fields/f.toml"
rules = "../rules/r.toml"
boat = "../boats/b.toml"
team = [{ name = "blue", strategy = "../strategies/p.toml" }, { name = "red", strategy = "../strategies/p.toml" }]
vehicle = [{ name = "a", team = "blue" }]
--- strategies/p.toml
roles = [] #~ 9: roles has 0 entries, expected 1 to 1000
"##;

#[test]
fn tournaments_are_checked() {
    assert_broken("tournaments/x.toml", "base = \"t.toml\"\n", TOURNAMENTS);
}
