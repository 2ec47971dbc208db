//! The Surveyor's model compared with measurements of the boat and predictions from its parameters.

mod common;

use common::alone;
use messages::Order;
use scenario::boat::{Drive, ThrustCurve};
use sim::hull::Planar;
use sim::{BoatState, World};

const AT_REST: (f64, f64, f64) = (0.0, 0.0, 0.0);

fn afloat(nu: (f64, f64, f64)) -> World {
    common::afloat(&alone("surveyor_m1_8", "calm"), 1, (100.0, 100.0, 0.0), nu)
}

/// The boat after this time under an order.
fn sail(world: &mut World, order: Order, seconds: u32) -> BoatState {
    common::sail(world, &[order, Order::Hold], 20 * seconds);
    world.state().boats[0]
}

/// The fraction of full ahead or astern at which one thruster gives this thrust.
fn share(newton: f64) -> f64 {
    let scenario = alone("surveyor_m1_8", "calm");
    let Drive::Thrusters { thruster, .. } = &scenario.boats[0].drive else {
        panic!("expected thrusters")
    };
    let ThrustCurve::Table { points } = &thruster.curve else {
        panic!("expected a thrust table")
    };
    primitives::math::interpolate(
        points.iter().map(|(share, newton)| (*newton, *share)),
        newton,
    )
}

fn speed(nu: Planar) -> f64 {
    (nu.surge * nu.surge + nu.sway * nu.sway).sqrt()
}

fn within(what: &str, got: f64, want: f64, share: f64) {
    assert!(
        (got - want).abs() <= share * want.abs(),
        "{what}: {got}, want {want} within {} %",
        100.0 * share
    );
}

#[test]
fn it_is_as_fast_as_its_thrust_map_says() {
    for (percent, want_m_s) in [
        (-100.0, -2.0),
        (20.0, 1.0),
        (40.0, 1.5),
        (60.0, 2.0),
        (70.0, 2.25),
        (100.0, 3.0),
    ] {
        let each = percent / 100.0;
        let nu = sail(
            &mut afloat(AT_REST),
            Order::Thrust {
                port: each,
                starboard: each,
            },
            100,
        )
        .nu;
        within(&format!("{percent} %"), nu.surge, want_m_s, 0.02);
        assert_eq!(
            (nu.sway, nu.yaw),
            (0.0, 0.0),
            "{percent} %: a straight line"
        );
    }
}

#[test]
fn it_turns_on_one_thruster_as_its_parameters_predict() {
    // Predicted with all of A22 in surge's Coriolis term: 1.90 m/s. Here the Munk factor applies to
    // that term, too, so that the inertia terms do no work; this makes a difference of 0.04 m/s.
    let nu = sail(
        &mut afloat(AT_REST),
        Order::Thrust {
            port: 1.0,
            starboard: 0.0,
        },
        100,
    )
    .nu;
    within("surge", nu.surge, 1.90, 0.025);
    within("yaw rate, degrees", nu.yaw.to_degrees(), 23.0, 0.02);
    within("radius", speed(nu) / nu.yaw, 4.7, 0.03);
    let nu = sail(
        &mut afloat(AT_REST),
        Order::Thrust {
            port: share(45.0),
            starboard: share(15.0),
        },
        100,
    )
    .nu;
    within(
        "yaw rate at 45 and 15 N, degrees",
        nu.yaw.to_degrees(),
        14.8,
        0.01,
    );
    within("radius at 45 and 15 N", speed(nu) / nu.yaw, 7.2, 0.01);
}

#[test]
fn it_spins_on_the_spot_under_opposed_thrust() {
    let nu = sail(
        &mut afloat(AT_REST),
        Order::Thrust {
            port: share(30.0),
            starboard: share(-30.0),
        },
        100,
    )
    .nu;
    within("yaw rate, degrees", nu.yaw.to_degrees(), 22.0, 0.01);
    assert!(speed(nu) < 1e-9, "{nu:?}");
}

#[test]
fn it_coasts_as_the_closed_form_says() {
    // (m + A11) u' = −(6 + 13 u) u from 2 to 0.2 m/s takes 9.57 s and (58.1 / 13) ln(32 / 8.6) =
    // 5.87 m; the distance to rest is (58.1 / 13) ln(32 / 6) = 7.48 m.
    let mut world = afloat((2.0, 0.0, 0.0));
    let start = world.state().boats[0].pose.at;
    let mut ticks = 0;
    let mut boat = world.state().boats[0];
    while boat.nu.surge > 0.2 && ticks < 1_000 {
        world.step(&[Order::Hold; 2]);
        (ticks, boat) = (ticks + 1, world.state().boats[0]);
    }
    within("time, s", f64::from(ticks) * 0.05, 9.57, 0.01);
    within("way, m", boat.pose.at.distance(start), 5.87, 0.01);
    let boat = sail(&mut world, Order::Hold, 200);
    within(
        "distance to rest, m",
        boat.pose.at.distance(start),
        7.48,
        0.01,
    );
}
