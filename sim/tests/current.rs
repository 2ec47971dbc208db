//! The current compared with closed forms: tide, shear, eddies and a bounded random walk.

mod common;

use common::{assert_memory, five_errors};
use primitives::{Ned, Rotation, SimTime, math};
use rules::Field;
use scenario::sea::{Current, Eddy, RandomEddies, Shear, Tide, Wander};
use sim::sea::current::CurrentField;
use sim::sea::eddy;
use std::f64::consts::TAU;

fn field() -> Field {
    common::empty_field(Ned::from_xy(30.0, -20.0), 20.0)
}

fn model(current: &Current, seed: u64) -> CurrentField {
    CurrentField::new(current, &field(), &seed.into())
}

/// The velocity at a place and a time (s).
fn at(model: &CurrentField, place: Ned, time_s: f64) -> Ned {
    model.at_time(SimTime::from_s(time_s)).at(place)
}

#[test]
fn water_of_which_nothing_is_said_lies_still_to_the_bit() {
    let model = model(&Current::default(), 1);
    let now = model.at_time(SimTime::from_s(77.0));
    assert_eq!(now.at(Ned::from_xy(3.0, 4.0)), Ned::default());
    assert_eq!(
        now.over_hull(Ned::from_xy(3.0, 4.0), Rotation { sin: 0.6, cos: 0.8 }),
        (Ned::default(), 0.0)
    );
}

#[test]
fn a_tide_is_a_sine_of_time_on_top_of_the_mean() {
    const PERIOD_S: f64 = 12.42 * 3600.0;
    let mean_m_s = Ned::from_xy(0.1, 0.0);
    let flood_m_s = Ned::from_xy(0.0, 0.5);
    for phase in [0.0, 0.3, 1.0] {
        let tide = Some(Tide {
            flood_m_s,
            period_s: PERIOD_S,
            phase,
        });
        let model = model(
            &Current {
                mean_m_s,
                tide,
                ..Current::default()
            },
            1,
        );
        for time_s in [
            0.0,
            600.0,
            0.25 * PERIOD_S,
            0.5 * PERIOD_S,
            0.75 * PERIOD_S,
            7.1 * PERIOD_S,
        ] {
            let want =
                mean_m_s + flood_m_s.scaled(math::sin_cos(TAU * (time_s / PERIOD_S + phase)).0);
            let got = at(&model, Ned::from_xy(5.0, 6.0), time_s);
            assert!(
                got.distance(want) < 1e-12,
                "phase {phase}, {time_s} s: {got:?}, want {want:?}"
            );
        }
    }
    let tide = Some(Tide {
        flood_m_s,
        period_s: PERIOD_S,
        phase: 0.0,
    });
    let flood = at(
        &model(
            &Current {
                tide,
                ..Current::default()
            },
            1,
        ),
        Ned::default(),
        0.25 * PERIOD_S,
    );
    assert!(
        flood.distance(flood_m_s) < 1e-12,
        "flood a quarter of a period after slack water: {flood:?}"
    );
}

fn shear() -> Shear {
    // The stream flows east and increases southwards from y = 10.
    Shear {
        toward: Ned::from_xy(1.0, 0.0),
        across: Ned::from_xy(0.0, -1.0),
        per_s: 0.004,
        origin: Ned::from_xy(0.0, 10.0),
    }
}

#[test]
fn a_shear_grows_across_and_turns_a_hull_that_lies_across() {
    let model = model(
        &Current {
            shear: Some(shear()),
            ..Current::default()
        },
        1,
    );
    for (y, want_m_s) in [(10.0, 0.0), (-40.0, 0.2), (60.0, -0.2)] {
        let got = at(&model, Ned::from_xy(123.0, y), 0.0);
        assert!(
            got.distance(Ned::from_xy(want_m_s, 0.0)) < 1e-15,
            "y = {y}: {got:?}"
        );
    }
    // Seen from above, the water farther south flows east faster. A hull that points north is
    // turned anticlockwise by the whole shear; one that points east is not turned.
    let now = model.at_time(SimTime::ZERO);
    for (heading_deg, want_rad_s) in [(0.0, -0.004), (180.0, -0.004), (90.0, 0.0), (45.0, -0.002)] {
        let place = Ned::from_xy(5.0, -40.0);
        let (mean, rate_rad_s) = now.over_hull(place, Rotation::from_heading_deg(heading_deg));
        assert!(
            (rate_rad_s - want_rad_s).abs() < 1e-12,
            "heading {heading_deg}: {rate_rad_s}"
        );
        assert!(mean.distance(now.at(place)) < 1e-15, "{mean:?}");
    }
}

const CORE_M: f64 = 20.0;
const PEAK_M_S: f64 = 0.3;

fn eddy_at(centre: Ned) -> Current {
    let eddy = Eddy {
        centre,
        radius_m: CORE_M,
        peak_m_s: PEAK_M_S,
    };
    Current {
        eddies: vec![eddy],
        ..Current::default()
    }
}

#[test]
fn an_eddy_has_its_circulation_no_divergence_and_the_vorticity_of_a_gaussian() {
    let centre = Ned::from_xy(40.0, -10.0);
    let model = model(&eddy_at(centre), 1);
    // Γ from the fastest flow, Γ / (2 π a) (1 − e^−α) / √α; in the literature, (1 − e^−α) / √α is
    // 0.6382.
    let gamma = PEAK_M_S * TAU * CORE_M / 0.638_173;
    for radius_m in [1.0, 10.0, CORE_M, 60.0, 125.0, 127.0, 500.0] {
        // Clockwise along a circle around the centre.
        let step = |i: u32| {
            let bearing = Rotation::from_heading(TAU * f64::from(i) / 720.0);
            let place = centre + bearing.ahead().scaled(radius_m);
            at(&model, place, 0.0).dot(bearing.starboard()) * TAU * radius_m / 720.0
        };
        let got: f64 = (0..720).map(step).sum();
        let want = gamma * (1.0 - math::exp(-(radius_m / CORE_M) * (radius_m / CORE_M)));
        assert!(
            (got / want - 1.0).abs() < 1e-5,
            "radius {radius_m}: {got}, want {want} m²/s"
        );
    }
    const STEP_M: f64 = 1e-3;
    for (x, y) in [(41.0, -9.0), (60.0, 0.0), (10.0, -30.0), (120.0, 80.0)] {
        let place = Ned::from_xy(x, y);
        let slope = |along: Ned| {
            let ahead = at(&model, place + along.scaled(STEP_M), 0.0);
            (ahead - at(&model, place - along.scaled(STEP_M), 0.0)).scaled(0.5 / STEP_M)
        };
        let by_north = slope(Ned {
            north: 1.0,
            east: 0.0,
        });
        let by_east = slope(Ned {
            north: 0.0,
            east: 1.0,
        });
        let divergence = by_north.north + by_east.east;
        let vorticity = by_north.east - by_east.north;
        let s = place.distance_squared(centre) / (CORE_M * CORE_M);
        let want = 2.0 * gamma / (TAU * CORE_M * CORE_M) * math::exp(-s);
        assert!(
            divergence.abs() < 1e-10,
            "({x}, {y}): divergence {divergence}"
        );
        assert!(
            (vorticity - want).abs() < 1e-7,
            "({x}, {y}): vorticity {vorticity}, not {want}"
        );
    }
}

#[test]
fn an_eddy_turns_a_hull_as_the_flow_at_its_ends_says() {
    const LENGTH_M: f64 = 1e-2;
    let model = model(&eddy_at(Ned::default()), 1);
    let now = model.at_time(SimTime::ZERO);
    let core_rad_s = PEAK_M_S / 0.638_173 / CORE_M;
    for heading_deg in [0.0, 33.0, 90.0, 211.0] {
        let rotation = Rotation::from_heading_deg(heading_deg);
        let (mean, rate_rad_s) = now.over_hull(Ned::default(), rotation);
        assert_eq!(mean, Ned::default());
        assert!(
            (rate_rad_s - core_rad_s).abs() < 1e-6 * core_rad_s,
            "in the middle it turns with the core: {rate_rad_s}"
        );
        for (x, y) in [
            (1e-5, 0.0),
            (0.1, 0.0),
            (5.0, 3.0),
            (-22.0, 1.0),
            (30.0, -40.0),
            (300.0, 5.0),
        ] {
            let place = Ned::from_xy(x, y);
            let (velocity, rate_rad_s) = now.over_hull(place, rotation);
            let half = rotation.ahead().scaled(0.5 * LENGTH_M);
            let want =
                (now.at(place + half) - now.at(place - half)).dot(rotation.starboard()) / LENGTH_M;
            assert!(
                (rate_rad_s - want).abs() < 1e-6 * core_rad_s,
                "({x}, {y}): {rate_rad_s}, not {want}"
            );
            assert_eq!(velocity, now.at(place));
        }
    }
}

#[test]
fn random_eddies_lie_on_the_field_in_their_bounds_and_add_up() {
    let random = RandomEddies {
        count: 200,
        radius_m: (10.0, 40.0),
        peak_m_s: (0.1, 0.3),
    };
    let drawn = eddy::draw(&random, &field(), 4);
    assert_eq!(drawn.len(), 200);
    assert!(drawn.iter().all(|eddy| field().contains(eddy.centre)));
    assert!(
        drawn
            .iter()
            .all(|eddy| (10.0..40.0).contains(&eddy.radius_m))
    );
    assert!(
        drawn
            .iter()
            .all(|eddy| (0.1..0.3).contains(&eddy.peak_m_s.abs()))
    );
    let clockwise = drawn.iter().filter(|eddy| eddy.peak_m_s > 0.0).count();
    assert!(
        (60..140).contains(&clockwise),
        "{clockwise} of 200 turn clockwise"
    );
    assert_eq!(drawn, eddy::draw(&random, &field(), 4));
    assert_ne!(drawn, eddy::draw(&random, &field(), 5));
    let summed = Current {
        random_eddies: Some(random),
        ..eddy_at(Ned::default())
    };
    let alone = |eddy: &Eddy| Current {
        eddies: vec![*eddy],
        ..Current::default()
    };
    let place = Ned::from_xy(50.0, 30.0);
    let want = drawn.iter().fold(
        at(&model(&eddy_at(Ned::default()), 4), place, 0.0),
        |sum, eddy| sum + at(&model(&alone(eddy), 4), place, 0.0),
    );
    assert!(at(&model(&summed, 4), place, 0.0).distance(want) < 1e-12);
}

fn wandering(sigma_m_s: f64, speed_m_s: (f64, f64)) -> Current {
    let toward = Ned::from_xy(0.6, 0.8);
    let wander = Some(Wander {
        toward,
        sigma_m_s,
        time_s: 120.0,
        speed_m_s,
    });
    Current {
        mean_m_s: toward.scaled(0.2),
        wander,
        ..Current::default()
    }
}

fn wander_record(current: &Current, count: i64, step_s: f64) -> Vec<f64> {
    let mut model = model(current, 8);
    let toward = Ned::from_xy(0.6, 0.8);
    let sample = |i: i64| {
        let now = SimTime::from_s(i as f64 * step_s);
        model.prepare(now);
        let velocity = model.at_time(now).at(Ned::from_xy(i as f64, 0.0));
        assert!(
            (velocity - toward.scaled(velocity.dot(toward))).length() < 1e-15,
            "it wanders in its direction"
        );
        velocity.dot(toward)
    };
    (0..count).map(sample).collect()
}

#[test]
fn a_wander_has_the_variance_and_the_memory_stated() {
    const COUNT: usize = 1_500_000;
    const STEP_S: f64 = 7.0;
    const SIGMA_M_S: f64 = 0.05;
    let speed = wander_record(&wandering(SIGMA_M_S, (-9.0, 9.0)), COUNT as i64, STEP_S);
    let x: Vec<f64> = speed
        .iter()
        .map(|speed| (speed - 0.2) / SIGMA_M_S)
        .collect();
    let within = five_errors(COUNT, STEP_S / 120.0);
    assert!(within < 0.03);
    assert_memory("wander", &x, &[0, 3, 10, 17, 34], STEP_S / 120.0, within);
}

#[test]
fn a_wander_is_clipped_to_its_bounds_and_untouched_between() {
    let free = wander_record(&wandering(0.1, (-9.0, 9.0)), 20_000, 11.0);
    let bound = wander_record(&wandering(0.1, (0.05, 0.3)), 20_000, 11.0);
    let mut clipped = 0;
    for (free, bound) in free.iter().zip(&bound) {
        assert!(
            (bound - free.clamp(0.05, 0.3)).abs() < 1e-15,
            "{free} became {bound}"
        );
        clipped += u32::from(free != bound);
    }
    assert!(
        (3_000..7_000).contains(&clipped),
        "{clipped} of 20 000 are beyond the bounds, expected a fifth to a third"
    );
}
