//! The names of the values in the observation spaces of Pyquaticus.

/// Incremented when the meaning of a value changes: models of a different version are rejected.
pub(super) const VERSION: u32 = 1;

/// A version of Pyquaticus' observations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edition {
    /// November 2023 to January 2024: without scores.
    Of2023,
    /// February 2024 to 2025.
    Of2025,
    /// The 2026 competition: with boats out of action.
    Of2026,
}

impl Edition {
    /// The names of the boat's own values.
    pub fn own_names(self) -> impl Iterator<Item = &'static str> {
        self.named(&OWN_NAMES)
    }

    /// The names of another boat's values.
    pub fn other_names(self) -> impl Iterator<Item = &'static str> {
        self.named(&OTHER_NAMES)
    }

    fn named(self, names: &'static [&'static str]) -> impl Iterator<Item = &'static str> {
        let is_in = move |name: &&str| match *name {
            "score" | "enemy_score" => self != Edition::Of2023,
            "disabled" => self == Edition::Of2026,
            _ => true,
        };
        names.iter().copied().filter(is_in)
    }
}

const OWN_NAMES: [&str; 22] = [
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
    "disabled",
    "score",
    "enemy_score",
];
const OTHER_NAMES: [&str; 9] = [
    "bearing",
    "distance",
    "relative_heading",
    "speed",
    "has_flag",
    "on_own_side",
    "time_since_tag",
    "tagged",
    "disabled",
];
