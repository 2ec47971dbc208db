//! The wind compared with its formulas, and its force with Fossen's formulas and the closed-form
//! drift.

mod common;

use common::{assert_memory, five_errors, mean_of};
use primitives::frame::Body;
use primitives::{Ned, Rotation, SimTime, math};
use rules::Field;
use scenario::boat::Windage;
use scenario::sea::{Gusts, Wind};
use sim::hull::Planar;
use sim::sea::wind::WindField;
use sim::sea::windage::{wind_force, wind_past_boat};
use std::f64::consts::TAU;

const HEIGHT_M: f64 = 1.5;
const SPEED_10M_M_S: f64 = 10.0;
const INTENSITY: f64 = 0.15;
const ACROSS_RATIO: f64 = 0.75;
const LENGTH_M: f64 = 40.0;

fn field() -> Field {
    common::empty_field(Ned::default(), 90.0)
}

fn wind(from_deg: f64, gusts: Gusts) -> Wind {
    Wind {
        speed_10m_m_s: SPEED_10M_M_S,
        from_rad: from_deg.to_radians(),
        profile_exponent: 0.12,
        gusts,
    }
}

fn ornstein_uhlenbeck() -> Gusts {
    Gusts::OrnsteinUhlenbeck {
        intensity: INTENSITY,
        across_ratio: ACROSS_RATIO,
        length_m: LENGTH_M,
    }
}

/// Wind from the west at one place, every `step_s`: (east over the mean − 1, south over the mean),
/// both relative to the intensity along the wind.
fn record(gusts: Gusts, seed: u64, count: i64, step_s: f64) -> Vec<(f64, f64)> {
    let mut field = WindField::new(&wind(270.0, gusts), HEIGHT_M, &field(), &seed.into());
    let mean_m_s = field.mean_m_s(HEIGHT_M);
    let sample = |i: i64| {
        let now = SimTime::from_s(i as f64 * step_s);
        if step_s < 1.0 {
            field.prepare(now);
        }
        let air_m_s = field.at(Ned::from_xy(33.0, 44.0), mean_m_s, now);
        (
            (air_m_s.east / mean_m_s - 1.0) / INTENSITY,
            -air_m_s.north / mean_m_s / INTENSITY,
        )
    };
    (0..count).map(sample).collect()
}

#[test]
fn the_wind_blows_from_where_it_is_said_to_come_and_falls_towards_the_water() {
    for (from_deg, x, y) in [
        (0.0, 0.0, -1.0),
        (90.0, -1.0, 0.0),
        (180.0, 0.0, 1.0),
        (270.0, 1.0, 0.0),
    ] {
        let field = WindField::new(&wind(from_deg, Gusts::None), HEIGHT_M, &field(), &1.into());
        let air_m_s = field.at(Ned::default(), field.mean_m_s(10.0), SimTime::ZERO);
        assert!(
            air_m_s.distance(Ned::from_xy(x, y).scaled(SPEED_10M_M_S)) < 1e-12,
            "from {from_deg}: {air_m_s:?}"
        );
    }
    let field = WindField::new(&wind(0.0, Gusts::None), HEIGHT_M, &field(), &1.into());
    assert!(
        (field.mean_m_s(HEIGHT_M) / SPEED_10M_M_S - 0.80).abs() < 0.005,
        "{}",
        field.mean_m_s(HEIGHT_M)
    );
}

#[test]
fn ornstein_uhlenbeck_gusts_have_the_moments_and_the_memory_of_their_process() {
    const STEP_S: f64 = 0.25;
    const COUNT: i64 = 1_200_000;
    let mean_m_s =
        WindField::new(&wind(0.0, Gusts::None), HEIGHT_M, &field(), &1.into()).mean_m_s(HEIGHT_M);
    let time_s = LENGTH_M / mean_m_s;
    let x = record(ornstein_uhlenbeck(), 11, COUNT, STEP_S);
    let within = five_errors(x.len(), STEP_S / time_s);
    assert!(within < 0.03);
    assert!(
        mean_of(x.len(), |i| x[i].0 * x[i].1).abs() < within,
        "correlation of along and across"
    );
    let (along, across): (Vec<f64>, Vec<f64>) =
        x.into_iter().map(|(a, b)| (a, b / ACROSS_RATIO)).unzip();
    for (what, x) in [("along", along), ("across", across)] {
        assert_memory(what, &x, &[0, 4, 12, 20, 40, 80], STEP_S / time_s, within);
    }
}

#[test]
fn a_gust_comes_to_a_boat_downwind_as_it_was() {
    const WITHIN_M_S: f64 = 1e-9;
    for from_deg in [0.0, 77.0, 200.0] {
        let mut field = WindField::new(
            &wind(from_deg, ornstein_uhlenbeck()),
            HEIGHT_M,
            &field(),
            &7.into(),
        );
        let mean_m_s = field.mean_m_s(HEIGHT_M);
        let upwind = Ned::from_xy(80.0, 40.0);
        let downwind = Ned::toward_deg(from_deg + 180.0);
        let abreast = Ned::toward_deg(from_deg + 90.0);
        let mut differ = 0;
        for i in 0..200_u32 {
            let now = SimTime::from_s(f64::from(i) * 0.73);
            field.prepare(now);
            let air_m_s = field.at(upwind, mean_m_s, now);
            let way_m = 1.0 + f64::from(i) * 0.3;
            let later = SimTime::from_s(now.as_s() + way_m / mean_m_s);
            let downwind_later = field.at(upwind + downwind.scaled(way_m), mean_m_s, later);
            // A nanosecond of rounding is 1e-8 m of distance.
            assert!(
                air_m_s.distance(downwind_later) < WITHIN_M_S + 1e-7,
                "{i}: {air_m_s:?}, {downwind_later:?}"
            );
            assert!(
                air_m_s.distance(field.at(upwind + abreast.scaled(30.0), mean_m_s, now))
                    < WITHIN_M_S
            );
            let ratio = field.at(upwind, 2.0 * mean_m_s, now);
            assert!(
                ratio.distance(air_m_s.scaled(2.0)) < WITHIN_M_S,
                "in proportion to the mean"
            );
            differ += u32::from(
                air_m_s.distance(field.at(upwind + downwind.scaled(way_m), mean_m_s, now)) > 0.1,
            );
        }
        assert!(
            differ > 100,
            "gusts differ along the wind at only {differ} of 200 times"
        );
    }
}

#[test]
fn no_wind_is_no_gusts_either() {
    let still = Wind {
        speed_10m_m_s: 0.0,
        ..wind(40.0, ornstein_uhlenbeck())
    };
    let field = WindField::new(&still, HEIGHT_M, &field(), &1.into());
    for i in 0..100 {
        let air_m_s = field.at(
            Ned::from_xy(3.0, 4.0),
            field.mean_m_s(HEIGHT_M),
            SimTime::from_s(f64::from(i)),
        );
        assert_eq!(air_m_s, Ned::default());
    }
}

/// The Surveyor's windage used for the closed-form drift.
fn surveyor() -> Windage {
    Windage {
        frontal_area_m2: 0.30,
        lateral_area_m2: 0.55,
        height_m: HEIGHT_M,
        surge_coefficient: 0.6,
        sway_coefficient: 0.9,
        yaw_coefficient: 0.1,
    }
}

const SURVEYOR_LENGTH_M: f64 = 1.83;

fn force(ahead: f64, starboard: f64) -> Planar {
    wind_force(&surveyor(), SURVEYOR_LENGTH_M, Body { ahead, starboard })
}

#[test]
fn the_wind_pushes_a_boat_away_and_its_bow_off() {
    // For a boat at rest heading north: the wind's bearing, and the signs of surge, sway and yaw.
    for (from_deg, want) in [
        (0.0, (-1.0, 0.0, 0.0)),
        (45.0, (-1.0, -1.0, -1.0)),
        (90.0, (0.0, -1.0, 0.0)),
        (135.0, (1.0, -1.0, 1.0)),
        (180.0, (1.0, 0.0, 0.0)),
        (225.0, (1.0, 1.0, -1.0)),
        (270.0, (0.0, 1.0, 0.0)),
        (315.0, (-1.0, 1.0, 1.0)),
    ] {
        let blowing = Ned::toward_deg(from_deg + 180.0).scaled(10.0);
        let past = wind_past_boat(Rotation::NORTH, blowing, Planar::default());
        let got = force(past.ahead, past.starboard);
        let sign = |x: f64| if x == 0.0 { 0.0 } else { x.signum() };
        assert_eq!(
            (sign(got.surge), sign(got.sway), sign(got.yaw)),
            want,
            "from {from_deg}: {got:?}"
        );
    }
    // A boat pointing east, moving at 3 m/s ahead and 1 m/s to starboard, in a wind from the north
    // on its port side.
    let past = wind_past_boat(
        Rotation::from_heading_deg(90.0),
        Ned {
            north: -4.0,
            east: 0.0,
        },
        Planar {
            surge: 3.0,
            sway: 1.0,
            yaw: 0.7,
        },
    );
    assert_eq!(
        past,
        Body {
            ahead: -3.0,
            starboard: 3.0
        }
    );
}

#[test]
fn the_force_is_fossen_s_at_every_angle() {
    for i in 0..720_u32 {
        let angle = f64::from(i) * TAU / 720.0;
        let (sin, cos) = math::sin_cos(angle);
        let u_rw = 7.0 * cos;
        let v_rw = 7.0 * sin;
        let gamma = -math::atan2(v_rw, u_rw);
        let (sin_gamma, cos_gamma) = math::sin_cos(gamma);
        let pressure = 0.5 * 1.225 * 49.0;
        let want = Planar {
            surge: -pressure * 0.6 * cos_gamma * 0.30,
            sway: pressure * 0.9 * sin_gamma * 0.55,
            yaw: pressure * 0.1 * math::sin_cos(2.0 * gamma).0 * 0.55 * 1.83,
        };
        let got = force(-u_rw, -v_rw);
        for (got, want) in [
            (got.surge, want.surge),
            (got.sway, want.sway),
            (got.yaw, want.yaw),
        ] {
            assert!(
                (got - want).abs() < 1e-12 * pressure,
                "γ = {gamma}: {got}, want {want}"
            );
        }
    }
}

#[test]
fn the_mirror_image_of_a_wind_gives_the_mirror_image_of_the_force_to_the_bit() {
    for (ahead, starboard) in [(3.1, 4.7), (-8.3, 0.1), (0.3, -11.9), (-5.5, -5.5)] {
        let one = force(ahead, starboard);
        let other = force(ahead, -starboard);
        let bits = |force: Planar| {
            (
                force.surge.to_bits(),
                force.sway.to_bits(),
                force.yaw.to_bits(),
            )
        };
        assert_eq!(
            bits(one),
            bits(Planar {
                surge: other.surge,
                sway: -other.sway,
                yaw: -other.yaw
            })
        );
    }
    let nothing = force(0.0, 0.0);
    for part in [nothing.surge, nothing.sway, nothing.yaw] {
        assert_eq!(part.to_bits(), 0, "no wind is +0: {nothing:?}");
    }
}
