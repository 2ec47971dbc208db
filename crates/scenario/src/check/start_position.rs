//! Checks start positions: a position, a named point, the team's line, or a random position in a
//! rectangle.

use super::field::is_inside;
use super::game::Entry;
use crate::StartPosition;
use crate::boat::Boat;
use crate::guess::did_you_mean;
use crate::raw;
use crate::read::Document;
use primitives::angle::rad_from_compass_deg;
use primitives::frame::{Ned, Pose};
use primitives::id::TeamId;
use primitives::near::Near;
use rules::field::Field;

/// Margin of a default rectangle on each side, m.
const MARGIN_M: f64 = 2.0;
/// Maximum fraction of the rectangle's area that the boats may need, with a square of side `gap_m`
/// for each. Random sequential placement jams at about 0.69.
const FULLEST: f64 = 0.5;

/// The start position given for the vehicle at `path`; `None` means on the team's line.
pub(super) fn stated(
    document: &Document<raw::Game>,
    path: &str,
    raw: &raw::Vehicle,
    team: TeamId,
    field: &Field,
) -> Option<StartPosition> {
    let at_path = format!("{path}.at");
    if let Some(spawn) = &raw.spawn {
        if raw.at.is_some() {
            let message = "vehicle has at and spawn, expected one of them";
            document.note(&at_path, message);
        }
        if raw.heading_deg.is_some() {
            let message = "heading_deg is given with spawn, expected only with at";
            document.note(&format!("{path}.heading_deg"), message);
        }
        return somewhere(document, &format!("{path}.spawn"), spawn, 1, field);
    }
    let at = match raw.at.as_ref()? {
        raw::Position::At([x, y]) => Ned::from_xy(*x, *y),
        raw::Position::Point(name) => {
            is_point(document, &at_path, name).then_some(())?;
            field.point(team, name)?
        }
    };
    is_inside(document, field, &at_path, at);
    Some(start_at(at, raw.heading_deg, field, team))
}

/// A position with a heading: by default towards the opponent's end.
fn start_at(at: Ned, heading_deg: Option<f64>, field: &Field, team: TeamId) -> StartPosition {
    let heading_deg = heading_deg.unwrap_or(field.facing_deg(team));
    let psi_rad = rad_from_compass_deg(heading_deg);
    StartPosition::At(Pose { at, psi_rad })
}

/// The rectangle of the `spawn` at `path`, if `count` boats fit into it.
pub(super) fn somewhere(
    document: &Document<raw::Game>,
    path: &str,
    raw: &raw::Spawn,
    count: usize,
    field: &Field,
) -> Option<StartPosition> {
    let width_m = field.plan.width_m;
    let depth_m = field.plan.depth_m;
    let gap_m = raw.gap_m;
    let bounds = |key: &str, given: Option<[f64; 2]>, whole_m: f64, usual_m: f64| {
        let Some([from_m, to_m]) = given else {
            return Some((MARGIN_M, usual_m - MARGIN_M));
        };
        let mut both_m = [from_m, to_m].into_iter();
        let message = if let Some(beyond_m) = both_m.find(|bound_m| *bound_m > whole_m) {
            format!("{key} is {beyond_m}, expected 0 to {whole_m}")
        } else if from_m >= to_m {
            format!("{key} is [{from_m}, {to_m}], expected the smaller value first")
        } else {
            return Some((from_m, to_m));
        };
        document.note(&format!("{path}.{key}"), message);
        None
    };
    let along_m = bounds("along_m", raw.along_m, width_m, width_m / 2.0);
    let across_m = bounds("across_m", raw.across_m, depth_m, depth_m);
    let along_m = along_m?;
    let across_m = across_m?;
    let area_m2 = (along_m.1 - along_m.0) * (across_m.1 - across_m.0);
    let wanted_m2 = count as f64 * gap_m * gap_m;
    if count > 1 && wanted_m2 > FULLEST * area_m2 {
        let message = format!(
            "spawn has {area_m2:.0} m² for {count} boats with gap_m {gap_m}, expected at least {:.0} m²",
            wanted_m2 / FULLEST
        );
        document.note(path, message);
        return None;
    }
    Some(StartPosition::Somewhere {
        along_m,
        across_m,
        gap_m,
    })
}

/// The start positions of all entries, in order. Vehicles without a given position are on their
/// team's line: midway between its flag and the scrimmage line, evenly spaced from port to
/// starboard, facing the opponent.
pub(super) fn all(entries: &[Entry], field: &Field) -> Vec<StartPosition> {
    let plan = &field.plan;
    let along_m = (plan.flag_inset_m + plan.width_m / 2.0) / 2.0;
    let in_line = [0, 1].map(|team| {
        let on_line = |e: &&Entry| e.team == TeamId(team) && e.start_position.is_none();
        entries.iter().filter(on_line).count()
    });
    let mut placed = [0_usize; 2];
    let mut start_position_of = |entry: &Entry| {
        if let Some(start_position) = &entry.start_position {
            return start_position.clone();
        }
        let team = entry.team.index();
        placed[team] += 1;
        let from_port_m = plan.depth_m * placed[team] as f64 / (in_line[team] + 1) as f64;
        let at = match team {
            0 => field.at(along_m, plan.depth_m - from_port_m),
            _ => field.at(plan.width_m - along_m, from_port_m),
        };
        start_at(at, entry.heading_deg, field, entry.team)
    };
    entries.iter().map(&mut start_position_of).collect()
}

/// Reports boats that would start too close to each other or to an obstacle.
pub(super) fn check_clear(
    document: &Document<raw::Game>,
    entries: &[Entry],
    start_positions: &[StartPosition],
    boats: &[Boat],
    field: &Field,
) {
    let mut placed: Vec<(&Entry, Ned, f64)> = vec![];
    for (entry, start_position) in entries.iter().zip(start_positions) {
        let StartPosition::At(pose) = start_position else {
            continue;
        };
        let length_m = boats[entry.boat].length_m;
        let mut obstacles = field.plan.obstacles.iter();
        if obstacles.any(|obstacle| obstacle.distance(pose.at) <= length_m / 2.0) {
            let message = format!(
                "{} starts at [{}, {}], on an obstacle, expected open water",
                entry.name, pose.at.east, pose.at.north
            );
            document.note(&entry.path, message);
        }
        placed.push((entry, pose.at, length_m));
    }
    let lengths_m = placed.iter().map(|(_, _, length_m)| *length_m);
    let longest_m = lengths_m.fold(0.1, f64::max);
    let mut near = Near::default();
    let mut last = "";
    for pair in near.pairs(|i| placed[i].1, placed.len(), longest_m) {
        let (a, _, a_length_m) = placed[usize::from(pair.a)];
        let (b, _, b_length_m) = placed[usize::from(pair.b)];
        let apart_m = pair.distance_squared.sqrt();
        let least_m = a_length_m.max(b_length_m);
        // Report each crowded boat or fleet only once.
        if apart_m < least_m && b.path != last {
            last = &b.path;
            let message = format!(
                "{} starts {apart_m:.2} m from {}, expected at least a boat's length, {least_m} m",
                b.name, a.name
            );
            document.note(&b.path, message);
        }
    }
}

/// Whether `name`, at `path`, is one of the field's named points; reports it if not.
fn is_point(document: &Document<raw::Game>, path: &str, name: &str) -> bool {
    let names = Field::point_names();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let is_known = names.contains(&name);
    if !is_known {
        let points = names.join(" ");
        let guess = did_you_mean(name, &names);
        let message = format!("at is {name:?}, expected a named point, one of {points}{guess}");
        document.note(path, message);
    }
    is_known
}
