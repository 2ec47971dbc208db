//! Views of a world: the true state for observers, and each team's picture.

use crate::sensor::imu::ImuReading;
use crate::sighting::Sightings;
use crate::world::World;
use messages::picture::{Contact, FlagView, Nav, OwnBoat, Picture, number_of_flag};
use messages::{Frame, Message, SeaView, Stamp, VehicleTruth};
use primitives::{TeamId, VehicleId};
use rules::Standing;
use rules::event::{Event, Logged};
use scenario::Scenario;

/// The data of one decision from which views are made.
#[derive(Clone, Copy)]
pub(crate) struct Scene<'a> {
    pub(crate) scenario: &'a Scenario,
    pub(crate) world: &'a World,
    pub(crate) standing: &'a Standing,
    pub(crate) decision: u64,
}

impl Scene<'_> {
    fn stamp<M: Message>(&self) -> Stamp {
        Stamp {
            valid_ns: self.world.state().now,
            seq: self.decision,
            version: M::VERSION,
        }
    }

    fn nav(&self, i: usize) -> Nav {
        let boat = &self.world.state().boats[i];
        Nav {
            north_m: boat.pose.at.north,
            east_m: boat.pose.at.east,
            psi_rad: boat.pose.psi_rad,
            surge_m_s: boat.nu.surge,
            sway_m_s: boat.nu.sway,
            yaw_rate_rad_s: boat.nu.yaw,
        }
    }

    fn flags(&self) -> impl Iterator<Item = FlagView> {
        self.standing.flags.iter().map(|flag| FlagView {
            carrier: flag.carrier.map_or(-1, |v| i32::from(v.0)),
        })
    }

    /// The true state of world and referee, with these events.
    pub(crate) fn frame(&self, events: &[Logged]) -> Frame {
        Frame {
            stamp: self.stamp::<Frame>(),
            vehicles: (0..self.scenario.vehicles.len())
                .map(|i| self.truth(i))
                .collect(),
            sea: self.sea(),
            flags: self.flags().collect(),
            score: self.standing.score.clone(),
            events: events.iter().map(|logged| (*logged).into()).collect(),
            over: self.standing.over,
            ..Frame::default()
        }
    }

    fn truth(&self, i: usize) -> VehicleTruth {
        let boat = &self.world.state().boats[i];
        let standing = &self.standing.vehicles[i];
        let attitude = self.world.truth(VehicleId::at(i)).attitude;
        VehicleTruth {
            nav: self.nav(i),
            heave_m: attitude.heave_up_m,
            roll_rad: attitude.roll_rad,
            pitch_rad: attitude.pitch_rad,
            port_newton: boat.port.newton,
            starboard_newton: boat.starboard.newton,
            tagged: standing.tagged,
            carrying: number_of_flag(standing.carrying),
            disabled: standing.disabled,
            outside: standing.outside,
            quarantined: boat.quarantined,
            ..VehicleTruth::default()
        }
    }

    fn sea(&self) -> SeaView {
        let middle = self.scenario.field.middle();
        let sea = self.world.sea();
        let wind = sea.wind_at(middle);
        let current = sea.current_at(middle);
        SeaView {
            wind_north_m_s: wind.north,
            wind_east_m_s: wind.east,
            current_north_m_s: current.north,
            current_east_m_s: current.east,
            elevation_m: sea.elevation_m(middle),
        }
    }

    /// Updates a team's picture in place. `own` is the known state of its boats, by vehicle index;
    /// `events` are the events since the previous picture.
    pub(crate) fn picture(
        &self,
        own: &[OwnBoat],
        sightings: Option<&Sightings>,
        events: &[Logged],
        picture: &mut Picture,
    ) {
        let team = TeamId(picture.team);
        picture.stamp = self.stamp::<Picture>();
        // Refill instead of rebuilding, so that a decision with many teams allocates nothing.
        picture.own.clear();
        picture.contacts.clear();
        for (i, vehicle) in self.scenario.vehicles.iter().enumerate() {
            if vehicle.team == team {
                picture.own.push(own[i]);
            } else {
                let known = sightings.map_or_else(
                    || Some(self.contact(i)),
                    |sightings| sightings.of(team.index(), i, self.world.state().now),
                );
                picture.contacts.extend(known);
            }
        }
        picture.flags.clear();
        picture.flags.extend(self.flags());
        picture.score.clone_from(&self.standing.score);
        picture.events.clear();
        let concerns = events
            .iter()
            .filter(|logged| concerns(self.scenario, team, logged.event));
        picture
            .events
            .extend(concerns.map(|logged| messages::EventRecord::from(*logged)));
        picture.over = self.standing.over;
    }

    /// A boat's report about itself.
    pub(crate) fn own_boat(&self, i: usize) -> OwnBoat {
        let vehicle = VehicleId::at(i);
        let standing = &self.standing.vehicles[i];
        let (nav, fix_ns, imu) = match self.world.reading(vehicle) {
            // Use sensor readings, even for the boat's own team: agents never see the true state
            // unless the boat's file omits sensors.
            Some(reading) => (reading.nav, reading.fix_at, reading.imu),
            None => (
                self.nav(i),
                self.world.state().now,
                ImuReading::of(&self.world.truth(vehicle)),
            ),
        };
        OwnBoat {
            vehicle,
            nav,
            fix_ns,
            imu: imu.into(),
            tagged: standing.tagged,
            carrying: number_of_flag(standing.carrying),
            disabled: standing.disabled,
            outside: standing.outside,
            tag_ready_ns: standing.tag_ready,
        }
    }

    /// The true state of a boat as in a node report: perfect sharing, as on shore in Aquaticus.
    pub(crate) fn contact(&self, i: usize) -> Contact {
        let state = self.world.state();
        let standing = &self.standing.vehicles[i];
        let boat = &state.boats[i];
        let velocity = boat.nu.in_ned(boat.pose.rotation());
        Contact {
            vehicle: VehicleId::at(i),
            team: self.scenario.vehicles[i].team,
            seen_ns: state.now,
            north_m: boat.pose.at.north,
            east_m: boat.pose.at.east,
            psi_rad: boat.pose.psi_rad,
            velocity_north_m_s: velocity.north,
            velocity_east_m_s: velocity.east,
            tagged: standing.tagged,
            carrying: number_of_flag(standing.carrying),
        }
    }
}

/// Whether an event involves one of the team's boats or its flag, or ends the game.
fn concerns(scenario: &Scenario, team: TeamId, event: Event) -> bool {
    let ours = |vehicle: VehicleId| scenario.vehicles[vehicle.index()].team == team;
    // On real water, a team would not learn of events that do not involve its boats or its flag.
    let is_own_flag = event
        .flag()
        .is_some_and(|flag| scenario.field.flags[flag.index()].team == team);
    let is_own_boat = [event.vehicle(), event.other()]
        .into_iter()
        .flatten()
        .any(ours);
    is_own_flag || is_own_boat || matches!(event, Event::Ended { .. })
}
