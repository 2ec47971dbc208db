//! Wave effects on a hull, compared with linear theory integrated by brute force and with published
//! magnitudes.

mod common;

use common::{mean_of, square, waves};
use primitives::frame::{Body, Ned, Pose, Rotation, ned_from_body};
use scenario::boat::Boat;
use scenario::sea::{GRAVITY_M_S2, Spreading, Waves};
use sim::hull::Planar;
use sim::sea::wave::wavenumber_rad_m;
use sim::sea::{Attitude, Component, HullWaves, WaveField, WaveResponse, WaveSample};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const DENSITY_KG_M3: f64 = 1000.0;

fn boat(length_m: f64, beam_m: f64, draught_m: f64) -> Boat {
    Boat {
        length_m,
        beam_m,
        draught_m,
        ..common::boat("surveyor_m1_8")
    }
}

fn surveyor() -> Boat {
    boat(1.8, 0.9, 0.14)
}

/// A boat so small that it feels the waves at a single point.
fn cork() -> Boat {
    boat(1e-4, 1e-4, 1e-6)
}

fn sea(hs_m: f64, tp_s: f64, spreading: Spreading) -> WaveField {
    WaveField::new(
        &Waves {
            spreading,
            ..waves(hs_m, tp_s, 0.7)
        },
        None,
        5,
    )
}

fn regular(length_m: f64, toward_rad: f64, depth_m: Option<f64>) -> WaveField {
    let k = TAU / length_m;
    let omega_rad_s = (GRAVITY_M_S2 * k * depth_m.map_or(1.0, |h| libm::tanh(k * h))).sqrt();
    WaveField::of(
        &[Component {
            amplitude_m: 0.2,
            omega_rad_s,
            toward_rad,
            phase_rad: 0.3,
        }],
        depth_m,
        1.0,
    )
}

fn pose(north: f64, east: f64, psi_rad: f64) -> Pose {
    Pose {
        at: Ned { north, east },
        psi_rad,
    }
}

/// Mean square of a component of the velocity over places and times, on this heading.
fn mean_square(hull: &HullWaves, psi_rad: f64, part: impl Fn(Planar) -> f64) -> f64 {
    let at = |i: usize| {
        hull.at(pose((i % 100) as f64 * 7.3, 0.0, psi_rad), 0.37 * i as f64)
            .velocity
    };
    mean_of(20_000, |i| square(part(at(i))))
}

#[test]
fn the_acceleration_at_the_surface_is_minus_g_times_its_gradient() {
    let waves = Waves {
        gamma: 2.0,
        ..waves(0.5, 3.0, 2.0)
    };
    for depth_m in [None, Some(1.5)] {
        let field = WaveField::new(&waves, depth_m, 1);
        let hull = HullWaves::new(&field, &cork(), DENSITY_KG_M3);
        for (t, psi_rad) in [(0.0, 0.0), (4.0, FRAC_PI_2), (9.0, PI)] {
            let at = pose(20.0, -7.0, psi_rad);
            let got = hull.at(at, t).acceleration;
            let got = got.in_ned(at.rotation());
            let off = got + field.surface(at.at, t).slope.scaled(GRAVITY_M_S2);
            assert!(
                off.length() < 1e-4,
                "{depth_m:?}, {t} s: error {off:?} m/s²"
            );
        }
    }
}

#[test]
fn a_hull_feels_the_mean_and_the_first_moment_over_its_length_and_beam() {
    let boat = boat(1.8, 0.9, 1e-6);
    let field = sea(0.3, 1.8, Spreading::CosineSquared);
    let hull = HullWaves::new(&field, &boat, DENSITY_KG_M3);
    let point = HullWaves::new(&field, &cork(), DENSITY_KG_M3);
    let n_x = 60;
    let n_y = 30;
    // Headings with an entry in the tables, so that the entry itself is tested.
    for (psi_deg, t) in [(0.0, 1.0), (35.0, 2.0), (90.0, 5.0), (-145.0, 8.0)] {
        let psi_rad = f64::to_radians(psi_deg);
        let rotation = Rotation::from_heading(psi_rad);
        let mut want = [Planar::default(); 2];
        for i in 0..n_x * n_y {
            let ahead = boat.length_m * ((f64::from(i % n_x) + 0.5) / f64::from(n_x) - 0.5);
            let starboard = boat.beam_m * ((f64::from(i / n_x) + 0.5) / f64::from(n_y) - 0.5);
            let at = Ned {
                north: 11.0,
                east: 3.0,
            } + ned_from_body(rotation, Body { ahead, starboard });
            let there = point.at(Pose { at, psi_rad }, t);
            for (sum, there) in want.iter_mut().zip([there.velocity, there.acceleration]) {
                let lever = ahead / (boat.length_m * boat.length_m / 12.0);
                let part = Planar {
                    surge: there.surge,
                    sway: there.sway,
                    yaw: lever * there.sway,
                };
                *sum = sum.plus(1.0 / f64::from(n_x * n_y), part);
            }
        }
        let got = hull.at(pose(11.0, 3.0, psi_rad), t);
        for (got, want) in [(got.velocity, want[0]), (got.acceleration, want[1])] {
            let off = [
                got.surge - want.surge,
                got.sway - want.sway,
                got.yaw - want.yaw,
            ];
            assert!(
                off.iter().all(|off| off.abs() < 2e-3),
                "{psi_deg} deg: {got:?}, by strips {want:?}"
            );
        }
    }
}

/// Interpolation errors between the headings of the table, in surge, sway and yaw velocity and
/// drift force: root mean squares over headings and times, relative to the values.
fn off_between_headings(field: &WaveField, boat: &Boat) -> [f64; 4] {
    let steps = 10;
    let bin_rad = TAU / 72.0;
    let hull = HullWaves::new(field, boat, DENSITY_KG_M3);
    let mut off = [0.0; 4];
    let mut size = [0.0; 4];
    for step in 0..steps {
        // The same sea in axes rotated by a fraction of a bin: there the heading has an entry.
        let by_rad = bin_rad * (f64::from(step) + 0.5) / f64::from(steps);
        let turned: Vec<Component> = field
            .components()
            .map(|c| Component {
                toward_rad: c.toward_rad - by_rad,
                ..*c
            })
            .collect();
        let exact = HullWaves::new(&WaveField::of(&turned, None, 1.0), boat, DENSITY_KG_M3);
        for i in 0..720 {
            let psi_rad = bin_rad * f64::from(i % 72);
            let t = f64::from(i) * 1.3;
            let got = hull.at(pose(0.0, 0.0, psi_rad + by_rad), t);
            let want = exact.at(pose(0.0, 0.0, psi_rad), t);
            let parts = |s: WaveSample| {
                [
                    s.velocity.surge,
                    s.velocity.sway,
                    s.velocity.yaw,
                    s.drift_newton.sway + s.drift_newton.surge,
                ]
            };
            for (n, (got, want)) in parts(got).into_iter().zip(parts(want)).enumerate() {
                off[n] += square(got - want);
                size[n] += want * want;
            }
        }
    }
    std::array::from_fn(|n| (off[n] / size[n]).sqrt())
}

#[test]
fn between_the_headings_of_the_table_the_error_is_a_small_part_of_the_motion() {
    // For the shipped boats the error is at most 0.4 %, in yaw. The response of a long hull to
    // waves several times shorter varies too fast with heading for the table, but is small.
    let heron = (boat(1.35, 1.0, 0.1), 0.005);
    let surveyor = (surveyor(), 0.005);
    let otter = (boat(2.0, 1.08, 0.195), 0.005);
    for (hs_m, tp_s, ten_metres) in [
        (0.1, 1.5, 0.03),
        (0.3, 2.0, 0.012),
        (0.5, 3.0, 0.006),
        (1.0, 5.0, 0.005),
    ] {
        for spreading in [Spreading::None, Spreading::CosineSquared] {
            for (boat, within) in [
                &heron,
                &surveyor,
                &otter,
                &(boat(10.0, 3.0, 0.6), ten_metres),
            ] {
                let off = off_between_headings(&sea(hs_m, tp_s, spreading), boat);
                let what = format!("{} m in {hs_m} m, {tp_s} s, {spreading:?}", boat.length_m);
                assert!(
                    off.iter().all(|off| off < within),
                    "{what}: errors {off:?}, limit {within}"
                );
            }
        }
    }
}

#[test]
fn the_acceleration_is_the_rate_of_change_of_the_velocity() {
    let hull = HullWaves::new(
        &sea(0.5, 3.0, Spreading::CosineSquared),
        &surveyor(),
        DENSITY_KG_M3,
    );
    for (t, psi_rad) in [(0.0, 0.3), (100.0, -2.0), (86_400.0, 1.0)] {
        let at = pose(50.0, 60.0, psi_rad);
        let got = hull.at(at, t).acceleration;
        let want = common::derivative(
            |dt| hull.at(at, t + dt).velocity,
            |v: &Planar| [v.surge, v.sway, v.yaw],
        );
        for (got, want) in [got.surge, got.sway, got.yaw].into_iter().zip(want) {
            assert!(
                (got - want).abs() < 5e-5,
                "{t} s: {got}, by differences {want}"
            );
        }
    }
}

#[test]
fn the_drift_force_of_a_regular_wave_is_steady_and_points_where_it_goes() {
    let toward_rad = 0.9;
    let length_m = 6.0;
    let k = TAU / length_m;
    let boat = surveyor();
    for depth_m in [None, Some(0.8)] {
        let field = regular(length_m, toward_rad, depth_m);
        let hull = HullWaves::new(&field, &boat, DENSITY_KG_M3);
        let reflected = 1.0 - libm::exp(-2.0 * k * boat.draught_m);
        // Twice the ratio of group speed to phase speed (Longuet-Higgins 1977), by differences of
        // ω(k).
        let omega = |k: f64| (GRAVITY_M_S2 * k * depth_m.map_or(1.0, |h| libm::tanh(k * h))).sqrt();
        let groups = 2.0 * k / omega(k) * (omega(k * 1.0001) - omega(k * 0.9999)) / (k * 0.0002);
        let per_metre = 0.5 * DENSITY_KG_M3 * GRAVITY_M_S2 * square(0.2 * reflected) * groups;
        for (off_bow_deg, t) in [
            (0.0, 0.0),
            (90.0, 0.7),
            (-90.0, 9.0),
            (60.0, 50.0),
            (-150.0, 3.0),
        ] {
            let off_bow_rad = f64::to_radians(off_bow_deg);
            let got = hull
                .at(pose(4.0, 5.0, toward_rad - off_bow_rad), t)
                .drift_newton;
            let (sin, cos) = libm::sincos(off_bow_rad);
            let want = (
                boat.beam_m * cos * cos.abs() * per_metre,
                boat.length_m * sin * sin.abs() * per_metre,
            );
            // Error of linear interpolation between the headings of the table: (5°)² / 4.
            let within = 2e-3 * boat.length_m * per_metre;
            let off = ((got.surge - want.0).abs(), (got.sway - want.1).abs());
            assert!(
                off.0 < within && off.1 < within,
                "{off_bow_deg} deg, {depth_m:?}: {got:?}, want {want:?}"
            );
        }
    }
}

#[test]
fn the_drift_force_comes_in_groups_about_the_closed_mean() {
    let boat = surveyor();
    for spreading in [Spreading::None, Spreading::CosineSquared] {
        let field = sea(0.5, 3.0, spreading);
        let hull = HullWaves::new(&field, &boat, DENSITY_KG_M3);
        let psi_rad = 35_f64.to_radians();
        let samples = 40_000;
        let at = |i: i32| {
            hull.at(
                pose(f64::from(i % 40) * 13.7, f64::from(i % 7) * 31.0, psi_rad),
                0.5 * f64::from(i),
            )
        };
        let force: Vec<f64> = (0..samples).map(|i| at(i).drift_newton.sway).collect();
        let mean = mean_of(force.len(), |i| force[i]);
        let deviation = mean_of(force.len(), |i| square(force[i] - mean)).sqrt();
        let want = field.mean_drift_newton(&boat, DENSITY_KG_M3, psi_rad).sway;
        assert!(
            (mean / want - 1.0).abs() < 0.03,
            "{spreading:?}: {mean} N, not {want} N"
        );
        // The squared envelope of a Gaussian process is exponentially distributed.
        assert!(
            (deviation / mean.abs() - 1.0).abs() < 0.1,
            "{spreading:?}: {deviation} N about {mean} N"
        );
    }
}

#[test]
fn orbital_motion_and_drift_have_the_magnitudes_computed_elsewhere() {
    // Hs and Tp; rms orbital velocity at a point and over the hull; rms slope; Stokes drift at the
    // surface; mean drift force beam-on and head-on, for 1.8 m by 0.9 m by 0.14 m. The values come
    // from a separate calculation for long-crested waves from 0.6 to 3.5 peak frequencies. The band
    // here extends to 5, so quantities that weight high frequencies are larger by up to a sixth.
    let rows = [
        (0.2, 2.0, 0.19, 0.13, 5.7, 0.036, 5.7, 2.8),
        (0.3, 2.5, 0.23, 0.18, 5.4, 0.041, 6.8, 3.4),
        (0.5, 3.0, 0.32, 0.27, 6.3, 0.066, 10.7, 5.3),
        (0.8, 4.0, 0.39, 0.36, 5.7, 0.071, 10.0, 5.0),
        (1.0, 5.0, 0.39, 0.38, 4.5, 0.057, 7.0, 3.7),
    ];
    let boat = surveyor();
    for (hs_m, tp_s, orbital, on_hull, slope_deg, stokes, beam_on, head_on) in rows {
        let field = sea(hs_m, tp_s, Spreading::None);
        let hull = HullWaves::new(&field, &boat, DENSITY_KG_M3);
        let toward_rad = field.components().next().unwrap().toward_rad;
        let drift = |psi_rad| field.mean_drift_newton(&boat, DENSITY_KG_M3, psi_rad);
        let got = [
            ("orbital velocity", field.orbital_rms_m_s(), orbital),
            (
                "orbital velocity on the hull",
                mean_square(&hull, toward_rad, |v| v.surge).sqrt(),
                on_hull,
            ),
            ("slope", field.slope_rms_rad().to_degrees(), slope_deg),
            (
                "Stokes drift",
                field.stokes_drift_m_s(1e-6).length(),
                stokes,
            ),
            ("drift beam-on", drift(toward_rad - FRAC_PI_2).sway, beam_on),
            ("drift head-on", -drift(toward_rad + PI).surge, head_on),
        ];
        for (what, got, want) in got {
            assert!(
                (got / want - 1.0).abs() < 0.2,
                "{hs_m} m, {tp_s} s: {what} {got}, reference {want}"
            );
        }
    }
}

#[test]
fn on_a_long_swell_a_boat_floats_with_the_surface() {
    // A wave a kilometre long, travelling north. Its period is 25 s or more, slow compared with
    // every spring.
    for (t, psi_deg, depth_m) in [
        (0.0, 0.0, None),
        (6.0, 90.0, None),
        (12.0, 180.0, Some(20.0)),
        (18.0, -90.0, Some(5.0)),
        (3.0, 45.0, None),
    ] {
        let field = regular(1000.0, 0.0, depth_m);
        let response = WaveResponse::new(&field, &surveyor());
        let psi_rad = f64::to_radians(psi_deg);
        let got = response.at(pose(100.0, 0.0, psi_rad), Ned::default(), 0.0, t);
        let surface = field.surface(
            Ned {
                north: 100.0,
                east: 0.0,
            },
            t,
        );
        let bow_up = surface.slope.north * libm::cos(psi_rad);
        // The surface rises to the north: with the bow east, that is the port side, and starboard
        // is down.
        let starboard_down = surface.slope.north * libm::sin(psi_rad);
        assert!(
            (got.heave_up_m - surface.elevation_m).abs() < 0.01,
            "{t} s: {got:?} {surface:?}"
        );
        assert!(
            (got.pitch_rad - bow_up).abs() < 5e-5,
            "{t} s: pitch {} {bow_up}",
            got.pitch_rad
        );
        assert!(
            (got.roll_rad - starboard_down).abs() < 5e-5,
            "{t} s: roll {} {starboard_down}",
            got.roll_rad
        );
    }
}

#[test]
fn a_wave_at_the_natural_frequency_rolls_the_boat_by_the_springs_amplification() {
    // Damping 0.2: 1 / (2 · 0.2) = 2.5 at resonance, a quarter turn behind the slope.
    let k = wavenumber_rad_m(7.4, f64::INFINITY);
    let field = regular(TAU / k, FRAC_PI_2, None);
    let hull = boat(0.2, 0.01, 1e-6);
    let response = WaveResponse::new(&field, &hull);
    let at = pose(0.0, 0.0, 0.0);
    let period_s = TAU / 7.4;
    for t in [0.1, 0.3, 0.6] {
        let roll_rad = response.at(at, Ned::default(), 0.0, t).roll_rad;
        let slope_then = field.surface(at.at, t - 0.25 * period_s).slope.east;
        assert!(
            (roll_rad + 2.5 * slope_then).abs() < 1e-3 * 2.5 * 0.2 * k,
            "{t} s: {roll_rad} {slope_then}"
        );
    }
}

#[test]
fn the_rates_of_the_attitude_are_its_changes_along_a_turning_track() {
    let field = sea(0.5, 2.5, Spreading::CosineSquared);
    let response = WaveResponse::new(&field, &surveyor());
    let velocity = Ned {
        north: 1.4,
        east: -0.9,
    };
    let turn_rad_s = 0.4;
    let along = |t: f64| {
        let here = pose(
            10.0 + velocity.north * t,
            4.0 + velocity.east * t,
            1.0 + turn_rad_s * t,
        );
        response.at(here, velocity, turn_rad_s, 500.0 + t)
    };
    let now = along(0.0);
    let want = common::derivative(along, |a: &Attitude| {
        [a.heave_up_m, a.roll_rad, a.pitch_rad]
    });
    let got = [now.heave_up_m_s, now.roll_rad_s, now.pitch_rad_s];
    for (what, (got, want)) in ["heave", "roll", "pitch"]
        .into_iter()
        .zip(got.into_iter().zip(want))
    {
        assert!(
            (got - want).abs() < 5e-5,
            "{what}: {got}, by differences {want}"
        );
    }
    // On a straight track the acceleration is exactly that of the heave.
    let straight = |t: f64| {
        let here = pose(10.0 + velocity.north * t, 4.0 + velocity.east * t, 1.0);
        response.at(here, velocity, 0.0, 500.0 + t)
    };
    let [want] = common::derivative(straight, |a: &Attitude| [a.heave_up_m_s]);
    let got = straight(0.0).heave_up_m_s2;
    assert!((got - want).abs() < 1e-4, "{got}, by differences {want}");
}
