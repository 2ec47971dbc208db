//! The mirror image of a game: rotated by half a turn, with the teams swapped.

use primitives::{FlagId, Leg, Ned, TeamId, VehicleId};
use rules::event::{Event, TagCause};
use rules::{Standing, VehicleStanding};

/// A half-turn about the middle of the field. The teams, which have the same number of boats, are
/// swapped.
pub(crate) struct Mirror {
    pub(crate) boats: usize,
}

impl Mirror {
    fn position(at: Ned) -> Ned {
        Ned::from_xy(160.0 - at.east, 80.0 - at.north)
    }

    fn vehicle(&self, vehicle: VehicleId) -> VehicleId {
        VehicleId::at((vehicle.index() + self.boats) % (2 * self.boats))
    }

    fn pair(&self, first: VehicleId, second: VehicleId) -> (VehicleId, VehicleId) {
        let a = self.vehicle(first);
        let b = self.vehicle(second);
        (a.min(b), a.max(b))
    }

    fn flag(flag: FlagId) -> FlagId {
        FlagId(flag.0 ^ 1)
    }

    pub(crate) fn event(&self, mut event: Event) -> Event {
        match &mut event {
            Event::Grabbed { vehicle, flag }
            | Event::Captured { vehicle, flag }
            | Event::FlagReturned { vehicle, flag } => {
                (*vehicle, *flag) = (self.vehicle(*vehicle), Mirror::flag(*flag));
            }
            Event::Tagged { vehicle, cause } => {
                *vehicle = self.vehicle(*vehicle);
                if let TagCause::Opponent(by) = cause {
                    *by = self.vehicle(*by);
                }
            }
            Event::Untagged(vehicle)
            | Event::LeftField(vehicle)
            | Event::ReturnedToField(vehicle)
            | Event::EnteredKeepout(vehicle)
            | Event::Disabled(vehicle)
            | Event::Enabled(vehicle) => *vehicle = self.vehicle(*vehicle),
            Event::Collided { first, second } => (*first, *second) = self.pair(*first, *second),
            Event::Ended { winner } => *winner = winner.map(|team| TeamId(1 - team.0)),
            Event::AgentLost(_) | Event::AgentBack(_) | Event::Quarantined(_) => {}
            Event::NavLost(_) | Event::NavBack(_) => {}
            Event::EStopped | Event::Released | Event::Halted | Event::WentOn => {}
        }
        event
    }

    pub(crate) fn fleet(&self, fleet: &[Leg]) -> Vec<Leg> {
        let leg = |i| {
            let Leg { from, to } = fleet[self.vehicle(VehicleId::at(i)).index()];
            Leg {
                from: Mirror::position(from),
                to: Mirror::position(to),
            }
        };
        (0..fleet.len()).map(leg).collect()
    }

    pub(crate) fn standing(&self, standing: &Standing) -> Standing {
        let source = |i: usize| self.vehicle(VehicleId::at(i)).index();
        let boat = |i: usize| {
            let boat = standing.vehicles[source(i)].clone();
            VehicleStanding {
                carrying: boat.carrying.map(Mirror::flag),
                ..boat
            }
        };
        let mut mirrored = standing.clone();
        mirrored.vehicles = (0..standing.vehicles.len()).map(boat).collect();
        mirrored.disabled = (0..standing.vehicles.len())
            .map(|i| standing.disabled[source(i)])
            .collect();
        for (i, flag) in mirrored.flags.iter_mut().enumerate() {
            *flag = standing.flags[i ^ 1].clone();
            flag.carrier = flag.carrier.map(|vehicle| self.vehicle(vehicle));
        }
        mirrored.score.reverse();
        mirrored
            .touching
            .iter_mut()
            .for_each(|(a, b)| (*a, *b) = self.pair(*a, *b));
        mirrored.touching.sort_unstable();
        mirrored
    }
}
