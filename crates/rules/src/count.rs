//! Tallies of a game: what each boat and each team did.

use crate::event::{Event, TagCause};
use primitives::id::{TeamId, VehicleId};
use serde::{Deserialize, Serialize};

/// How often what happened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Flags taken.
    pub grabs: u32,
    /// Flags brought in.
    pub captures: u32,
    /// Opponents tagged.
    pub tags: u32,
    /// Times tagged, by an opponent or the boundary.
    pub tagged: u32,
    /// Times the boat left the field.
    pub out_of_bounds: u32,
    /// Collisions the boat was in. A team's count adds up its boats', so one between team-mates is two.
    pub collisions: u32,
    /// Times the boat's agent was lost. Older recordings have it under its former name.
    #[serde(alias = "minds_lost")]
    pub agents_lost: u32,
}

/// The tally of a game, kept from its events.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tally {
    /// By vehicle.
    pub vehicles: Vec<Counts>,
}

impl Tally {
    /// Nothing has happened to any of `vehicles` boats.
    #[must_use]
    pub fn new(vehicles: usize) -> Tally {
        Tally { vehicles: vec![Counts::default(); vehicles] }
    }

    /// Takes one more event into account.
    pub fn add(&mut self, event: Event) {
        let mut count = |vehicle: VehicleId, field: fn(&mut Counts) -> &mut u32| {
            *field(&mut self.vehicles[vehicle.index()]) += 1;
        };
        match event {
            Event::Grabbed { vehicle, .. } => count(vehicle, |c| &mut c.grabs),
            Event::Captured { vehicle, .. } => count(vehicle, |c| &mut c.captures),
            Event::Tagged { vehicle, cause } => {
                count(vehicle, |c| &mut c.tagged);
                if let TagCause::Opponent(by) = cause {
                    count(by, |c| &mut c.tags);
                }
            }
            Event::LeftField(vehicle) => count(vehicle, |c| &mut c.out_of_bounds),
            Event::Collided { first, second } => {
                count(first, |c| &mut c.collisions);
                count(second, |c| &mut c.collisions);
            }
            Event::AgentLost(vehicle) => count(vehicle, |c| &mut c.agents_lost),
            _ => {}
        }
    }

    /// The sum over one team's boats.
    #[must_use]
    pub fn team(&self, team: TeamId, team_of: impl Fn(usize) -> TeamId) -> Counts {
        let mut sum = Counts::default();
        for (_, c) in self.vehicles.iter().enumerate().filter(|(i, _)| team_of(*i) == team) {
            sum.grabs += c.grabs;
            sum.captures += c.captures;
            sum.tags += c.tags;
            sum.tagged += c.tagged;
            sum.out_of_bounds += c.out_of_bounds;
            sum.collisions += c.collisions;
            sum.agents_lost += c.agents_lost;
        }
        sum
    }
}
