//! The sum of waves compared with the spectrum that it represents, and with linear wave theory.

mod common;

use common::square;
use primitives::frame::Ned;
use primitives::stream::Stream;
use scenario::sea::{GRAVITY_M_S2, Spreading, Waves};
use sim::sea::spectrum::jonswap_m2_s;
use sim::sea::wave::wavenumber_rad_m;
use sim::sea::{Component, Surface, WaveField};
use std::f64::consts::{PI, TAU};

const HALF_HOUR_S: f64 = 1800.0;

fn sea(components: u32) -> Waves {
    Waves {
        components,
        ..common::waves(0.5, 3.0, 0.7)
    }
}

fn power(x: f64, n: usize) -> f64 {
    std::iter::repeat_n(x, n).product()
}

/// The moments of order 0, 1 and 2 of the components, and those of the spectrum up to 60 peak
/// frequencies, beyond which 0.0004 of the second moment remains.
fn moments(field: &WaveField) -> [f64; 3] {
    let of = |n| {
        field
            .components()
            .map(|c| 0.5 * square(c.amplitude_m) * power(c.omega_rad_s, n))
            .sum()
    };
    [of(0), of(1), of(2)]
}

fn moments_of_spectrum(waves: &Waves) -> [f64; 3] {
    let peak = TAU / waves.tp_s;
    [0, 1, 2].map(|n| integral(waves, 0.3 * peak, 60.0 * peak, |omega| power(omega, n)))
}

fn integral(waves: &Waves, from: f64, to: f64, weight: impl Fn(f64) -> f64) -> f64 {
    let pieces = 60_000;
    let step = (to - from) / f64::from(pieces);
    let at = |i: i32| from + step * (f64::from(i) + 0.5);
    (0..pieces)
        .map(|i| jonswap_m2_s(waves, at(i)) * weight(at(i)) * step)
        .sum()
}

#[test]
fn the_variance_is_that_of_the_significant_height_to_the_last_digits() {
    for gamma in [1.0, 3.3, 7.0] {
        for components in [1, 3, 16, 64, 255] {
            let field = WaveField::new(
                &Waves {
                    gamma,
                    ..sea(components)
                },
                None,
                4,
            );
            assert!(
                (field.hs_m() - 0.5).abs() < 1e-12,
                "{components} components: {}",
                field.hs_m()
            );
            assert_eq!(field.components().len(), components as usize);
        }
    }
}

#[test]
fn the_spectrum_has_the_published_mean_periods() {
    // Tz/Tp and T1/Tp: DNV-RP-C205, 3.5.5.4 to 3.5.5.5, and for gamma = 1 those of Pierson and
    // Moskowitz.
    for (gamma, zero_up, mean) in [(3.3, 0.778, 0.834), (1.0, 0.710, 0.772)] {
        let [m0, m1, m2] = moments_of_spectrum(&Waves {
            gamma,
            tp_s: 1.0,
            ..sea(1)
        });
        let got = (TAU * (m0 / m2).sqrt(), TAU * m0 / m1);
        assert!(
            (got.0 - zero_up).abs() < 0.004 && (got.1 - mean).abs() < 0.004,
            "gamma {gamma}: {got:?}"
        );
        assert!(
            (16.0 * m0 / 0.25 - 1.0).abs() < 0.005,
            "gamma {gamma}: m0 {m0}"
        );
    }
}

#[test]
fn the_components_have_the_mean_periods_of_the_spectrum() {
    // The band ends at five peak frequencies, which removes 4 % of the second moment: 2 % of Tz.
    for (components, within) in [(16, 0.08), (64, 0.04), (256, 0.03)] {
        for seed in 0..20 {
            let [m0, m1, m2] = moments(&WaveField::new(
                &Waves {
                    tp_s: 1.0,
                    ..sea(components)
                },
                None,
                seed,
            ));
            let zero_up = TAU * (m0 / m2).sqrt();
            let mean = TAU * m0 / m1;
            assert!(
                (zero_up / 0.778 - 1.0).abs() < within,
                "{components} components, seed {seed}: Tz {zero_up}"
            );
            assert!(
                (mean / 0.834 - 1.0).abs() < within,
                "{components} components, seed {seed}: T1 {mean}"
            );
        }
    }
}

#[test]
fn half_an_hour_at_a_place_has_the_stated_variance() {
    // Half an hour is about 700 waves. For this spectrum the sampling error of a Gaussian sea is
    // then 6 % (the root of 2π ∫S² dω / (T m0²)), and that of the mean over sixteen seas 1.5 %.
    let seas = 16;
    let mut mean = 0.0;
    for seed in 0..seas {
        let field = WaveField::new(&sea(64), None, seed);
        let samples = (HALF_HOUR_S / 0.4) as u32;
        let at = Ned {
            north: 31.0,
            east: -12.0,
        };
        let squares = (0..samples)
            .map(|i| field.surface(at, 0.4 * f64::from(i)).elevation_m)
            .map(square);
        let ratio = squares.sum::<f64>() / f64::from(samples) / (0.5 * 0.5 / 16.0);
        assert!(
            (ratio - 1.0).abs() < 0.15,
            "seed {seed}: {ratio} of the variance"
        );
        mean += ratio / seas as f64;
    }
    assert!((mean - 1.0).abs() < 0.03, "{mean} of the variance");
}

/// Energy-weighted mean vector of the components' directions, relative to the expected direction.
fn mean_vector(components: &[Component], from_rad: f64) -> (f64, f64) {
    let energy: f64 = components.iter().map(|c| square(c.amplitude_m)).sum();
    let sum = |f: fn(f64) -> f64| -> f64 {
        components
            .iter()
            .map(|c| square(c.amplitude_m) * f(c.toward_rad - from_rad - PI))
            .sum()
    };
    (sum(libm::cos) / energy, sum(libm::sin) / energy)
}

#[test]
fn directions_have_the_mean_and_the_spread_of_their_distribution_at_all_frequencies() {
    // First Fourier coefficients: 8 / 3π for cos², s / (s + 1) for cos^2s (Longuet-Higgins,
    // Cartwright and Smith 1963).
    let cases = [
        (Spreading::None, 1.0),
        (Spreading::CosineSquared, 8.0 / (3.0 * PI)),
        (Spreading::Cosine2s { s: 1.0 }, 0.5),
        (Spreading::Cosine2s { s: 10.0 }, 10.0 / 11.0),
        (Spreading::Cosine2s { s: 200.0 }, 200.0 / 201.0),
    ];
    for (spreading, want) in cases {
        for seed in 0..10 {
            let waves = Waves {
                spreading,
                ..sea(64)
            };
            let components: Vec<Component> = WaveField::new(&waves, None, seed)
                .components()
                .copied()
                .collect();
            let (low, high) = components.split_at(24);
            for (part, within) in [(&components[..], 0.04), (low, 0.1), (high, 0.1)] {
                let (cos, sin) = mean_vector(part, waves.from_rad);
                let off = (cos - want).abs().max(sin.abs());
                assert!(
                    off < within,
                    "{spreading:?}, seed {seed}: ({cos}, {sin}), not ({want}, 0)"
                );
            }
        }
    }
}

#[test]
fn a_seed_gives_the_same_sea_and_another_seed_another() {
    let at = |seed| {
        WaveField::new(&sea(64), Some(8.0), seed).surface(
            Ned {
                north: 1.0,
                east: 2.0,
            },
            100.0,
        )
    };
    assert_eq!(at(1), at(1));
    assert!((1..50).all(|seed| (at(seed).elevation_m - at(0).elevation_m).abs() > 1e-6));
}

fn regular(period_s: f64, toward_rad: f64, depth_m: Option<f64>) -> WaveField {
    let wave = Component {
        amplitude_m: 0.3,
        omega_rad_s: TAU / period_s,
        toward_rad,
        phase_rad: 0.4,
    };
    WaveField::of(&[wave], depth_m, 1.0)
}

/// The first place after `from_m`, in the direction `toward_rad`, at which the surface rises
/// through zero.
fn rise_after_m(field: &WaveField, toward_rad: f64, from_m: f64, time_s: f64) -> f64 {
    let (sin, cos) = libm::sincos(toward_rad);
    let height = |m: f64| {
        field
            .surface(
                Ned {
                    north: m * cos,
                    east: m * sin,
                },
                time_s,
            )
            .elevation_m
    };
    let mut low = from_m;
    while !(height(low) < 0.0 && height(low + 0.05) >= 0.0) {
        low += 0.05;
    }
    common::root((low, low + 0.05), height)
}

#[test]
fn a_regular_wave_has_the_length_and_speed_of_its_depth() {
    for (period_s, depth_m) in [
        (1.5, None),
        (3.0, None),
        (3.0, Some(1.0)),
        (6.0, Some(0.5)),
        (6.0, Some(40.0)),
    ] {
        let toward_rad = 2.3;
        let field = regular(period_s, toward_rad, depth_m);
        let first_m = rise_after_m(&field, toward_rad, 0.0, 7.0);
        let next_m = rise_after_m(&field, toward_rad, first_m + 0.5, 7.0);
        let omega = TAU / period_s;
        let k = TAU / (next_m - first_m);
        let tanh = depth_m.map_or(1.0, |h| libm::tanh(k * h));
        let residue = omega * omega / (GRAVITY_M_S2 * k * tanh) - 1.0;
        assert!(
            residue.abs() < 1e-7,
            "{period_s} s, {depth_m:?} m: off by {residue}"
        );
        assert!((field.wavelength_m(period_s) * k / TAU - 1.0).abs() < 1e-7);

        let later_m = rise_after_m(&field, toward_rad, first_m + 0.05, 7.1);
        let speed_m_s = (later_m - first_m) / 0.1;
        assert!(
            (speed_m_s * k / omega - 1.0).abs() < 1e-6,
            "{period_s} s: {speed_m_s} m/s"
        );
        if depth_m.is_none() {
            assert!(
                (speed_m_s * omega / GRAVITY_M_S2 - 1.0).abs() < 1e-6,
                "g / omega, {speed_m_s} m/s"
            );
        }
    }
}

#[test]
fn dispersion_holds_from_very_shallow_to_very_deep() {
    for omega in [0.1, 1.0, 4.0, 20.0] {
        for depth_m in [0.01, 0.3, 1.0, 5.0, 50.0, 2000.0] {
            let k = wavenumber_rad_m(omega, depth_m);
            let residue = omega * omega / (GRAVITY_M_S2 * k * libm::tanh(k * depth_m)) - 1.0;
            assert!(
                residue.abs() < 1e-14,
                "{omega} rad/s, {depth_m} m: {residue}"
            );
        }
    }
}

#[test]
fn the_slope_is_the_gradient_of_the_elevation() {
    let field = WaveField::new(&sea(64), Some(3.0), 2);
    let surface = |north, east| field.surface(Ned { north, east }, 55.0);
    let slope = surface(9.0, 4.0).slope;
    let [north] = common::derivative(|d| surface(9.0 + d, 4.0), |s: &Surface| [s.elevation_m]);
    let [east] = common::derivative(|d| surface(9.0, 4.0 + d), |s: &Surface| [s.elevation_m]);
    assert!(
        (slope.north - north).abs() < 5e-5 && (slope.east - east).abs() < 5e-5,
        "{slope:?} {north} {east}"
    );
}

#[test]
fn after_a_day_the_phases_are_as_good_as_after_a_second() {
    let field = WaveField::new(
        &Waves {
            tp_s: 1.2,
            ..sea(64)
        },
        None,
        6,
    );
    let mut stream = Stream::new(1, "test");
    for time_s in [1.0, 3600.0, 86_400.0] {
        for _ in 0..100 {
            let at = Ned {
                north: stream.between(-2e3, 2e3),
                east: stream.between(-2e3, 2e3),
            };
            let time_s = time_s + stream.unit();
            let want: f64 = field
                .components()
                .map(|c| c.amplitude_m * libm::cos(phase_rad(c, at, time_s)))
                .sum();
            let off = field.surface(at, time_s).elevation_m - want;
            assert!(off.abs() < 3e-7, "{time_s} s: off by {off} m");
        }
    }
}

/// A phase in deep water, with the product of frequency and time to twice as many digits.
fn phase_rad(c: &Component, at: Ned, time_s: f64) -> f64 {
    let (sin, cos) = libm::sincos(c.toward_rad);
    let k = c.omega_rad_s * c.omega_rad_s / GRAVITY_M_S2;
    let turned = c.omega_rad_s * time_s;
    let lost = c.omega_rad_s.mul_add(time_s, -turned);
    // The tail of 2π: 2.449e-16.
    let turns = (turned / TAU).round();
    let rest = turns.mul_add(-TAU, turned) - turns * 2.449_293_598_294_706_4e-16 + lost;
    k * (at.north * cos + at.east * sin) - rest + c.phase_rad
}

#[test]
fn stokes_drift_is_the_closed_form_at_the_surface_and_its_mean_over_the_draught() {
    let a = 0.3_f64;
    let omega = TAU / 3.0;
    let toward_rad = 2.3;
    for depth_m in [None, Some(1.0), Some(30.0)] {
        let field = regular(3.0, toward_rad, depth_m);
        let k = wavenumber_rad_m(omega, depth_m.unwrap_or(f64::INFINITY));
        let at = |z: f64| match depth_m {
            None => a * a * omega * k * libm::exp(2.0 * k * z),
            Some(h) => {
                a * a * omega * k * libm::cosh(2.0 * k * (z + h))
                    / (2.0 * square(libm::sinh(k * h)))
            }
        };
        for draught_m in [1e-6, 0.14, 0.5] {
            let strips = 1000;
            let mean = (0..strips)
                .map(|i| at(-draught_m * (f64::from(i) + 0.5) / 1000.0))
                .sum::<f64>()
                / 1000.0;
            let got = field.stokes_drift_m_s(draught_m);
            assert!(
                (got.length() / mean - 1.0).abs() < 1e-6,
                "{depth_m:?}, {draught_m} m: {got:?}, not {mean}"
            );
            assert!((got.bearing_rad(got.scaled(2.0)) - toward_rad).abs() < 1e-9);
        }
    }
}
