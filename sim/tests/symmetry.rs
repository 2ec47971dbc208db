//! Invariances: orientation of north, port and starboard, uniform motion of the water, and
//! disturbances of size zero.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

use common::{afloat, digest, surveyor_on};
use messages::Order;
use primitives::math::sin_cos;
use primitives::{Ned, Pose};
use rules::Field;
use rules::field::Plan;
use scenario::Scenario;
use scenario::sea::{Eddy, Gusts, RandomEddies, Sea, Shear, Spreading, Tide, Wander, Waves, Wind};

fn waves(hs_m: f64) -> Waves {
    common::waves(hs_m, 2.5, 0.4)
}

fn wind(speed_10m_m_s: f64) -> Wind {
    let gusts = Gusts::OrnsteinUhlenbeck {
        intensity: 0.15,
        across_ratio: 0.75,
        length_m: 40.0,
    };
    Wind {
        speed_10m_m_s,
        from_rad: -0.9,
        profile_exponent: 0.12,
        gusts,
    }
}

fn turned(v: Ned, by_rad: f64) -> Ned {
    let (sin, cos) = sin_cos(by_rad);
    Ned {
        north: v.north * cos - v.east * sin,
        east: v.north * sin + v.east * cos,
    }
}

/// The scenario rotated clockwise by `by_rad` about the datum.
fn with_all_turned(mut scenario: Scenario, by_rad: f64) -> Scenario {
    let sea = &mut scenario.sea;
    for from_rad in [
        &mut sea.waves.as_mut().unwrap().from_rad,
        &mut sea.wind.as_mut().unwrap().from_rad,
    ] {
        *from_rad += by_rad;
    }
    let current = &mut sea.current;
    let shear = current.shear.as_mut().unwrap();
    let tide = current.tide.as_mut().unwrap();
    let wander = current.wander.as_mut().unwrap();
    let eddy = &mut current.eddies[0];
    let vectors = [
        &mut current.mean_m_s,
        &mut shear.toward,
        &mut shear.across,
        &mut shear.origin,
        &mut tide.flood_m_s,
    ];
    for vector in vectors
        .into_iter()
        .chain([&mut wander.toward, &mut eddy.centre])
    {
        *vector = turned(*vector, by_rad);
    }
    let plan = &scenario.field.plan;
    let corner = turned(plan.corner, by_rad);
    let along_deg = plan.along_deg + by_rad.to_degrees();
    scenario.field = Field::new(Plan {
        corner,
        along_deg,
        ..plan.clone()
    });
    scenario
}

/// Adds all effects of a sea.
fn everything(sea: &mut Sea) {
    (sea.waves, sea.wind) = (Some(waves(0.3)), Some(wind(8.0)));
    sea.current.mean_m_s = Ned {
        north: 0.2,
        east: 0.1,
    };
    sea.current.tide = Some(Tide {
        flood_m_s: Ned {
            north: -0.1,
            east: 0.3,
        },
        period_s: 300.0,
        phase: 0.1,
    });
    let toward = Ned::toward_deg(30.0);
    sea.current.shear = Some(Shear {
        toward,
        across: Ned::toward_deg(120.0),
        per_s: 0.002,
        origin: Ned {
            north: 180.0,
            east: 280.0,
        },
    });
    sea.current.wander = Some(Wander {
        toward,
        sigma_m_s: 0.1,
        time_s: 60.0,
        speed_m_s: (-1.0, 1.0),
    });
    sea.current.eddies = vec![Eddy {
        centre: Ned {
            north: 215.0,
            east: 320.0,
        },
        radius_m: 20.0,
        peak_m_s: 0.3,
    }];
}

/// A boat's position, heading and velocity after each tick, starting from north 200 and east 300 on
/// a heading of 20°, in a world rotated by `by_rad` and rotated back.
fn track(scenario: &Scenario, order_of: impl Fn(f64) -> Order, by_rad: f64) -> Vec<[f64; 6]> {
    let start = turned(
        Ned {
            north: 200.0,
            east: 300.0,
        },
        by_rad,
    );
    let start = (start.east, start.north, 20.0 + by_rad.to_degrees());
    let mut world = afloat(scenario, 3, start, (1.0, 0.2, 0.1));
    let step = |_| {
        world.step(&[order_of(by_rad), Order::Hold]);
        let boat = world.state().boats[0];
        let Pose { at, psi_rad } = boat.pose;
        let at = turned(at, -by_rad);
        [
            at.north,
            at.east,
            primitives::angle::wrap_pi(psi_rad - by_rad),
            boat.nu.surge,
            boat.nu.sway,
            boat.nu.yaw,
        ]
    };
    (0..1_200).map(step).collect()
}

#[test]
fn it_does_not_matter_where_north_is() {
    // The heading table has an entry every 5°. Rotated by a multiple of that, a boat finds the same
    // numbers in single precision; otherwise it finds different numbers between the entries, with
    // an error of a fraction of a per cent.
    let scenario = surveyor_on(everything);
    let steer = |by_rad: f64| Order::Steer {
        heading_rad: primitives::angle::wrap_pi(0.6 + by_rad),
        speed_m_s: 1.5,
    };
    let thrust = |_| Order::Thrust {
        port: 0.6,
        starboard: 0.55,
    };
    let mut farthest_m = 0.0_f64;
    for by_deg in [90.0, 35.0, 180.0, -115.0, 2.5, 47.3, 181.7] {
        let by_rad = f64::to_radians(by_deg);
        let other = with_all_turned(scenario.clone(), by_rad);
        let within_m = if by_deg % 5.0 == 0.0 { 1e-4 } else { 0.05 };
        for order_of in [&steer as &dyn Fn(f64) -> Order, &thrust] {
            let here = track(&scenario, order_of, 0.0);
            let there = track(&other, order_of, by_rad);
            let off_m = here
                .iter()
                .zip(&there)
                .map(|(a, b)| primitives::math::length(a[0] - b[0], a[1] - b[1]))
                .fold(0.0, f64::max);
            assert!(off_m < within_m, "{by_deg}°: {off_m} m off after a minute");
            farthest_m = farthest_m.max(here[1199][0] - 200.0);
        }
    }
    assert!(farthest_m > 30.0, "the boats move only {farthest_m} m");
}

#[test]
fn it_does_not_matter_which_side_is_port() {
    // The scene is mirrored at the meridian of the datum: east, heading, sway and yaw change sign.
    // Exact without waves; with them in single precision, because a heading and its mirror image
    // lie between different entries of the table. Waves come from a single direction, because
    // spread directions are drawn at random and not mirrored.
    let sail = |side: f64, has_waves: bool| {
        let mut scenario = surveyor_on(|sea| {
            sea.current.mean_m_s = Ned {
                north: 0.2,
                east: side * 0.3,
            };
            sea.current.tide = Some(Tide {
                flood_m_s: Ned {
                    north: -0.1,
                    east: side * 0.1,
                },
                period_s: 60.0,
                phase: 0.1,
            });
            sea.current.eddies = vec![Eddy {
                centre: Ned {
                    north: 230.0,
                    east: side * 15.0,
                },
                radius_m: 20.0,
                peak_m_s: side * 0.3,
            }];
            let gusts = Gusts::OrnsteinUhlenbeck {
                intensity: 0.15,
                across_ratio: 0.0,
                length_m: 40.0,
            };
            sea.wind = Some(Wind {
                speed_10m_m_s: 8.0,
                from_rad: side * 0.9,
                profile_exponent: 0.12,
                gusts,
            });
            sea.waves = has_waves.then(|| Waves {
                from_rad: side * 0.7,
                spreading: Spreading::None,
                ..waves(0.3)
            });
        });
        scenario.field.plan.obstacles.clear();
        let mut world = afloat(
            &scenario,
            1,
            (0.0, 200.0, side * 20.0),
            (1.0, side * 0.2, side * 0.1),
        );
        let (port, starboard) = if side > 0.0 { (0.9, 0.3) } else { (0.3, 0.9) };
        let step = |_| {
            world.step(&[Order::Thrust { port, starboard }, Order::Hold]);
            let boat = world.state().boats[0];
            let Pose { at, psi_rad } = boat.pose;
            let nu = boat.nu;
            [
                at.north,
                side * at.east,
                side * psi_rad,
                nu.surge,
                side * nu.sway,
                side * nu.yaw,
            ]
        };
        (0..1_200).map(step).collect::<Vec<_>>()
    };
    for (tick, (a, b)) in sail(1.0, false).iter().zip(&sail(-1.0, false)).enumerate() {
        assert_eq!(
            a.map(f64::to_bits),
            b.map(f64::to_bits),
            "tick {tick}: {a:?} {b:?}"
        );
    }
    for (tick, (a, b)) in sail(1.0, true).iter().zip(&sail(-1.0, true)).enumerate() {
        let off = a
            .iter()
            .zip(b)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        // Rounding to single precision, 1e-10 per tick, grows a millionfold in a minute as
        // neighbouring tracks separate.
        let within = if tick < 300 { 2e-6 } else { 0.01 };
        assert!(off < within, "tick {tick}: {a:?} {b:?}");
    }
}

#[test]
fn a_uniform_current_carries_everything_along_and_changes_nothing_else() {
    // Thrust is imposed, because the front seat steers by motion over the ground, which a current
    // changes.
    let current = Ned {
        north: 0.35,
        east: -0.2,
    };
    let orders = [
        Order::Thrust {
            port: 0.8,
            starboard: 0.5,
        },
        Order::Hold,
    ];
    let at_rest = surveyor_on(|_| ());
    let streaming = surveyor_on(|sea| sea.current.mean_m_s = current);
    // The same velocity through the water; over the ground the current is added, as seen from the
    // boat at 0°.
    let mut carried = afloat(
        &streaming,
        1,
        (200.0, 200.0, 0.0),
        (1.0 + current.north, current.east, 0.1),
    );
    let mut still = afloat(&at_rest, 1, (200.0, 200.0, 0.0), (1.0, 0.0, 0.1));
    for tick in 1..=12_000 {
        still.step(&orders);
        carried.step(&orders);
        let a = still.state().boats[0].pose;
        let b = carried.state().boats[0].pose;
        let off_m = (b.at - current.scaled(f64::from(tick) * 0.05)).distance(a.at);
        let off_rad = primitives::angle::wrap_pi(a.psi_rad - b.psi_rad).abs();
        // The state stores the velocity over the ground, so every tick adds and subtracts the
        // current, which rounds: headings agree to rounding, not to the last bit.
        assert!(
            off_m < 1e-10 && off_rad < 1e-12,
            "tick {tick}: {off_m} m, {off_rad} rad"
        );
    }
}

/// A name, and a change of the sea.
type Change = (&'static str, fn(&mut Sea));

const NOTHINGS: [Change; 9] = [
    ("waves of zero height", |sea| sea.waves = Some(waves(0.0))),
    ("one wave of zero height", |sea| {
        sea.waves = Some(Waves {
            components: 1,
            ..waves(0.0)
        })
    }),
    ("wind of zero speed", |sea| {
        sea.wind = Some(Wind {
            gusts: Gusts::None,
            ..wind(0.0)
        })
    }),
    ("gusts of zero wind", |sea| sea.wind = Some(wind(0.0))),
    ("a tide of zero strength", |sea| {
        sea.current.tide = Some(Tide {
            flood_m_s: Ned::default(),
            period_s: 300.0,
            phase: 0.3,
        });
    }),
    ("a shear of zero strength", |sea| {
        let toward = Ned::toward_deg(30.0);
        let across = Ned::toward_deg(120.0);
        sea.current.shear = Some(Shear {
            toward,
            across,
            per_s: 0.0,
            origin: Ned {
                north: 10.0,
                east: 20.0,
            },
        });
    }),
    ("a wander of zero size", |sea| {
        let toward = Ned::toward_deg(30.0);
        sea.current.wander = Some(Wander {
            toward,
            sigma_m_s: 0.0,
            time_s: 100.0,
            speed_m_s: (-1.0, 1.0),
        });
    }),
    ("an eddy of zero strength", |sea| {
        sea.current.eddies = vec![Eddy {
            centre: Ned {
                north: 210.0,
                east: 190.0,
            },
            radius_m: 20.0,
            peak_m_s: 0.0,
        }];
    }),
    ("random eddies of zero strength", |sea| {
        sea.current.random_eddies = Some(RandomEddies {
            count: 5,
            radius_m: (10.0, 40.0),
            peak_m_s: (0.0, 0.0),
        });
    }),
];

/// The digests of a game's state, tick by tick, on the changed sea.
fn digests(change: impl FnOnce(&mut Sea)) -> Vec<u128> {
    let mut world = afloat(
        &surveyor_on(change),
        1,
        (200.0, 200.0, 40.0),
        (1.0, 0.2, -0.1),
    );
    let orders = [
        Order::Steer {
            heading_rad: 2.0,
            speed_m_s: 2.0,
        },
        Order::Thrust {
            port: 0.7,
            starboard: 0.2,
        },
    ];
    let step = |_| {
        world.step(&orders);
        digest(&world)
    };
    (0..1_000).map(step).collect()
}

#[test]
fn a_disturbance_of_no_size_is_none_to_the_last_bit_in_calm_and_in_a_rough_sea() {
    // Zero wind rather than still air, which would resist a moving boat.
    let rough = |sea: &mut Sea| {
        sea.waves = Some(waves(0.3));
        sea.current.mean_m_s = Ned {
            north: 0.2,
            east: 0.1,
        };
    };
    let calm = |_: &mut Sea| ();
    // Waves of zero height would replace those of the rough sea.
    for (name, base, changes) in [
        ("calm", calm as fn(&mut Sea), &NOTHINGS[..]),
        ("rough", rough as fn(&mut Sea), &NOTHINGS[2..]),
    ] {
        let want = digests(base);
        for (what, change) in changes {
            let got = digests(|sea| {
                base(sea);
                change(sea);
            });
            assert!(got == want, "with {what}, different from {name}");
        }
    }
    assert_ne!(
        digests(|sea| sea.wind = Some(wind(0.001))),
        digests(calm),
        "a light wind must change the digest"
    );
}
