//! ArduPilot's own firmware as the front seat of a simulated boat: Squall is the physics of its
//! *software in the loop* (SITL), through SITL's JSON back end.
//!
//! For each step, the firmware sends its servo outputs as a UDP datagram and waits for a line of
//! JSON with time, attitude, position, velocity and IMU values. The simulation publishes a boat's
//! motion at every decision. Between two such moments each coordinate is a cubic of time, so that
//! position, velocity and specific force agree. The firmware is therefore one decision behind.
//!
//! Source: ArduPilot, `libraries/SITL/SIM_JSON.cpp` and `libraries/SITL/examples/JSON/readme.md`.

use messages::{Order, VehicleTruth};
use primitives::SimTime;
use primitives::angle::wrap_pi;
use primitives::math;
use serde::Serialize;
use std::collections::VecDeque;

/// Standard gravity, m/s², as in the firmware.
const GRAVITY_M_S2: f64 = 9.80665;
/// Limits of the steps per second that a firmware requests. It asks for 1200 by default. Coarser
/// steps delay its loops so much that it finds its GPS receiver too slow.
const RATE_MAX_HZ: u16 = 1200;
const RATE_MIN_HZ: u16 = 50;
/// Further behind the simulation than this, s, the firmware gets steps of twice the length.
const BEHIND_S: f64 = 0.3;
/// Further behind than this, s, it skips to the present.
const LOST_S: f64 = 2.0;
/// Without servo outputs for this long the thrusters stop, s.
const SILENT_S: f64 = 1.0;

/// Channels of the largest datagram.
const CHANNELS: usize = 32;
/// The datagram's first number, by its count of channels.
const FORMATS: [(u16, usize); 2] = [(18_458, 16), (29_569, CHANNELS)];
/// Bytes before the pulses: magic number, rate and step.
const HEADER: usize = 8;

/// Which servo outputs drive the thrusters, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Servos {
    /// Channel of the port thruster, from 1. 1 in ArduPilot's skid-steering boats.
    pub port: usize,
    /// Channel of the starboard thruster, from 1. 3 in ArduPilot's skid-steering boats.
    pub starboard: usize,
    /// Pulse lengths of full astern, zero and full ahead, µs, in ascending order.
    pub pulse_us: [u16; 3],
}

impl Servos {
    /// Maximum channel.
    pub const CHANNEL_MAX: u64 = CHANNELS as u64;

    /// Thrust from -1 to 1 for a pulse; zero for no pulse.
    fn thrust(&self, pulse_us: u16) -> f64 {
        let [astern, zero, ahead] = self.pulse_us.map(f64::from);
        let from_zero = f64::from(pulse_us) - zero;
        match pulse_us {
            0 => 0.0,
            _ if from_zero < 0.0 => (from_zero / (zero - astern)).max(-1.0),
            _ => (from_zero / (ahead - zero)).min(1.0),
        }
    }
}

/// Servo outputs of one step.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Outputs {
    /// Steps per second that the firmware requests.
    rate_hz: u16,
    /// Number of the step. It repeats when a reply was lost, and starts again with the firmware.
    step: u32,
    /// Pulse lengths by channel, µs; 0 means no pulse.
    pulses_us: [u16; CHANNELS],
}

impl Outputs {
    /// Parses a datagram: little-endian magic number, rate, step and pulses.
    fn parse(datagram: &[u8]) -> Option<Outputs> {
        let ([m0, m1, r0, r1, s0, s1, s2, s3], pulses) = datagram.split_first_chunk::<HEADER>()?;
        let magic = u16::from_le_bytes([*m0, *m1]);
        if !FORMATS.iter().any(|(of_format, channels)| *of_format == magic && 2 * channels == pulses.len()) {
            return None;
        }
        let mut pulses_us = [0; CHANNELS];
        for (pulse_us, bytes) in pulses_us.iter_mut().zip(pulses.chunks_exact(2)) {
            *pulse_us = u16::from_le_bytes([bytes[0], bytes[1]]);
        }
        let step = u32::from_le_bytes([*s0, *s1, *s2, *s3]);
        Some(Outputs { rate_hz: u16::from_le_bytes([*r0, *r1]), step, pulses_us })
    }
}

/// North, east, down, m; roll, pitch, yaw, rad, yaw without jumps.
type Coordinates = [f64; 6];

/// A boat's true motion at one moment.
#[derive(Clone, Copy, Debug)]
struct Moment {
    at: SimTime,
    value: Coordinates,
    rate: Coordinates,
}

impl Moment {
    /// The motion at `at`, which followed `before`.
    fn new(at: SimTime, truth: &VehicleTruth, before: Option<&Moment>) -> Moment {
        let nav = truth.nav;
        let velocity = nav.velocity_m_s();
        let yaw = before.map_or(nav.psi_rad, |before| before.value[5] + wrap_pi(nav.psi_rad - before.value[5]));
        let value = [nav.north_m, nav.east_m, -truth.heave_m, truth.roll_rad, truth.pitch_rad, yaw];
        let mut rate = [velocity.north, velocity.east, 0.0, 0.0, 0.0, nav.yaw_rate_rad_s];
        // The simulation publishes no rates of the motions that only the waves cause.
        if let Some(before) = before {
            let dt = (at - before.at).as_s();
            (2..5).for_each(|i| rate[i] = (value[i] - before.value[i]) / dt);
        }
        Moment { at, value, rate }
    }

    /// Values, rates and accelerations at a time between two moments: the cubics with the values
    /// and rates of both.
    fn between(from: &Moment, to: &Moment, at: SimTime) -> [Coordinates; 3] {
        let span = (to.at - from.at).as_s();
        let u = (at - from.at).as_s() / span;
        std::array::from_fn(|derivative| {
            std::array::from_fn(|i| {
                let rise = to.value[i] - from.value[i];
                let (start, end) = (span * from.rate[i], span * to.rate[i]);
                let square = 3.0 * rise - 2.0 * start - end;
                let cube = start + end - 2.0 * rise;
                match derivative {
                    0 => from.value[i] + u * (start + u * (square + u * cube)),
                    1 => (start + u * (2.0 * square + 3.0 * u * cube)) / span,
                    _ => (2.0 * square + 6.0 * u * cube) / (span * span),
                }
            })
        })
    }
}

/// The reply to one step. The firmware finds keys by their text, in this order.
#[derive(Serialize)]
struct State {
    /// Since the firmware's start, s.
    timestamp: f64,
    imu: Imu,
    /// North, east, down of the firmware's home, m.
    position: [f64; 3],
    /// Roll, pitch, yaw, rad.
    attitude: [f64; 3],
    /// North, east, down, m/s.
    velocity: [f64; 3],
}

#[derive(Serialize)]
struct Imu {
    /// About the axes ahead, to starboard, down, rad/s.
    gyro: [f64; 3],
    /// Specific force along these axes, m/s².
    accel_body: [f64; 3],
}

impl State {
    fn new(timestamp: f64, [value, rate, acceleration]: [Coordinates; 3]) -> State {
        let [north, east, down, roll, pitch, yaw] = value;
        let [north_rate, east_rate, down_rate, roll_rate, pitch_rate, yaw_rate] = rate;
        let [(sr, cr), (sp, cp), (sy, cy)] = [roll, pitch, yaw].map(math::sin_cos);
        let gyro =
            [roll_rate - yaw_rate * sp, pitch_rate * cr + yaw_rate * cp * sr, yaw_rate * cp * cr - pitch_rate * sr];
        // From the field's axes to the boat's: yaw, then pitch, then roll (Fossen 2011, eq. 2.18).
        let [n, e, d] = [acceleration[0], acceleration[1], acceleration[2] - GRAVITY_M_S2];
        let accel_body = [
            cy * cp * n + sy * cp * e - sp * d,
            (cy * sp * sr - sy * cr) * n + (sy * sp * sr + cy * cr) * e + cp * sr * d,
            (cy * sp * cr + sy * sr) * n + (sy * sp * cr - cy * sr) * e + cp * cr * d,
        ];
        State {
            timestamp,
            imu: Imu { gyro, accel_body },
            position: [north, east, down],
            attitude: [roll, pitch, wrap_pi(yaw)],
            velocity: [north_rate, east_rate, down_rate],
        }
    }
}

/// The firmware of one boat, as seen from the simulation.
#[derive(Debug)]
pub struct Sitl {
    servos: Servos,
    /// The boat's motion from the moment before the firmware's time on, oldest first.
    moments: VecDeque<Moment>,
    /// Game time of the last reply, and of the firmware's time zero.
    clock: Option<(SimTime, SimTime)>,
    /// Last servo outputs, and the newest moment when they arrived.
    outputs: Option<(Outputs, SimTime)>,
    /// Whether the firmware waits for a reply.
    waits: bool,
    remarks: VecDeque<String>,
    is_silent: bool,
    garbage: u64,
}

impl Sitl {
    /// Waits for a firmware with these thrusters.
    pub fn new(servos: Servos) -> Sitl {
        Sitl {
            servos,
            moments: VecDeque::new(),
            clock: None,
            outputs: None,
            waits: false,
            remarks: VecDeque::new(),
            is_silent: false,
            garbage: 0,
        }
    }

    /// Receives a datagram.
    pub fn receive(&mut self, datagram: &[u8]) {
        let Some(outputs) = Outputs::parse(datagram) else {
            self.garbage += 1;
            if self.garbage == 1 {
                let count = datagram.len();
                self.remarks.push_back(format!(
                    "ignored a datagram of {count} bytes: expected SITL's servo outputs, of 40 or 72 bytes"
                ));
            }
            return;
        };
        let starts = self.outputs.as_ref().is_none_or(|(before, _)| outputs.step < before.step);
        if starts {
            self.clock = None;
            self.remarks.push_back(format!("firmware started, {} Hz", outputs.rate_hz));
        } else if self.is_silent {
            self.remarks.push_back("firmware continues".to_owned());
        }
        self.is_silent = false;
        self.waits = true;
        let newest = self.moments.back().map_or(SimTime::ZERO, |moment| moment.at);
        self.outputs = Some((outputs, newest));
    }

    /// Receives the boat's true motion.
    pub fn observe(&mut self, at: SimTime, truth: &VehicleTruth) {
        let before = self.moments.back();
        // A quarantined boat may have no finite motion. It stays where it was for the firmware.
        if truth.quarantined || before.is_some_and(|before| before.at >= at) {
            return;
        }
        let moment = Moment::new(at, truth, before);
        self.moments.push_back(moment);
        // What a slow firmware will skip is not kept either.
        let skipped = at - SimTime::from_s(2.0 * LOST_S);
        let done = self.clock.map_or(at, |(now, _)| now.max(skipped));
        while self.moments.len() > 2 && self.moments[1].at <= done {
            self.moments.pop_front();
        }
        if let Some((_, heard)) = self.outputs
            && !self.waits
            && !self.is_silent
            && (at - heard).as_s() > SILENT_S
        {
            self.is_silent = true;
            self.remarks.push_back(format!("no servo outputs for {SILENT_S} s: zero thrust"));
        }
    }

    /// The reply that the firmware waits for, once the simulation has reached its time.
    pub fn reply(&mut self) -> Option<String> {
        let newest = self.moments.back()?.at;
        let (outputs, _) = self.outputs.as_ref().filter(|_| self.waits && self.moments.len() >= 2)?;
        let step_s = 1.0 / f64::from(outputs.rate_hz.clamp(RATE_MIN_HZ, RATE_MAX_HZ));
        let last = self.moments[self.moments.len() - 2].at;
        let (mut now, mut zero) = *self.clock.get_or_insert((last, last));
        let lost_s = (newest - now).as_s();
        if lost_s > LOST_S {
            self.remarks.push_back(format!("firmware was {lost_s:.1} s behind the game: skipped to the present"));
            // The firmware's own clock must not jump: its drivers would find their sensors dead.
            zero = zero + (last - now);
            now = last;
        }
        let steps = if (newest - now).as_s() > BEHIND_S { 2.0 } else { 1.0 };
        let next = now + SimTime::from_s(steps * step_s);
        if next > newest {
            return None;
        }
        self.waits = false;
        self.clock = Some((next, zero));
        let after = self.moments.iter().position(|moment| moment.at >= next)?.max(1);
        let motion = Moment::between(&self.moments[after - 1], &self.moments[after], next);
        let state = State::new((next - zero).as_s(), motion);
        let json = serde_json::to_string(&state).expect("numbers are JSON");
        // The firmware reads what is between the last two line feeds.
        Some(format!("\n{json}\n"))
    }

    /// The thrusters' order.
    pub fn order(&self) -> Order {
        let Some((outputs, _)) = self.outputs.as_ref().filter(|_| !self.is_silent) else { return Order::Hold };
        let thrust = |channel: usize| self.servos.thrust(outputs.pulses_us[channel - 1]);
        Order::Thrust { port: thrust(self.servos.port), starboard: thrust(self.servos.starboard) }
    }

    /// The next log message.
    pub fn take_remark(&mut self) -> Option<String> {
        self.remarks.pop_front()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use messages::picture::Nav;

    const SERVOS: Servos = Servos { port: 1, starboard: 3, pulse_us: [1100, 1500, 1900] };
    const PERIOD_S: f64 = 0.1;

    fn datagram(rate_hz: u16, step: u32, pulses_us: &[u16]) -> Vec<u8> {
        let magic = if pulses_us.len() == 16 { 18_458 } else { 29_569 };
        let words = [magic, rate_hz, (step & 0xffff) as u16, (step >> 16) as u16];
        words.iter().chain(pulses_us).flat_map(|word: &u16| word.to_le_bytes()).collect()
    }

    fn pulses(port_us: u16, starboard_us: u16) -> [u16; 16] {
        let mut pulses_us = [0; 16];
        (pulses_us[0], pulses_us[2]) = (port_us, starboard_us);
        pulses_us
    }

    /// Three numbers after a key, read as the firmware does: the first occurrence of the section's text, then of the
    /// key's, then `":[` without spaces.
    fn triple(json: &str, section: &str, key: &str) -> [f64; 3] {
        let section = json.find(section).expect("the section is there");
        let from = section + json[section..].find(key).expect("the key is there") + key.len();
        let list = json[from..].strip_prefix("\":[").expect("a list follows at once");
        let numbers = list[..list.find(']').expect("it ends")].split(',').map(|n| n.parse().expect("a number"));
        numbers.collect::<Vec<_>>().try_into().expect("three numbers")
    }

    fn timestamp_s(json: &str) -> f64 {
        let from = json.find("timestamp\":").expect("it is there") + "timestamp\":".len();
        json[from..].split(',').next().expect("a number").parse().expect("a number")
    }

    fn near(found: [f64; 3], want: [f64; 3], tolerance: f64) {
        assert!(found.iter().zip(want).all(|(a, b)| (a - b).abs() < tolerance), "{found:?}, expected {want:?}");
    }

    /// Everything that the firmware receives within the first `seconds` of a motion, at 400 Hz.
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
        let truth = VehicleTruth { roll_rad, ..VehicleTruth::default() };
        let json = replies(1.0, |_| truth).pop().expect("the boat is there");
        assert!(json.starts_with("\n{") && json.ends_with("}\n"), "{json:?}");
        near(triple(&json, "imu", "gyro"), [0.0; 3], 1e-12);
        let (sine, cosine) = math::sin_cos(roll_rad);
        let [side, down] = [-GRAVITY_M_S2 * sine, -GRAVITY_M_S2 * cosine];
        near(triple(&json, "imu", "accel_body"), [0.0, side, down], 1e-9);
        near(triple(&json, "", "attitude"), [roll_rad, 0.0, 0.0], 1e-12);
    }

    /// 2 m/s on a circle of 10 m to starboard: 0.2 rad/s and 0.4 m/s² towards the centre.
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
            VehicleTruth { nav, heave_m: 0.1, ..VehicleTruth::default() }
        };
        // Once around, so that the heading wraps.
        let replies = replies(33.0, on_circle);
        assert_eq!(replies.len(), (330 - 1) * 40, "a reply to each step of 2.5 ms");
        for (i, json) in replies.iter().enumerate() {
            let time_s = timestamp_s(json);
            assert!((time_s - (i + 1) as f64 / 400.0).abs() < 1e-9, "{time_s}");
            let (sine, cosine) = math::sin_cos(turn_rad_s * time_s);
            let truth = on_circle(time_s);
            near(triple(json, "", "position"), [truth.nav.north_m, truth.nav.east_m, -0.1], 1e-5);
            let velocity = [2.0 * cosine, 2.0 * sine, 0.0];
            near(triple(json, "", "velocity"), velocity, 1e-3);
            near(triple(json, "imu", "gyro"), [0.0, 0.0, turn_rad_s], 1e-6);
            near(triple(json, "imu", "accel_body"), [0.0, 2.0 * turn_rad_s, -GRAVITY_M_S2], 0.02);
        }
    }

    /// Captured from ArduRover 4.7 (motorboat-skid), built from its public sources: the first datagram, and one while it
    /// kept 1.5 m/s westwards in these waves.
    #[test]
    fn datagrams_of_the_real_firmware_are_read() {
        let first = "1a48b004000000000000000000000000000000000000000000000000000000000000000000000000";
        let under_way = "1a48b004f25f01009d060000b2060000000000000000000000000000000000000000000000000000";
        for (hex, step, port_us, starboard_us) in [(first, 0, 0, 0), (under_way, 90_098, 1693, 1714)] {
            let byte = |at: usize| u8::from_str_radix(&hex[at..at + 2], 16).expect("hexadecimal digits");
            let datagram: Vec<u8> = (0..hex.len()).step_by(2).map(byte).collect();
            let mut pulses_us = [0; CHANNELS];
            pulses_us[..16].copy_from_slice(&pulses(port_us, starboard_us));
            let want = Outputs { rate_hz: 1200, step, pulses_us };
            assert_eq!(Outputs::parse(&datagram), Some(want));
        }
    }

    #[test]
    fn servo_outputs_become_thrust_until_they_stop() {
        let mut sitl = Sitl::new(Servos { port: 1, starboard: 3, pulse_us: [1100, 1500, 1700] });
        assert_eq!(sitl.order(), Order::Hold);
        for (port_us, starboard_us, port, starboard) in
            [(1500, 1500, 0.0, 0.0), (1100, 1600, -1.0, 0.5), (900, 2100, -1.0, 1.0), (0, 1300, 0.0, -0.5)]
        {
            sitl.receive(&datagram(400, 1, &pulses(port_us, starboard_us)));
            assert_eq!(sitl.order(), Order::Thrust { port, starboard }, "{port_us} {starboard_us}");
        }
        let mut wide = [1500; 32];
        wide[2] = 1700;
        sitl.receive(&datagram(400, 1, &wide));
        assert_eq!(sitl.order(), Order::Thrust { port: 0.0, starboard: 1.0 });
        // A firmware that waits for a reply is not silent, however long the game is paused.
        let truth = VehicleTruth::default();
        sitl.observe(SimTime::from_s(0.0), &truth);
        sitl.observe(SimTime::from_s(5.0), &truth);
        assert_eq!(sitl.order(), Order::Thrust { port: 0.0, starboard: 1.0 });
        assert!(sitl.reply().is_some());
        sitl.observe(SimTime::from_s(6.1), &truth);
        assert_eq!(sitl.order(), Order::Hold);
        sitl.receive(&datagram(400, 2, &wide));
        assert_eq!(sitl.order(), Order::Thrust { port: 0.0, starboard: 1.0 });
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
        assert_eq!(step(&mut sitl, 101), Some(SimTime::from_s(0.0075)), "twice as fast while it is behind");
        advance(&mut sitl, 25);
        assert_eq!(step(&mut sitl, 102), Some(SimTime::from_s(0.01)), "skipped, but not by its own clock");
        assert_eq!(sitl.clock.map(|(now, _)| now), Some(SimTime::from_s(5.8025)), "from the last frame but one");
        assert_eq!(step(&mut sitl, 0), Some(SimTime::from_s(0.0025)), "the firmware started again");
        advance(&mut sitl, 1000);
        assert!(sitl.moments.len() <= 50, "nor is it kept for a dead firmware");
    }

    #[test]
    fn other_datagrams_are_ignored_and_reported_once() {
        let mut sitl = Sitl::new(SERVOS);
        let sound = datagram(400, 1, &pulses(1500, 1500));
        let mut other_magic = sound.clone();
        other_magic[0] ^= 1;
        for bad in [&sound[..39], &sound[..0], &[sound.as_slice(), &[0]].concat(), &other_magic] {
            sitl.receive(bad);
        }
        sitl.observe(SimTime::from_s(0.0), &VehicleTruth::default());
        sitl.observe(SimTime::from_s(0.1), &VehicleTruth::default());
        assert_eq!((sitl.order(), sitl.reply(), sitl.garbage), (Order::Hold, None, 4));
        let remark = sitl.take_remark().expect("it is reported");
        assert!(remark.contains("39 bytes") && sitl.take_remark().is_none(), "{remark}");
    }
}
