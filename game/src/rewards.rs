//! Rewards: what happens in a game, as numbers for boats that learn.
//!
//! [`Rewards`] are data, from `scenarios/rewards/*.toml`, whose keys they declare.

use crate::event::{Event, Logged, TagCause};
use crate::id::{TeamId, VehicleId};
use crate::scenario::Scenario;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What is worth how much to a boat: the sum of all that follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Rewards {
    /// What the own boat does, and what happens to it.
    pub boat: Worth,
    /// What any boat of the own team does, this one included.
    pub team: Worth,
    /// What any boat of the enemies does.
    pub enemy: Worth,
    /// The end of the game, for every boat of a team.
    pub end: End,
    /// For being on the way: see [`Potential`].
    pub potential: Potential,
    /// Each second of the game.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub second: f64,
}

/// What events of a boat are worth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Worth {
    /// It took the enemies' flag.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub grab: f64,
    /// It brought that home.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub capture: f64,
    /// It tagged an enemy.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub tag: f64,
    /// It tagged an enemy that carried a flag: instead of `tag`.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub tag_carrier: f64,
    /// It was tagged by an enemy.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub tagged: f64,
    /// It was tagged by an enemy while it carried a flag: instead of `tagged`.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub tagged_carrying: f64,
    /// It was untagged.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub untagged: f64,
    /// It left the field.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub left_field: f64,
    /// It came nearer to another boat than the collision distance.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub collided: f64,
}

/// What the end of a game is worth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct End {
    /// For a game won; one that is lost costs as much.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub win: f64,
    /// For every point more than the enemies have.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub point: f64,
}

/// Potential-based shaping (Ng, Harada and Russell, ICML 1999): the discounted gain of a potential that depends on the state alone, and
/// is 0 at the end of a game. It does not change which policy is the best one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Potential {
    /// At the enemies' flag; 0 where that is a field's width away. A carrier has as much, and again as much when it has brought
    /// the flag home. A tagged boat has none.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub attack: f64,
    /// Of a tagged boat: less than nothing by this much for a field's width from where it is untagged.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub untag: f64,
}

/// How far a boat has come, for its potential.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BoatProgress {
    /// Whether it is tagged.
    pub tagged: bool,
    /// Whether it carries a flag.
    pub carrying: bool,
    /// Its distance from the enemies' flag, in widths of the field.
    pub from_flag: f64,
    /// Its distance from where a flag is brought and a tagged boat is untagged, in widths of the field.
    pub from_home: f64,
}

impl Potential {
    /// Of a boat that has come so far.
    #[must_use]
    pub fn of(&self, boat: &BoatProgress) -> f64 {
        if boat.tagged {
            -self.untag * boat.from_home
        } else if boat.carrying {
            self.attack * (2.0 - boat.from_home).max(1.0)
        } else {
            self.attack * (1.0 - boat.from_flag)
        }
    }
}

impl Rewards {
    /// Adds what events are worth to the boats' rewards. `carrying` says of each boat whether it carried a flag before them.
    pub fn add_events(&self, scenario: &Scenario, events: &[Logged], carrying: &[bool], rewards: &mut [f64]) {
        let team_of = |vehicle: VehicleId| scenario.team_of(vehicle);
        let mut add = |vehicle: VehicleId, worth: fn(&Worth) -> f64| {
            for (i, reward) in rewards.iter_mut().enumerate() {
                let other = VehicleId::at(i);
                if other == vehicle {
                    *reward += worth(&self.boat);
                }
                *reward += worth(if team_of(other) == team_of(vehicle) { &self.team } else { &self.enemy });
            }
        };
        for logged in events {
            match logged.event {
                Event::Grabbed { vehicle, .. } => add(vehicle, |worth| worth.grab),
                Event::Captured { vehicle, .. } => add(vehicle, |worth| worth.capture),
                Event::Tagged { vehicle, cause: TagCause::Opponent(by) } => {
                    if carrying[vehicle.index()] {
                        add(by, |worth| worth.tag_carrier);
                        add(vehicle, |worth| worth.tagged_carrying);
                    } else {
                        add(by, |worth| worth.tag);
                        add(vehicle, |worth| worth.tagged);
                    }
                }
                Event::Untagged(vehicle) => add(vehicle, |worth| worth.untagged),
                Event::LeftField(vehicle) => add(vehicle, |worth| worth.left_field),
                Event::Collided { first, second } => {
                    add(first, |worth| worth.collided);
                    add(second, |worth| worth.collided);
                }
                _ => {}
            }
        }
    }

    /// What the end of a game with this score is worth to a team.
    #[must_use]
    pub fn of_end(&self, score: &[u32], team: TeamId) -> f64 {
        let own = f64::from(score[team.index()]);
        let ahead = 2.0 * own - score.iter().map(|points| f64::from(*points)).sum::<f64>();
        let won = if ahead == 0.0 { 0.0 } else { ahead.signum() };
        self.end.win * won + self.end.point * ahead
    }
}
