//! Tests SITL's datagrams, its clock and the replies.

use super::*;
use messages::picture::Nav;

const SERVOS: Servos = Servos {
    port: 1,
    starboard: 3,
    pulse_us: [1100, 1500, 1900],
};
const PERIOD_S: f64 = 0.1;

fn datagram(rate_hz: u16, step: u32, pulses_us: &[u16]) -> Vec<u8> {
    let magic = if pulses_us.len() == 16 {
        18_458
    } else {
        29_569
    };
    let words = [magic, rate_hz, (step & 0xffff) as u16, (step >> 16) as u16];
    words
        .iter()
        .chain(pulses_us)
        .flat_map(|word: &u16| word.to_le_bytes())
        .collect()
}

fn pulses(port_us: u16, starboard_us: u16) -> [u16; 16] {
    let mut pulses_us = [0; 16];
    (pulses_us[0], pulses_us[2]) = (port_us, starboard_us);
    pulses_us
}

/// Three numbers after a key, read as the firmware does: the first occurrence of the section's
/// text, then that of the key, then `":[` without spaces.
fn triple(json: &str, section: &str, key: &str) -> [f64; 3] {
    let section = json.find(section).expect("the section is there");
    let from = section + json[section..].find(key).expect("the key is there") + key.len();
    let list = json[from..]
        .strip_prefix("\":[")
        .expect("a list follows at once");
    let numbers = list[..list.find(']').expect("it ends")]
        .split(',')
        .map(|n| n.parse().expect("a number"));
    numbers
        .collect::<Vec<_>>()
        .try_into()
        .expect("three numbers")
}

fn timestamp_s(json: &str) -> f64 {
    let from = json.find("timestamp\":").expect("it is there") + "timestamp\":".len();
    json[from..]
        .split(',')
        .next()
        .expect("a number")
        .parse()
        .expect("a number")
}

fn near(found: [f64; 3], want: [f64; 3], tolerance: f64) {
    assert!(
        found
            .iter()
            .zip(want)
            .all(|(a, b)| (a - b).abs() < tolerance),
        "{found:?}, expected {want:?}"
    );
}

/// All replies that the firmware receives within the first `seconds` of a motion, at 400 Hz.
fn replies(seconds: f64, truth_at: impl Fn(f64) -> VehicleTruth) -> Vec<String> {
    let mut sitl = Sitl::new(SERVOS);
    let mut replies = Vec::new();
    sitl.receive(&datagram(400, 0, &pulses(1500, 1500)));
    for i in 0..(seconds / PERIOD_S) as u32 {
        let at_s = f64::from(i) * PERIOD_S;
        sitl.observe(SimTime::from_s(at_s), &truth_at(at_s));
        while let Some(reply) = sitl.reply() {
            replies.push(reply);
            sitl.receive(&datagram(400, replies.len() as u32, &pulses(1500, 1500)));
        }
    }
    replies
}

#[test]
fn a_boat_at_rest_feels_gravity_along_its_own_axes() {
    let roll_rad = 0.3;
    let truth = VehicleTruth {
        roll_rad,
        ..VehicleTruth::default()
    };
    let json = replies(1.0, |_| truth).pop().expect("the boat is there");
    assert!(json.starts_with("\n{") && json.ends_with("}\n"), "{json:?}");
    near(triple(&json, "imu", "gyro"), [0.0; 3], 1e-12);
    let (sine, cosine) = math::sin_cos(roll_rad);
    let [side, down] = [-GRAVITY_M_S2 * sine, -GRAVITY_M_S2 * cosine];
    near(triple(&json, "imu", "accel_body"), [0.0, side, down], 1e-9);
    near(triple(&json, "", "attitude"), [roll_rad, 0.0, 0.0], 1e-12);
}

/// 2 m/s on a circle to starboard with a radius of 10 m: 0.2 rad/s and 0.4 m/s² towards the centre.
#[test]
fn a_turning_boat_is_on_its_circle_between_the_frames_too() {
    let (radius_m, turn_rad_s) = (10.0, 0.2);
    let on_circle = |at_s: f64| {
        let psi_rad = turn_rad_s * at_s;
        let (sine, cosine) = math::sin_cos(psi_rad);
        let north_m = radius_m * sine;
        let east_m = radius_m * (1.0 - cosine);
        let nav = Nav {
            north_m,
            east_m,
            psi_rad: wrap_pi(psi_rad),
            surge_m_s: radius_m * turn_rad_s,
            sway_m_s: 0.0,
            yaw_rate_rad_s: turn_rad_s,
        };
        VehicleTruth {
            nav,
            heave_m: 0.1,
            ..VehicleTruth::default()
        }
    };
    // A full circle, so that the heading wraps.
    let replies = replies(33.0, on_circle);
    assert_eq!(
        replies.len(),
        (330 - 1) * 40,
        "a reply to each step of 2.5 ms"
    );
    for (i, json) in replies.iter().enumerate() {
        let time_s = timestamp_s(json);
        assert!((time_s - (i + 1) as f64 / 400.0).abs() < 1e-9, "{time_s}");
        let (sine, cosine) = math::sin_cos(turn_rad_s * time_s);
        let truth = on_circle(time_s);
        near(
            triple(json, "", "position"),
            [truth.nav.north_m, truth.nav.east_m, -0.1],
            1e-5,
        );
        let velocity = [2.0 * cosine, 2.0 * sine, 0.0];
        near(triple(json, "", "velocity"), velocity, 1e-3);
        near(triple(json, "imu", "gyro"), [0.0, 0.0, turn_rad_s], 1e-6);
        near(
            triple(json, "imu", "accel_body"),
            [0.0, 2.0 * turn_rad_s, -GRAVITY_M_S2],
            0.02,
        );
    }
}

/// Captured from ArduRover 4.7 (motorboat-skid), built from its public sources: the first datagram,
/// and one while the boat drove west at 1.5 m/s in waves.
#[test]
fn datagrams_of_the_real_firmware_are_read() {
    let first = "1a48b004000000000000000000000000000000000000000000000000000000000000000000000000";
    let under_way =
        "1a48b004f25f01009d060000b2060000000000000000000000000000000000000000000000000000";
    for (hex, step, port_us, starboard_us) in [(first, 0, 0, 0), (under_way, 90_098, 1693, 1714)] {
        let mut pulses_us = [0; CHANNELS];
        pulses_us[..16].copy_from_slice(&pulses(port_us, starboard_us));
        let want = Outputs {
            rate_hz: 1200,
            step,
            pulses_us,
        };
        assert_eq!(Outputs::parse(&bytes(hex)), Some(want));
    }
}

fn bytes(hex: &str) -> Vec<u8> {
    let byte = |at: usize| u8::from_str_radix(&hex[at..at + 2], 16).expect("hexadecimal digits");
    (0..hex.len()).step_by(2).map(byte).collect()
}

#[test]
fn the_real_firmware_gets_the_replies_that_it_accepted() {
    let mut sitl = Sitl::new(SERVOS);
    let (mut step, mut replies) = (None, 0);
    for line in include_str!("exchange.txt").lines() {
        let (kind, rest) = line.split_once(' ').expect("a kind");
        let numbers: Vec<f64> = rest.split(' ').map_while(|n| n.parse().ok()).collect();
        match kind {
            "clock" => {
                let [now, zero] = [0, 1].map(|i| SimTime(numbers[i] as i64));
                sitl.clock = Some((now, zero));
            }
            "frame" => {
                let nav = Nav {
                    north_m: numbers[1],
                    east_m: numbers[2],
                    psi_rad: numbers[3],
                    surge_m_s: numbers[4],
                    sway_m_s: numbers[5],
                    yaw_rate_rad_s: numbers[6],
                };
                let truth = VehicleTruth {
                    nav,
                    heave_m: numbers[7],
                    roll_rad: numbers[8],
                    pitch_rad: numbers[9],
                    ..VehicleTruth::default()
                };
                sitl.observe(SimTime(numbers[0] as i64), &truth);
            }
            "in" => {
                let outputs = Outputs::parse(&bytes(rest)).expect("servo outputs");
                assert!(step.is_none_or(|before| outputs.step == before + 1));
                step = Some(outputs.step);
                // As a first datagram, this would count as a restart and set the clock to zero.
                sitl.outputs = Some((outputs, SimTime::ZERO));
                sitl.receive(&bytes(rest));
            }
            "out" => {
                let reply = sitl.reply().expect("it is due");
                assert_eq!(timestamp_s(&reply), timestamp_s(rest));
                for (section, key) in [
                    ("imu", "gyro"),
                    ("imu", "accel_body"),
                    ("", "position"),
                    ("", "attitude"),
                    ("", "velocity"),
                ] {
                    near(
                        triple(&reply, section, key),
                        triple(rest, section, key),
                        1e-9,
                    );
                }
                replies += 1;
            }
            _ => assert_eq!(kind, "#"),
        }
    }
    assert_eq!(replies, 14);
}

#[test]
fn servo_outputs_become_thrust_until_they_stop() {
    let mut sitl = Sitl::new(Servos {
        port: 1,
        starboard: 3,
        pulse_us: [1100, 1500, 1700],
    });
    assert_eq!(sitl.order(), Order::Hold);
    for (port_us, starboard_us, port, starboard) in [
        (1500, 1500, 0.0, 0.0),
        (1100, 1600, -1.0, 0.5),
        (900, 2100, -1.0, 1.0),
        (0, 1300, 0.0, -0.5),
    ] {
        sitl.receive(&datagram(400, 1, &pulses(port_us, starboard_us)));
        assert_eq!(
            sitl.order(),
            Order::Thrust { port, starboard },
            "{port_us} {starboard_us}"
        );
    }
    let mut wide = [1500; 32];
    wide[2] = 1700;
    sitl.receive(&datagram(400, 1, &wide));
    assert_eq!(
        sitl.order(),
        Order::Thrust {
            port: 0.0,
            starboard: 1.0
        }
    );
    // Firmware that is waiting for a reply is not silent, however long the game is paused.
    let truth = VehicleTruth::default();
    sitl.observe(SimTime::from_s(0.0), &truth);
    sitl.observe(SimTime::from_s(5.0), &truth);
    assert_eq!(
        sitl.order(),
        Order::Thrust {
            port: 0.0,
            starboard: 1.0
        }
    );
    assert!(sitl.reply().is_some());
    sitl.observe(SimTime::from_s(6.1), &truth);
    assert_eq!(sitl.order(), Order::Hold);
    sitl.receive(&datagram(400, 2, &wide));
    assert_eq!(
        sitl.order(),
        Order::Thrust {
            port: 0.0,
            starboard: 1.0
        }
    );
}

#[test]
fn a_restarted_firmware_begins_at_zero_and_a_slow_one_catches_up() {
    let mut sitl = Sitl::new(SERVOS);
    let truth = VehicleTruth::default();
    let mut at_s = 0.0;
    let mut advance = |sitl: &mut Sitl, periods: u32| {
        for _ in 0..periods {
            sitl.observe(SimTime::from_s(at_s), &truth);
            at_s += PERIOD_S;
        }
    };
    let step = |sitl: &mut Sitl, step: u32| {
        sitl.receive(&datagram(400, step, &pulses(1500, 1500)));
        sitl.reply().map(|json| SimTime::from_s(timestamp_s(&json)))
    };
    advance(&mut sitl, 30);
    assert_eq!(step(&mut sitl, 100), Some(SimTime::from_s(0.0025)));
    advance(&mut sitl, 5);
    assert_eq!(
        step(&mut sitl, 101),
        Some(SimTime::from_s(0.0075)),
        "twice as fast while it is behind"
    );
    advance(&mut sitl, 25);
    assert_eq!(
        step(&mut sitl, 102),
        Some(SimTime::from_s(0.01)),
        "skipped, but not by its own clock"
    );
    assert_eq!(
        sitl.clock.map(|(now, _)| now),
        Some(SimTime::from_s(5.8025)),
        "from the last frame but one"
    );
    assert_eq!(
        step(&mut sitl, 0),
        Some(SimTime::from_s(0.0025)),
        "the firmware started again"
    );
    advance(&mut sitl, 1000);
    assert!(
        sitl.moments.len() <= 50,
        "nor is it kept for a dead firmware"
    );
}

#[test]
fn other_datagrams_are_ignored_and_reported_once() {
    let mut sitl = Sitl::new(SERVOS);
    let sound = datagram(400, 1, &pulses(1500, 1500));
    let mut other_magic = sound.clone();
    other_magic[0] ^= 1;
    for bad in [
        &sound[..39],
        &sound[..0],
        &[sound.as_slice(), &[0]].concat(),
        &other_magic,
    ] {
        sitl.receive(bad);
    }
    sitl.observe(SimTime::from_s(0.0), &VehicleTruth::default());
    sitl.observe(SimTime::from_s(0.1), &VehicleTruth::default());
    assert_eq!(
        (sitl.order(), sitl.reply(), sitl.garbage),
        (Order::Hold, None, 4)
    );
    let remark = sitl.take_remark().expect("it is reported");
    assert!(
        remark.contains("39 bytes") && sitl.take_remark().is_none(),
        "{remark}"
    );
}
