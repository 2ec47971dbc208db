//! The names of the values in the observation space `squall`.

use super::names_of;

/// Incremented when the meaning of a value changes: models from another version are rejected.
pub(super) const VERSION: u32 = 1;

/// Number of values of the own boat, its goals and the game.
const OWN: usize = 44;
/// Number of values of another boat: presence, position, motion, state.
pub const OTHER: usize = 16;

const OWN_NAMES: [&str; OWN] = [
    "position_ahead",
    "position_port",
    "heading_ahead",
    "heading_port",
    "surge",
    "sway",
    "yaw_rate",
    "drift_ahead",
    "drift_starboard",
    "drift_spread",
    "tagged",
    "has_flag",
    "outside",
    "disabled",
    "may_tag",
    "front_edge_near",
    "rear_edge_near",
    "port_edge_near",
    "starboard_edge_near",
    "obstacle_near",
    "speed_share",
    "enemy_flag_ahead",
    "enemy_flag_starboard",
    "enemy_flag_distance",
    "enemy_flag_near",
    "own_flag_ahead",
    "own_flag_starboard",
    "own_flag_distance",
    "own_flag_near",
    "home_ahead",
    "home_starboard",
    "home_distance",
    "home_near",
    "goal_ahead",
    "goal_starboard",
    "goal_distance",
    "goal_near",
    "on_own_side",
    "own_flag_taken",
    "enemy_flag_taken",
    "mate_has_flag",
    "score_lead",
    "time_left",
    "rank",
];
const OTHER_NAMES: [&str; OTHER] = [
    "known",
    "ahead",
    "starboard",
    "distance",
    "near",
    "velocity_ahead",
    "velocity_starboard",
    "heading_ahead",
    "heading_starboard",
    "tagged",
    "has_flag",
    "intrudes",
    "on_own_side",
    "tag_wait",
    "age",
    "near_own_flag",
];

pub(super) fn names(mates: usize, enemies: usize) -> Vec<String> {
    names_of(&OWN_NAMES, &OTHER_NAMES, (mates, enemies))
}

pub(super) fn size(mates: usize, enemies: usize) -> usize {
    OWN + (mates + enemies) * OTHER
}
