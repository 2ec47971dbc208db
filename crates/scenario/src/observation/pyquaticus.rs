//! What the numbers of the observation space `pyquaticus` are called.

use super::names_of;

/// Counted up when the meaning of a number changes: models of another version are refused.
pub(super) const VERSION: u32 = 1;

/// Of the own boat.
const OWN: usize = 21;
/// Of another one.
pub const OTHER: usize = 8;

/// The numbers of the own boat.
const OWN_NAMES: [&str; OWN] = [
    "enemy_flag_bearing",
    "enemy_flag_distance",
    "own_flag_bearing",
    "own_flag_distance",
    "starboard_wall_bearing",
    "starboard_wall_distance",
    "rear_wall_bearing",
    "rear_wall_distance",
    "port_wall_bearing",
    "port_wall_distance",
    "front_wall_bearing",
    "front_wall_distance",
    "scrimmage_bearing",
    "scrimmage_distance",
    "speed",
    "has_flag",
    "on_own_side",
    "time_since_tag",
    "tagged",
    "score",
    "enemy_score",
];
/// Those of another boat.
const OTHER_NAMES: [&str; OTHER] =
    ["bearing", "distance", "relative_heading", "speed", "has_flag", "on_own_side", "time_since_tag", "tagged"];

/// What the numbers are called, in their order.
pub(super) fn names(mates: usize, enemies: usize) -> Vec<String> {
    names_of(&OWN_NAMES, &OTHER_NAMES, (mates, enemies))
}

/// How many numbers there are with so many other boats.
pub(super) fn size(others: usize) -> usize {
    OWN + others * OTHER
}
