//! The standing of a game: tagged boats, carried flags, the score.

use super::Ability;
use primitives::id::{FlagId, TeamId, VehicleId};
use primitives::time::SimTime;
use serde::{Deserialize, Serialize};

/// The referee's complete state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Standing {
    /// Time of the referee's last check.
    pub now: SimTime,
    /// Boats, by vehicle index.
    pub vehicles: Vec<VehicleStanding>,
    /// Flags, by flag index.
    pub flags: Vec<FlagStanding>,
    /// Points, by team index.
    pub score: Vec<u32>,
    /// Pairs of boats within the collision distance, lower index first, sorted.
    pub touching: Vec<(VehicleId, VehicleId)>,
    /// Start and end of each boat's power play, by vehicle index.
    pub disabled: Vec<(SimTime, SimTime)>,
    /// Whether the game is over.
    pub over: bool,
}

/// The standing of one boat.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VehicleStanding {
    /// Whether the boat takes part: a quarantined boat is only an obstacle.
    pub in_play: bool,
    /// Whether the boat is tagged.
    pub tagged: bool,
    /// Time at which the boat was last tagged.
    pub tagged_at: SimTime,
    /// The flag that the boat carries.
    pub carrying: Option<FlagId>,
    /// Time from which the boat may tag again.
    pub tag_ready: SimTime,
    /// Whether the boat is outside the field.
    pub outside: bool,
    /// Whether the boat was at its untag place, and on the field, at the last check.
    pub at_home: bool,
    /// Whether the boat was in its own flag's keep-out circle at the last check.
    pub in_keepout: bool,
    /// Whether the boat is out of action: power play, or it has not joined yet.
    pub disabled: bool,
}

/// The standing of one flag.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlagStanding {
    /// The flag's carrier; `None` if the flag is home.
    pub carrier: Option<VehicleId>,
    /// Time of the flag's last grab or return.
    pub moved_at: SimTime,
}

impl Standing {
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
            flags: vec![
                FlagStanding {
                    carrier: None,
                    moved_at: SimTime::LONG_AGO
                };
                flags
            ],
            score: vec![0; teams],
            touching: Vec::new(),
            disabled: vec![(SimTime::NEVER, SimTime::NEVER); vehicles],
            over: false,
        }
    }

    pub(super) fn award(&mut self, team: TeamId, points: u32) {
        let score = &mut self.score[team.index()];
        *score = score.saturating_add(points);
    }
}

impl VehicleStanding {
    /// Whether the boat may act on others: tag, grab, capture.
    #[inline]
    pub fn acts(&self) -> bool {
        self.in_play && Ability::from(self).acts()
    }
}
