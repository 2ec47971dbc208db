//! Where boats start: by hand, by name, in the team's line, or somewhere in a rectangle.

use super::field::{COORDINATE_M, is_inside};
use super::game::Entry;
use super::same_place;
use super::strategy::is_point;
use crate::angle::rad_from_compass_deg;
use crate::boat::Boat;
use crate::field::Field;
use crate::frame::{Ned, Pose};
use crate::id::TeamId;
use crate::near::Near;
use crate::scenario::StartPosition;
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw::{At, Pair, RawSpawn, RawVehicle, Whereabouts};

/// What a default rectangle leaves free at either side, m.
const MARGIN_M: f64 = 2.0;
/// The default distance between boats drawn into a rectangle, m.
const GAP_M: f64 = 5.0;
/// Boats drawn one by one jam when their gaps cover about 0.69 of the rectangle as squares; half is easy.
const FULLEST: f64 = 0.5;

/// The start_position of a vehicle that states one by hand, by name or by lot; `None` for the team's line.
pub(super) fn stated(
    diagnostics: &mut Diagnostics,
    raw: &RawVehicle,
    heading_deg: Option<f64>,
    team: TeamId,
    field: &Field,
) -> Option<StartPosition> {
    if let Some(spawn) = &raw.spawn {
        if let Some(at) = &raw.at {
            diagnostics.note(at.at, "vehicle has at and spawn, expected one of them");
        }
        if let Some(heading) = &raw.heading_deg {
            diagnostics.note(heading.at, "heading_deg is given with spawn, expected with at only");
        }
        return somewhere(diagnostics, spawn, 1, field);
    }
    let given = raw.at.as_ref()?;
    let at = match &given.value {
        Whereabouts::Position(position) => {
            let (x, y) = diagnostics.pair("at", Some(&same_place(given, Pair(*position))), COORDINATE_M)?;
            Ned::from_xy(x, y)
        }
        Whereabouts::Point(name) => {
            is_point(diagnostics, given.at, "at", name).then_some(())?;
            field.point(team, name)?
        }
    };
    is_inside(diagnostics, field, given.at, at);
    let heading_deg = heading_deg.unwrap_or(field.facing_deg(team));
    Some(StartPosition::At(Pose { at, psi_rad: rad_from_compass_deg(heading_deg) }))
}

/// The rectangle that `spawn` states, if `count` boats fit into it.
pub(super) fn somewhere(
    diagnostics: &mut Diagnostics,
    spawn: &At<RawSpawn>,
    count: usize,
    field: &Field,
) -> Option<StartPosition> {
    let (width_m, depth_m) = (field.plan.width_m, field.plan.depth_m);
    let raw = &spawn.value;
    let along_m = bounds(diagnostics, "along_m", raw.along_m.as_ref(), width_m, width_m / 2.0)?;
    let across_m = bounds(diagnostics, "across_m", raw.across_m.as_ref(), depth_m, depth_m)?;
    let gap_m = match &raw.gap_m {
        Some(gap) => diagnostics.number("gap_m", Some(gap), 0.0..=1000.0)?,
        None => GAP_M,
    };
    let area_m2 = (along_m.1 - along_m.0) * (across_m.1 - across_m.0);
    let wanted_m2 = count as f64 * gap_m * gap_m;
    if count > 1 && wanted_m2 > FULLEST * area_m2 {
        let message = format!(
            "spawn has {area_m2:.0} m² for {count} boats with gap_m {gap_m}, expected at least {:.0} m²",
            wanted_m2 / FULLEST
        );
        diagnostics.note(spawn.at, message);
        return None;
    }
    Some(StartPosition::Somewhere { along_m, across_m, gap_m })
}

fn bounds(
    diagnostics: &mut Diagnostics,
    key: &str,
    given: Option<&At<Pair>>,
    whole_m: f64,
    usual_m: f64,
) -> Option<(f64, f64)> {
    let Some(given) = given else { return Some((MARGIN_M, usual_m - MARGIN_M)) };
    let (from_m, to_m) = diagnostics.pair(key, Some(given), 0.0..=whole_m)?;
    if from_m >= to_m {
        diagnostics.note(given.at, format!("{key} is [{from_m}, {to_m}], expected the smaller one first"));
        return None;
    }
    Some((from_m, to_m))
}

/// The start_positions of all entries, in their order; those that state none lie in their team's line: midway
/// between own flag and scrimmage line, evenly across, from port to starboard, bows to the opponent.
pub(super) fn all(entries: &[Entry], field: &Field) -> Vec<StartPosition> {
    let plan = &field.plan;
    let along_m = (plan.flag_inset_m + plan.width_m / 2.0) / 2.0;
    let in_line = |team: TeamId| entries.iter().filter(|e| e.team == team && e.start_position.is_none()).count();
    let in_line: Vec<usize> = (0..2).map(|team| in_line(TeamId(team))).collect();
    let mut placed = [0_usize; 2];
    let mut berth_of = |entry: &Entry| {
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
        let heading_deg = entry.heading_deg.unwrap_or(field.facing_deg(entry.team));
        StartPosition::At(Pose { at, psi_rad: rad_from_compass_deg(heading_deg) })
    };
    entries.iter().map(&mut berth_of).collect()
}

/// Notes boats that would start on top of one another, or on an obstacle.
pub(super) fn check_clear(
    diagnostics: &mut Diagnostics,
    entries: &[Entry],
    start_positions: &[StartPosition],
    boats: &[Boat],
    field: &Field,
) {
    let mut placed: Vec<(&Entry, Ned, f64)> = vec![];
    for (entry, start_position) in entries.iter().zip(start_positions) {
        let StartPosition::At(pose) = start_position else { continue };
        let length_m = boats[entry.boat].length_m;
        if field.plan.obstacles.iter().any(|obstacle| obstacle.distance(pose.at) <= length_m / 2.0) {
            let (x, y) = (pose.at.east, pose.at.north);
            let message = format!("{} starts at [{x}, {y}], on an obstacle, expected open water", entry.name);
            diagnostics.note(entry.place, message);
        }
        placed.push((entry, pose.at, length_m));
    }
    let longest_m = placed.iter().map(|(_, _, length_m)| *length_m).fold(0.1, f64::max);
    let mut near = Near::default();
    let mut last = usize::MAX;
    for pair in near.pairs(|i| placed[i].1, placed.len(), longest_m) {
        let ((a, _, a_length_m), (b, _, b_length_m)) = (placed[usize::from(pair.a)], placed[usize::from(pair.b)]);
        let (apart_m, least_m) = (pair.distance_squared.sqrt(), a_length_m.max(b_length_m));
        // A boat in a crowd is told of once, and a crowded fleet once.
        if apart_m < least_m && b.place != last {
            last = b.place;
            let message =
                format!("{} starts {apart_m:.2} m from {}, expected a boat's length, {least_m} m", b.name, a.name);
            diagnostics.note(b.place, message);
        }
    }
}
