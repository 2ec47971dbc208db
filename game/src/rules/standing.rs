//! How the game stands: who is tagged, who carries what, the score.

use crate::id::{FlagId, VehicleId};
use crate::time::SimTime;
use serde::{Deserialize, Serialize};

/// The referee's whole memory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Standing {
    /// By vehicle.
    pub vehicles: Vec<VehicleStanding>,
    /// By flag.
    pub flags: Vec<FlagStanding>,
    /// Points, by team.
    pub score: Vec<u32>,
    /// Pairs of boats that are within the collision distance, lower index first, in order.
    pub touching: Vec<(VehicleId, VehicleId)>,
    /// When each vehicle is out of action (power play): from, until; by vehicle.
    pub disabled: Vec<(SimTime, SimTime)>,
    /// Whether the game is over.
    pub over: bool,
}

/// How one boat stands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VehicleStanding {
    /// Whether it is tagged.
    pub tagged: bool,
    /// The flag it carries.
    pub carrying: Option<FlagId>,
    /// From when on it may tag again.
    pub tag_ready: SimTime,
    /// Whether it is outside of the field.
    pub outside: bool,
    /// Whether it was in its untagging place at the last look.
    pub at_home: bool,
    /// Whether it was in its own flag's keep-out circle at the last look.
    pub in_keepout: bool,
    /// Whether it is out of action by power play.
    pub disabled: bool,
}

/// How one flag stands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlagStanding {
    /// Who carries it; at its home when nobody does.
    pub carrier: Option<VehicleId>,
}
