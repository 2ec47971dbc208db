//! Mistakes in strategies: behaviours.

use super::{BASE, VARIABLES, assert_broken};

const CASES: &str = r#"
## no kind
[behaviour.go] #~ 1: go.kind is missing, expected one of {kinds}
speed_m_s = 3

## a mistyped kind
[behaviour.go]
kind = "waypiont" #~ 8: kind is "waypiont", expected one of {kinds} (did you mean waypoint?)
points = ["CF"]

## a kind that is no text
[behaviour.go]
kind = 3 #~ 8: kind is 3, expected one of {kinds}
weight = -1 #~ 10: weight is -1, expected 0 to 1000

## a mistyped safety behaviour
behaviour.keep_clear.kind = "avoid_colision" #~ 29: kind is "avoid_colision", expected one of {kinds} (did you mean avoid_collision?)

## a key of another kind
[behaviour.go]
kind = "cut_range"
contact = "opponent"
speed_m_s = 3 #~ 1: speed_m_s is unknown, expected one of contact, duration_s, giveup_m, in, kind, on_active, on_complete, on_idle, on_inactive, on_reach, on_run, patience, perpetual, time_on_leg_s, weight, when

## a mistyped key
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
speed_ms = 3 #~ 1: speed_ms is unknown, expected one of capture_radius_m, course_share, duration_s, in, kind, lead_m, on_active, on_complete, on_idle, on_inactive, on_reach, on_run, perpetual, points, repeat, reverse, slip_radius_m, speed_m_s, weight, when (did you mean speed_m_s?)

## a key that means nothing without others
[behaviour.wait]
kind = "timer"
duration_s = 3
speed_m_s = 3 #~ 1: speed_m_s is unknown, expected one of duration_s, in, kind, on_active, on_complete, on_idle, on_inactive, on_reach, on_run, perpetual, weight, when

## nothing that is required
[behaviour.a] #~ 1: a.points is missing, expected 1 to 1000 places
kind = "waypoint"
[behaviour.b] #~ 1: b.contact is missing, expected one of {boats}
kind = "cut_range"
[behaviour.c] #~ 1: c.duration_s is missing, expected 0 to 86400
kind = "timer"
[behaviour.d] #~ 1: d.guarded is missing, expected [x, y], or the name of a place or a boat
kind = "shield"
[behaviour.e] #~ 1: e.heading_deg is missing, expected -360 to 360
kind = "constant_heading"
[behaviour.f] #~ 1: f.to is missing, expected [x, y], or the name of a place or a boat
kind = "attractor"
[behaviour.g] #~ 1: g.ellipse is missing, expected it or polygon
kind = "loiter"
[behaviour.h] #~ 1: h.speed_m_s is missing, expected 0 to 60
kind = "max_speed"

## no points
[behaviour.go]
kind = "waypoint"
points = [] #~ 10: points has 0 entries, expected 1 to 1000 places

## a point that is none
[behaviour.go]
kind = "waypoint"
points = ["CCH", "own_flg", [nan, 0]] #~ 11: points is "CCH", expected [x, y], {places} (did you mean CC?) #~ 18: points is "own_flg", expected [x, y], {places} (did you mean own_flag?) #~ 30: points is nan, expected -1000000 to 1000000

## a point of three numbers
[behaviour.go]
kind = "waypoint"
points = ["CH", [1, 2, 3]] #~ 17: points has 3 entries, expected a pair of numbers [a, b]

## a point that is a number
[behaviour.go]
kind = "waypoint"
points = [3] #~ 11: points is 3, expected [x, y], or the name of a place or a boat

## points that are no list
[behaviour.go]
kind = "waypoint"
points = "CF" #~ 10: points is the string "CF", expected 1 to 1000 places

## a boat that is none
[behaviour.go]
kind = "intercept"
contact = "nearest_enemies" #~ 11: contact is "nearest_enemies", expected one of {boats}

## a place for a boat
[behaviour.go]
kind = "intercept"
contact = "own_flag" #~ 11: contact is "own_flag", expected one of {boats}

## both shapes
[behaviour.go]
kind = "loiter"
polygon = ["CF", "CH", "PH"]
ellipse = {} #~ 11: ellipse is given with polygon, expected one of them #~ 11: ellipse.across_m is missing, expected 1 to 10000 #~ 11: ellipse.along_m is missing, expected 1 to 10000 #~ 11: ellipse.centre is missing, expected [x, y], or the name of a place or a boat

## a polygon of two corners
[behaviour.go]
kind = "loiter"
polygon = ["CF", "CH"] #~ 11: polygon has 2 entries, expected 3 to 1000 places

## half an ellipse
[behaviour.go]
kind = "loiter"
ellipse = { along_m = 0, corners = 2, width_m = 3 } #~ 11: ellipse.centre is missing, expected [x, y], or the name of a place or a boat #~ 11: ellipse.across_m is missing, expected 1 to 10000 #~ 23: along_m is 0, expected 1 to 10000 #~ 36: corners is 2, expected 3 to 1000 #~ 39: width_m is unknown, expected one of across_m, along_m, centre, corners
turn = "left" #~ 8: turn is "left", expected one of clockwise, counterclockwise, best (did you mean best?)

## numbers out of range
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
speed_m_s = -1 #~ 13: speed_m_s is -1, expected 0 to 60
capture_radius_m = 0 #~ 20: capture_radius_m is 0, expected 0.1 to 1000
course_share = 1.5 #~ 16: course_share is 1.5, expected 0 to 1
weight = 1001 #~ 10: weight is 1001, expected 0 to 1000
duration_s = -1 #~ 14: duration_s is -1, expected 0 to 86400

## a constant expression out of range
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
speed_m_s = "10 * 7" #~ 13: speed_m_s is 70, expected 0 to 60

## a truth for a number
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
speed_m_s = true #~ 13: speed_m_s is true, expected a number or an expression

## an inner distance beyond the outer
[behaviour.keep_clear]
inner_m = 16 #~ 11: inner_m is 16, expected at most outer_m, which is 15
cpa_max_m = 2 #~ 13: cpa_min_m is 3, expected at most cpa_max_m, which is 2
[behaviour.hold]
kind = "station_keep"
inner_radius_m = 20 #~ 18: inner_radius_m is 20, expected at most outer_radius_m, which is 15
[behaviour.to]
kind = "attractor"
to = "CF"
inner_m = 30 #~ 11: inner_m is 30, expected at most outer_m, which is 20
outer_m = "4 * 5"

## unknown choices
[behaviour.keep_clear]
contacts = "enemy" #~ 12: contacts is "enemy", expected one of all, enemies, taggers, mates
grade = "cubic" #~ 9: grade is "cubic", expected one of linear, quasi, quadratic

## no mode at all
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
in = [] #~ 6: in has 0 entries, expected at least one mode
"#;

const WITH_VARIABLES: &str = r#"
## an unknown mode
[[mode]]
name = "attack"
when = "tagged"
[[mode]]
name = "defend"
[behaviour.go]
kind = "waypoint"
in = ["atack", "defend"] #~ 7: in has "atack", expected one of the modes attack, defend (did you mean attack?)
points = ["CF"]

## unknown variables at moments
[behaviour.go]
kind = "waypoint"
points = ["CF"]
on_run = { lapse = 1 } #~ 20: lapse is unknown, expected one of the variables alarmed, laps, phase (did you mean laps?)
on_reach = { phase = "gone" } #~ 22: phase is "gone", expected one of go, return (did you mean go?)
on_complete = { laps = "laps + tagged", alarmed = 1 } #~ 32: laps has true or false here, expected a number #~ 51: alarmed is 1, expected true, false or an expression
"#;

#[test]
fn behaviours_are_checked() {
    assert_broken(BASE, CASES);
    assert_broken(VARIABLES, WITH_VARIABLES);
}
