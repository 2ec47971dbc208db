//! The chart: what does not change while a game is played, as the page draws it.
//!
//! x is east and y is north, both in metres from the datum; bearings are compass degrees.

use game::field::{Obstacle, Walls};
use game::scenario::Source;
use game::water::{PlaneWave, Water};
use game::{Ned, Scenario, math};
use serde::Serialize;
use std::collections::BTreeMap;

/// All of it, as it stands in `PROTOCOL.md`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Chart {
    pub(super) name: String,
    pub(super) seed: u64,
    pub(super) duration_s: f64,
    pub(super) decision_s: f64,
    pub(super) rules: String,
    pub(super) sea: String,
    pub(super) teams: Vec<TeamMark>,
    pub(super) vehicles: Vec<VehicleMark>,
    pub(super) field: FieldMark,
    pub(super) radii: Radii,
    pub(super) points: PointsMark,
    pub(super) waves: Vec<Wave>,
    pub(super) drawn: BTreeMap<String, f64>,
}

/// A place: x, y.
pub(super) type Place = [f64; 2];

/// A team.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct TeamMark {
    pub(super) name: String,
}

/// A vehicle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct VehicleMark {
    pub(super) name: String,
    pub(super) team: usize,
    pub(super) length_m: f64,
    pub(super) beam_m: f64,
    pub(super) external: bool,
    pub(super) teleop: bool,
    pub(super) strategy: String,
    pub(super) speed_max_m_s: f64,
}

/// The field.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct FieldMark {
    pub(super) name: String,
    pub(super) datum: [f64; 2],
    pub(super) along_deg: f64,
    pub(super) walls: bool,
    pub(super) corners: Vec<Place>,
    pub(super) zones: Vec<ZoneMark>,
    pub(super) scrimmage: [Place; 2],
    pub(super) flags: Vec<FlagMark>,
    pub(super) obstacles: Vec<ObstacleMark>,
}

/// A team's own side.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct ZoneMark {
    pub(super) team: usize,
    pub(super) corners: Vec<Place>,
}

/// A flag at its home.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct FlagMark {
    pub(super) team: usize,
    pub(super) x: f64,
    pub(super) y: f64,
}

/// Something solid in the water.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum ObstacleMark {
    /// x, y and radius.
    Circle([f64; 3]),
    /// Its corners.
    Polygon(Vec<Place>),
}

/// How near is near.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Radii {
    pub(super) grab_m: f64,
    pub(super) tag_m: f64,
    pub(super) untag_m: f64,
    pub(super) capture_m: f64,
    pub(super) keepout_m: f64,
    pub(super) collision_m: f64,
}

/// What is worth what.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct PointsMark {
    pub(super) grab: u32,
    pub(super) capture: u32,
    pub(super) tag: u32,
}

/// One plane wave.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Wave {
    pub(super) amplitude_m: f64,
    pub(super) k_x: f64,
    pub(super) k_y: f64,
    pub(super) omega_rad_s: f64,
    pub(super) phase_rad: f64,
}

impl Chart {
    /// The chart of a game.
    pub(super) fn new(scenario: &Scenario, water: &Water) -> Chart {
        let rules = &scenario.rules;
        Chart {
            name: scenario.name.clone(),
            seed: scenario.seed,
            duration_s: rules.time_limit.as_s(),
            decision_s: scenario.decision().as_s(),
            rules: rules.name.clone(),
            sea: scenario.sea.name.clone(),
            teams: scenario.teams.iter().map(|team| TeamMark { name: team.name.clone() }).collect(),
            vehicles: vehicles(scenario),
            field: FieldMark::new(&scenario.field),
            radii: Radii {
                grab_m: rules.grab_radius_m,
                tag_m: rules.tag_radius_m,
                untag_m: rules.untag_radius_m,
                capture_m: rules.capture_radius_m,
                keepout_m: rules.flag_keepout_m,
                collision_m: rules.collision_distance_m,
            },
            points: PointsMark { grab: rules.points.grab, capture: rules.points.capture, tag: rules.points.tag },
            waves: water.waves.iter().map(Wave::new).collect(),
            drawn: scenario.drawn.iter().map(|drawn| (drawn.parameter.clone(), drawn.value)).collect(),
        }
    }
}

fn vehicles(scenario: &Scenario) -> Vec<VehicleMark> {
    let mark = |vehicle: &game::scenario::Vehicle| {
        let (boat, strategy) = (&scenario.boats[vehicle.boat], &scenario.strategies[vehicle.strategy]);
        VehicleMark {
            name: vehicle.name.clone(),
            team: vehicle.team.index(),
            length_m: boat.length_m,
            beam_m: boat.beam_m,
            external: vehicle.source == Source::External,
            teleop: strategy.is_steered(),
            strategy: strategy.name.clone(),
            speed_max_m_s: boat.speed_max_m_s(),
        }
    };
    scenario.vehicles.iter().map(mark).collect()
}

impl FieldMark {
    fn new(field: &game::Field) -> FieldMark {
        let plan = &field.plan;
        let zone = |(team, zone): (usize, &game::field::Zone)| ZoneMark { team, corners: places(&zone.corners) };
        let flag = |flag: &game::field::Flag| {
            let [x, y] = place(flag.home);
            FlagMark { team: flag.team.index(), x, y }
        };
        FieldMark {
            name: plan.name.clone(),
            datum: [plan.datum.lat_deg, plan.datum.lon_deg],
            along_deg: plan.along_deg,
            walls: plan.walls == Walls::AllRound,
            corners: places(&field.corners),
            zones: field.zones.iter().enumerate().map(zone).collect(),
            scrimmage: field.scrimmage.map(place),
            flags: field.flags.iter().map(flag).collect(),
            obstacles: plan.obstacles.iter().map(ObstacleMark::new).collect(),
        }
    }
}

impl ObstacleMark {
    fn new(obstacle: &Obstacle) -> ObstacleMark {
        match obstacle {
            Obstacle::Circle { centre, radius_m } => ObstacleMark::Circle([centre.east, centre.north, *radius_m]),
            Obstacle::Polygon { corners } => ObstacleMark::Polygon(places(corners)),
        }
    }
}

impl Wave {
    fn new(wave: &PlaneWave) -> Wave {
        let (sin, cos) = math::sin_cos(wave.toward_rad);
        Wave {
            amplitude_m: wave.amplitude_m,
            k_x: wave.wavenumber_rad_m * sin,
            k_y: wave.wavenumber_rad_m * cos,
            omega_rad_s: wave.omega_rad_s,
            phase_rad: wave.phase_rad,
        }
    }
}

fn place(at: Ned) -> Place {
    [at.east, at.north]
}

fn places(corners: &[Ned]) -> Vec<Place> {
    corners.iter().copied().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn chart(file: &str, water: &Water) -> Value {
        let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/games").join(file);
        let scenario = game::scenario::load(&file).unwrap_or_else(|e| panic!("{e}"));
        serde_json::to_value(Chart::new(&scenario, water)).expect("a chart is JSON")
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
        let chart = chart("mixed_2v2.toml", &Water { waves: vec![eastward] });
        assert_eq!(chart["name"], "mixed_2v2");
        assert_eq!(chart["teams"], json!([{"name": "blue"}, {"name": "red"}]));
        assert_eq!(chart["decision_s"], 0.1);
        let first = &chart["vehicles"][0];
        assert_eq!((&first["team"], &first["teleop"]), (&json!(0), &json!(false)));
        assert!(first["speed_max_m_s"].as_f64().is_some_and(|speed| speed > 0.5), "{first}");
        let kinds: Vec<&Value> = chart["vehicles"].as_array().expect("a list").iter().map(|v| &v["external"]).collect();
        assert!(kinds.contains(&&json!(true)) && kinds.contains(&&json!(false)), "real boats among others: {kinds:?}");
        let wave = &chart["waves"][0];
        assert!((wave["k_x"].as_f64().expect("a number") - 0.3).abs() < 1e-12);
        assert!(wave["k_y"].as_f64().expect("a number").abs() < 1e-12);
    }

    #[test]
    fn the_field_has_x_east_and_y_north() {
        let chart = chart("pav01_vs_pav01.toml", &Water::default());
        let field = &chart["field"];
        assert_eq!(field["name"], "aquaticus_160x80");
        assert_eq!(field["corners"], json!([[0.0, 0.0], [0.0, 80.0], [160.0, 80.0], [160.0, 0.0]]));
        assert_eq!(field["scrimmage"], json!([[80.0, 0.0], [80.0, 80.0]]));
        assert_eq!(field["flags"][0], json!({"team": 0, "x": 20.0, "y": 40.0}));
        assert_eq!(field["walls"], false);
        assert_eq!(chart["waves"], json!([]));
        assert_eq!(chart["points"], json!({"grab": 1, "capture": 2, "tag": 0}));
    }

    #[test]
    fn obstacles_are_circles_and_polygons() {
        let chart = chart("harbour_2v2.toml", &Water::default());
        let obstacles = chart["field"]["obstacles"].as_array().expect("a list");
        assert!(!obstacles.is_empty());
        assert!(obstacles.iter().all(|one| one["circle"].is_array() || one["polygon"].is_array()), "{obstacles:?}");
    }
}
