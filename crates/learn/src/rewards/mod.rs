//! Rewards for learning boats, from events and states of a game.
//!
//! [`Rewards`] are data, read from `scenarios/rewards/*.toml`; the type declares the keys.

mod progress;

pub use progress::{Among, BoatProgress, progress};

use primitives::id::{TeamId, VehicleId};
use rules::event::{Event, Logged, TagCause};
use scenario::Scenario;
use scenario::{Document, ScenarioFile};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The reward of a boat: the sum of all parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Rewards {
    /// Events of the boat itself.
    pub boat: Worth,
    /// Events of any boat of its team, including itself.
    pub team: Worth,
    /// Events of any enemy.
    pub enemy: Worth,
    /// The end of the game, for every boat of a team.
    pub end: End,
    /// Potential-based shaping.
    pub potential: Potential,
    /// Rewards for positions.
    pub place: Place,
    /// Per second of the game.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub second: f64,
}

impl ScenarioFile for Rewards {
    type Keys = Rewards;
    const NAME: &'static str = "rewards";
    const FOLDER: &'static str = "rewards";

    fn check(document: &Document<Rewards>) -> Option<Rewards> {
        let rewards = document.raw;
        if rewards == Rewards::default() && document.is_sound("") {
            let message = "all rewards are 0, expected at least one other value".to_owned();
            document.note("", message);
        }
        document.is_faultless().then_some(rewards)
    }
}

/// Events of a boat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Worth {
    /// The boat grabs the enemies' flag.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub grab: f64,
    /// The boat captures the flag.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub capture: f64,
    /// The boat tags an enemy.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub tag: f64,
    /// The boat tags a carrier; replaces `tag`.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub tag_carrier: f64,
    /// An enemy tags the boat.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub tagged: f64,
    /// The boat is tagged while carrying a flag; replaces `tagged`.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub tagged_carrying: f64,
    /// The boat is untagged.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub untagged: f64,
    /// The boat leaves the field.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub left_field: f64,
    /// The boat comes within the collision distance of another boat.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub collided: f64,
}

/// The end of the game.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct End {
    /// For a win; a loss costs the same amount.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub win: f64,
    /// Per point of lead.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub point: f64,
}

/// Discounted gain of a potential that depends only on the state and is 0 at the end of a game (Ng,
/// Harada and Russell, ICML 1999). It does not change the optimal policy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Potential {
    /// Potential at the enemies' flag; 0 a field's width away. For a carrier, it rises to twice
    /// this at the capture place.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub attack: f64,
    /// For a tagged boat: minus this much per field width of distance from its untag place.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub untag: f64,
}

/// Values of positions, 0 for a tagged boat: each step adds the change in value. In the discounted
/// return, this equals (1 - γ) of the value per step. Unlike `potential`, these change the optimal
/// policy: use them for policies with a single task.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Place {
    /// At the enemies' flag, or anywhere while carrying it; 0 a field's width away.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub flag: f64,
    /// At the capture or untag place; 0 a field's width away.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub home: f64,
    /// At the nearest intruder, an untagged enemy on the team's side; 0 a field's width away, and
    /// without intruders.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub intruder: f64,
    /// An eighth of the field's width from the team's flag towards its nearest untagged enemy, or
    /// at that enemy if nearer; 0 a quarter of the width away.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub guard: f64,
    /// As `guard`, for an untagged teammate on the enemies' side instead of the flag: the one
    /// nearest to an untagged enemy.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub shield: f64,
    /// At least a quarter of the field's width from every untagged enemy; 0 at an enemy.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub clear: f64,
}

impl Place {
    /// The value of a boat's position.
    pub fn of(&self, boat: &BoatProgress) -> f64 {
        if boat.tagged {
            return 0.0;
        }
        let among = &boat.among;
        let near = |away: f64| (1.0 - away).max(0.0);
        self.flag
            * if boat.carrying {
                1.0
            } else {
                near(boat.from_flag)
            }
            + self.home * near(boat.from_home)
            + self.intruder * among.at_intruder
            + self.guard * among.on_guard
            + self.shield * among.at_shield
            + self.clear * among.clear
    }
}

impl Potential {
    /// The potential of a boat.
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
    /// Whether the positions of other boats matter; see [`Among`].
    pub fn depend_on_others(&self) -> bool {
        let Place {
            intruder,
            guard,
            shield,
            clear,
            ..
        } = self.place;
        [intruder, guard, shield, clear]
            .iter()
            .any(|worth| *worth != 0.0)
    }

    /// Adds the rewards for events. `carrying` states whether each boat carried a flag before the
    /// events.
    pub fn add_events(
        &self,
        scenario: &Scenario,
        events: &[Logged],
        carrying: &[bool],
        rewards: &mut [f64],
    ) {
        let team_of = |vehicle: VehicleId| scenario.team_of(vehicle);
        let mut add = |vehicle: VehicleId, worth: fn(&Worth) -> f64| {
            for (i, reward) in rewards.iter_mut().enumerate() {
                let other = VehicleId::at(i);
                if other == vehicle {
                    *reward += worth(&self.boat);
                }
                *reward += worth(if team_of(other) == team_of(vehicle) {
                    &self.team
                } else {
                    &self.enemy
                });
            }
        };
        for logged in events {
            match logged.event {
                Event::Grabbed { vehicle, .. } => add(vehicle, |worth| worth.grab),
                Event::Captured { vehicle, .. } => add(vehicle, |worth| worth.capture),
                Event::Tagged {
                    vehicle,
                    cause: TagCause::Opponent(by),
                } => {
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

    /// A team's reward for the end of a game with this score.
    pub fn of_end(&self, score: &[u32], team: TeamId) -> f64 {
        let own = f64::from(score[team.index()]);
        let ahead = 2.0 * own - score.iter().map(|points| f64::from(*points)).sum::<f64>();
        let won = if ahead == 0.0 { 0.0 } else { ahead.signum() };
        self.end.win * won + self.end.point * ahead
    }
}

#[cfg(test)]
mod tests {
    use super::{Among, BoatProgress, Place, Rewards};

    #[test]
    fn a_place_is_worth_the_sum_of_its_parts_and_nothing_to_a_tagged_boat() {
        let place = Place {
            flag: 0.1,
            home: 1.0,
            intruder: 1e4,
            guard: 10.0,
            shield: 100.0,
            clear: 1000.0,
        };
        let among = Among {
            at_intruder: 0.5,
            on_guard: 0.5,
            at_shield: 0.25,
            clear: 0.75,
        };
        let boat = BoatProgress {
            from_flag: 0.5,
            from_home: 0.25,
            among,
            ..BoatProgress::default()
        };
        assert_eq!(place.of(&boat), 0.05 + 0.75 + 5e3 + 5.0 + 25.0 + 750.0);
        assert_eq!(
            place.of(&BoatProgress {
                carrying: true,
                ..boat
            }),
            0.1 + 0.75 + 5e3 + 5.0 + 25.0 + 750.0
        );
        assert_eq!(
            place.of(&BoatProgress {
                tagged: true,
                ..boat
            }),
            0.0
        );
        assert_eq!(
            Place {
                home: 1.0,
                ..Place::default()
            }
            .of(&BoatProgress {
                from_home: 1.5,
                ..boat
            }),
            0.0
        );
    }

    #[test]
    fn others_matter_to_what_depends_on_them() {
        let mut rewards = Rewards::default();
        (rewards.place.home, rewards.place.flag) = (1.0, 1.0);
        rewards.potential.attack = 1.0;
        assert!(!rewards.depend_on_others());
        for change in [
            |rewards: &mut Rewards| rewards.place.guard = 1.0,
            |rewards: &mut Rewards| rewards.place.shield = -1.0,
            |rewards: &mut Rewards| rewards.place.clear = 1.0,
            |rewards: &mut Rewards| rewards.place.intruder = 1.0,
        ] {
            let mut rewards = rewards;
            change(&mut rewards);
            assert!(rewards.depend_on_others(), "{rewards:?}");
        }
    }
}
