//! Numerical accuracy: the error by tick length, and stability for any added mass.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use common::{afloat, alone, sail, scenarios, waves};
use messages::Order;
use primitives::{Ned, Pose, SimTime};
use scenario::sea::{Gusts, Sea, Wind};
use sim::hull::{HullModel, Planar};

/// The Otter's pose after 20 s on this sea under imposed thrust, with this tick length.
fn pose_after(tick_s: f64, change: impl Fn(&mut Sea)) -> Pose {
    let mut scenario = alone("otter", "calm_salt");
    change(&mut scenario.sea);
    scenario.tick = SimTime::from_s(tick_s);
    let mut world = afloat(&scenario, 2, (300.0, 100.0, 11.0), (0.6, 0.05, 0.03));
    let orders = [
        Order::Thrust {
            port: 0.5,
            starboard: 0.4,
        },
        Order::Hold,
    ];
    sail(&mut world, &orders, (20.0 / tick_s).round() as u32);
    world.state().boats[0].pose
}

/// The factor by which the error shrinks with each halving of the tick from 100 ms to 12.5 ms, in
/// position and heading.
fn gains(change: impl Fn(&mut Sea)) -> Vec<[f64; 2]> {
    let truth = pose_after(0.001_25, &change);
    let errors = [0.1, 0.05, 0.025, 0.0125].map(|tick_s| {
        let pose = pose_after(tick_s, &change);
        [
            pose.at.distance(truth.at),
            primitives::angle::wrap_pi(pose.psi_rad - truth.psi_rad).abs(),
        ]
    });
    let gain = |pair: &[[f64; 2]]| [pair[0][0] / pair[1][0], pair[0][1] / pair[1][1]];
    errors.windows(2).map(gain).collect()
}

#[test]
fn in_calm_the_error_falls_with_the_fourth_power_of_the_tick() {
    let gains = gains(|sea| {
        sea.current.mean_m_s = Ned {
            north: 0.2,
            east: -0.1,
        }
    });
    assert!(
        gains
            .iter()
            .flatten()
            .all(|gain| (12.0..22.0).contains(gain)),
        "{gains:?}"
    );
}

#[test]
fn in_waves_it_falls_with_the_square_and_in_wind_in_proportion() {
    // Waves are evaluated half-way through the tick, wind at its start; both are held constant over
    // the tick.
    let in_waves = gains(|sea| sea.waves = Some(waves(0.3, 2.5, 0.5)));
    assert!(
        in_waves.iter().flatten().all(|gain| *gain > 3.5),
        "{in_waves:?}"
    );
    assert!(
        in_waves[2].iter().all(|gain| *gain < 4.5),
        "the gain exceeds that of the longest ticks: {in_waves:?}"
    );
    let in_wind = gains(|sea| {
        sea.wind = Some(Wind {
            speed_10m_m_s: 8.0,
            from_rad: 1.0,
            profile_exponent: 0.0,
            gusts: Gusts::None,
        });
    });
    assert!(
        in_wind
            .iter()
            .flatten()
            .all(|gain| (1.7..2.3).contains(gain)),
        "{in_wind:?}"
    );
}

#[test]
fn whatever_water_a_hull_carries_along_it_stays_stable_in_a_gale() {
    // Added mass of three times the boat's own mass or moment of inertia, in each direction and in
    // all. If added mass were a force computed from the last acceleration, the motion would diverge
    // even with added mass equal to the boat's own. Waves may carry a boat along, but no faster
    // than the crests of a gale.
    for (surge, sway, yaw) in [
        (3.0, 1.0, 1.0),
        (0.1, 3.0, 1.0),
        (0.1, 1.0, 3.0),
        (3.0, 3.0, 3.0),
    ] {
        for order in [
            Order::Steer {
                heading_rad: 1.0,
                speed_m_s: 1.5,
            },
            Order::Thrust {
                port: 0.8,
                starboard: 0.5,
            },
        ] {
            let mut scenario = alone("surveyor_m1_8", "calm");
            let gale = scenario::draw_file::<scenario::sea::Sea>(
                &scenarios().join("seas/bay_gale.toml"),
                1,
            );
            scenario.sea = gale.unwrap_or_else(|e| panic!("{e}")).0;
            let hull = &mut scenario.boats[0].hull;
            hull.added_surge_kg = surge * hull.mass_kg;
            hull.added_sway_kg = sway * hull.mass_kg;
            hull.added_yaw_kg_m2 = yaw * hull.yaw_inertia_kg_m2;
            let model = HullModel::new(hull, scenario.sea.water_density_kg_m3);
            let mut world = afloat(&scenario, 1, (300.0, 200.0, 10.0), (0.0, 0.0, 0.0));
            let crests_m_s =
                9.806_65 * scenario.sea.waves.as_ref().unwrap().tp_s / std::f64::consts::TAU;
            let limit_joule = model.energy_joule(Planar {
                surge: crests_m_s,
                ..Planar::default()
            });
            for tick in 0..36_000 {
                world.step(&[order, Order::Hold]);
                let boat = world.state().boats[0];
                let energy_joule = model.energy_joule(boat.nu);
                let what = format!("{surge} {sway} {yaw}, {order:?}, tick {tick}: {boat:?}");
                assert!(
                    !boat.quarantined && energy_joule.is_finite() && energy_joule < limit_joule,
                    "{what}: {energy_joule} J"
                );
            }
        }
    }
}
