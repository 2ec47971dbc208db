//! The sea and the boats together: invariants, closed forms and symmetry.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use common::{afloat, alone, on_sea, place_boat, sail, scenarios, surveyor_on};
use messages::Order;
use primitives::Ned;
use scenario::sea::{GRAVITY_M_S2, Spreading, Waves};
use sim::World;
use sim::sea::WaveField;
use std::f64::consts::TAU;

const DRIFTING: [Order; 2] = [Order::Hold; 2];

fn waves(hs_m: f64, tp_s: f64) -> Waves {
    common::waves(hs_m, tp_s, 0.0)
}

/// A drifter's mean velocity over ten minutes and the root mean square of its velocity (m/s), in
/// waves of this height without drift force.
fn adrift(hs_m: f64, seed: u64) -> (Ned, f64) {
    let scenario = surveyor_on(|sea| {
        sea.waves = Some(Waves {
            drift_factor: 0.0,
            ..waves(hs_m, 2.5)
        })
    });
    let mut world = afloat(&scenario, seed, (300.0, 200.0, 20.0), (0.0, 0.0, 0.0));
    sail(&mut world, &DRIFTING, 1_200);
    let start = world.state().boats[0].pose.at;
    let mut sum = 0.0;
    let n = 12_000;
    for _ in 0..n {
        world.step(&DRIFTING);
        let nu = world.state().boats[0].nu;
        sum += nu.surge * nu.surge + nu.sway * nu.sway;
    }
    let gone = world.state().boats[0].pose.at - start;
    (
        gone.scaled(1.0 / (f64::from(n) * 0.05)),
        (sum / f64::from(n)).sqrt(),
    )
}

#[test]
fn a_drifter_in_waves_goes_to_and_fro_and_only_second_order_takes_it_anywhere() {
    // The published magnitude: 0.18 m/s of orbital velocity averaged over the hull in a sea of 0.3
    // m. Stokes drift is 0.04 m/s.
    let (mean, rms) = adrift(0.3, 4);
    assert!((0.08..0.3).contains(&rms), "oscillates at {rms} m/s");
    assert!(mean.length() < 0.08, "mean velocity {mean:?} m/s");
    // First-order motion is proportional to the height and has no mean: in waves a tenth as high a
    // boat oscillates a tenth as fast, and a hundredth of the second-order motion remains.
    let (small_mean, small_rms) = adrift(0.03, 4);
    assert!(
        (small_rms / rms - 0.1).abs() < 0.01,
        "oscillates at {small_rms} m/s, compared with {rms}"
    );
    assert!(
        small_mean.length() < 0.03 * small_rms,
        "mean velocity {small_mean:?} m/s, oscillation {small_rms} m/s"
    );
}

#[test]
fn boats_in_waves_heave_at_the_frequency_of_encounter() {
    // One long-crested wave of about 2.5 s from ahead, abeam and astern, at constant speeds: the
    // frequency of encounter is ω − k V cos, with the resulting V.
    let samples = 2_048_usize;
    let dt_s = 0.05;
    let resolution = TAU / (samples as f64 * dt_s);
    for (from_deg, speed_m_s) in [
        (0.0, 0.8),
        (0.0, 1.5),
        (90.0, 1.5),
        (180.0, 0.8),
        (180.0, 1.5),
    ] {
        let from_rad = f64::to_radians(from_deg);
        let scenario = surveyor_on(|sea| {
            let components = 1;
            let spreading = Spreading::None;
            sea.waves = Some(Waves {
                components,
                spreading,
                from_rad,
                drift_factor: 0.0,
                ..waves(0.1, 2.5)
            });
        });
        let mut world = afloat(&scenario, 1, (300.0, 50.0, 0.0), (speed_m_s, 0.0, 0.0));
        let wave = *world.sea().waves().unwrap().components().next().unwrap();
        let orders = [
            Order::Steer {
                heading_rad: 0.0,
                speed_m_s,
            },
            Order::Hold,
        ];
        sail(&mut world, &orders, 400);
        let start = world.state().boats[0].pose.at;
        let step = |_| {
            world.step(&orders);
            world.truth(primitives::VehicleId(0)).attitude.heave_up_m
        };
        let spectrum = common::amplitudes(&(0..samples).map(step).collect::<Vec<_>>());
        let gone = world.state().boats[0].pose.at - start;
        let k = wave.omega_rad_s * wave.omega_rad_s / GRAVITY_M_S2;
        let (sin, cos) = primitives::math::sin_cos(wave.toward_rad);
        let along_m_s = (gone.north * cos + gone.east * sin) / (samples as f64 * dt_s);
        let want = (wave.omega_rad_s - k * along_m_s) / resolution;
        let peak = (1..spectrum.len()).fold(0, |best, bin| {
            if spectrum[bin] > spectrum[best] {
                bin
            } else {
                best
            }
        });
        let what =
            format!("from {from_deg}°, {speed_m_s} m/s: {peak}, not {want} at {along_m_s} m/s");
        assert!((peak as f64 - want).abs() <= 1.0, "{what}");
        let still = wave.omega_rad_s / resolution;
        assert!(
            from_deg == 90.0 || (still - want).abs() > 4.0,
            "{what}: too close to {still} at a fixed place"
        );
    }
}

#[test]
fn every_shipped_sea_can_be_sailed_for_a_whole_game() {
    let mut files: Vec<_> = std::fs::read_dir(scenarios().join("seas"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    assert!(files.len() >= 14, "{files:?}");
    for file in files {
        let mut world = World::of_game(&on_sea("pav01_afloat.toml", &file), 1).unwrap();
        sail(
            &mut world,
            &[Order::Steer {
                heading_rad: 1.0,
                speed_m_s: 2.0,
            }; 4],
            12_000,
        );
        assert!(
            world.state().boats.iter().all(|boat| !boat.quarantined),
            "{}",
            file.display()
        );
        let speed = world
            .state()
            .boats
            .iter()
            .map(|boat| primitives::math::length(boat.nu.surge, boat.nu.sway))
            .fold(0.0, f64::max);
        assert!(speed < 10.0, "{}: {speed} m/s", file.display());
    }
}

#[test]
fn a_free_boat_in_a_long_swell_goes_with_stokes_drift() {
    for (hs_m, tp_s) in [(0.5, 5.0), (1.0, 6.0)] {
        let swell = Waves {
            drift_factor: 0.0,
            spreading: Spreading::None,
            ..waves(hs_m, tp_s)
        };
        let scenario = surveyor_on(|sea| sea.waves = Some(swell.clone()));
        let field = WaveField::new(&swell, None, 4);
        let want = field.stokes_drift_m_s(scenario.boats[0].draught_m);
        let mut world = afloat(&scenario, 4, (300.0, 200.0, 20.0), (0.0, 0.0, 0.0));
        let start = world.state().boats[0].pose.at;
        let minutes = 40;
        sail(&mut world, &DRIFTING, 1_200 * minutes);
        let gone = (world.state().boats[0].pose.at - start).scaled(1.0 / f64::from(60 * minutes));
        assert!(
            gone.distance(want) < 0.15 * want.length(),
            "{hs_m} m, {tp_s} s: {gone:?} m/s, not {want:?}"
        );
    }
}

#[test]
fn point_boats_collide_in_a_current_as_they_do_in_still_water() {
    let current = Ned {
        north: 0.3,
        east: 0.4,
    };
    let after = |mean_m_s: Ned| {
        let mut scenario = alone("heron_kinematic", "calm");
        scenario.sea.current.mean_m_s = mean_m_s;
        // Blue runs into red's side.
        let mut world = afloat(&scenario, 1, (300.0, 200.0, 90.0), (0.0, 0.0, 0.0));
        place_boat(&mut world, 1, (308.0, 200.2, 0.0), (0.0, 0.0, 0.0));
        let ahead = Order::Steer {
            heading_rad: std::f64::consts::FRAC_PI_2,
            speed_m_s: 1.5,
        };
        sail(&mut world, &[ahead, Order::Hold], 600);
        [0, 1].map(|i| world.state().boats[i].pose.at - mean_m_s.scaled(30.0))
    };
    let still = after(Ned::default());
    let drifting = after(current);
    assert!(
        (still[0].north - 200.0).abs() > 1.0,
        "blue did not hit red: {still:?}"
    );
    for (still, drifting) in still.into_iter().zip(drifting) {
        assert!(
            still.distance(drifting) < 1e-3,
            "{still:?}, in a current {drifting:?}"
        );
    }
}
