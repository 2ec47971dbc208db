//! The same seed and the same orders make the same bytes; and what is done about bad bytes and bad numbers.

mod common;

use common::{alone, put, set, shipped};
use game::scenario::StartPosition;
use game::{Event, Order, Scenario, VehicleId};
use sim::{RestoreError, World};

/// Orders that make for a lively game, from nothing but the tick and the vehicle.
fn orders(world: &World) -> Vec<Order> {
    let field = world.referee().field();
    let middle = (field.corners[0] + field.corners[2]).scaled(0.5);
    let phase = world.state().tick / 300;
    let order = |(i, boat): (usize, &sim::BoatState)| match (i as u64 + phase) % 5 {
        0 => Order::Thrust { port: 0.9, starboard: 0.4 },
        1 => Order::Hold,
        2 => Order::Steer { heading_rad: i as f64 * 0.7 - 3.0, speed_m_s: 2.0 },
        _ => Order::Steer { heading_rad: boat.pose.at.bearing_rad(middle), speed_m_s: 3.0 },
    };
    world.state().boats.iter().enumerate().map(order).collect()
}

/// Sails on; how many times boats came together.
fn sail(world: &mut World, ticks: u32) -> usize {
    let collided = |event: &&Event| matches!(event, Event::Collided { .. });
    (0..ticks).map(|_| world.step(&orders(world)).iter().filter(collided).count()).sum()
}

#[test]
fn the_same_seed_makes_the_same_bytes_and_another_seed_other_ones() {
    let scenario = shipped("swarm_20v20.toml");
    let run = |seed: u64| {
        let mut world = World::new(&scenario, seed).unwrap();
        assert!(sail(&mut world, 1_500) > 0, "seed {seed}: nobody met anybody");
        (world.snapshot(), world.digest())
    };
    let (first, again, other) = (run(1), run(1), run(2));
    assert!(first == again, "one seed, two games");
    assert!(first.0 != other.0 && first.1 != other.1, "two seeds, one game");
}

#[test]
fn a_game_goes_on_from_a_snapshot_as_if_it_had_never_stopped() {
    for game in ["swarm_20v20.toml", "harbour_2v2.toml"] {
        let scenario = shipped(game);
        let mut world = World::new(&scenario, 3).unwrap();
        let mut collisions = 0;
        for leg in 0..30 {
            let bytes = world.snapshot();
            let mut other = World::new(&scenario, 3).unwrap();
            sail(&mut other, leg + 50);
            other.restore(&bytes).unwrap();
            assert!(other.snapshot() == bytes, "{game}, leg {leg}: not what was put in");
            for vehicle in (0..world.state().boats.len()).map(VehicleId::at) {
                assert_eq!(other.truth(vehicle), world.truth(vehicle), "{game}, leg {leg}");
            }
            collisions += sail(&mut world, 97);
            sail(&mut other, 97);
            assert!(world.snapshot() == other.snapshot(), "{game}, leg {leg}: they differ");
        }
        assert!(collisions > 0, "{game}: nobody met anybody");
    }
}

#[test]
fn a_game_goes_on_from_a_snapshot_taken_while_hulls_touch() {
    let mut world = World::new(&alone("surveyor_m1_8", "calm"), 1).unwrap();
    put(&mut world, 0, (100.0, 100.0, 90.0), (2.0, 0.0, 0.0));
    put(&mut world, 1, (103.0, 100.3, 250.0), (2.0, 0.0, 0.0));
    let ahead = [Order::Thrust { port: 1.0, starboard: 0.9 }; 2];
    for tick in 0..100 {
        let mut other = world.clone();
        other.restore(&world.snapshot()).unwrap();
        (0..10).for_each(|_| {
            other.step(&ahead);
        });
        let mut on = world.clone();
        (0..10).for_each(|_| {
            on.step(&ahead);
        });
        assert!(on.snapshot() == other.snapshot(), "from tick {tick} on");
        world.step(&ahead);
    }
}

#[test]
fn bytes_that_are_no_snapshot_of_this_game_change_nothing() {
    let scenario = shipped("pav01_vs_pav01.toml");
    let mut world = World::new(&scenario, 1).unwrap();
    sail(&mut world, 50);
    let good = world.snapshot();
    let mut refuse = |bytes: &[u8], want: &[RestoreError], what: &str| {
        let error = world.restore(bytes).expect_err(what);
        assert!(want.contains(&error), "{what}: {error}");
        assert!(world.snapshot() == good, "{what}: the world has changed");
    };
    use RestoreError::{Damaged, NotASnapshot, OtherScenario};
    for cut in 0..good.len() {
        refuse(&good[..cut], &[NotASnapshot, Damaged], &format!("cut at {cut}"));
    }
    for at in 0..good.len() {
        let mut bytes = good.clone();
        bytes[at] ^= 1 << (at % 8);
        let want = match at {
            0..5 => NotASnapshot,
            5..13 => OtherScenario,
            _ => Damaged,
        };
        refuse(&bytes, &[want], &format!("byte {at} changed"));
    }
    refuse(&[good.clone(), vec![0]].concat(), &[Damaged], "a byte too many");
    refuse(&World::new(&scenario, 2).unwrap().snapshot(), &[OtherScenario], "of another seed");
    let other = Scenario { order_ttl_s: 7.0, ..scenario };
    refuse(&World::new(&other, 1).unwrap().snapshot(), &[OtherScenario], "of another scenario");
}

#[test]
fn an_order_with_bad_numbers_is_an_order_to_hold() {
    let bad = [
        Order::Steer { heading_rad: f64::NAN, speed_m_s: 1.0 },
        Order::Steer { heading_rad: 0.0, speed_m_s: f64::INFINITY },
        Order::Steer { heading_rad: 0.0, speed_m_s: -1.0 },
        Order::Thrust { port: f64::NAN, starboard: 0.0 },
        Order::Thrust { port: 0.0, starboard: 1.5 },
    ];
    for order in bad {
        let mut world = World::new(&alone("heron", "calm"), 1).unwrap();
        put(&mut world, 0, (100.0, 100.0, 10.0), (1.0, 0.1, 0.1));
        let mut holding = world.clone();
        for _ in 0..50 {
            world.step(&[order, Order::Hold]);
            holding.step(&[Order::Hold; 2]);
        }
        assert!(world.snapshot() == holding.snapshot(), "{order:?}");
    }
}

#[test]
fn a_boat_whose_numbers_go_bad_is_taken_out_and_the_others_sail_on() {
    let scenario = shipped("pav01_vs_pav01.toml");
    let mut world = World::new(&scenario, 1).unwrap();
    let flag = scenario.field.flags[1].home;
    put(&mut world, 1, (flag.east, flag.north, 90.0), (0.0, 0.0, 0.0));
    let ahead = vec![Order::Thrust { port: 0.5, starboard: 0.5 }; 4];
    let grabbed = world.step(&ahead).iter().any(|event| matches!(event, Event::Grabbed { .. }));
    assert!(grabbed, "it carries a flag");
    let mut healthy = world.clone();

    set(&mut world, |state| state.boats[1].nu.yaw = 1e200);
    let victim = VehicleId(1);
    let mut events = Vec::new();
    for _ in 0..200 {
        events.extend_from_slice(world.step(&ahead));
        healthy.step(&ahead);
    }
    let flag = game::FlagId(1);
    let want = [Event::Quarantined { vehicle: victim }, Event::FlagReturned { vehicle: victim, flag }];
    let of_victim: Vec<Event> = events.into_iter().filter(|event| event.vehicle() == Some(victim)).collect();
    assert_eq!(of_victim, want);
    let boat = world.state().boats[1];
    assert!(boat.quarantined && boat.nu == sim::hull::Planar::default() && boat.pose.at.is_finite(), "{boat:?}");
    for i in [0, 2, 3] {
        assert_eq!(world.state().boats[i], healthy.state().boats[i], "boat {i} sails on as if nothing had happened");
    }
}

#[test]
fn a_quarantined_boat_is_something_to_bump_into() {
    let scenario = alone("surveyor_m1_8", "calm");
    let mut world = World::new(&scenario, 1).unwrap();
    put(&mut world, 0, (100.0, 100.0, 90.0), (2.0, 0.0, 0.0));
    put(&mut world, 1, (106.0, 100.0, 0.0), (f64::INFINITY, 0.0, 0.0));
    for _ in 0..200 {
        world.step(&[Order::Steer { heading_rad: std::f64::consts::FRAC_PI_2, speed_m_s: 2.0 }, Order::Hold]);
        assert!(common::gap_m(&world, &scenario, 0, 1) > -0.02);
    }
    assert_eq!(world.state().boats[1].pose.at, game::Ned::from_xy(106.0, 100.0));
    assert!(world.state().boats[0].pose.at.east < 106.0);
}

#[test]
fn boats_start_inside_of_their_areas_and_apart() {
    let scenario = shipped("swarm_20v20.toml");
    let mut seen = Vec::new();
    for seed in 1..=20 {
        let world = World::new(&scenario, seed).unwrap();
        let boats = &world.state().boats;
        for (i, (boat, vehicle)) in boats.iter().zip(&scenario.vehicles).enumerate() {
            let StartPosition::Somewhere { along_m, across_m, gap_m } = vehicle.start_position else {
                panic!("{}", vehicle.name)
            };
            let corner = scenario.field.seen_from(vehicle.team, along_m.0, across_m.0);
            let opposite = scenario.field.seen_from(vehicle.team, along_m.1, across_m.1);
            let between = |x: f64, a: f64, b: f64| (a.min(b)..=a.max(b)).contains(&x);
            let inside = between(boat.pose.at.north, corner.north, opposite.north)
                && between(boat.pose.at.east, corner.east, opposite.east);
            assert!(inside, "seed {seed}: {} starts at {:?}", vehicle.name, boat.pose.at);
            let apart = boats[..i].iter().all(|other| other.pose.at.distance(boat.pose.at) >= gap_m);
            assert!(apart, "seed {seed}: {} starts too near another boat", vehicle.name);
        }
        seen.push(world.snapshot());
    }
    seen.sort();
    seen.dedup();
    assert_eq!(seen.len(), 20, "every seed is another start");
}

#[test]
fn a_full_area_says_which_boat_has_no_berth() {
    let mut scenario = shipped("swarm_20v20.toml");
    for vehicle in &mut scenario.vehicles {
        if let StartPosition::Somewhere { gap_m, .. } = &mut vehicle.start_position {
            *gap_m = 30.0;
        }
    }
    let error = World::new(&scenario, 1).err().expect("no room for twenty boats 30 m apart");
    let sim::NoStart::SpawnError(error) = error else { panic!("{error}") };
    assert!(scenario.vehicles.iter().any(|vehicle| vehicle.name == error.vehicle), "{error}");
    assert!(error.to_string().contains(&error.vehicle) && error.to_string().contains("gap_m"), "{error}");
}
