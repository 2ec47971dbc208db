//! A field file, checked.

use super::same_place;
use crate::field::{Field, Flag, Obstacle, Plan, Walls, do_meet, turn};
use crate::frame::{LatLon, Ned};
use crate::id::TeamId;
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw::{At, Pair, RawField, RawObstacle, RawSide, RawWalls};
use crate::scenario::read::Document;
use std::ops::RangeInclusive;

/// Coordinates, m from the datum: beyond it the local frame is no longer flat.
pub(super) const COORDINATE_M: RangeInclusive<f64> = -1e6..=1e6;
/// How far outside of the field an obstacle may stand and still matter, m.
const NEAR_M: f64 = 50.0;
/// An index has eight bits; this leaves room for the teams' own.
const MOST_EXTRA_FLAGS: usize = 100;

/// Checks a field.
pub(in crate::scenario) fn field(diagnostics: &mut Diagnostics, document: &Document<RawField>) -> Option<Field> {
    let faults = diagnostics.faults();
    let raw = &document.raw;
    let corner = diagnostics.pair("corner", raw.corner.as_ref(), COORDINATE_M).unwrap_or((0.0, 0.0));
    let width_m = diagnostics.required(document.start, "width_m", raw.width_m.as_ref(), 10.0..=20000.0);
    let plan = Plan {
        name: document.name.clone(),
        datum: datum(diagnostics, document),
        corner: Ned::from_xy(corner.0, corner.1),
        along_deg: diagnostics.number("along_deg", raw.along_deg.as_ref(), -360.0..=360.0).unwrap_or(90.0),
        width_m,
        depth_m: diagnostics.required(document.start, "depth_m", raw.depth_m.as_ref(), 10.0..=20000.0),
        flag_inset_m: inset(diagnostics, raw, width_m),
        extra_flags: vec![],
        obstacles: vec![],
        walls: match raw.walls {
            Some(RawWalls::AllRound) => Walls::AllRound,
            Some(RawWalls::None) | None => Walls::None,
        },
    };
    if diagnostics.faults() != faults {
        return None;
    }
    let mut plan = Field::new(plan).plan;
    plan.extra_flags = extra_flags(diagnostics, document, &Field::new(plan.clone()));
    let field = Field::new(plan.clone());
    for obstacle in raw.obstacle.iter().flatten() {
        plan.obstacles.extend(self::obstacle(diagnostics, obstacle, &field));
    }
    (diagnostics.faults() == faults).then(|| Field::new(plan))
}

fn datum(diagnostics: &mut Diagnostics, document: &Document<RawField>) -> LatLon {
    let Some(datum) = &document.raw.datum else {
        diagnostics.note_missing(document.start, "datum", "{ lat_deg = …, lon_deg = … }");
        return LatLon::default();
    };
    LatLon {
        lat_deg: diagnostics.required(datum.at, "datum.lat_deg", datum.value.lat_deg.as_ref(), -90.0..=90.0),
        lon_deg: diagnostics.required(datum.at, "datum.lon_deg", datum.value.lon_deg.as_ref(), -180.0..=180.0),
    }
}

fn inset(diagnostics: &mut Diagnostics, raw: &RawField, width_m: f64) -> f64 {
    let Some(inset) = &raw.flag_inset_m else { return width_m / 8.0 };
    let inset_m = inset.value;
    if !(inset_m > 0.0 && inset_m < width_m / 2.0) {
        let half_m = width_m / 2.0;
        diagnostics.note(inset.at, format!("flag_inset_m is {inset_m}, expected more than 0 and less than {half_m}"));
    }
    inset_m
}

fn extra_flags(diagnostics: &mut Diagnostics, document: &Document<RawField>, field: &Field) -> Vec<Flag> {
    let mut flags = vec![];
    for flag in document.raw.flag.iter().flatten() {
        if flags.len() == MOST_EXTRA_FLAGS {
            diagnostics.note(flag.at, format!("flag is one too many, expected at most {MOST_EXTRA_FLAGS}"));
            break;
        }
        if flag.value.team.is_none() {
            diagnostics.note_missing(flag.at, "flag.team", "one of first, second");
        }
        let Some(at) = &flag.value.at else {
            diagnostics.note_missing(flag.at, "flag.at", "[x, y]");
            continue;
        };
        let home = diagnostics.pair("at", Some(at), COORDINATE_M).map(|(x, y)| Ned::from_xy(x, y));
        if let Some((side, home)) = flag.value.team.zip(home)
            && is_inside(diagnostics, field, at.at, home)
        {
            let team = match side {
                RawSide::First => TeamId(0),
                RawSide::Second => TeamId(1),
            };
            flags.push(Flag { team, home });
        }
    }
    flags
}

/// Whether `position`, given at `at`, is inside the field; notes it if not.
pub(super) fn is_inside(diagnostics: &mut Diagnostics, field: &Field, at: usize, position: Ned) -> bool {
    let is_inside = field.contains(position);
    if !is_inside {
        let (along, across) = field.along_across(position);
        let (width, depth) = (field.plan.width_m, field.plan.depth_m);
        diagnostics.note(
            at,
            format!(
                "at is [{}, {}], expected a position inside the field: it is {along:.2} m along (of {width}) \
                 and {across:.2} m across (of {depth})",
                position.east, position.north
            ),
        );
    }
    is_inside
}

fn obstacle(diagnostics: &mut Diagnostics, given: &At<RawObstacle>, field: &Field) -> Option<Obstacle> {
    let faults = diagnostics.faults();
    let obstacle = match (&given.value.circle, &given.value.polygon) {
        (Some(circle), None) => {
            if circle.value.centre.is_none() {
                diagnostics.note_missing(circle.at, "circle.centre", "[x, y]");
            }
            let centre = diagnostics.pair("centre", circle.value.centre.as_ref(), COORDINATE_M);
            let radius = circle.value.radius_m.as_ref();
            let radius_m = diagnostics.required(circle.at, "circle.radius_m", radius, 0.01..=1e4);
            let (x, y) = centre?;
            Obstacle::Circle { centre: Ned::from_xy(x, y), radius_m }
        }
        (None, Some(polygon)) => Obstacle::Polygon { corners: corners(diagnostics, polygon)? },
        _ => {
            diagnostics.note_if_intact(given.at, "obstacle says neither or both, expected either circle or polygon");
            return None;
        }
    };
    if diagnostics.faults() != faults {
        return None;
    }
    let is_near = |point: &Ned| {
        let (along, across) = field.along_across(*point);
        let within = |x: f64, size: f64| (-NEAR_M..=size + NEAR_M).contains(&x);
        within(along, field.plan.width_m) && within(across, field.plan.depth_m)
    };
    let is_near = match &obstacle {
        Obstacle::Circle { centre, .. } => is_near(centre),
        Obstacle::Polygon { corners } => corners.iter().all(is_near),
    };
    if !is_near {
        diagnostics.note(given.at, format!("obstacle is off the field, expected at most {NEAR_M} m outside of it"));
    }
    if field.flags.iter().any(|flag| obstacle.distance(flag.home) <= 0.0) {
        diagnostics.note(given.at, "obstacle stands on a flag, expected open water there");
    }
    Some(obstacle)
}

fn corners(diagnostics: &mut Diagnostics, polygon: &At<Vec<At<Pair>>>) -> Option<Vec<Ned>> {
    let mut corners = vec![];
    for corner in &polygon.value {
        let (x, y) = diagnostics.pair("polygon", Some(&same_place(corner, corner.value)), COORDINATE_M)?;
        corners.push(Ned::from_xy(x, y));
    }
    let count = corners.len();
    if !(3..=1000).contains(&count) {
        diagnostics.note(polygon.at, format!("polygon has {count} corners, expected 3 to 1000"));
        return None;
    }
    let side = |i: usize| (corners[i], corners[(i + 1) % count]);
    for i in 0..count {
        if corners[i] == side(i).1 {
            diagnostics.note(polygon.value[i].at, "polygon has two corners in one place, expected different ones");
            return None;
        }
        // Neighbours share a corner; they may only not fold back onto one another.
        let crossing = (i + 1..count).find(|&j| {
            let (is_next, is_before) = (j == i + 1, (j + 1) % count == i);
            match (is_next, is_before) {
                (true, _) => folds_back(corners[i], corners[j], side(j).1),
                (_, true) => folds_back(corners[j], corners[i], side(i).1),
                _ => do_meet(side(i), side(j)),
            }
        });
        if let Some(j) = crossing {
            let message = format!("polygon's side {} meets its side {}, expected no crossing", i + 1, j + 1);
            diagnostics.note(polygon.value[j].at, message);
            return None;
        }
    }
    Some(corners)
}

fn folds_back(a: Ned, b: Ned, c: Ned) -> bool {
    turn(a, b, c) == 0.0 && (a - b).dot(c - b) > 0.0
}
