//! Contact of hulls with boats, obstacles and walls.

mod common;

use common::{
    afloat, among, came_together, digest, energy_joule, gap_m, hulls, place_boat, shipped,
};
use messages::Order;
use primitives::Ned;
use primitives::stream::Stream;
use rules::field::Obstacle;
use scenario::Scenario;
use sim::World;

const BOATS: [&str; 3] = ["heron", "otter", "surveyor_m1_8"];
/// Maximum penetration of hulls, m: about a hundredth of a boat's beam.
const DEEPEST_M: f64 = 0.02;
const AHEAD: Order = Order::Thrust {
    port: 1.0,
    starboard: 1.0,
};

/// Runs the world; returns the smallest gap between the first two boats, m.
fn sail(world: &mut World, scenario: &Scenario, orders: [Order; 2], ticks: u32) -> f64 {
    let mut least_m = f64::INFINITY;
    for _ in 0..ticks {
        world.step(&orders);
        least_m = least_m.min(gap_m(world, scenario, 0, 1));
    }
    least_m
}

#[test]
fn boats_that_meet_head_on_stop_each_other() {
    for boat in BOATS {
        let scenario = among(boat, Vec::new());
        let mut world = afloat(&scenario, 1, (100.0, 100.0, 90.0), (2.0, 0.0, 0.0));
        place_boat(&mut world, 1, (110.0, 100.0, 270.0), (2.0, 0.0, 0.0));
        let least_m = sail(&mut world, &scenario, [AHEAD; 2], 200);
        assert!(
            (-DEEPEST_M..0.05).contains(&least_m),
            "{boat}: hulls come as near as {least_m} m"
        );
        let [first, second] = [0, 1].map(|i| world.state().boats[i].pose.at.east);
        assert!(
            first < second,
            "{boat}: the boats passed through each other: {first} {second}"
        );
    }
}

#[test]
fn a_boat_that_rams_anothers_side_pushes_it_away() {
    for boat in BOATS {
        let scenario = among(boat, Vec::new());
        let mut world = afloat(&scenario, 1, (100.0, 100.0, 90.0), (2.0, 0.0, 0.0));
        place_boat(&mut world, 1, (106.0, 100.0, 0.0), (0.0, 0.0, 0.0));
        let least_m = sail(&mut world, &scenario, [AHEAD, Order::Hold], 120);
        assert!(
            (-DEEPEST_M..0.05).contains(&least_m),
            "{boat}: hulls come as near as {least_m} m"
        );
        let rammed = world.state().boats[1].pose.at;
        assert!(
            rammed.east > 106.2,
            "{boat}: not pushed away, at {}",
            rammed.east
        );
        assert!(
            world.state().boats[0].pose.at.east < rammed.east,
            "{boat}: passed through the other boat"
        );
    }
}

/// Places two boats at random, one aimed roughly at the other.
fn collision_course(world: &mut World, seed: u64) {
    let mut stream = Stream::new(seed, "collision");
    let bearing_deg = stream.between(0.0, 360.0);
    let distance_m = stream.between(2.5, 3.5);
    let (sin, cos) = primitives::math::sin_cos_deg(bearing_deg);
    let aim_deg = bearing_deg + 180.0 + stream.between(-15.0, 15.0);
    let mut nu = |ahead: f64, across: f64, turn: f64| {
        (
            stream.between(ahead, ahead + 2.0),
            stream.between(-across, across),
            stream.between(-turn, turn),
        )
    };
    let rammer = nu(1.5, 0.5, 0.3);
    let rammed = nu(-1.0, 1.0, 1.0);
    let heading_deg = stream.between(0.0, 360.0);
    place_boat(
        world,
        0,
        (100.0 + distance_m * sin, 100.0 + distance_m * cos, aim_deg),
        rammer,
    );
    place_boat(world, 1, (100.0, 100.0, heading_deg), rammed);
}

#[test]
fn no_collision_makes_energy() {
    for boat in BOATS {
        let scenario = among(boat, Vec::new());
        let start = World::of_game(&scenario, 1).unwrap();
        let hulls = hulls(&scenario);
        let mut met = 0;
        for seed in 0..400 {
            let mut world = start.clone();
            collision_course(&mut world, seed);
            let mut touched = false;
            for tick in 0..160 {
                let before_joule = energy_joule(&world, &hulls);
                world.step(&[Order::Hold; 2]);
                let after_joule = energy_joule(&world, &hulls);
                assert!(
                    after_joule <= before_joule * (1.0 + 1e-12),
                    "{boat}, seed {seed}, tick {tick}: {before_joule} J became {after_joule} J"
                );
                let gap_m = gap_m(&world, &scenario, 0, 1);
                assert!(
                    gap_m > -0.1,
                    "{boat}, seed {seed}, tick {tick}: the hulls are {gap_m} m apart"
                );
                touched |= gap_m < 0.01;
            }
            met += u32::from(touched);
        }
        assert!(met > 200, "{boat}: only {met} of 400 met");
    }
}

/// Drives the boat for half a minute. Returns the deepest penetration of its capsule into the
/// obstacle's outline (m), and its position.
fn run_into(obstacle: &Obstacle, start: (f64, f64, f64)) -> (f64, Ned) {
    let scenario = among("surveyor_m1_8", vec![obstacle.clone()]);
    let mut world = afloat(&scenario, 1, start, (2.5, 0.0, 0.0));
    let mut least_m = f64::INFINITY;
    for _ in 0..600 {
        // The front seat keeps the boat on its initial heading.
        let heading_rad = primitives::angle::rad_from_compass_deg(start.2);
        world.step(&[
            Order::Steer {
                heading_rad,
                speed_m_s: 2.5,
            },
            Order::Hold,
        ]);
        least_m = least_m.min(outline_gap_m(&world, &scenario, obstacle));
    }
    (least_m, world.state().boats[0].pose.at)
}

fn outline_gap_m(world: &World, scenario: &Scenario, obstacle: &Obstacle) -> f64 {
    let (keel, radius_m) = common::capsule(world, scenario, 0);
    let distance_m = match obstacle {
        Obstacle::Circle { centre, radius_m } => common::point_m(*centre, keel) - radius_m,
        Obstacle::Polygon { corners } => {
            let side = |i: usize| (corners[i], corners[(i + 1) % corners.len()]);
            (0..corners.len())
                .map(|i| common::keels_m(keel, side(i)))
                .fold(f64::INFINITY, f64::min)
        }
    };
    distance_m - radius_m
}

#[test]
fn a_boat_stops_at_a_dolphin() {
    let dolphin = Obstacle::Circle {
        centre: Ned::from_xy(100.0, 100.0),
        radius_m: 1.5,
    };
    let (least_m, at) = run_into(&dolphin, (80.0, 100.0, 90.0));
    assert!((-DEEPEST_M..0.05).contains(&least_m), "{least_m} m");
    assert!(at.east < 98.0, "at {at:?}");
}

#[test]
fn a_boat_stops_in_the_bay_of_a_mole() {
    // A U open to the west, with a bay 6 m wide and 10 m deep.
    let corners = [
        (100.0, 95.0),
        (112.0, 95.0),
        (112.0, 105.0),
        (100.0, 105.0),
        (100.0, 103.0),
        (110.0, 103.0),
    ];
    let corners = corners
        .into_iter()
        .chain([(110.0, 97.0), (100.0, 97.0)])
        .map(|(x, y)| Ned::from_xy(x, y));
    let mole = Obstacle::Polygon {
        corners: corners.collect(),
    };
    // A boat may enter the bay up to its end. It must not penetrate the end of an arm, the back or
    // a side.
    for (start, east_m, north_m) in [
        ((90.0, 100.0, 90.0), (108.9, 109.2), (97.0, 103.0)),
        ((90.0, 104.0, 90.0), (98.0, 130.0), (103.0, 130.0)),
        ((125.0, 100.0, 270.0), (112.8, 113.3), (90.0, 110.0)),
        ((106.0, 80.0, 0.0), (100.0, 112.0), (93.9, 94.2)),
    ] {
        let (least_m, at) = run_into(&mole, start);
        assert!(
            (-DEEPEST_M..0.05).contains(&least_m),
            "from {start:?}: {least_m} m"
        );
        let inside =
            (east_m.0..east_m.1).contains(&at.east) && (north_m.0..north_m.1).contains(&at.north);
        assert!(inside, "from {start:?} to {at:?}");
    }
}

#[test]
fn boats_stay_inside_of_walls() {
    let scenario = shipped("harbour_2v2.toml");
    for (heading_deg, turn) in [
        (0.0, 0.02),
        (90.0, -0.02),
        (180.0, 0.0),
        (270.0, 0.05),
        (45.0, 0.0),
        (225.0, 0.0),
    ] {
        let mut world = World::of_game(&scenario, 1).unwrap();
        let heading_rad = primitives::angle::rad_from_compass_deg(heading_deg);
        for tick in 0..4_000 {
            let order = Order::Thrust {
                port: 1.0 - turn,
                starboard: 1.0,
            };
            let steer = Order::Steer {
                heading_rad,
                speed_m_s: 3.0,
            };
            world.step(&[steer, order, steer, order]);
            for (i, boat) in world.state().boats.iter().enumerate() {
                assert!(
                    scenario.field.contains(boat.pose.at),
                    "{heading_deg}: boat {i} is out at tick {tick}"
                );
                assert!(!boat.quarantined);
            }
        }
    }
}

/// Boats in a dense crowd: each steers for the middle of the fleet or past it.
fn crowd(world: &World, orders: &mut Vec<Order>) {
    let boats = &world.state().boats;
    let sum = boats
        .iter()
        .fold(Ned::default(), |sum, boat| sum + boat.pose.at);
    let middle = sum.scaled(1.0 / boats.len() as f64);
    let minute = world.state().tick / 400;
    orders.clear();
    orders.extend(boats.iter().enumerate().map(|(i, boat)| {
        let past = if (i as u64 + minute).is_multiple_of(3) {
            1.5
        } else {
            0.1
        };
        Order::Steer {
            heading_rad: boat.pose.at.bearing_rad(middle) + past,
            speed_m_s: 2.5,
        }
    }));
}

#[test]
fn asking_rapier_only_about_close_hulls_changes_no_byte() {
    let crowded = |scenario: &mut Scenario| {
        for vehicle in &mut scenario.vehicles {
            if let scenario::StartPosition::Somewhere {
                along_m,
                across_m,
                gap_m,
            } = &mut vehicle.start_position
            {
                (*along_m, *across_m, *gap_m) = ((60.0, 75.0), (25.0, 55.0), 3.0);
            }
        }
    };
    for (game, ticks) in [("swarm_20v20.toml", 1_200), ("harbour_2v2.toml", 4_000)] {
        let mut scenario = shipped(game);
        crowded(&mut scenario);
        let mut world = World::of_game(&scenario, 7).unwrap();
        let mut all = world.clone();
        all.widen_contact(1_000.0);
        let mut orders = Vec::new();
        let mut touching = Vec::new();
        let mut collisions = 0;
        for tick in 0..ticks {
            crowd(&world, &mut orders);
            world.step(&orders);
            all.step(&orders);
            collisions += came_together(&world, &scenario, &mut touching);
            assert!(
                digest(&world) == digest(&all),
                "{game}: different from tick {tick} on"
            );
        }
        assert!(
            collisions > 3,
            "{game}: only {collisions} boats came together"
        );
    }
}

#[test]
fn mirrored_orders_make_a_mirrored_course() {
    for boat in BOATS {
        let scenario = among(boat, Vec::new());
        // The mirror line is the meridian of the datum, so that mirrored numbers are exact.
        let mut world = afloat(&scenario, 1, (20.0, 100.0, 30.0), (1.0, 0.3, -0.2));
        place_boat(&mut world, 1, (-20.0, 100.0, -30.0), (1.0, -0.3, 0.2));
        let mut stream = Stream::new(1, "orders");
        let mut orders = [Order::Hold; 2];
        for tick in 0..800 {
            if tick % 40 == 0 {
                let a = stream.between(-1.0, 1.0);
                let b = stream.between(-1.0, 1.0);
                let steer = |side: f64| Order::Steer {
                    heading_rad: side * 0.5 * a,
                    speed_m_s: 2.0 * b.abs(),
                };
                orders = if tick % 80 == 0 {
                    [
                        Order::Thrust {
                            port: a,
                            starboard: b,
                        },
                        Order::Thrust {
                            port: b,
                            starboard: a,
                        },
                    ]
                } else {
                    [steer(1.0), steer(-1.0)]
                };
            }
            world.step(&orders);
            let [one, two] = [0, 1].map(|i| world.state().boats[i]);
            let image = (two.pose.at.north, -two.pose.at.east, -two.pose.psi_rad);
            assert_eq!(
                (one.pose.at.north, one.pose.at.east, one.pose.psi_rad),
                image,
                "{boat}, tick {tick}"
            );
            let image = (two.nu.surge, -two.nu.sway, -two.nu.yaw);
            assert_eq!(
                (one.nu.surge, one.nu.sway, one.nu.yaw),
                image,
                "{boat}, tick {tick}"
            );
            assert_eq!(
                (one.port, one.starboard),
                (two.starboard, two.port),
                "{boat}, tick {tick}"
            );
        }
    }
}
