//! Squall's own recordings of a game, or of the gateway of a real boat.

use crate::mavlink_log::Vehicles;
use crate::nmea::Sentences;
use crate::{Found, Quantity};
use messages::external::LinkBytes;
use messages::input::{Input, Inputs};
use messages::order::Order;
use primitives::angle::compass_deg_from_rad;
use recording::{Bag, INPUTS, Kind, Recording, RecordingError};

pub(crate) fn read(bag: Bag) -> Result<Found, RecordingError> {
    match bag.kind {
        Kind::Game => game(bag),
        Kind::Gateway => Ok(gateway(&bag)),
    }
}

/// The true motion of all boats, and their thrust orders.
fn game(bag: Bag) -> Result<Found, RecordingError> {
    let recording = Recording::of_bag(bag)?;
    let scenario = recording.scenario();
    let mut found = Found::default();
    let logs = &mut found.logs;
    logs.datum = Some(scenario.field.plan.datum);
    let name = |i: usize| {
        scenario
            .vehicles
            .get(i)
            .map(|vehicle| vehicle.name.as_str())
    };
    for vehicle in &scenario.vehicles {
        let team = &scenario.teams[vehicle.team.index()];
        logs.set_team(&vehicle.name, &team.name);
    }
    for frame in recording.frames().flatten() {
        let at_s = frame.stamp.valid_ns.as_s();
        for (i, vehicle) in frame.vehicles.iter().enumerate() {
            let Some(boat) = name(i).filter(|_| !vehicle.nav_lost) else {
                continue;
            };
            let nav = vehicle.nav;
            for (quantity, value) in [
                (Quantity::X, nav.east_m),
                (Quantity::Y, nav.north_m),
                (Quantity::Heading, compass_deg_from_rad(nav.psi_rad)),
                (Quantity::Surge, nav.surge_m_s),
                (Quantity::Sway, nav.sway_m_s),
                (Quantity::YawRate, nav.yaw_rate_rad_s.to_degrees()),
                (Quantity::Tagged, f64::from(u8::from(vehicle.tagged))),
                (
                    Quantity::HasFlag,
                    f64::from(u8::from(vehicle.carrying >= 0)),
                ),
            ] {
                logs.push(boat, quantity, 0, (at_s, value));
            }
        }
        for (team, score) in scenario.teams.iter().zip(&frame.score) {
            logs.push(&team.name, Quantity::Scores, 0, (at_s, f64::from(*score)));
        }
    }
    for message in recording.bag().on(INPUTS) {
        let at_s = message.at.as_s();
        let Ok(inputs) = message.read::<Inputs>() else {
            continue;
        };
        for input in inputs.of(scenario).flatten() {
            let Input::Ordered { vehicle, order, .. } = input else {
                continue;
            };
            if let (Some(boat), Order::Thrust { port, starboard }) = (name(vehicle.index()), order)
            {
                logs.push(boat, Quantity::Port, 0, (at_s, 100.0 * port));
                logs.push(boat, Quantity::Starboard, 0, (at_s, 100.0 * starboard));
            }
        }
    }
    Ok(found)
}

/// What the boat and the gateway sent each other, in either protocol.
fn gateway(bag: &Bag) -> Found {
    let mut found = Found {
        has_utc: true,
        ..Found::default()
    };
    let topics = bag.topics();
    let links = topics
        .keys()
        .filter_map(|topic| topic.strip_prefix("link/"));
    for boat in links {
        let topic = format!("link/{boat}");
        // One parser for each direction, because a message may be split between chunks.
        let mut sentences = [Sentences::new(boat), Sentences::new(boat)];
        let mut framers = [
            gateway::mavlink::Framer::new(),
            gateway::mavlink::Framer::new(),
        ];
        let mut vehicles = Vehicles::default();
        for message in bag.on(&topic) {
            let Ok(link) = message.read::<LinkBytes>() else {
                continue;
            };
            let at_s = 1e-9 * bag.began_utc_ns as f64 + message.at.as_s();
            let direction = usize::from(link.outward);
            sentences[direction].push(&mut found, Some(at_s), &link.data);
            framers[direction].push(&link.data, &mut |received| {
                vehicles.add(&mut found, boat, at_s, &received);
            });
        }
        vehicles.note(&mut found);
    }
    found
}
