//! Counts of a game's events for each boat and each team.

use crate::event::{Event, TagCause};
use primitives::id::{TeamId, VehicleId};
use serde::{Deserialize, Serialize};

/// Counts of each kind of event.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Flags grabbed.
    pub grabs: u32,
    /// Flags captured.
    pub captures: u32,
    /// Opponents tagged.
    pub tags: u32,
    /// Times tagged, by an opponent, by the boundary or by an obstacle.
    pub tagged: u32,
    /// Times the boat left the field.
    pub out_of_bounds: u32,
    /// Collisions that involved the boat. A collision between teammates counts twice for the team.
    pub collisions: u32,
    /// Times the boat's agent was lost. Older recordings use a former name of this field.
    #[serde(alias = "minds_lost")]
    pub agents_lost: u32,
}

/// The counts of a game, computed from its events.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tally {
    /// Counts, by vehicle index.
    pub vehicles: Vec<Counts>,
}

impl Tally {
    /// The counts of `vehicles` boats before any event.
    pub fn new(vehicles: usize) -> Tally {
        Tally {
            vehicles: vec![Counts::default(); vehicles],
        }
    }

    /// Adds one event.
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
    pub fn team(&self, team: TeamId, team_of: impl Fn(usize) -> TeamId) -> Counts {
        let mut sum = Counts::default();
        for (_, c) in self
            .vehicles
            .iter()
            .enumerate()
            .filter(|(i, _)| team_of(*i) == team)
        {
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
