//! The names of the values in the observation space `pyquaticus`.

/// Incremented when the meaning of a value changes: models from another version are rejected.
pub(super) const VERSION: u32 = 1;

/// Number of values of another boat.
pub const OTHER: usize = 8;

pub(super) const OWN_NAMES: [&str; 21] = [
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
pub(super) const OTHER_NAMES: [&str; OTHER] = [
    "bearing",
    "distance",
    "relative_heading",
    "speed",
    "has_flag",
    "on_own_side",
    "time_since_tag",
    "tagged",
];
