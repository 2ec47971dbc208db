//! Checks a field file.

use super::polygon::check_corners;
use crate::diagnostics::keys_of;
use crate::kind::ScenarioFile;
use crate::raw;
use crate::read::Document;
use primitives::frame::Ned;
use primitives::id::TeamId;
use rules::field::{
    Field, Flag, FlagSettings, Obstacle, Plan, Route, distance_to_line, distance_to_side, sides,
};

/// Maximum distance of an obstacle from the field, m.
const NEAR_M: f64 = 50.0;

impl ScenarioFile for Field {
    type Keys = raw::Field;
    const NAME: &'static str = "field";
    const FOLDER: &'static str = "fields";

    fn check(document: &Document<raw::Field>) -> Option<Field> {
        let raw = &document.raw;
        let given = raw.plan.clone();
        let flag_inset_m = given.flag_inset_m.unwrap_or(given.width_m / 8.0);
        let half_m = given.width_m / 2.0;
        if !(flag_inset_m > 0.0 && flag_inset_m < half_m) && document.is_sound("width_m") {
            let message = format!(
                "flag_inset_m is {flag_inset_m}, expected more than 0 and less than {half_m}"
            );
            document.note("flag_inset_m", message);
        }
        let keys = ["corner", "along_deg", "width_m", "depth_m", "flag_inset_m"];
        if !keys.iter().all(|key| document.is_sound(key)) {
            return None;
        }
        let mut plan = Plan {
            name: given.name,
            datum: given.datum,
            corner: given.corner,
            along_deg: given.along_deg,
            width_m: given.width_m,
            depth_m: given.depth_m,
            flag_inset_m,
            default_flags: Default::default(),
            extra_flags: vec![],
            obstacles: vec![],
            walls: given.walls,
        };
        let empty = Field::new(plan.clone());
        plan.default_flags = default_flags(document, &empty);
        plan.extra_flags = extra_flags(document, &empty);
        let field = Field::new(plan.clone());
        for (i, raw) in raw.obstacle.iter().enumerate() {
            plan.obstacles
                .extend(obstacle(document, &format!("obstacle.{i}"), raw, &field));
        }
        document.is_faultless().then(|| Field::new(plan))
    }
}

/// The settings of the default flags, by team: those of the entries without a position.
fn default_flags(document: &Document<raw::Field>, field: &Field) -> [FlagSettings; 2] {
    let mut given = [None, None];
    for (i, raw) in document.raw.flag.iter().enumerate() {
        let path = format!("flag.{i}");
        if raw.at.is_some() || !document.is_sound(&format!("{path}.at")) {
            continue;
        }
        let team = team(raw).index();
        let settings = settings(document, &path, raw, (field, field.flags[team].start));
        if given[team].replace(settings).is_some() {
            let message = "at is missing, expected a position: an earlier entry describes the \
                           team's default flag";
            document.note_if_intact(&path, message);
        }
    }
    given.map(Option::unwrap_or_default)
}

fn extra_flags(document: &Document<raw::Field>, field: &Field) -> Vec<Flag> {
    let flag = |(i, raw): (usize, &raw::Flag)| {
        let path = format!("flag.{i}");
        let at_path = format!("{path}.at");
        let [x, y] = raw.at?;
        let start = Ned::from_xy(x, y);
        let is_inside = document.is_sound(&at_path) && is_inside(document, field, &at_path, start);
        is_inside.then(|| Flag {
            team: team(raw),
            start,
            settings: settings(document, &path, raw, (field, start)),
        })
    };
    let flags = document.raw.flag.iter().enumerate();
    flags.filter_map(flag).collect()
}

fn team(raw: &raw::Flag) -> TeamId {
    match raw.team {
        raw::Side::First => TeamId(0),
        raw::Side::Second => TeamId(1),
    }
}

/// The settings of the flag at `path`, which starts at `start`.
fn settings(
    document: &Document<raw::Field>,
    path: &str,
    raw: &raw::Flag,
    (field, start): (&Field, Ned),
) -> FlagSettings {
    let points_path = format!("{path}.route.points");
    let route = raw
        .route
        .as_ref()
        .filter(|_| document.is_sound(&points_path));
    let route = route.map(|route| {
        let mut points = vec![start];
        for (i, [x, y]) in route.points.iter().enumerate() {
            let point = Ned::from_xy(*x, *y);
            let point_path = format!("{points_path}.{i}");
            is_inside(document, field, &point_path, point);
            let is_last = i + 1 == route.points.len();
            if points.last() == Some(&point) || is_last && point == start {
                let message = format!("points has [{x}, {y}] twice in a row, expected a path");
                document.note(&point_path, message);
            }
            points.push(point);
        }
        Route::new(points, route.speed_m_s)
    });
    FlagSettings {
        radii: raw.radii,
        route,
    }
}

/// Whether `position`, given at `path`, is inside the field; reports it if not.
pub(super) fn is_inside<T>(
    document: &Document<T>,
    field: &Field,
    path: &str,
    position: Ned,
) -> bool {
    let is_inside = field.contains(position);
    if !is_inside {
        let (along, across) = field.along_across(position);
        let key = keys_of(path).next().unwrap_or("at");
        let message = format!(
            "{key} is [{}, {}], expected a position inside the field: it is {along:.2} m along (of {}) \
             and {across:.2} m across (of {})",
            position.east, position.north, field.plan.width_m, field.plan.depth_m
        );
        document.note(path, message);
    }
    is_inside
}

fn obstacle(
    document: &Document<raw::Field>,
    path: &str,
    raw: &raw::Obstacle,
    field: &Field,
) -> Option<Obstacle> {
    document.is_sound(path).then_some(())?;
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
                document.note(&format!("{path}.polygon.{corner}"), message);
                return None;
            }
            Obstacle::Polygon { corners }
        }
        _ => {
            let message =
                "obstacle has neither or both of circle and polygon, expected one of them";
            document.note_if_intact(path, message);
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
        let message = format!("obstacle is off the field, expected at most {NEAR_M} m outside it");
        document.note(path, message);
    }
    let mut flags = field.flags.iter();
    if flags.any(|flag| covers(&obstacle, flag)) {
        document.note(path, "obstacle covers a flag, expected open water there");
    }
    Some(obstacle)
}

/// Whether an obstacle covers a flag's home, or a part of its path.
fn covers(obstacle: &Obstacle, flag: &Flag) -> bool {
    let is_met = |leg: (Ned, Ned)| match obstacle {
        Obstacle::Circle { centre, radius_m } => {
            distance_to_side(leg.0, leg.1, *centre) <= *radius_m
        }
        Obstacle::Polygon { corners } => distance_to_line(corners, leg) <= 0.0,
    };
    let route = flag.settings.route.iter();
    obstacle.distance(flag.start) <= 0.0 || route.flat_map(|route| sides(&route.points)).any(is_met)
}
