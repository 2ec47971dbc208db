//! The front seat: how well the shipped boats follow course and speed orders.

mod common;

use common::alone;
use messages::Order;
use primitives::angle::wrap_pi;
use sim::World;

/// Boats at cruising speed and at top speed, m/s.
const BOATS: [(&str, f64); 6] = [
    ("heron", 1.5),
    ("heron", 2.0),
    ("otter", 2.0),
    ("otter", 3.0),
    ("surveyor_m1_8", 2.0),
    ("surveyor_m1_8", 3.0),
];

fn afloat(boat: &str) -> World {
    common::afloat(
        &alone(boat, "calm_salt"),
        1,
        (100.0, 100.0, 0.0),
        (0.0, 0.0, 0.0),
    )
}

fn steer(
    world: &mut World,
    heading_deg: f64,
    speed_m_s: f64,
    seconds: u32,
    mut look: impl FnMut(&sim::BoatState),
) {
    for _ in 0..seconds * 20 {
        world.step(&[
            Order::Steer {
                heading_rad: heading_deg.to_radians(),
                speed_m_s,
            },
            Order::Hold,
        ]);
        look(&world.state().boats[0]);
    }
}

#[test]
fn a_right_turn_at_speed_settles_without_much_overshoot() {
    for (boat, speed_m_s) in BOATS {
        let mut world = afloat(boat);
        steer(&mut world, 0.0, speed_m_s, 60, |_| ());
        let mut farthest_rad = 0.0_f64;
        steer(&mut world, 90.0, speed_m_s, 60, |boat| {
            farthest_rad = farthest_rad.max(boat.pose.psi_rad)
        });
        let over_deg = farthest_rad.to_degrees() - 90.0;
        assert!(
            over_deg < 0.15 * 90.0,
            "{boat} overshoots by {over_deg} degrees"
        );
        let mut off_rad = 0.0_f64;
        steer(&mut world, 90.0, speed_m_s, 20, |boat| {
            off_rad = off_rad.max(wrap_pi(boat.pose.psi_rad - 90_f64.to_radians()).abs());
        });
        assert!(
            off_rad.to_degrees() < 3.0,
            "{boat} keeps an error of {} degrees",
            off_rad.to_degrees()
        );
    }
}

#[test]
fn a_change_of_speed_settles_at_the_speed_ordered() {
    for (boat, speed_m_s) in BOATS {
        let mut world = afloat(boat);
        for wanted_m_s in [speed_m_s, 0.5 * speed_m_s, speed_m_s] {
            steer(&mut world, 0.0, wanted_m_s, 60, |_| ());
            let mut least = f64::INFINITY;
            let mut most = 0.0_f64;
            steer(&mut world, 0.0, wanted_m_s, 20, |boat| {
                (least, most) = (least.min(boat.nu.surge), most.max(boat.nu.surge));
            });
            assert!(
                least > 0.98 * wanted_m_s && most < 1.02 * wanted_m_s,
                "{boat}: {least} to {most} m/s, want {wanted_m_s} m/s"
            );
        }
    }
}
