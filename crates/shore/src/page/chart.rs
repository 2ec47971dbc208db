//! The chart: everything constant during a game, as the page draws it.
//!
//! x is east and y is north, both in metres from the datum; bearings are compass degrees.

use messages::water::{PlaneWave, Water};
use primitives::{Ned, math};
use rules::field::{Flag, Obstacle, Walls};
use rules::{Field, Rules};
use scenario::{Drawn, Scenario, Source, Vehicle};
use serde_json::{Map, Value, json};

/// The chart of a game, as `PROTOCOL.md` defines it.
pub(super) fn chart(scenario: &Scenario, water: &Water) -> Value {
    let rules = &scenario.rules;
    let drawn = |Drawn { parameter, value }: &Drawn| (parameter.clone(), json!(value));
    json!({
        "name": scenario.name,
        "seed": scenario.seed,
        "duration_s": rules.time_limit.as_s(),
        "decision_s": scenario.decision().as_s(),
        "rules": rules.name,
        "sea": scenario.sea.name,
        "teams": scenario.teams.iter().map(|team| json!({"name": team.name})).collect::<Vec<_>>(),
        "vehicles": scenario.vehicles.iter().map(|one| vehicle(scenario, one)).collect::<Vec<_>>(),
        "field": field(&scenario.field, rules),
        "radii": {
            "grab_m": rules.grab_radius_m,
            "tag_m": rules.tag_radius_m,
            "untag_m": rules.untag_radius_m,
            "capture_m": rules.capture_radius_m,
            "keepout_m": rules.flag_keepout_m,
            "collision_m": rules.collision_distance_m,
        },
        "points": {"grab": rules.points.grab, "capture": rules.points.capture, "tag": rules.points.tag},
        "waves": water.waves.iter().map(wave).collect::<Vec<_>>(),
        "drawn": scenario.drawn.iter().map(drawn).collect::<Map<_, _>>(),
    })
}

fn vehicle(scenario: &Scenario, vehicle: &Vehicle) -> Value {
    let boat = &scenario.boats[vehicle.boat];
    let strategy = &scenario.strategies[vehicle.strategy];
    json!({
        "name": vehicle.name,
        "team": vehicle.team.index(),
        "length_m": boat.length_m,
        "beam_m": boat.beam_m,
        "external": vehicle.source == Source::External,
        "teleop": strategy.is_steered(),
        "strategy": strategy.name,
        "speed_max_m_s": boat.speed_max_m_s(),
    })
}

fn field(field: &Field, rules: &Rules) -> Value {
    let plan = &field.plan;
    let zones = field.zones.iter().enumerate();
    let flags = field.flags.iter().map(|one| flag(one, rules));
    json!({
        "name": plan.name,
        "datum": [plan.datum.lat_deg, plan.datum.lon_deg],
        "along_deg": plan.along_deg,
        "walls": plan.walls == Walls::AllRound,
        "corners": places(&field.corners),
        "zones": zones.map(|(team, zone)| json!({"team": team, "corners": places(&zone.corners)})).collect::<Vec<_>>(),
        "scrimmage": places(&field.scrimmage),
        "flags": flags.collect::<Vec<_>>(),
        "obstacles": plan.obstacles.iter().map(obstacle).collect::<Vec<_>>(),
    })
}

fn flag(flag: &Flag, rules: &Rules) -> Value {
    let radii = rules.radii_of(flag);
    let route = flag.settings.route.as_ref();
    let route = route.map(|route| {
        let points = places(&route.points);
        json!({"points": points, "ends_m": route.ends_m, "speed_m_s": route.speed_m_s})
    });
    json!({
        "team": flag.team.index(),
        "x": flag.start.east,
        "y": flag.start.north,
        "route": route,
        "radii": {
            "grab_m": radii.grab_m,
            "capture_m": radii.capture_m,
            "untag_m": radii.untag_m,
            "keepout_m": radii.keepout_m,
        },
    })
}

fn obstacle(obstacle: &Obstacle) -> Value {
    match obstacle {
        Obstacle::Circle { centre, radius_m } => {
            json!({"circle": [centre.east, centre.north, radius_m]})
        }
        Obstacle::Polygon { corners } => json!({"polygon": places(corners)}),
    }
}

fn wave(wave: &PlaneWave) -> Value {
    let (sin, cos) = math::sin_cos(wave.toward_rad);
    json!({
        "amplitude_m": wave.amplitude_m,
        "k_x": wave.wavenumber_rad_m * sin,
        "k_y": wave.wavenumber_rad_m * cos,
        "omega_rad_s": wave.omega_rad_s,
        "phase_rad": wave.phase_rad,
    })
}

/// East and north of each corner, m.
fn places(corners: &[Ned]) -> Vec<[f64; 2]> {
    corners.iter().map(|at| [at.east, at.north]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rules::field::Route;
    use std::path::Path;

    fn chart(file: &str, water: &Water) -> Value {
        let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../scenarios/games")
            .join(file);
        let scenario = scenario::load(&file).unwrap_or_else(|e| panic!("{e}"));
        super::chart(&scenario, water)
    }

    #[test]
    fn a_shipped_game_is_drawn_as_the_protocol_says() {
        let eastward = PlaneWave {
            amplitude_m: 0.1,
            wavenumber_rad_m: 0.3,
            toward_rad: std::f64::consts::FRAC_PI_2,
            omega_rad_s: 1.7,
            phase_rad: 0.4,
        };
        let chart = chart(
            "mixed_2v2.toml",
            &Water {
                waves: vec![eastward],
            },
        );
        assert_eq!(chart["name"], "mixed_2v2");
        assert_eq!(chart["teams"], json!([{"name": "blue"}, {"name": "red"}]));
        assert_eq!(chart["decision_s"], 0.1);
        let first = &chart["vehicles"][0];
        assert_eq!(
            (&first["team"], &first["teleop"]),
            (&json!(0), &json!(false))
        );
        assert!(
            first["speed_max_m_s"]
                .as_f64()
                .is_some_and(|speed| speed > 0.5),
            "{first}"
        );
        let kinds: Vec<&Value> = chart["vehicles"]
            .as_array()
            .expect("a list")
            .iter()
            .map(|v| &v["external"])
            .collect();
        assert!(
            kinds.contains(&&json!(true)) && kinds.contains(&&json!(false)),
            "real boats among others: {kinds:?}"
        );
        let wave = &chart["waves"][0];
        assert!((wave["k_x"].as_f64().expect("a number") - 0.3).abs() < 1e-12);
        assert!(wave["k_y"].as_f64().expect("a number").abs() < 1e-12);
    }

    #[test]
    fn the_field_has_x_east_and_y_north() {
        let chart = chart("pav01_vs_pav01.toml", &Water::default());
        let field = &chart["field"];
        assert_eq!(field["name"], "aquaticus_160x80");
        assert_eq!(
            field["corners"],
            json!([[0.0, 0.0], [0.0, 80.0], [160.0, 80.0], [160.0, 0.0]])
        );
        assert_eq!(field["scrimmage"], json!([[80.0, 0.0], [80.0, 80.0]]));
        let flag = &field["flags"][0];
        let want = json!({
            "team": 0, "x": 20.0, "y": 40.0, "route": null,
            "radii": {"grab_m": 10.0, "capture_m": 10.0, "untag_m": 10.0, "keepout_m": 0.0},
        });
        assert_eq!(*flag, want);
        assert_eq!(field["walls"], false);
        assert_eq!(chart["waves"], json!([]));
        assert_eq!(chart["points"], json!({"grab": 1, "capture": 2, "tag": 0}));
    }

    #[test]
    fn a_flag_is_drawn_with_its_own_radii_and_path() {
        let file =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/games/pav01_vs_pav01.toml");
        let mut scenario = scenario::load(&file).unwrap_or_else(|e| panic!("{e}"));
        let flag = &mut scenario.field.flags[0];
        flag.settings.radii.grab_radius_m = Some(4.0);
        let points = vec![flag.start, flag.start + Ned::from_xy(0.0, 20.0)];
        flag.settings.route = Some(Route::new(points, 0.5));
        let flag = &super::chart(&scenario, &Water::default())["field"]["flags"][0];
        let radii = &flag["radii"];
        assert_eq!([&radii["grab_m"], &radii["capture_m"]], [4.0, 10.0]);
        let points = json!([[20.0, 40.0], [20.0, 60.0]]);
        let route = json!({"points": points, "ends_m": [20.0, 40.0], "speed_m_s": 0.5});
        assert_eq!(flag["route"], route);
    }

    #[test]
    fn obstacles_are_circles_and_polygons() {
        let chart = chart("harbour_2v2.toml", &Water::default());
        let obstacles = chart["field"]["obstacles"].as_array().expect("a list");
        assert!(!obstacles.is_empty());
        assert!(
            obstacles
                .iter()
                .all(|one| one["circle"].is_array() || one["polygon"].is_array()),
            "{obstacles:?}"
        );
    }
}
