//! The field and the game as markers for RViz and Foxglove.

use crate::convert::{MAP, Motion, enu};
use crate::message::{Color, Header, Marker, MarkerArray, Pose};
use messages::Frame;
use primitives::{Ned, SimTime, TeamId, VehicleId};
use rules::field::Obstacle;
use scenario::Scenario;

// Kinds of markers, as in `visualization_msgs/Marker`.
const ARROW: i32 = 0;
const SPHERE: i32 = 2;
const CYLINDER: i32 = 3;
const LINE_STRIP: i32 = 4;

const WHITE: Color = [1.0, 1.0, 1.0, 0.8];
const GREY: Color = [0.5, 0.5, 0.5, 1.0];
/// The colours of the teams.
const TEAMS: [Color; 4] = [
    [0.1, 0.4, 1.0, 1.0],
    [1.0, 0.2, 0.2, 1.0],
    [0.2, 0.8, 0.2, 1.0],
    [1.0, 0.8, 0.1, 1.0],
];

fn color(team: TeamId) -> Color {
    TEAMS[team.index() % TEAMS.len()]
}

/// A marker with this number in the namespace `ns`.
fn marker(at: SimTime, ns: &str, id: usize, kind: i32, color: Color) -> Marker {
    let header = Header {
        stamp: at.into(),
        frame_id: MAP.to_owned(),
    };
    let id = i32::try_from(id).unwrap_or(i32::MAX);
    Marker {
        header,
        ns: ns.to_owned(),
        id,
        kind,
        color,
        ..Marker::default()
    }
}

/// A line through these positions.
fn line(
    at: SimTime,
    (ns, id): (&str, usize),
    color: Color,
    places: impl Iterator<Item = Ned>,
) -> Marker {
    let scale = [0.3, 0.0, 0.0];
    Marker {
        scale,
        points: places.map(enu).collect(),
        ..marker(at, ns, id, LINE_STRIP, color)
    }
}

fn standing(at: Ned) -> Pose {
    Pose {
        position: enu(at),
        orientation: [0.0, 0.0, 0.0, 1.0],
    }
}

/// The fixed parts: edges, scrimmage line and obstacles.
pub fn field(scenario: &Scenario, at: SimTime) -> MarkerArray {
    let field = &scenario.field;
    let closed = |corners: &[Ned]| {
        corners
            .iter()
            .chain(corners.first())
            .copied()
            .collect::<Vec<_>>()
            .into_iter()
    };
    let mut markers = vec![
        line(at, ("edges", 0), WHITE, closed(&field.corners)),
        line(at, ("scrimmage", 0), WHITE, field.scrimmage.into_iter()),
    ];
    markers.extend(
        field
            .plan
            .obstacles
            .iter()
            .enumerate()
            .map(|(i, obstacle)| match obstacle {
                Obstacle::Circle { centre, radius_m } => {
                    let scale = [2.0 * radius_m, 2.0 * radius_m, 1.0];
                    Marker {
                        pose: standing(*centre),
                        scale,
                        ..marker(at, "obstacles", i, CYLINDER, GREY)
                    }
                }
                Obstacle::Polygon { corners } => line(at, ("obstacles", i), GREY, closed(corners)),
            }),
    );
    MarkerArray { markers }
}

/// The moving parts: boats as arrows of the boats' size, and flags as spheres, at home or on their
/// carriers.
pub fn game(scenario: &Scenario, frame: &Frame) -> MarkerArray {
    let at = frame.stamp.valid_ns;
    let boats = frame
        .vehicles
        .iter()
        .take(scenario.vehicles.len())
        .enumerate()
        .map(|(i, truth)| {
            let boat = VehicleId::at(i);
            let hull = scenario.boat_of(boat);
            let scale = [hull.length_m, hull.beam_m, 0.3];
            let pose = Motion::truth(frame.stamp, truth).pose();
            Marker {
                pose,
                scale,
                ..marker(at, "boats", i, ARROW, color(scenario.team_of(boat)))
            }
        });
    let flags = scenario.field.flags.iter().enumerate().map(|(i, flag)| {
        let carrier = frame
            .flags
            .get(i)
            .and_then(|flag| usize::try_from(flag.carrier).ok());
        let place = carrier
            .and_then(|boat| frame.vehicles.get(boat))
            .map_or(flag.home(at), |boat| boat.nav.at());
        let scale = [2.0; 3];
        Marker {
            pose: standing(place),
            scale,
            ..marker(at, "flags", i, SPHERE, color(flag.team))
        }
    });
    MarkerArray {
        markers: boats.chain(flags).collect(),
    }
}
