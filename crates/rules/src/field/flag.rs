//! A flag: its team, its home, and what differs from the rules.

use super::Route;
use primitives::frame::Ned;
use primitives::id::TeamId;
use primitives::time::SimTime;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A flag with its team.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Flag {
    /// The team that defends it.
    pub team: TeamId,
    /// Its home at the start.
    #[serde(rename = "home")]
    pub start: Ned,
    /// Its own settings.
    #[serde(default, skip_serializing_if = "FlagSettings::is_empty")]
    pub settings: FlagSettings,
}

/// A flag's own settings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FlagSettings {
    /// Its own radii.
    pub radii: FlagRadii,
    /// The path of its home; `None`: it does not move.
    pub route: Option<Route>,
}

/// A flag's own radii.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FlagRadii {
    /// Maximum distance for a grab, m. Default: that of the rules, as for the other radii.
    #[schemars(range(min = 0.1, max = 1000))]
    pub grab_radius_m: Option<f64>,
    /// Maximum distance for a capture at this flag, m.
    #[schemars(range(min = 0.1, max = 1000))]
    pub capture_radius_m: Option<f64>,
    /// Maximum distance for untagging at this flag, m.
    #[schemars(range(min = 0.1, max = 1000))]
    pub untag_radius_m: Option<f64>,
    /// Minimum distance of its team's boats while it is home, m; 0: no limit.
    #[schemars(range(min = 0, max = 1000))]
    pub flag_keepout_m: Option<f64>,
}

impl Flag {
    /// The flag's home at a time: its position while no boat carries it.
    #[inline]
    pub fn home(&self, now: SimTime) -> Ned {
        let route = self.settings.route.as_ref();
        route.map_or(self.start, |route| route.at(now))
    }
}

impl FlagSettings {
    /// Whether the flag has no setting of its own.
    pub fn is_empty(&self) -> bool {
        *self == FlagSettings::default()
    }
}
