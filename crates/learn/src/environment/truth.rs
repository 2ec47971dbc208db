//! The true state of a game as input for a critic: values beyond the sensors of any boat, in the
//! same frame for both teams.
//!
//! Positions and directions are relative to the centre of the field: ahead, as the boat's team
//! faces the enemies' end, and to port. Speeds are in units of 3 m/s, wind in units of 10 m/s.
//! Booleans are 0 or 1. The boat itself comes first, then its teammates, then its enemies, each in
//! scenario order.

use messages::{Picture, VehicleTruth};
use primitives::frame::{Body, Rotation, ned_from_body};
use primitives::{Ned, VehicleId};
use rules::event::EventCursor;
use sim::Contest;

/// Values per boat.
const BOAT: [&str; 11] = [
    "position_ahead",
    "position_port",
    "heading_ahead",
    "heading_port",
    "velocity_ahead",
    "velocity_port",
    "yaw_rate",
    "tagged",
    "has_flag",
    "outside",
    "tag_wait",
];
/// Values per game.
const GAME: [&str; 8] = [
    "enemy_flag_taken",
    "own_flag_taken",
    "score_lead",
    "time_left",
    "wind_ahead",
    "wind_port",
    "current_ahead",
    "current_port",
];
/// Unit of speeds, m/s: a Surveyor's top speed.
const SPEED_M_S: f64 = 3.0;
/// Unit of wind speeds, m/s.
const WIND_M_S: f64 = 10.0;
const POINTS: f64 = 10.0;

/// The number of values in a game with this many boats.
pub(super) fn size(boats: usize) -> usize {
    boats * BOAT.len() + GAME.len()
}

/// The names of the values, in order.
pub(super) fn names(mates: usize, enemies: usize) -> Vec<String> {
    let mates = (1..=mates).map(|i| format!("mate_{i}"));
    let enemies = (1..=enemies).map(|i| format!("enemy_{i}"));
    let boats = std::iter::once("own".to_owned())
        .chain(mates)
        .chain(enemies);
    let of_boats = boats.flat_map(|boat| BOAT.map(|name| format!("{boat}_{name}")));
    of_boats.chain(GAME.map(str::to_owned)).collect()
}

/// Appends the values of each boat.
pub(super) fn write(contest: &Contest, boats: &[VehicleId], out: &mut Vec<f32>) {
    // A default cursor, since past events do not matter.
    let mut cursor = EventCursor::default();
    cursor.read(contest.events());
    // Only for training: the critic knows everything but the boats' future decisions. These values
    // are stored next to the observation, and no policy ever receives them.
    let frame = contest.frame(&mut cursor);
    let scenario = contest.scenario();
    let field = &scenario.field;
    let half_m = (0.5 * field.plan.width_m, 0.5 * field.plan.depth_m);
    let waits = waits(contest);
    for me in boats {
        let team = scenario.team_of(*me);
        let sign = if team.index() == 0 { 1.0 } else { -1.0 };
        let axes = (field.along.scaled(sign), field.across.scaled(sign));
        let mut push = |number: f64| out.push(number as f32);
        let along = |vector: Ned| [vector.dot(axes.0), vector.dot(axes.1)];
        let mut boat = |i: usize, truth: &VehicleTruth| {
            let [forward_m, port_m] = along(truth.nav.at() - field.middle());
            let turn = Rotation::from_heading(truth.nav.psi_rad);
            let velocity = ned_from_body(
                turn,
                Body {
                    ahead: truth.nav.surge_m_s,
                    starboard: truth.nav.sway_m_s,
                },
            );
            push(forward_m / half_m.0);
            push(port_m / half_m.1);
            along(turn.ahead()).into_iter().for_each(&mut push);
            along(velocity)
                .into_iter()
                .for_each(|m_s| push(m_s / SPEED_M_S));
            push(truth.nav.yaw_rate_rad_s);
            [truth.tagged, truth.carrying >= 0, truth.outside]
                .into_iter()
                .for_each(|is| push(f64::from(u8::from(is))));
            push(waits[i]);
        };
        boat(me.index(), &frame.vehicles[me.index()]);
        for of_team in [true, false] {
            for (i, truth) in frame.vehicles.iter().enumerate() {
                let other = VehicleId::at(i);
                if other != *me && (scenario.team_of(other) == team) == of_team {
                    boat(i, truth);
                }
            }
        }
        let carried = |own: bool| {
            let of_team = |i: usize| (scenario.team_of(VehicleId::at(i)) == team) == own;
            frame
                .vehicles
                .iter()
                .enumerate()
                .any(|(i, truth)| of_team(i) && truth.carrying >= 0)
        };
        push(f64::from(u8::from(carried(true))));
        push(f64::from(u8::from(carried(false))));
        let points: f64 = frame.score.iter().map(|points| f64::from(*points)).sum();
        push((2.0 * f64::from(frame.score[team.index()]) - points) / POINTS);
        let limit_s = scenario.rules.time_limit.as_s().max(1.0);
        push((1.0 - contest.now().as_s() / limit_s).max(0.0));
        let sea = frame.sea;
        let wind = Ned {
            north: sea.wind_north_m_s,
            east: sea.wind_east_m_s,
        };
        let current = Ned {
            north: sea.current_north_m_s,
            east: sea.current_east_m_s,
        };
        along(wind).into_iter().for_each(|m_s| push(m_s / WIND_M_S));
        along(current)
            .into_iter()
            .for_each(|m_s| push(m_s / SPEED_M_S));
    }
}

/// By vehicle index: the remaining fraction of the time until the boat may tag again.
fn waits(contest: &Contest) -> Vec<f64> {
    let scenario = contest.scenario();
    let now = contest.now();
    let mut waits = vec![0.0; scenario.vehicles.len()];
    for boat in contest
        .last_pictures()
        .iter()
        .flat_map(|picture: &Picture| &picture.own)
    {
        waits[boat.vehicle.index()] = scenario.rules.tag_wait_share(boat.tag_ready_ns, now);
    }
    waits
}
