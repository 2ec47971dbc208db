//! Checks a field file.

use super::polygon::check_corners;
use crate::diagnostics::Diagnostics;
use crate::kind::ScenarioFile;
use crate::raw;
use crate::read::Document;
use primitives::frame::Ned;
use primitives::id::TeamId;
use rules::field::{Field, Flag, Obstacle, Plan};

/// Maximum distance of a relevant obstacle outside the field, m.
const NEAR_M: f64 = 50.0;

impl ScenarioFile for Field {
    type Keys = raw::Field;
    const NAME: &'static str = "field";
    const FOLDER: &'static str = "fields";

    fn check(diagnostics: &mut Diagnostics, document: &Document<raw::Field>) -> Option<Field> {
        let raw = &document.raw;
        let Plan {
            name,
            datum,
            corner,
            along_deg,
            width_m,
            depth_m,
            walls,
            ..
        } = raw.plan.clone();
        let flag_inset_m = raw.plan.flag_inset_m.unwrap_or(width_m / 8.0);
        let half_m = width_m / 2.0;
        if !(flag_inset_m > 0.0 && flag_inset_m < half_m) && document.is_sound("width_m") {
            let message = format!(
                "flag_inset_m is {flag_inset_m}, expected more than 0 and less than {half_m}"
            );
            diagnostics.note(document.at("flag_inset_m"), message);
        }
        let is_plane_sound = ["corner", "along_deg", "width_m", "depth_m", "flag_inset_m"]
            .iter()
            .all(|key| document.is_sound(key));
        if !is_plane_sound {
            return None;
        }
        let extra_flags = vec![];
        let obstacles = vec![];
        let mut plan = Plan {
            name,
            datum,
            corner,
            along_deg,
            width_m,
            depth_m,
            flag_inset_m,
            extra_flags,
            obstacles,
            walls,
        };
        let empty = Field::new(plan.clone());
        plan.extra_flags = self::extra_flags(diagnostics, document, &empty);
        let field = Field::new(plan.clone());
        for (i, raw) in raw.obstacle.iter().enumerate() {
            plan.obstacles.extend(obstacle(
                diagnostics,
                document,
                &format!("obstacle.{i}"),
                raw,
                &field,
            ));
        }
        document.is_faultless(diagnostics).then(|| Field::new(plan))
    }
}

fn extra_flags(
    diagnostics: &mut Diagnostics,
    document: &Document<raw::Field>,
    field: &Field,
) -> Vec<Flag> {
    let flag = |(i, raw): (usize, &raw::Flag)| {
        let path = format!("flag.{i}.at");
        let home = Ned::from_xy(raw.at[0], raw.at[1]);
        let team = match raw.team {
            raw::Side::First => TeamId(0),
            raw::Side::Second => TeamId(1),
        };
        let is_inside =
            document.is_sound(&path) && is_inside(diagnostics, field, document.at(&path), home);
        is_inside.then_some(Flag { team, home })
    };
    document
        .raw
        .flag
        .iter()
        .enumerate()
        .filter_map(flag)
        .collect()
}

/// Whether `position`, given at `at`, is inside the field; reports it if not.
pub(super) fn is_inside(
    diagnostics: &mut Diagnostics,
    field: &Field,
    at: usize,
    position: Ned,
) -> bool {
    let is_inside = field.contains(position);
    if !is_inside {
        let (along, across) = field.along_across(position);
        let width = field.plan.width_m;
        let depth = field.plan.depth_m;
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

fn obstacle(
    diagnostics: &mut Diagnostics,
    document: &Document<raw::Field>,
    path: &str,
    raw: &raw::Obstacle,
    field: &Field,
) -> Option<Obstacle> {
    if !document.is_sound(path) {
        return None;
    }
    let place = document.at(path);
    let obstacle = match (&raw.circle, &raw.polygon) {
        (
            Some(raw::Circle {
                centre: [x, y],
                radius_m,
            }),
            None,
        ) => Obstacle::Circle {
            centre: Ned::from_xy(*x, *y),
            radius_m: *radius_m,
        },
        (None, Some(polygon)) => {
            let corners: Vec<Ned> = polygon.iter().map(|[x, y]| Ned::from_xy(*x, *y)).collect();
            if let Err((corner, message)) = check_corners(&corners) {
                diagnostics.note(document.at(&format!("{path}.polygon.{corner}")), message);
                return None;
            }
            Obstacle::Polygon { corners }
        }
        _ => {
            diagnostics.note_if_intact(
                place,
                "obstacle has neither or both, expected either circle or polygon",
            );
            return None;
        }
    };
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
        diagnostics.note(
            place,
            format!("obstacle is off the field, expected at most {NEAR_M} m outside it"),
        );
    }
    if field
        .flags
        .iter()
        .any(|flag| obstacle.distance(flag.home) <= 0.0)
    {
        diagnostics.note(place, "obstacle covers a flag, expected open water there");
    }
    Some(obstacle)
}
