//! Sensors compared with their specification, and perfect sensors with the truth.

#[path = "../common/mod.rs"]
mod common;
mod gps;

use common::{assert_memory, five_errors, mean_of};
use messages::Order;
use primitives::frame::{Body, Pose, Rotation, body_from_ned, ned_from_body};
use primitives::{Ned, SimTime, VehicleId, math};
use scenario::sea::GRAVITY_M_S2;
use scenario::sensor::{Compass, Gps, Imu, Jump, Outage, Sensors};
use sim::World;
use sim::hull::Planar;
use sim::sea::Attitude;
use sim::sensor::imu::ImuReading;
use sim::sensor::{Reading, SensorModel, SensorState, Truth};
use std::f64::consts::{FRAC_PI_2, PI};

const TICK: SimTime = SimTime(50_000_000);

/// A receiver that takes an exact fix five times a second.
fn exact_gps() -> Gps {
    Gps {
        bias_m: 0.0,
        bias_time_s: 60.0,
        noise_m: 0.0,
        velocity_noise_m_s: 0.0,
        period_s: 0.2,
        latency_s: 0.0,
        dropout: Outage::default(),
        freeze: Outage::default(),
        jump: Jump::default(),
    }
}

const EXACT_COMPASS: Compass = Compass {
    deviation_rad: [0.0; 5],
    thrust_error_rad: 0.0,
    noise_rad: 0.0,
    period_s: 0.1,
    declination_error_rad: 0.0,
};

fn with_gps(gps: Gps) -> Sensors {
    Sensors {
        gps: Some(gps),
        ..Sensors::default()
    }
}

fn with_compass(compass: Compass) -> Sensors {
    Sensors {
        compass: Some(compass),
        ..Sensors::default()
    }
}

/// A boat moving at 2 m/s ahead and 0.5 m/s to starboard with its bow 30° east of north.
fn sailing(now: SimTime) -> Truth {
    let psi_rad = PI / 6.0;
    let velocity = ned_from_body(
        Rotation::from_heading(psi_rad),
        Body {
            ahead: 2.0,
            starboard: 0.5,
        },
    );
    Truth {
        pose: Pose {
            at: velocity.scaled(now.as_s()),
            psi_rad,
        },
        nu: Planar {
            surge: 2.0,
            sway: 0.5,
            yaw: 0.0,
        },
        ..Truth::default()
    }
}

/// The readings of one boat, tick by tick.
fn record(
    sensors: &Sensors,
    seed: u64,
    ticks: i64,
    truth: impl Fn(SimTime) -> Truth,
) -> Vec<(SimTime, Reading)> {
    let model = SensorModel::new(sensors, TICK, &seed.into(), "blue_one", &[]);
    let mut state = SensorState::default();
    (0..ticks)
        .map(|i| (TICK * i, model.read(&mut state, &truth(TICK * i), TICK * i)))
        .collect()
}

/// The readings of one boat with this receiver, fix by fix.
fn gps_record(
    gps: Gps,
    seed: u64,
    fixes: i64,
    truth: impl Fn(SimTime) -> Truth,
) -> Vec<(SimTime, Reading)> {
    record(&with_gps(gps), seed, 4 * fixes, truth)
        .into_iter()
        .step_by(4)
        .collect()
}

fn at_rest(_now: SimTime) -> Truth {
    Truth::default()
}

/// All faults at once.
fn faulty() -> Sensors {
    Sensors {
        gps: Some(Gps {
            bias_m: 1.0,
            noise_m: 0.1,
            velocity_noise_m_s: 0.07,
            latency_s: 0.55,
            dropout: Outage {
                rate_per_s: 0.05,
                mean_s: 3.0,
            },
            freeze: Outage {
                rate_per_s: 0.05,
                mean_s: 4.0,
            },
            jump: Jump {
                rate_per_s: 0.1,
                sigma_m: 6.0,
            },
            ..exact_gps()
        }),
        compass: Some(Compass {
            noise_rad: 0.02,
            thrust_error_rad: 0.05,
            ..EXACT_COMPASS
        }),
        imu: Some(Imu {
            gyro_noise_rad_s: 1e-3,
            gyro_bias_rad_s: 5e-4,
            bias_time_s: 300.0,
            accelerometer_noise_m_s2: 0.03,
            accelerometer_bias_m_s2: 0.02,
        }),
    }
}

#[test]
fn perfect_sensors_tell_the_truth_bit_for_bit() {
    for i in 0..200_u32 {
        let x = f64::from(i);
        let truth = Truth {
            pose: Pose {
                at: Ned::from_xy(0.1 * x, 7.7 - x / 3.0),
                psi_rad: 0.0173 * x - 1.0,
            },
            nu: Planar {
                surge: 0.3 * x,
                sway: -0.011 * x,
                yaw: 0.7 - 0.013 * x,
            },
            attitude: Attitude {
                roll_rad: 0.01 * x,
                ..Attitude::default()
            },
            ..Truth::default()
        };
        let now = TICK * i64::from(i);
        let model = SensorModel::new(&Sensors::default(), TICK, &1.into(), "blue_one", &[]);
        let mut state = SensorState::default();
        let Reading { nav, fix_at, imu } = model.read(&mut state, &truth, now);
        for (got, want) in [
            (nav.north_m, truth.pose.at.north),
            (nav.east_m, truth.pose.at.east),
            (nav.psi_rad, truth.pose.psi_rad),
            (nav.surge_m_s, truth.nu.surge),
            (nav.sway_m_s, truth.nu.sway),
            (nav.yaw_rate_rad_s, truth.nu.yaw),
        ] {
            assert_eq!(got.to_bits(), want.to_bits());
        }
        assert_eq!((fix_at, imu), (now, ImuReading::of(&truth)));
        assert_eq!(
            state,
            SensorState::default(),
            "perfect sensors have no state"
        );
    }
}

#[test]
fn a_compass_deviates_by_its_curve_and_no_more() {
    let [a, b, c, d, e] = [0.02, 0.05, -0.03, 0.011, 0.007];
    let compass = Compass {
        deviation_rad: [a, b, c, d, e],
        thrust_error_rad: 0.06,
        declination_error_rad: -0.21,
        ..EXACT_COMPASS
    };
    let sensors = with_compass(compass);
    for i in -180..=180_i32 {
        let psi_rad = f64::from(i).to_radians();
        let thrust_share = 0.5;
        let truth = Truth {
            pose: Pose {
                at: Ned::default(),
                psi_rad,
            },
            thrust_share,
            ..Truth::default()
        };
        let reading = record(&sensors, 1, 1, |_| truth)[0].1;
        let (sin, cos) = math::sin_cos(psi_rad);
        let (sin_2, cos_2) = math::sin_cos(2.0 * psi_rad);
        let want = psi_rad + 0.21 - (a + b * sin + c * cos + d * sin_2 + e * cos_2) + 0.03;
        let off = primitives::angle::wrap_pi(reading.nav.psi_rad - want);
        assert!(
            off.abs() < 1e-12,
            "heading {i}°: {} not {want}",
            reading.nav.psi_rad
        );
        assert!(reading.nav.psi_rad.abs() <= PI);
    }
}

#[test]
fn a_compass_is_read_every_period_with_white_noise() {
    let turning = |now: SimTime| Truth {
        pose: Pose {
            at: Ned::default(),
            psi_rad: 0.1 * now.as_s(),
        },
        ..Truth::default()
    };
    for (now, reading) in record(&with_compass(EXACT_COMPASS), 1, 100, turning) {
        let taken = TICK * (now.0 / TICK.0 / 2 * 2);
        assert_eq!(reading.nav.psi_rad, turning(taken).pose.psi_rad);
    }
    let noisy = record(
        &with_compass(Compass {
            noise_rad: 0.02,
            ..EXACT_COMPASS
        }),
        1,
        400_000,
        at_rest,
    );
    let error: Vec<f64> = noisy
        .iter()
        .step_by(2)
        .map(|(_, reading)| reading.nav.psi_rad)
        .collect();
    let n = error.len();
    let sigma = mean_of(n, |i| error[i] * error[i]).sqrt();
    assert!((sigma / 0.02 - 1.0).abs() < 0.01, "{sigma}");
    assert!(
        mean_of(n - 1, |i| error[i] * error[i + 1]).abs() / (sigma * sigma) < 0.012,
        "white"
    );
    assert!(mean_of(n, |i| error[i]).abs() < 5.0 * sigma / (n as f64).sqrt());
}

#[test]
fn at_rest_a_gyro_reads_its_bias_and_noise_and_an_accelerometer_the_water_s_push() {
    const TICKS: usize = 1_500_000;
    let imu = Imu {
        gyro_noise_rad_s: 2e-3,
        gyro_bias_rad_s: 1e-3,
        bias_time_s: 5.0,
        accelerometer_noise_m_s2: 0.04,
        accelerometer_bias_m_s2: 0.03,
    };
    let read = record(
        &Sensors {
            imu: Some(imu),
            ..Sensors::default()
        },
        6,
        TICKS as i64,
        at_rest,
    );
    let within = five_errors(TICKS, 0.05 / 5.0);
    let columns: Vec<(Vec<f64>, f64, f64)> = (0..6)
        .map(|axis| {
            let rest = if axis == 5 { -GRAVITY_M_S2 } else { 0.0 };
            let value = |reading: &Reading| match axis {
                0..3 => reading.imu.gyro_rad_s[axis],
                _ => reading.imu.accelerometer_m_s2[axis - 3] - rest,
            };
            let (noise, bias) = if axis < 3 { (2e-3, 1e-3) } else { (0.04, 0.03) };
            (
                read.iter().map(|(_, reading)| value(reading)).collect(),
                noise,
                bias,
            )
        })
        .collect();
    for (axis, (x, noise, bias)) in columns.iter().enumerate() {
        // Noise is white, so any correlation between neighbours is bias.
        for lag in [0, 1, 50, 100, 200] {
            let got = mean_of(TICKS - lag, |i| x[i] * x[i + lag]);
            let white = if lag == 0 { noise * noise } else { 0.0 };
            let want = white + bias * bias * math::exp(-(lag as f64) * 0.05 / 5.0);
            let off = (got - want).abs() / (bias * bias);
            assert!(off < within, "axis {axis}, lag {lag}: {got}, want {want}");
        }
        assert!(
            mean_of(TICKS, |i| x[i]).abs() / bias < within,
            "axis {axis}: mean"
        );
        for (other, _, other_bias) in &columns[..axis] {
            let shared = mean_of(TICKS, |i| x[i] * other[i]) / (bias * other_bias);
            assert!(shared.abs() < within, "axis {axis} and another: {shared}");
        }
    }
    assert_eq!(read[77].1.nav.yaw_rate_rad_s, read[77].1.imu.gyro_rad_s[2]);
}

#[test]
fn a_true_reading_follows_the_boat_s_motion() {
    let level = Truth {
        nu: Planar {
            surge: 2.0,
            sway: 1.0,
            yaw: 0.25,
        },
        ..Truth::default()
    };
    let lying = |attitude: Attitude| Truth {
        attitude,
        ..Truth::default()
    };
    let rolled = lying(Attitude {
        roll_rad: FRAC_PI_2 / 3.0,
        ..Attitude::default()
    });
    let pitched = lying(Attitude {
        pitch_rad: FRAC_PI_2 / 3.0,
        ..Attitude::default()
    });
    let half = 0.5 * GRAVITY_M_S2;
    let most = 0.75_f64.sqrt() * GRAVITY_M_S2;
    let surging = Truth {
        nu_dot: Planar {
            surge: 0.4,
            sway: -0.2,
            yaw: 0.0,
        },
        ..Truth::default()
    };
    let heaving = lying(Attitude {
        heave_up_m_s2: -1.0,
        ..Attitude::default()
    });
    for (what, truth, want) in [
        // A turn to starboard pushes to starboard by u r, and astern by v r if the boat slides to
        // starboard.
        ("turn", level, [-0.25, 0.5, -GRAVITY_M_S2]),
        // With the starboard side down, the upward push points to port of the mast; with the bow
        // up, ahead of it.
        ("roll", rolled, [0.0, -half, -most]),
        ("pitch", pitched, [half, 0.0, -most]),
        ("surge and sway", surging, [0.4, -0.2, -GRAVITY_M_S2]),
        ("heave", heaving, [0.0, 0.0, 1.0 - GRAVITY_M_S2]),
    ] {
        let got = ImuReading::of(&truth).accelerometer_m_s2;
        for axis in 0..3 {
            assert!(
                (got[axis] - want[axis]).abs() < 1e-12,
                "{what}: {got:?}, want {want:?}"
            );
        }
    }
    let falling = Attitude {
        heave_up_m_s2: -GRAVITY_M_S2,
        roll_rad: 0.4,
        pitch_rad: -0.3,
        ..Attitude::default()
    };
    assert!(
        ImuReading::of(&lying(falling))
            .accelerometer_m_s2
            .iter()
            .all(|f| f.abs() < 1e-15),
        "free fall"
    );
}

#[test]
fn a_gyro_feels_the_turning_of_its_attitude() {
    // Compared with the rotation matrix: R' = R S(ω), by finite differences of R = Rz(ψ) Ry(θ)
    // Rx(φ).
    type Matrix = [[f64; 3]; 3];
    let times = |a: Matrix, b: Matrix| -> Matrix {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
    };
    let attitude = |roll: f64, pitch: f64, yaw: f64| {
        let (sr, cr) = math::sin_cos(roll);
        let (sp, cp) = math::sin_cos(pitch);
        let (sy, cy) = math::sin_cos(yaw);
        let about_z = [[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]];
        let about_y = [[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]];
        let about_x = [[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]];
        times(times(about_z, about_y), about_x)
    };
    let truth = Truth {
        pose: Pose {
            at: Ned::default(),
            psi_rad: 1.1,
        },
        nu: Planar {
            surge: 0.0,
            sway: 0.0,
            yaw: 0.3,
        },
        attitude: Attitude {
            roll_rad: 0.4,
            pitch_rad: -0.25,
            roll_rad_s: 0.7,
            pitch_rad_s: -0.5,
            ..Attitude::default()
        },
        ..Truth::default()
    };
    const STEP_S: f64 = 1e-5;
    let at = |t: f64| attitude(0.4 + 0.7 * t, -0.25 - 0.5 * t, 1.1 + 0.3 * t);
    let before = at(-STEP_S);
    let middle = at(0.0);
    let after = at(STEP_S);
    let transposed: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| middle[j][i]));
    let rate: Matrix = std::array::from_fn(|i| {
        std::array::from_fn(|j| (after[i][j] - before[i][j]) / (2.0 * STEP_S))
    });
    let spin = times(transposed, rate);
    let got = ImuReading::of(&truth);
    for (got, want) in got
        .gyro_rad_s
        .into_iter()
        .zip([spin[2][1], spin[0][2], spin[1][0]])
    {
        assert!((got - want).abs() < 1e-9, "{got}, want {want}");
    }
    for (axis, got) in got.accelerometer_m_s2.into_iter().enumerate() {
        // Rᵀ (0, 0, −g) is the third row of R.
        assert!((got + GRAVITY_M_S2 * middle[2][axis]).abs() < 1e-12);
    }
}

#[test]
fn the_same_seed_reads_the_same_and_another_boat_or_seed_otherwise() {
    let read = |seed: u64, vehicle: &str| -> Vec<Reading> {
        let model = SensorModel::new(&faulty(), TICK, &seed.into(), vehicle, &[]);
        let mut state = SensorState::default();
        (0..600)
            .map(|i| model.read(&mut state, &sailing(TICK * i), TICK * i))
            .collect()
    };
    let one = read(1, "blue_one");
    assert_eq!(one, read(1, "blue_one"));
    for (seed, vehicle) in [(1, "blue_two"), (2, "blue_one")] {
        let other = read(seed, vehicle);
        assert!(
            one.iter()
                .zip(&other)
                .all(|(one, other)| one.nav.at() != other.nav.at()),
            "{vehicle}: gps"
        );
        assert!(
            one.iter()
                .zip(&other)
                .all(|(one, other)| one.nav.psi_rad != other.nav.psi_rad),
            "{vehicle}: compass"
        );
        assert!(
            one.iter()
                .zip(&other)
                .all(|(one, other)| one.imu != other.imu),
            "{vehicle}: imu"
        );
    }
}

#[test]
fn sensors_go_on_from_a_snapshot_to_the_bit() {
    let model = SensorModel::new(&faulty(), TICK, &1.into(), "blue_one", &[]);
    let mut state = SensorState::default();
    for i in 0..4_000 {
        if i % 37 == 0 {
            let bytes = postcard::to_stdvec(&state).unwrap();
            let back: SensorState = postcard::from_bytes(&bytes).unwrap();
            assert_eq!(back, state, "tick {i}");
            assert!(
                bytes.len() < 500,
                "only fixes in transit are stored: {} bytes",
                bytes.len()
            );
            // A state restored from bytes continues like the original.
            let mut one = state.clone();
            let mut other = back;
            for j in i..i + 30 {
                let readings = [&mut one, &mut other]
                    .map(|state| model.read(state, &sailing(TICK * j), TICK * j));
                assert_eq!(readings[0], readings[1], "tick {j}");
            }
        }
        let _ = model.read(&mut state, &sailing(TICK * i), TICK * i);
    }
    assert!(postcard::from_bytes::<SensorState>(&[0xff; 40]).is_err());
}

#[test]
fn the_front_seat_steers_by_the_heading_that_the_compass_shows() {
    let mut scenario = common::alone("surveyor_m1_8", "calm");
    let off = Compass {
        deviation_rad: [0.2, 0.0, 0.0, 0.0, 0.0],
        ..EXACT_COMPASS
    };
    scenario.boats[0].sensors = with_compass(off);
    let mut world = World::of_game(&scenario, 1).unwrap();
    let orders = [
        Order::Steer {
            heading_rad: 1.0,
            speed_m_s: 1.5,
        },
        Order::Hold,
    ];
    for _ in 0..20 * 60 {
        world.step(&orders);
        world.read_sensors();
    }
    // A compass needle 0.2 rad too far east reads 0.2 rad too low.
    let psi_rad = world.state().boats[0].pose.psi_rad;
    let reading = world.reading(VehicleId::at(0)).unwrap().nav.psi_rad;
    assert!((reading - 1.0).abs() < 0.01, "the compass reads {reading}");
    assert!((psi_rad - 1.2).abs() < 0.01, "the heading is {psi_rad}");
}
