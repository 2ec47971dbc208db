//! What others see of a world: the truth for observers, and each team's picture.

use crate::sensor::imu::ImuReading;
use crate::sighting::Sightings;
use crate::state::State;
use crate::world::World;
use game::event::{Event, Logged, TagCause};
use game::message::{Frame, Message, SeaView, Stamp, VehicleTruth};
use game::picture::{Contact, FlagView, Imu, Nav, OwnBoat, Picture, number_of_flag};
use game::{Scenario, TeamId, VehicleId};

fn stamp<M: Message>(state: &State, seq: u64) -> Stamp {
    Stamp { valid_ns: state.now, seq, version: M::VERSION }
}

fn nav(state: &State, i: usize) -> Nav {
    let boat = &state.boats[i];
    Nav {
        north_m: boat.pose.at.north,
        east_m: boat.pose.at.east,
        psi_rad: boat.pose.psi_rad,
        surge_m_s: boat.nu.surge,
        sway_m_s: boat.nu.sway,
        yaw_rate_rad_s: boat.nu.yaw,
    }
}

fn flags(state: &State) -> impl Iterator<Item = FlagView> {
    state.standing.flags.iter().map(|flag| FlagView { carrier: flag.carrier.map_or(-1, |v| i32::from(v.0)) })
}

/// The truth about everything that the world knows of, with these events.
pub(crate) fn frame(world: &World, seq: u64, events: &[Logged]) -> Frame {
    let state = world.state();
    let truth = |i: usize| {
        let (boat, standing) = (&state.boats[i], &state.standing.vehicles[i]);
        let attitude = world.attitude(VehicleId::at(i));
        VehicleTruth {
            nav: nav(state, i),
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
    };
    Frame {
        stamp: stamp::<Frame>(state, seq),
        vehicles: (0..state.boats.len()).map(truth).collect(),
        sea: sea(world),
        flags: flags(state).collect(),
        score: state.standing.score.clone(),
        events: events.iter().map(|logged| (*logged).into()).collect(),
        over: state.standing.over,
        ..Frame::default()
    }
}

fn sea(world: &World) -> SeaView {
    let corners = &world.referee().field().corners;
    let middle = (corners[0] + corners[2]).scaled(0.5);
    let sea = world.sea();
    let (wind, current) = (sea.wind_at(middle), sea.current_at(middle));
    SeaView {
        wind_north_m_s: wind.north,
        wind_east_m_s: wind.east,
        current_north_m_s: current.north,
        current_east_m_s: current.east,
        elevation_m: sea.elevation_m(middle),
    }
}

/// Brings a team's picture up to date in place. `own` is what is known of its boats, by vehicle.
pub(crate) fn picture(
    scenario: &Scenario,
    world: &World,
    (seq, events): (u64, &[Logged]),
    (own, sightings): (&[OwnBoat], Option<&Sightings>),
    picture: &mut Picture,
) {
    let state = world.state();
    let team = TeamId(picture.team);
    picture.stamp = stamp::<Picture>(state, seq);
    picture.own.clear();
    picture.contacts.clear();
    for (i, vehicle) in scenario.vehicles.iter().enumerate() {
        if vehicle.team == team {
            picture.own.push(own[i]);
        } else {
            let known = sightings.map_or_else(
                || Some(contact(state, i, vehicle.team)),
                |sightings| sightings.of(team.index(), i, state.now),
            );
            picture.contacts.extend(known);
        }
    }
    picture.flags.clear();
    picture.flags.extend(flags(state));
    picture.score.clone_from(&state.standing.score);
    picture.events.clear();
    let concerns = events.iter().filter(|logged| concerns(scenario, team, logged.event));
    picture.events.extend(concerns.map(|logged| game::message::EventRecord::from(*logged)));
    picture.over = state.standing.over;
}

/// What a boat reports of itself.
pub(crate) fn own_boat(world: &World, i: usize) -> OwnBoat {
    let state = world.state();
    let standing = &state.standing.vehicles[i];
    let (nav, fix_ns, imu) = match world.reading(VehicleId::at(i)) {
        Some(reading) => (reading.nav, reading.fix_at, reading.imu),
        None => (nav(state, i), state.now, ImuReading::of(&world.truth(VehicleId::at(i)))),
    };
    OwnBoat {
        vehicle: VehicleId::at(i),
        nav,
        fix_ns,
        imu: Imu {
            roll_rate_rad_s: imu.gyro_rad_s[0],
            pitch_rate_rad_s: imu.gyro_rad_s[1],
            yaw_rate_rad_s: imu.gyro_rad_s[2],
            ahead_m_s2: imu.accelerometer_m_s2[0],
            starboard_m_s2: imu.accelerometer_m_s2[1],
            down_m_s2: imu.accelerometer_m_s2[2],
        },
        tagged: standing.tagged,
        carrying: number_of_flag(standing.carrying),
        disabled: standing.disabled,
        outside: standing.outside,
        tag_ready_ns: standing.tag_ready,
    }
}

/// The truth about a boat, as a node report tells it: perfect sharing, as Aquaticus does ashore.
pub(crate) fn contact(state: &State, i: usize, team: TeamId) -> Contact {
    let (boat, standing) = (&state.boats[i], &state.standing.vehicles[i]);
    let velocity = boat.nu.in_ned(boat.pose.rotation());
    Contact {
        vehicle: VehicleId::at(i),
        team,
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

/// Whether an event is about one of the team's boats or its flag, or ends the game.
fn concerns(scenario: &Scenario, team: TeamId, event: Event) -> bool {
    let ours = |vehicle: VehicleId| scenario.vehicles[vehicle.index()].team == team;
    let second = match event {
        Event::Tagged { cause: TagCause::Opponent(by), .. } => ours(by),
        Event::Collided { second, .. } => ours(second),
        Event::Grabbed { flag, .. } | Event::Captured { flag, .. } | Event::FlagReturned { flag, .. } => {
            scenario.field.flags[flag.index()].team == team
        }
        Event::Ended { .. } => true,
        _ => false,
    };
    second || event.vehicle().is_some_and(ours)
}
