//! The true state of a game as input for a critic: values beyond the sensors of any boat, in the
//! same frame for both teams.
//!
//! Positions and directions are relative to the centre of the field: ahead, as the boat's team
//! faces the enemies' end, and to port. Speeds are in units of 3 m/s, wind in units of 10 m/s.
//! Booleans are 0 or 1. The boat itself comes first, then its teammates, then its enemies, each in
//! scenario order.

use messages::{Frame, Picture, VehicleTruth};
use primitives::frame::{Body, Rotation, ned_from_body};
use primitives::{Ned, TeamId, VehicleId};
use rules::event::EventCursor;
use scenario::Scenario;
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

/// Writes the values of each row's boat, with room for teams of `team_size` boats. Values without a
/// boat are 0.
pub(super) fn write(
    contest: &Contest,
    rows: &[Option<VehicleId>],
    team_size: usize,
    out: &mut Vec<f32>,
) {
    // A default cursor, since past events do not matter.
    let mut cursor = EventCursor::default();
    cursor.read(contest.events());
    // Only for training: the critic knows everything but the boats' future decisions. These values
    // are stored next to the observation, and no policy ever receives them.
    let frame = contest.frame(&mut cursor);
    let scenario = contest.scenario();
    let waits = waits(contest);
    let size = size(2 * team_size);
    out.clear();
    out.resize(rows.len() * size, 0.0);
    for (me, values) in rows.iter().zip(out.chunks_exact_mut(size)) {
        let Some(me) = *me else { continue };
        let view = View::new(scenario, &frame, scenario.team_of(me));
        let (slots, game) = values.split_at_mut(2 * team_size * BOAT.len());
        let mut write = |slot: usize, i: usize| {
            let numbers = view.boat(&frame.vehicles[i], waits[i]);
            slots[slot * BOAT.len()..][..BOAT.len()].copy_from_slice(&numbers.map(|n| n as f32));
        };
        write(0, me.index());
        let (mut mates, mut enemies) = (1.., team_size..);
        for i in (0..frame.vehicles.len()).filter(|i| *i != me.index()) {
            let slots = if view.is_own(i) {
                &mut mates
            } else {
                &mut enemies
            };
            slots.next().into_iter().for_each(|slot| write(slot, i));
        }
        let left = 1.0 - contest.now().as_s() / scenario.rules.time_limit.as_s().max(1.0);
        game.copy_from_slice(&view.game(left).map(|number| number as f32));
    }
}

/// A game as one team sees it.
struct View<'a> {
    scenario: &'a Scenario,
    frame: &'a Frame,
    team: TeamId,
    /// Unit vectors ahead and to port.
    axes: [Ned; 2],
}

impl<'a> View<'a> {
    fn new(scenario: &'a Scenario, frame: &'a Frame, team: TeamId) -> View<'a> {
        let field = &scenario.field;
        let sign = if team.index() == 0 { 1.0 } else { -1.0 };
        View {
            scenario,
            frame,
            team,
            axes: [field.along.scaled(sign), field.across.scaled(sign)],
        }
    }

    fn is_own(&self, boat: usize) -> bool {
        self.scenario.team_of(VehicleId::at(boat)) == self.team
    }

    fn along(&self, vector: Ned) -> [f64; 2] {
        self.axes.map(|axis| vector.dot(axis))
    }

    fn boat(&self, truth: &VehicleTruth, wait: f64) -> [f64; BOAT.len()] {
        let field = &self.scenario.field;
        let [forward_m, port_m] = self.along(truth.nav.at() - field.middle());
        let turn = Rotation::from_heading(truth.nav.psi_rad);
        let velocity = Body {
            ahead: truth.nav.surge_m_s,
            starboard: truth.nav.sway_m_s,
        };
        let heading = self.along(turn.ahead());
        let velocity_m_s = self.along(ned_from_body(turn, velocity));
        [
            forward_m / (0.5 * field.plan.width_m),
            port_m / (0.5 * field.plan.depth_m),
            heading[0],
            heading[1],
            velocity_m_s[0] / SPEED_M_S,
            velocity_m_s[1] / SPEED_M_S,
            truth.nav.yaw_rate_rad_s,
            number(truth.tagged),
            number(truth.carrying >= 0),
            number(truth.outside),
            wait,
        ]
    }

    /// The values of the game. `left` is the remaining fraction of its time.
    fn game(&self, left: f64) -> [f64; GAME.len()] {
        let carried = |own: bool| {
            let vehicles = self.frame.vehicles.iter().enumerate();
            let mut carriers = vehicles.filter(|(_, truth)| truth.carrying >= 0);
            number(carriers.any(|(i, _)| self.is_own(i) == own))
        };
        let score = &self.frame.score;
        let points: f64 = score.iter().map(|points| f64::from(*points)).sum();
        let sea = self.frame.sea;
        let wind_m_s = self.along(Ned {
            north: sea.wind_north_m_s,
            east: sea.wind_east_m_s,
        });
        let current_m_s = self.along(Ned {
            north: sea.current_north_m_s,
            east: sea.current_east_m_s,
        });
        [
            carried(true),
            carried(false),
            (2.0 * f64::from(score[self.team.index()]) - points) / POINTS,
            left.max(0.0),
            wind_m_s[0] / WIND_M_S,
            wind_m_s[1] / WIND_M_S,
            current_m_s[0] / SPEED_M_S,
            current_m_s[1] / SPEED_M_S,
        ]
    }
}

fn number(is: bool) -> f64 {
    f64::from(u8::from(is))
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
