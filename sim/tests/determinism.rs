//! Equal seeds and orders give equal bytes; invalid bytes and numbers are rejected.

mod common;

use common::{alone, digest, order, place_boat, shipped};
use messages::Order;
use messages::order::BadOrder;
use primitives::{Pose, VehicleId};
use rules::Event;
use rules::event::{EventCursor, Logged};
use scenario::{Scenario, StartPosition};
use sim::{Contest, RestoreError, World};

/// Plays a decision with lively orders that depend only on time and vehicle.
fn play(contest: &mut Contest) {
    contest.pictures();
    let middle = contest.scenario().field.middle();
    let phase = contest.world().state().tick / 300;
    for i in 0..contest.scenario().vehicles.len() {
        let at = contest.world().state().boats[i].pose.at;
        let given = match (i as u64 + phase) % 5 {
            0 => Order::Thrust {
                port: 0.9,
                starboard: 0.4,
            },
            1 => Order::Hold,
            2 => Order::Steer {
                heading_rad: i as f64 * 0.7 - 3.0,
                speed_m_s: 2.0,
            },
            _ => Order::Steer {
                heading_rad: at.bearing_rad(middle),
                speed_m_s: 3.0,
            },
        };
        order(contest, VehicleId::at(i), given);
    }
    contest.advance();
}

/// Plays several decisions. Returns how often boats came together.
fn sail(contest: &mut Contest, decisions: u32) -> usize {
    let mut cursor = EventCursor::default();
    cursor.read(contest.events());
    (0..decisions).for_each(|_| play(contest));
    let collided = |logged: &&Logged| matches!(logged.event, Event::Collided { .. });
    cursor
        .read(contest.events())
        .iter()
        .filter(collided)
        .count()
}

fn started(scenario: &Scenario, seed: u64) -> Contest {
    Contest::new(scenario, seed).unwrap_or_else(|e| panic!("{e}"))
}

/// Waves, wind, sensors and flawed thrusters, with radio links and limits on sharing.
fn hampered() -> Scenario {
    let mut scenario = shipped("pav01_afloat.toml");
    common::hamper(&mut scenario);
    scenario
}

#[test]
fn a_game_goes_on_from_a_snapshot_as_if_it_had_never_stopped() {
    let mut games = vec![
        (shipped("swarm_20v20.toml"), 30, true),
        (shipped("harbour_2v2.toml"), 30, true),
        (hampered(), 30, false),
    ];
    for sea in [
        "fresh_breeze.toml",
        "bay_gale.toml",
        "river.toml",
        "tidal.toml",
        "eddies.toml",
        "any.toml",
    ] {
        games.push((common::on_sea("pav01_afloat.toml", sea.as_ref()), 10, false));
    }
    for (scenario, legs, meet) in &games {
        let name = format!("{}, {}", scenario.name, scenario.sea.name);
        let mut contest = started(scenario, 3);
        let mut collisions = 0;
        for leg in 0..*legs {
            // In every other round, take the snapshot in the middle of a decision, after the
            // pictures.
            if leg % 2 == 1 {
                contest.pictures();
            }
            let bytes = contest.snapshot();
            let mut other = started(scenario, 3);
            sail(&mut other, leg + 25);
            other.restore(&bytes).unwrap();
            assert!(
                other.snapshot() == bytes,
                "{name}, leg {leg}: not the restored state"
            );
            assert_eq!(
                other.last_pictures(),
                contest.last_pictures(),
                "{name}, leg {leg}"
            );
            for vehicle in (0..scenario.vehicles.len()).map(VehicleId::at) {
                assert_eq!(
                    other.world().truth(vehicle),
                    contest.world().truth(vehicle),
                    "{name}, leg {leg}"
                );
            }
            collisions += sail(&mut contest, 49);
            sail(&mut other, 49);
            assert_eq!(other.pictures(), contest.pictures(), "{name}, leg {leg}");
            assert!(
                contest.snapshot() == other.snapshot(),
                "{name}, leg {leg}: different snapshots"
            );
            assert_eq!(contest.outcome(), other.outcome(), "{name}, leg {leg}");
        }
        assert!(!meet || collisions > 0, "{name}: no boats met");
    }
}

#[test]
fn a_game_goes_on_from_a_snapshot_taken_while_hulls_touch() {
    let mut world = World::of_game(&alone("surveyor_m1_8", "calm"), 1).unwrap();
    place_boat(&mut world, 0, (100.0, 100.0, 90.0), (2.0, 0.0, 0.0));
    place_boat(&mut world, 1, (103.0, 100.3, 250.0), (2.0, 0.0, 0.0));
    let ahead = [Order::Thrust {
        port: 1.0,
        starboard: 0.9,
    }; 2];
    for tick in 0..100 {
        let mut on = world.clone();
        let mut other = world.clone();
        let bytes = postcard::to_stdvec(world.state()).unwrap();
        other.set_state(postcard::from_bytes(&bytes).unwrap());
        for world in [&mut on, &mut other] {
            common::sail(world, &ahead, 10);
        }
        assert!(digest(&on) == digest(&other), "from tick {tick} on");
        world.step(&ahead);
    }
}

#[test]
fn bytes_that_are_no_snapshot_of_this_game_change_nothing() {
    let scenario = shipped("pav01_vs_pav01.toml");
    let mut contest = started(&scenario, 1);
    sail(&mut contest, 25);
    let good = contest.snapshot();
    let mut refuse = |bytes: &[u8], want: &[RestoreError], what: &str| {
        let error = contest.restore(bytes).expect_err(what);
        assert!(want.contains(&error), "{what}: {error}");
        assert!(
            contest.snapshot() == good,
            "{what}: the contest has changed"
        );
    };
    use RestoreError::{Damaged, NotASnapshot, OtherScenario};
    for cut in 0..good.len() {
        refuse(
            &good[..cut],
            &[NotASnapshot, Damaged],
            &format!("cut at {cut}"),
        );
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
    refuse(
        &[good.clone(), vec![0]].concat(),
        &[Damaged],
        "one byte too many",
    );
    refuse(
        &started(&scenario, 2).snapshot(),
        &[OtherScenario],
        "from another seed",
    );
    let other = Scenario {
        order_ttl_s: 7.0,
        ..scenario
    };
    refuse(
        &started(&other, 1).snapshot(),
        &[OtherScenario],
        "from another scenario",
    );
}

#[test]
fn an_order_with_bad_numbers_is_refused_and_the_boat_holds() {
    let bad = [
        (
            Order::Steer {
                heading_rad: f64::NAN,
                speed_m_s: 1.0,
            },
            BadOrder::NotFinite,
        ),
        (
            Order::Steer {
                heading_rad: 0.0,
                speed_m_s: f64::INFINITY,
            },
            BadOrder::NotFinite,
        ),
        (
            Order::Steer {
                heading_rad: 0.0,
                speed_m_s: -1.0,
            },
            BadOrder::OutOfRange,
        ),
        (
            Order::Thrust {
                port: f64::NAN,
                starboard: 0.0,
            },
            BadOrder::NotFinite,
        ),
        (
            Order::Thrust {
                port: 0.0,
                starboard: 1.5,
            },
            BadOrder::OutOfRange,
        ),
    ];
    for (bad, why) in bad {
        let play = |given: Order, want: Result<(), BadOrder>| {
            let mut contest = started(&alone("heron", "calm"), 1);
            contest.keep_inputs();
            common::set_in(&mut contest, |state| {
                state.boats[0].nu = sim::hull::Planar {
                    surge: 1.0,
                    sway: 0.1,
                    yaw: 0.1,
                };
            });
            for _ in 0..25 {
                assert_eq!(
                    contest.order(VehicleId(0), given, contest.now()),
                    want,
                    "{given:?}"
                );
                contest.advance();
            }
            (contest.snapshot(), contest.take_inputs())
        };
        assert!(play(bad, Err(why)) == play(Order::Hold, Ok(())), "{bad:?}");
    }
}

#[test]
fn a_boat_with_bad_numbers_is_removed_and_the_others_continue() {
    let mut scenario = shipped("pav01_vs_pav01.toml");
    let victim = VehicleId(1);
    let flag = primitives::FlagId(1);
    let pose = Pose {
        at: scenario.field.flags[1].start,
        psi_rad: 0.0,
    };
    scenario.vehicles[1].start_position = StartPosition::At(pose);
    let mut contest = started(&scenario, 1);
    let sail = |contest: &mut Contest| {
        for vehicle in (0..4).map(VehicleId::at) {
            order(
                contest,
                vehicle,
                Order::Thrust {
                    port: 0.5,
                    starboard: 0.5,
                },
            );
        }
        contest.advance();
    };
    sail(&mut contest);
    let mut healthy = started(&scenario, 1);
    healthy.restore(&contest.snapshot()).unwrap();

    common::set_in(&mut contest, |state| state.boats[1].nu.yaw = 1e200);
    for _ in 0..100 {
        sail(&mut contest);
        sail(&mut healthy);
    }
    let of_victim = contest
        .events()
        .iter()
        .map(|logged| logged.event)
        .filter(|event| event.vehicle() == Some(victim));
    let want = [
        Event::Grabbed {
            vehicle: victim,
            flag,
        },
        Event::Quarantined(victim),
        Event::FlagReturned {
            vehicle: victim,
            flag,
        },
    ];
    assert_eq!(of_victim.collect::<Vec<_>>(), want);
    let boat = contest.world().state().boats[1];
    assert!(
        boat.quarantined && boat.nu == sim::hull::Planar::default() && boat.pose.at.is_finite(),
        "{boat:?}"
    );
    for i in [0, 2, 3] {
        let [one, other] = [&contest, &healthy].map(|contest| contest.world().state().boats[i]);
        assert_eq!(one, other, "boat {i} is not affected");
    }
}

#[test]
fn a_quarantined_boat_is_something_to_bump_into() {
    let scenario = alone("surveyor_m1_8", "calm");
    let mut world = World::of_game(&scenario, 1).unwrap();
    place_boat(&mut world, 0, (100.0, 100.0, 90.0), (2.0, 0.0, 0.0));
    place_boat(
        &mut world,
        1,
        (106.0, 100.0, 0.0),
        (f64::INFINITY, 0.0, 0.0),
    );
    for _ in 0..200 {
        world.step(&[
            Order::Steer {
                heading_rad: std::f64::consts::FRAC_PI_2,
                speed_m_s: 2.0,
            },
            Order::Hold,
        ]);
        assert!(common::gap_m(&world, &scenario, 0, 1) > -0.02);
    }
    assert_eq!(
        world.state().boats[1].pose.at,
        primitives::Ned::from_xy(106.0, 100.0)
    );
    assert!(world.state().boats[0].pose.at.east < 106.0);
}

#[test]
fn boats_start_inside_of_their_areas_and_apart() {
    let scenario = shipped("swarm_20v20.toml");
    let mut seen = Vec::new();
    for seed in 1..=20 {
        let world = World::of_game(&scenario, seed).unwrap();
        let boats = &world.state().boats;
        for (i, (boat, vehicle)) in boats.iter().zip(&scenario.vehicles).enumerate() {
            let StartPosition::Somewhere {
                along_m,
                across_m,
                gap_m,
            } = vehicle.start_position
            else {
                panic!("{}", vehicle.name)
            };
            let corner = scenario
                .field
                .seen_from(vehicle.team, along_m.0, across_m.0);
            let opposite = scenario
                .field
                .seen_from(vehicle.team, along_m.1, across_m.1);
            let between = |x: f64, a: f64, b: f64| (a.min(b)..=a.max(b)).contains(&x);
            let inside = between(boat.pose.at.north, corner.north, opposite.north)
                && between(boat.pose.at.east, corner.east, opposite.east);
            assert!(
                inside,
                "seed {seed}: {} starts at {:?}",
                vehicle.name, boat.pose.at
            );
            let apart = boats[..i]
                .iter()
                .all(|other| other.pose.at.distance(boat.pose.at) >= gap_m);
            assert!(
                apart,
                "seed {seed}: {} starts too near another boat",
                vehicle.name
            );
        }
        seen.push(digest(&world));
    }
    seen.sort();
    seen.dedup();
    assert_eq!(seen.len(), 20, "every seed gives a different start");
}

#[test]
fn a_full_area_says_which_boat_has_no_start_position() {
    let mut scenario = shipped("swarm_20v20.toml");
    for vehicle in &mut scenario.vehicles {
        if let StartPosition::Somewhere { gap_m, .. } = &mut vehicle.start_position {
            *gap_m = 30.0;
        }
    }
    let error = World::of_game(&scenario, 1)
        .err()
        .expect("twenty boats 30 m apart do not fit");
    let sim::NoStart::SpawnError(error) = error else {
        panic!("{error}")
    };
    assert!(
        scenario
            .vehicles
            .iter()
            .any(|vehicle| vehicle.name == error.vehicle),
        "{error}"
    );
    assert!(
        error.to_string().contains(&error.vehicle) && error.to_string().contains("gap_m"),
        "{error}"
    );
}
