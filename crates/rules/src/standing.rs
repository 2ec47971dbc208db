//! How the game stands: who is tagged, who carries what, the score.

use super::Ability;
use primitives::id::{FlagId, TeamId, VehicleId};
use primitives::time::SimTime;
use serde::{Deserialize, Serialize};

/// The referee's whole memory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Standing {
    /// When the referee last looked.
    pub now: SimTime,
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
    /// Whether it takes part: a quarantined boat is only something to bump into.
    pub in_play: bool,
    /// Whether it is tagged.
    pub tagged: bool,
    /// When it was last tagged.
    pub tagged_at: SimTime,
    /// The flag it carries.
    pub carrying: Option<FlagId>,
    /// From when on it may tag again.
    pub tag_ready: SimTime,
    /// Whether it is outside of the field.
    pub outside: bool,
    /// Whether it was in its untagging place, and on the field, at the last look.
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
    /// When it was last taken or brought home.
    pub moved_at: SimTime,
}

impl Standing {
    /// Nothing has happened yet.
    pub(super) fn new(vehicles: usize, flags: usize, teams: usize) -> Standing {
        let vehicle = VehicleStanding {
            in_play: true,
            tagged: false,
            tagged_at: SimTime::LONG_AGO,
            carrying: None,
            tag_ready: SimTime::LONG_AGO,
            outside: false,
            at_home: false,
            in_keepout: false,
            disabled: false,
        };
        Standing {
            now: SimTime::LONG_AGO,
            vehicles: vec![vehicle; vehicles],
            flags: vec![FlagStanding { carrier: None, moved_at: SimTime::LONG_AGO }; flags],
            score: vec![0; teams],
            touching: Vec::new(),
            disabled: vec![(SimTime::NEVER, SimTime::NEVER); vehicles],
            over: false,
        }
    }

    /// Adds to a team's score.
    pub(super) fn award(&mut self, team: TeamId, points: u32) {
        let score = &mut self.score[team.index()];
        *score = score.saturating_add(points);
    }
}

impl VehicleStanding {
    /// Whether it may do things to others: tag, grab, capture.
    #[inline]
    #[must_use]
    pub fn acts(&self) -> bool {
        self.in_play && Ability::from(self).acts()
    }
}
