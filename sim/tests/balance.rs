//! Balances of force and energy: a boat drifting in the wind, and the effect of thrust and
//! resistance on its energy.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use common::{afloat, alone};
use messages::Order;
use primitives::angle::wrap_pi;
use primitives::frame::body_from_ned;
use primitives::{Ned, SimTime};
use scenario::Scenario;
use scenario::sea::{Gusts, Wind};
use sim::World;
use sim::hull::Planar;

fn blowing(speed_10m_m_s: f64) -> Wind {
    Wind {
        speed_10m_m_s,
        from_rad: 0.0,
        profile_exponent: 0.0,
        gusts: Gusts::None,
    }
}

/// The speed at which a boat drifts beam to the wind:
/// ½ρ_a C_y A_L (W − V)² = Y_v V + ½ρ C_d L T V².
fn beam_drift_m_s(scenario: &Scenario, wind_m_s: f64) -> f64 {
    let boat = &scenario.boats[0];
    let water_kg_m3 = scenario.sea.water_density_kg_m3;
    let air = 0.5 * 1.225 * boat.windage.sway_coefficient * boat.windage.lateral_area_m2;
    let hull = &boat.hull;
    let water = 0.5
        * water_kg_m3
        * hull.crossflow_coefficient
        * hull.crossflow_length_m
        * hull.crossflow_draught_m;
    common::root((0.0, wind_m_s), |v| {
        water * v * v + hull.sway_linear_kg_s * v - air * (wind_m_s - v) * (wind_m_s - v)
    })
}

/// A boat from this file after `minutes` in this wind from the north, without thrust, starting from
/// rest on a given heading.
fn left_to_the_wind(kind: &str, wind_m_s: f64, heading_deg: f64, minutes: u32) -> (f64, Planar) {
    let mut scenario = alone(kind, "calm");
    scenario.sea.wind = Some(blowing(wind_m_s));
    let mut world = afloat(&scenario, 1, (400.0, 200.0, heading_deg), (0.0, 0.0, 0.0));
    common::sail(&mut world, &[Order::Hold; 2], minutes * 1_200);
    let boat = world.state().boats[0];
    (boat.pose.psi_rad.to_degrees(), boat.nu)
}

#[test]
fn a_free_boat_comes_to_lie_beam_to_the_wind_and_drifts_as_the_balance_says() {
    // Equilibria of the moment: wind ahead, abeam, astern. The wind pushes the bow away, and as the
    // boat drifts obliquely, the water's Munk moment turns it across its path. Abeam is therefore
    // stable; ahead and astern are not.
    for kind in ["surveyor_m1_8", "otter", "heron"] {
        for wind_m_s in [5.0, 10.0] {
            let drift_m_s = beam_drift_m_s(&alone(kind, "calm"), wind_m_s);
            for heading_deg in [
                1.0, 30.0, 60.0, 90.0, 120.0, 150.0, 179.0, 181.0, 230.0, 270.0, 310.0, 359.0,
            ] {
                let (end_deg, nu) = left_to_the_wind(kind, wind_m_s, heading_deg, 30);
                let side = if heading_deg < 180.0 { 1.0 } else { -1.0 };
                let what = format!(
                    "{kind}, {wind_m_s} m/s, from {heading_deg}°: {end_deg}°, {nu:?}, not {drift_m_s}"
                );
                assert!((end_deg - side * 90.0).abs() < 0.01, "{what}");
                assert!(
                    (nu.sway - side * drift_m_s).abs() < 1e-5 * drift_m_s,
                    "{what}"
                );
                assert!(
                    nu.surge.abs() < 1e-4 * drift_m_s && nu.yaw.abs() < 1e-6,
                    "{what}"
                );
            }
        }
    }
}

#[test]
fn wind_right_ahead_or_astern_holds_a_boat_only_until_something_turns_it() {
    for heading_deg in [0.0, 180.0] {
        let (end_deg, nu) = left_to_the_wind("surveyor_m1_8", 10.0, heading_deg, 1);
        assert!(
            wrap_pi((end_deg - heading_deg).to_radians()).abs() < 1e-9 && nu.surge.abs() > 0.1,
            "{end_deg} {nu:?}"
        );
        let (end_deg, _) = left_to_the_wind("surveyor_m1_8", 10.0, heading_deg + 0.01, 1);
        assert!(
            wrap_pi((end_deg - heading_deg).to_radians())
                .to_degrees()
                .abs()
                > 0.1,
            "from {heading_deg}.01°: {end_deg}°"
        );
    }
}

/// A boat under imposed thrust, with its energy balance.
struct Accounts {
    scenario: Scenario,
    world: World,
    order: Order,
}

impl Accounts {
    /// A boat from this file at rest in this water, with this current.
    fn of(kind: &str, tick_s: f64, current_m_s: Ned, order: Order) -> Accounts {
        let mut scenario = alone(kind, "calm_salt");
        scenario.sea.current.mean_m_s = current_m_s;
        scenario.tick = SimTime::from_s(tick_s);
        let world = World::of_game(&scenario, 1).unwrap();
        Accounts {
            scenario,
            world,
            order,
        }
    }

    fn step(&mut self) {
        self.world.step(&[self.order, Order::Hold]);
    }

    fn through_water(&self) -> Planar {
        let boat = self.world.state().boats[0];
        let water = body_from_ned(boat.pose.rotation(), self.scenario.sea.current.mean_m_s);
        Planar {
            surge: boat.nu.surge - water.ahead,
            sway: boat.nu.sway - water.starboard,
            yaw: boat.nu.yaw,
        }
    }

    fn energy_joule(&self) -> f64 {
        common::hulls(&self.scenario)[0].energy_joule(self.through_water())
    }

    /// Power from the thrusters, and power lost to resistance, strip by strip, W.
    fn powers_watt(&self) -> (f64, f64) {
        let boat = self.world.state().boats[0];
        let kind = &self.scenario.boats[0];
        let Planar {
            surge: u,
            sway: v,
            yaw: r,
        } = self.through_water();
        let hull = &kind.hull;
        let scenario::boat::Drive::Thrusters { thruster, .. } = &kind.drive else {
            panic!("expected thrusters")
        };
        let port = boat.port.newton;
        let starboard = boat.starboard.newton;
        let given = (port + starboard) * u + thruster.arm_m * (port - starboard) * r;
        let plain = (hull.surge_linear_kg_s + hull.surge_quadratic_kg_m * u.abs()) * u * u
            + (hull.sway_linear_kg_s + hull.sway_lift_kg_m * u.abs()) * v * v
            + (hull.yaw_linear_kg_m2_s
                + hull.yaw_quadratic_kg_m2 * r.abs()
                + hull.yaw_lift_kg_m * u.abs())
                * r
                * r;
        let strips = 200;
        let step_m = hull.crossflow_length_m / f64::from(strips);
        let strip = |i: i32| {
            let across = v + r * (step_m * (f64::from(i) + 0.5) - 0.5 * hull.crossflow_length_m);
            across.abs() * across * across * step_m
        };
        let water = 0.5
            * self.scenario.sea.water_density_kg_m3
            * hull.crossflow_coefficient
            * hull.crossflow_draught_m;
        (given, plain + water * (0..strips).map(strip).sum::<f64>())
    }
}

const ORDERS: [Order; 3] = [
    Order::Thrust {
        port: 0.7,
        starboard: 0.7,
    },
    Order::Thrust {
        port: 0.9,
        starboard: 0.4,
    },
    Order::Thrust {
        port: 0.5,
        starboard: -0.6,
    },
];

#[test]
fn the_energy_changes_by_what_thrust_puts_in_and_resistance_takes_out() {
    // The boat starts from rest and later gets a second order, in still water and in a current,
    // where motion through the water counts. Integrals by Simpson's rule over pairs of ticks, which
    // are short because shafts respond quickly. The Surveyor's Munk factor is not 1.
    const TICK_S: f64 = 0.005;
    let stream = Ned {
        north: 0.3,
        east: -0.4,
    };
    for (kind, current) in [
        ("otter", Ned::default()),
        ("otter", stream),
        ("surveyor_m1_8", stream),
        ("heron", stream),
    ] {
        for order in ORDERS {
            let mut boat = Accounts::of(kind, TICK_S, current, order);
            let start_joule = boat.energy_joule();
            let mut put_in = 0.0;
            let mut taken_out = 0.0;
            for pair in 0..2_000 {
                if pair == 1_000 {
                    boat.order = Order::Thrust {
                        port: -0.3,
                        starboard: 0.8,
                    };
                }
                let mut powers = [boat.powers_watt(); 3];
                for power in &mut powers[1..] {
                    boat.step();
                    *power = boat.powers_watt();
                }
                let over_pair = |[a, b, c]: [f64; 3]| TICK_S / 3.0 * (a + 4.0 * b + c);
                put_in += over_pair(powers.map(|p| p.0));
                taken_out += over_pair(powers.map(|p| p.1));
                let gained = boat.energy_joule() - start_joule;
                let off = (gained - (put_in - taken_out)).abs() / taken_out.max(1.0);
                assert!(
                    off < 1e-4,
                    "{kind}, {order:?}, {pair}: {gained} J, {put_in} J in, {taken_out} J out"
                );
            }
        }
    }
}

#[test]
fn at_a_steady_speed_thrust_puts_in_what_resistance_takes_out() {
    for kind in ["otter", "surveyor_m1_8", "heron"] {
        for order in ORDERS {
            let mut boat = Accounts::of(
                kind,
                0.05,
                Ned {
                    north: 0.3,
                    east: -0.4,
                },
                order,
            );
            for _ in 0..6_000 {
                boat.step();
            }
            let (given, taken) = boat.powers_watt();
            assert!(
                (given / taken - 1.0).abs() < 2e-5 && given > 1.0,
                "{kind}, {order:?}: {given} W in, {taken} W out"
            );
        }
    }
}
