//! The sea and the boats together: what must hold of every world, against closed forms and symmetry.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use common::{alone, put, scenarios};
use game::sea::{Current, Gusts, Sea, Spreading, Waves, Wind};
use game::{Ned, Order, Pose, Scenario};
use sim::World;
use sim::sea::WaveField;

const DRIFTING: [Order; 2] = [Order::Hold; 2];

fn sea(file: &str) -> Sea {
    game::scenario::load_sea(&scenarios().join("seas").join(file)).unwrap_or_else(|e| panic!("{e}"))
}

fn waves(hs_m: f64, tp_s: f64) -> Waves {
    Waves {
        hs_m,
        tp_s,
        gamma: 3.3,
        from_rad: 0.0,
        spreading: Spreading::CosineSquared,
        components: 64,
        drift_factor: 1.0,
    }
}

fn steady(speed_10m_m_s: f64, from_deg: f64) -> Wind {
    Wind { speed_10m_m_s, from_rad: from_deg.to_radians(), profile_exponent: 0.0, gusts: Gusts::None }
}

/// The Surveyor on this water, two of them far apart.
fn on(change: impl FnOnce(&mut Sea)) -> Scenario {
    let mut scenario = alone("surveyor_m1_8", "calm");
    change(&mut scenario.sea);
    scenario
}

fn run(world: &mut World, orders: &[Order], seconds: f64) {
    for _ in 0..(seconds / 0.05).round() as u64 {
        world.step(orders);
    }
}

#[test]
fn a_uniform_current_carries_everything_along_and_changes_nothing_else() {
    let current = Ned { north: 0.35, east: -0.2 };
    let steer = [Order::Steer { heading_rad: 1.0, speed_m_s: 1.5 }, Order::Hold];
    for orders in [[Order::Thrust { port: 0.8, starboard: 0.5 }, Order::Hold], steer] {
        let mut still = World::new(&on(|_| ()), 1).unwrap();
        let mut carried = World::new(&on(|sea| sea.current.mean_m_s = current), 1).unwrap();
        // The same velocity through the water: over the ground it is that and the current, seen from the boat at 0°.
        put(&mut carried, 0, (200.0, 200.0, 0.0), (1.0 + current.north, current.east, 0.1));
        put(&mut still, 0, (200.0, 200.0, 0.0), (1.0, 0.0, 0.1));
        // The front seat steers by speed over the ground; only imposed thrust is the same through the water.
        let is_imposed = matches!(orders[0], Order::Thrust { .. });
        for tick in 1..=1_200 {
            still.step(&orders);
            carried.step(&orders);
            let (a, b) = (still.state().boats[0].pose, carried.state().boats[0].pose);
            let off = (b.at - current.scaled(f64::from(tick) * 0.05)).distance(a.at);
            if is_imposed {
                assert!(off < 1e-6 && (a.psi_rad - b.psi_rad).abs() < 1e-9, "tick {tick}: {off} m, {a:?} {b:?}");
            }
        }
    }
}

#[test]
fn without_thrust_a_boat_ends_up_going_with_the_current_whatever_its_heading() {
    for heading_deg in [0.0, 37.0, 90.0, 200.0] {
        let mut world = World::new(&on(|sea| sea.current.mean_m_s = Ned { north: 0.3, east: 0.4 }), 1).unwrap();
        put(&mut world, 0, (300.0, 200.0, heading_deg), (0.0, 0.0, 0.0));
        run(&mut world, &DRIFTING, 240.0);
        let before = world.state().boats[0].pose.at;
        world.step(&DRIFTING);
        let velocity = (world.state().boats[0].pose.at - before).scaled(20.0);
        assert!(velocity.distance(Ned { north: 0.3, east: 0.4 }) < 1e-6, "{heading_deg}: {velocity:?}");
    }
}

#[test]
fn wind_abeam_drifts_a_boat_at_the_speed_at_which_air_and_water_balance() {
    // ½ρ_a C_y A_L (W − V)² = Y_v V + ½ρ C_d L T V², by bisection.
    let scenario = alone("surveyor_m1_8", "calm");
    let boat = &scenario.boats[0];
    for wind_m_s in [5.0, 10.0] {
        let excess = |v: f64| {
            let air = 0.5 * 1.225 * boat.windage.sway_coefficient * boat.windage.lateral_area_m2;
            let water = 0.5 * 1000.0 * boat.hull.crossflow_coefficient * boat.hull.crossflow_length_m;
            let relative = wind_m_s - v;
            air * relative * relative - boat.hull.sway_linear_kg_s * v - water * boat.hull.crossflow_draught_m * v * v
        };
        let (mut low, mut high) = (0.0, wind_m_s);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if excess(middle) > 0.0 { low = middle } else { high = middle }
        }
        let mut world = World::new(&on(|sea| sea.wind = Some(steady(wind_m_s, 0.0))), 1).unwrap();
        // Beam on is an equilibrium of heading, if not a stable one: from there it stays there for a while.
        put(&mut world, 0, (200.0, 300.0, 90.0), (0.0, low, 0.0));
        run(&mut world, &DRIFTING, 5.0);
        let nu = world.state().boats[0].nu;
        assert!((nu.sway - low).abs() < 0.01 * low, "{wind_m_s} m/s: {} against {low}", nu.sway);
        // Published estimates for this boat: 2.6 % of 5 m/s and 3.4 % of 10 m/s.
        assert!((0.02..0.04).contains(&(low / wind_m_s)), "{}", low / wind_m_s);
    }
}

#[test]
fn a_mirrored_boat_on_a_mirrored_sea_does_the_mirrored_thing_to_the_last_bit() {
    // Mirrored in the line north-south through the middle of the boat: east, heading, sway and yaw change sign.
    let mirrored = |side: f64| {
        let mut scenario = on(|sea| {
            sea.current.mean_m_s = Ned { north: 0.2, east: side * 0.3 };
            sea.wind = Some(steady(8.0, side * 50.0));
        });
        scenario.field.plan.obstacles.clear();
        let mut world = World::new(&scenario, 1).unwrap();
        put(&mut world, 0, (0.0, 200.0, side * 20.0), (1.0, side * 0.2, side * 0.1));
        let (port, starboard) = if side > 0.0 { (0.9, 0.3) } else { (0.3, 0.9) };
        let mut path = vec![];
        for _ in 0..400 {
            world.step(&[Order::Thrust { port, starboard }, Order::Hold]);
            let boat = world.state().boats[0];
            let Pose { at, psi_rad } = boat.pose;
            path.push([
                at.north,
                side * at.east,
                side * psi_rad,
                boat.nu.surge,
                side * boat.nu.sway,
                side * boat.nu.yaw,
            ]);
        }
        path
    };
    let (right, left) = (mirrored(1.0), mirrored(-1.0));
    for (tick, (a, b)) in right.iter().zip(&left).enumerate() {
        assert_eq!(a.map(f64::to_bits), b.map(f64::to_bits), "tick {tick}: {a:?} {b:?}");
    }
}

#[test]
fn a_sea_of_no_size_is_no_sea_to_the_last_bit() {
    let nothing = on(|sea| {
        sea.waves = Some(waves(0.0, 2.0));
        sea.wind = Some(Wind {
            gusts: Gusts::OrnsteinUhlenbeck { intensity: 0.2, across_ratio: 0.7, length_m: 40.0 },
            ..steady(0.0, 30.0)
        });
        sea.current.wander = Some(game::sea::Wander {
            toward: Ned { north: 1.0, east: 0.0 },
            sigma_m_s: 0.0,
            time_s: 100.0,
            speed_m_s: (-1.0, 1.0),
        });
    });
    let (mut still, mut other) = (World::new(&on(|_| ()), 1).unwrap(), World::new(&nothing, 1).unwrap());
    let orders = [Order::Steer { heading_rad: 2.0, speed_m_s: 2.0 }, Order::Thrust { port: 0.7, starboard: 0.2 }];
    // Air at rest still resists a boat under way: take the windage away.
    let mut calm = nothing.clone();
    calm.sea.wind = None;
    let mut other_calm = World::new(&calm, 1).unwrap();
    for tick in 0..1_000 {
        still.step(&orders);
        other.step(&orders);
        other_calm.step(&orders);
        assert_eq!(still.state().boats, other_calm.state().boats, "tick {tick}");
    }
    let drag = still.state().boats[0].pose.at.distance(other.state().boats[0].pose.at);
    assert!(drag > 0.0 && drag < 1.0, "air at rest slows a boat a little: {drag} m in 50 s");
}

#[test]
fn energy_does_not_grow_without_input_in_a_moving_water_seen_from_it() {
    let scenario = on(|sea| sea.current.mean_m_s = Ned { north: 0.3, east: 0.1 });
    let hull = &common::hulls(&scenario)[0];
    let mut world = World::new(&scenario, 1).unwrap();
    put(&mut world, 0, (200.0, 200.0, 70.0), (2.0, -0.5, 0.6));
    let relative = |world: &World| {
        let boat = world.state().boats[0];
        let turn = game::math::sin_cos(boat.pose.psi_rad);
        let water = game::frame::body_from_ned(turn, Ned { north: 0.3, east: 0.1 });
        sim::hull::Planar { surge: boat.nu.surge - water.ahead, sway: boat.nu.sway - water.starboard, yaw: boat.nu.yaw }
    };
    let mut before = hull.energy_joule(relative(&world));
    for tick in 0..2_000 {
        world.step(&DRIFTING);
        let now = hull.energy_joule(relative(&world));
        assert!(now <= before, "tick {tick}: {before} -> {now}");
        before = now;
    }
}

#[test]
fn a_drifter_in_waves_goes_to_and_fro_and_hardly_anywhere() {
    // Without drift force and Stokes drift the first-order motion has no mean.
    let scenario = on(|sea| sea.waves = Some(Waves { drift_factor: 0.0, ..waves(0.3, 2.5) }));
    let mut world = World::new(&scenario, 4).unwrap();
    put(&mut world, 0, (300.0, 200.0, 20.0), (0.0, 0.0, 0.0));
    let start = world.state().boats[0].pose.at;
    let (mut sum, n) = (0.0, 12_000);
    for _ in 0..n {
        world.step(&DRIFTING);
        let nu = world.state().boats[0].nu;
        sum += nu.surge * nu.surge + nu.sway * nu.sway;
    }
    let rms = (sum / f64::from(n)).sqrt();
    let gone = world.state().boats[0].pose.at.distance(start) / 600.0;
    // The published scale: 0.18 m/s of orbital velocity averaged over the hull. Stokes drift is 0.04 m/s.
    assert!((0.08..0.3).contains(&rms), "{rms} m/s to and fro");
    assert!(gone < 0.08, "{gone} m/s on the whole");
}

#[test]
fn boats_in_waves_meet_them_at_the_frequency_of_encounter() {
    // One long-crested component from ahead, ω = 2π / 2.5 s, at a held 1.5 m/s: ω_e = ω + k U.
    let scenario = on(|sea| {
        sea.waves = Some(Waves { components: 1, spreading: Spreading::None, drift_factor: 0.0, ..waves(0.1, 2.5) });
    });
    let mut world = World::new(&scenario, 1).unwrap();
    let omega = world.sea().waves().unwrap().components().next().unwrap().omega_rad_s;
    put(&mut world, 0, (300.0, 50.0, 0.0), (1.5, 0.0, 0.0));
    let orders = [Order::Steer { heading_rad: 0.0, speed_m_s: 1.5 }, Order::Hold];
    run(&mut world, &orders, 20.0);
    let (mut crossings, mut last, mut first_at, mut last_at) = (0, 0.0, 0.0, 0.0);
    let start = world.state().boats[0].pose.at.north;
    let mut speed = 0.0;
    for tick in 0..2_000 {
        world.step(&orders);
        let boat = world.state().boats[0];
        speed = (boat.pose.at.north - start) / (f64::from(tick + 1) * 0.05);
        let pitch = world.attitude(game::VehicleId(0)).pitch_rad;
        if last < 0.0 && pitch >= 0.0 {
            let at = f64::from(tick) * 0.05 - 0.05 * pitch / (pitch - last);
            if crossings == 0 {
                first_at = at
            }
            (crossings, last_at) = (crossings + 1, at);
        }
        last = pitch;
    }
    let found = std::f64::consts::TAU * f64::from(crossings - 1) / (last_at - first_at);
    let want = omega + omega * omega / game::sea::GRAVITY_M_S2 * speed;
    assert!((found / want - 1.0).abs() < 0.01, "{found} against {want} rad/s (ω {omega}, U {speed})");
}

#[test]
fn halving_the_tick_changes_a_rough_passage_little_and_less_each_time() {
    let passage = |tick_s: f64| {
        let mut scenario = on(|sea| {
            sea.waves = Some(waves(0.3, 2.5));
            sea.wind = Some(steady(8.0, 60.0));
            sea.current = Current { mean_m_s: Ned { north: 0.1, east: 0.2 }, ..Current::default() };
        });
        scenario.tick = game::SimTime::from_s(tick_s);
        let mut world = World::new(&scenario, 2).unwrap();
        put(&mut world, 0, (300.0, 100.0, 10.0), (0.0, 0.0, 0.0));
        for _ in 0..(30.0 / tick_s).round() as u64 {
            world.step(&[Order::Thrust { port: 0.6, starboard: 0.55 }, Order::Hold]);
        }
        world.state().boats[0].pose.at
    };
    let truth = passage(0.00625);
    let errors = [0.05, 0.025, 0.0125].map(|tick_s| passage(tick_s).distance(truth));
    assert!(errors[0] < 0.3 && errors[0] > 1.6 * errors[1] && errors[1] > 1.6 * errors[2], "{errors:?}");
}

#[test]
fn a_hull_that_carries_three_times_its_mass_of_water_stays_stable_in_a_gale() {
    let mut scenario = on(|_| ());
    scenario.sea = sea("bay_gale.toml");
    scenario.boats[0].hull.added_sway_kg = 3.0 * scenario.boats[0].hull.mass_kg;
    let mut world = World::new(&scenario, 1).unwrap();
    put(&mut world, 0, (300.0, 200.0, 10.0), (0.0, 0.0, 0.0));
    for _ in 0..6_000 {
        world.step(&[Order::Steer { heading_rad: 1.0, speed_m_s: 1.0 }, Order::Hold]);
        let nu = world.state().boats[0].nu;
        assert!(nu.surge.abs() < 6.0 && nu.sway.abs() < 4.0 && nu.yaw.abs() < 4.0, "{nu:?}");
    }
}

#[test]
fn a_rough_game_goes_on_from_a_snapshot_as_if_it_had_never_stopped() {
    for file in ["fresh_breeze.toml", "bay_gale.toml", "river.toml", "tidal.toml", "eddies.toml", "any.toml"] {
        let scenario = game::scenario::load_with(
            &scenarios().join("games/pav01_afloat.toml"),
            Some(&scenarios().join("seas").join(file)),
        )
        .unwrap_or_else(|e| panic!("{e}"));
        let mut world = World::new(&scenario, 5).unwrap();
        let orders = [Order::Steer { heading_rad: 1.0, speed_m_s: 2.0 }; 4];
        for leg in 0..10_u64 {
            let bytes = world.snapshot();
            let mut other = World::new(&scenario, 5).unwrap();
            for _ in 0..10 * leg {
                other.step(&orders);
            }
            other.restore(&bytes).unwrap();
            for _ in 0..137 {
                world.step(&orders);
                other.step(&orders);
            }
            assert!(world.snapshot() == other.snapshot(), "{file}, leg {leg}");
        }
    }
}

#[test]
fn every_shipped_sea_can_be_sailed_for_a_whole_game() {
    let mut files: Vec<_> =
        std::fs::read_dir(scenarios().join("seas")).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(files.len() >= 14, "{files:?}");
    for file in files {
        let game = scenarios().join("games/pav01_afloat.toml");
        let scenario = game::scenario::load_with(&game, Some(&file)).unwrap_or_else(|e| panic!("{e}"));
        let mut world = World::new(&scenario, 1).unwrap();
        for _ in 0..12_000 {
            world.step(&[Order::Steer { heading_rad: 1.0, speed_m_s: 2.0 }; 4]);
        }
        assert!(world.state().boats.iter().all(|boat| !boat.quarantined), "{}", file.display());
        let speed =
            world.state().boats.iter().map(|boat| game::math::length(boat.nu.surge, boat.nu.sway)).fold(0.0, f64::max);
        assert!(speed < 10.0, "{}: {speed} m/s", file.display());
    }
}

#[test]
fn a_free_boat_in_a_long_swell_goes_with_stokes_drift() {
    for (hs_m, tp_s) in [(0.5, 5.0), (1.0, 6.0)] {
        let swell = Waves { drift_factor: 0.0, spreading: Spreading::None, ..waves(hs_m, tp_s) };
        let scenario = on(|sea| sea.waves = Some(swell.clone()));
        let field = WaveField::new(&swell, None, 4);
        let want = field.stokes_drift_m_s(scenario.boats[0].draught_m);
        let mut world = World::new(&scenario, 4).unwrap();
        put(&mut world, 0, (300.0, 200.0, 20.0), (0.0, 0.0, 0.0));
        let start = world.state().boats[0].pose.at;
        let minutes = 40;
        for _ in 0..20 * 60 * minutes {
            world.step(&DRIFTING);
        }
        let gone = (world.state().boats[0].pose.at - start).scaled(1.0 / f64::from(60 * minutes));
        assert!(gone.distance(want) < 0.15 * want.length(), "{hs_m} m, {tp_s} s: {gone:?} m/s, not {want:?}");
    }
}

#[test]
fn point_boats_collide_in_a_current_as_they_do_in_still_water() {
    let current = Ned { north: 0.3, east: 0.4 };
    let after = |mean_m_s: Ned| {
        let mut scenario = alone("heron_kinematic", "calm");
        scenario.sea.current.mean_m_s = mean_m_s;
        let mut world = World::new(&scenario, 1).unwrap();
        // Blue runs into red's side.
        put(&mut world, 0, (300.0, 200.0, 90.0), (0.0, 0.0, 0.0));
        put(&mut world, 1, (308.0, 200.2, 0.0), (0.0, 0.0, 0.0));
        let ahead = Order::Steer { heading_rad: std::f64::consts::FRAC_PI_2, speed_m_s: 1.5 };
        run(&mut world, &[ahead, Order::Hold], 30.0);
        [0, 1].map(|i| world.state().boats[i].pose.at - mean_m_s.scaled(30.0))
    };
    let (still, drifting) = (after(Ned::default()), after(current));
    assert!((still[0].north - 200.0).abs() > 1.0, "red was in the way: {still:?}");
    for (still, drifting) in still.into_iter().zip(drifting) {
        assert!(still.distance(drifting) < 1e-3, "{still:?}, in a current {drifting:?}");
    }
}
