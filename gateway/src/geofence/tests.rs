//! Tests the geofence on fields and in polygons, and against an independent point-in-polygon test.

use super::*;
use crate::geodesy::LocalFrame;
use primitives::frame::LatLon;
use primitives::math;
use proptest::prelude::*;
use rules::field::sides;

fn game() -> scenario::Scenario {
    let game = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../scenarios/games/pav01_vs_pav01.toml");
    scenario::load(&game).unwrap_or_else(|problems| panic!("{problems}"))
}

fn rules() -> Geofence {
    crate::config::default_gateway().geofence
}

fn at(seconds: f64) -> SimTime {
    SimTime::from_s(seconds)
}

#[test]
fn a_boat_must_be_inside_and_able_to_stop_inside() {
    // The field is 160 x 80 m from the datum; at 3 m/s a boat needs 3 + 18 = 21 m.
    for (x, y, east_m_s, inside) in [
        (80.0, 40.0, 3.0, true),
        (168.9, 40.0, 3.0, true),
        (169.1, 40.0, 3.0, false),
        (169.1, 40.0, -3.0, true),
        (189.9, 40.0, 0.0, true),
        (190.1, 40.0, 0.0, false),
        (190.1, 40.0, -3.0, false),
        (80.0, -30.1, 0.0, false),
    ] {
        let mut geofence = GeofenceWatch::new(&game().field, &rules(), None);
        let velocity = Ned {
            north: 0.0,
            east: east_m_s,
        };
        geofence.is_inside(at(0.0), Ned::from_xy(x, y), (velocity, 0.0));
        assert_eq!(
            geofence.is_inside(at(0.5), Ned::from_xy(x, y), (velocity, 0.0)),
            inside,
            "{x}, {y} at {east_m_s}"
        );
    }
}

/// The Surveyor among the shipped boat files.
fn surveyor() -> Coasting {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../scenarios/boats/surveyor_m1_8.toml");
    Coasting::of(&scenario::load_file(&path).unwrap_or_else(|problems| panic!("{problems}")))
}

/// The error caused by the prediction's quarter-second steps, m.
const COARSE_M: f64 = 0.5;

/// M / q ln(1 + q v / l): a hull's coasting distance from a speed.
fn coasted_m(coasting: &Coasting, speed_m_s: f64) -> f64 {
    let Coasting {
        mass_kg,
        linear_kg_s,
        quadratic_kg_m,
        ..
    } = *coasting;
    mass_kg / quadratic_kg_m * (quadratic_kg_m * speed_m_s / linear_kg_s).ln_1p()
}

#[test]
fn a_boat_coasts_as_far_as_its_file_says_or_as_was_measured() {
    let surveyor = surveyor();
    for (speed_m_s, glides_m) in [(0.5, 3.3), (1.0, 5.2), (1.5, 6.5), (3.0, 9.0)] {
        let exact_m = coasted_m(&surveyor, speed_m_s);
        assert!(
            (exact_m - glides_m).abs() < 0.1,
            "{exact_m} m from {speed_m_s} m/s"
        );
        let found_m = surveyor.distance_m(speed_m_s);
        assert!(
            (found_m - exact_m).abs() < COARSE_M,
            "{found_m} m from {speed_m_s} m/s, {exact_m}"
        );
    }
    let measured = surveyor.as_measured(&[(0.5, 5.0), (2.0, 7.0)]);
    assert!((measured.distance_m(0.5) - 5.0).abs() < 0.3 && measured.distance_m(2.0) > 7.0);
    assert!(
        surveyor.as_measured(&[(1.0, 2.0)]).distance_m(1.0) < 2.5,
        "it is better than the file says"
    );
}

#[test]
fn a_slow_boat_keeps_the_distance_that_it_coasts() {
    // The edge lies at x = 190 m. By v²/2a alone the first boat would need 1.0 m.
    for (speed_m_s, least_m) in [(0.5, 3.5), (1.0, 6.0), (1.5, 8.0), (3.0, 21.0)] {
        let mut geofence = GeofenceWatch::new(&game().field, &rules(), Some(surveyor()));
        let velocity = Ned {
            north: 0.0,
            east: speed_m_s,
        };
        let mut inside = |clearance_m: f64| {
            geofence.straight = Breach::default();
            let at_edge = Ned::from_xy(190.0 - clearance_m, 40.0);
            geofence.is_inside(at(0.0), at_edge, (velocity, 0.0));
            geofence.is_inside(at(0.5), at_edge, (velocity, 0.0))
        };
        assert!(!inside(least_m) && inside(least_m + 4.0), "{speed_m_s} m/s");
    }
}

#[test]
fn one_fix_outside_is_not_enough() {
    let mut geofence = GeofenceWatch::new(&game().field, &rules(), None);
    let inside = Ned::from_xy(80.0, 40.0);
    let outside = Ned::from_xy(80.0, 400.0);
    for (seconds, place, want) in [
        (0.0, outside, true),
        (0.4, outside, true),
        (0.45, inside, true),
        (0.6, outside, true),
        (1.2, outside, false),
    ] {
        assert_eq!(
            geofence.is_inside(at(seconds), place, (Ned::default(), 0.0)),
            want,
            "{seconds}"
        );
    }
}

/// The polygon that an operator would type for these points of the field.
fn typed(field: &Field, corners: &[Ned]) -> Vec<[f64; 2]> {
    let frame = LocalFrame::new(field.plan.datum);
    let place = |corner: &Ned| {
        let LatLon { lat_deg, lon_deg } = frame.lat_lon(*corner);
        [lat_deg, lon_deg]
    };
    corners.iter().map(place).collect()
}

/// A star around a point: concave, and its sides do not cross, whatever the radii.
fn star(centre: Ned, radii_m: &[f64]) -> Vec<Ned> {
    let step_deg = 360.0 / radii_m.len() as f64;
    radii_m
        .iter()
        .enumerate()
        .map(|(i, radius_m)| centre + Ned::toward_deg(i as f64 * step_deg).scaled(*radius_m))
        .collect()
}

/// Whether a point is in a polygon, from the sum of the angles of the sides as seen from the point:
/// a full turn or zero.
fn is_seen_around(polygon: &[Ned], at: Ned) -> bool {
    let angle = |(a, b): (Ned, Ned)| {
        let a = a - at;
        let b = b - at;
        math::atan2(a.north * b.east - a.east * b.north, a.dot(b))
    };
    sides(polygon).map(angle).sum::<f64>().abs() > std::f64::consts::PI
}

fn may_be_at(area: &GeofenceArea, at: Ned) -> bool {
    is_seen_around(&area.outline, at)
        && !area
            .keep_out
            .iter()
            .any(|polygon| is_seen_around(polygon, at))
}

/// Steps of the independent check, m.
const STEP_M: f64 = 0.25;

/// Points on a straight line, at most `STEP_M` apart.
fn along(from: Ned, to: Ned) -> impl Iterator<Item = Ned> {
    let count = (from.distance(to) / STEP_M).ceil().max(1.0);
    (0..=count as u32).map(move |i| from + (to - from).scaled(f64::from(i) / count))
}

fn place() -> impl Strategy<Value = Ned> {
    (-150.0..150.0, -150.0..150.0).prop_map(|(north, east)| Ned { north, east })
}

/// Concave areas with keep-outs, some of which cross the outline or each other.
fn area() -> impl Strategy<Value = GeofenceArea> {
    let outline = prop::collection::vec(40.0..140.0_f64, 3..12);
    let keep_out = (place(), prop::collection::vec(3.0..40.0_f64, 3..8));
    (outline, prop::collection::vec(keep_out, 0..4)).prop_map(|(radii_m, keep_out)| {
        let keep_out = keep_out
            .into_iter()
            .map(|(at, radii_m)| star(at.scaled(0.6), &radii_m))
            .collect();
        GeofenceArea {
            outline: star(Ned::default(), &radii_m),
            keep_out,
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, max_global_rejects: 200_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_place_is_inside_if_the_outline_goes_round_it_and_no_keep_out_does(area in area(), at in place()) {
        prop_assume!(area.clearance_m(at).abs() > 1e-6);
        prop_assert_eq!(area.contains(at), may_be_at(&area, at));
    }

    #[test]
    fn a_way_is_inside_if_every_place_of_it_is(area in area(), from in place(), to in place()) {
        let all_inside = along(from, to).all(|at| may_be_at(&area, at));
        if area.contains_way(from, to) {
            prop_assert!(all_inside, "{from:?} to {to:?} is not all inside");
        } else if all_inside {
            // The line cuts a corner between two steps near the corner.
            let nearest_m = along(from, to).map(|at| area.clearance_m(at)).fold(f64::INFINITY, f64::min);
            prop_assert!(nearest_m <= 0.5 * STEP_M, "{from:?} to {to:?} stays {nearest_m} m inside");
        }
    }

    #[test]
    fn a_way_back_is_outside_at_its_beginning_only(area in area(), from in place(), to in place()) {
        prop_assume!(area.leads_in(from, to));
        let places: Vec<bool> = along(from, to).map(|at| may_be_at(&area, at)).collect();
        prop_assert!(places.is_sorted() && places.last() == Some(&true), "{from:?} to {to:?}");
    }

    #[test]
    fn the_clearance_is_how_far_a_boat_can_go_in_any_direction(area in area(), at in place(), toward_deg in 0.0..360.0) {
        let clearance_m = area.clearance_m(at);
        let there = at + Ned::toward_deg(toward_deg).scaled(0.999 * clearance_m.abs());
        prop_assert_eq!(area.contains(there), clearance_m > 0.0);
    }

    #[test]
    fn a_boat_that_is_stopped_where_all_is_well_comes_to_rest_inside(
        area in area(), from in place(), toward_deg in 0.0..360.0, speed_m_s in 0.0..5.0_f64,
    ) {
        let rules = Geofence { debounce_s: 0.0, ..rules() };
        let Geofence { reaction_s, deceleration_m_s2, .. } = rules;
        let mut watch = GeofenceWatch::of_area(area.clone(), &rules, None);
        let toward = Ned::toward_deg(toward_deg);
        prop_assume!(watch.is_inside(SimTime::ZERO, from, (toward.scaled(speed_m_s), 0.0)));
        let brakes_for_s = speed_m_s / deceleration_m_s2;
        for tick in 0..=(20.0 * (reaction_s + brakes_for_s)) as u32 {
            let elapsed_s = f64::from(tick) / 20.0;
            let braked_s = (elapsed_s - reaction_s).clamp(0.0, brakes_for_s);
            let gone_m = speed_m_s * elapsed_s.min(reaction_s) + (speed_m_s - 0.5 * deceleration_m_s2 * braked_s) * braked_s;
            prop_assert!(may_be_at(&area, from + toward.scaled(gone_m)), "outside after {gone_m} m");
        }
    }
}

#[test]
fn a_concave_geofence_and_a_keep_out_count_on_all_of_the_way_to_rest() {
    let field = game().field;
    // A horseshoe, open to the north, with a rock in its eastern arm.
    let xy = |corners: &[(f64, f64)]| -> Vec<Ned> {
        corners.iter().map(|&(x, y)| Ned::from_xy(x, y)).collect()
    };
    let horseshoe = [
        (0.0, 0.0),
        (160.0, 0.0),
        (160.0, 80.0),
        (100.0, 80.0),
        (100.0, 40.0),
        (90.0, 40.0),
        (90.0, 80.0),
        (0.0, 80.0),
    ];
    let rock = [(120.0, 50.0), (124.0, 50.0), (122.0, 54.0)];
    let rules = Geofence {
        polygon: Some(typed(&field, &xy(&horseshoe))),
        keep_out: vec![typed(&field, &xy(&rock))],
        debounce_s: 0.0,
        ..rules()
    };
    // At 3 m/s a boat needs 21 m.
    for (x, y, east_m_s, inside) in [
        (80.0, 20.0, 3.0, true),
        (85.0, 60.0, 3.0, false), // it would come to rest inside, beyond the gap
        (85.0, 60.0, -3.0, true),
        (85.0, 60.0, 0.0, true),
        (95.0, 60.0, 0.0, false),
        (110.0, 52.0, 3.0, false), // the same beyond the rock
        (110.0, 56.0, 3.0, true),
        (122.0, 52.0, 0.0, false),
        (122.0, 48.0, 0.0, true),
    ] {
        let mut geofence = GeofenceWatch::new(&field, &rules, None);
        let velocity = Ned {
            north: 0.0,
            east: east_m_s,
        };
        assert_eq!(
            geofence.is_inside(at(0.0), Ned::from_xy(x, y), (velocity, 0.0)),
            inside,
            "{x}, {y} at {east_m_s}"
        );
    }
}

#[test]
fn a_geofence_that_does_not_go_with_the_game_is_refused() {
    let scenario = game();
    let square = |x: f64, y: f64, half_m: f64| {
        typed(
            &scenario.field,
            &[
                (-half_m, -half_m),
                (half_m, -half_m),
                (half_m, half_m),
                (-half_m, half_m),
            ]
            .map(|(dx, dy)| Ned::from_xy(x + dx, y + dy)),
        )
    };
    let starts: Vec<Ned> = scenario
        .vehicles
        .iter()
        .map(|vehicle| match &vehicle.start_position {
            scenario::StartPosition::At(pose) => pose.at,
            other => panic!("{other:?}"),
        })
        .collect();
    let start = |half_m: f64| square(starts[0].east, starts[0].north, half_m);
    let all = || Some(square(80.0, 40.0, 200.0));
    for (polygon, keep_out, refusal) in [
        (None, vec![], ""),
        (all(), vec![square(80.0, 40.0, 5.0)], ""),
        (
            None,
            vec![square(80.0, 40.0, 5.0), square(80.0, 400.0, 5.0)],
            "keep_out 1 (the first is 0) lies outside",
        ),
        (all(), vec![start(3.0)], "must start inside"),
        (
            Some(square(1000.0, 40.0, 200.0)),
            vec![],
            "must start inside",
        ),
    ] {
        let area = GeofenceArea::new(
            &scenario.field,
            &Geofence {
                polygon,
                keep_out,
                ..rules()
            },
        );
        let checked = area
            .check(&scenario, primitives::VehicleId::at(0))
            .map_err(|e| e.to_string())
            .err()
            .unwrap_or_default();
        assert!(
            checked.contains(refusal) && checked.is_empty() == refusal.is_empty(),
            "{checked:?}, expected {refusal:?}"
        );
    }
}
