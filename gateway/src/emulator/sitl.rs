//! ArduPilot's own firmware as the front seat of a simulated boat: Squall provides the physics for
//! its *software in the loop* (SITL), through SITL's JSON back end.
//!
//! For each step, the firmware sends its servo outputs as a UDP datagram and waits for a line of
//! JSON with time, attitude, position, velocity and IMU values. The simulation publishes a boat's
//! motion at every decision. Between two decisions, each coordinate is a cubic function of time, so
//! that position, velocity and specific force agree. The firmware is therefore one decision behind.
//! Source: ArduPilot, `libraries/SITL/SIM_JSON.cpp` and `libraries/SITL/examples/JSON/readme.md`.

use messages::{Order, VehicleTruth};
use primitives::SimTime;
use primitives::angle::wrap_pi;
use primitives::math;
use serde::Serialize;
use std::collections::VecDeque;

/// Standard gravity, m/s², as in the firmware.
const GRAVITY_M_S2: f64 = 9.80665;
/// Maximum and minimum number of steps per second; requests are limited to this range. The
/// firmware's default is 1200. Coarser steps delay its loops so much that it considers its GPS
/// receiver too slow.
const RATE_MAX_HZ: u16 = 1200;
const RATE_MIN_HZ: u16 = 50;
/// Lag behind the simulation (s) beyond which the firmware gets steps of twice the length.
const BEHIND_S: f64 = 0.3;
/// Lag (s) beyond which the firmware skips to the present.
const LOST_S: f64 = 2.0;
/// Time (s) without servo outputs after which the thrusters stop.
const SILENT_S: f64 = 1.0;

/// Number of channels in the largest datagram.
const CHANNELS: usize = 32;
/// The datagram's magic number for each number of channels.
const FORMATS: [(u16, usize); 2] = [(18_458, 16), (29_569, CHANNELS)];
/// Number of bytes before the pulses: magic number, rate and step.
const HEADER: usize = 8;

/// Which servo outputs drive the thrusters, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Servos {
    /// Channel of the port thruster, from 1; in ArduPilot's skid-steering boats, 1.
    pub port: usize,
    /// Channel of the starboard thruster, from 1; in ArduPilot's skid-steering boats, 3.
    pub starboard: usize,
    /// Pulse widths for full astern, zero and full ahead, µs, in ascending order.
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
    /// Number of the step. Repeated if a reply was lost; restarts with the firmware.
    step: u32,
    /// Pulse widths by channel, µs; 0 means no pulse.
    pulses_us: [u16; CHANNELS],
}

impl Outputs {
    /// Parses a datagram: little-endian magic number, rate, step and pulses.
    fn parse(datagram: &[u8]) -> Option<Outputs> {
        let ([m0, m1, r0, r1, s0, s1, s2, s3], pulses) = datagram.split_first_chunk::<HEADER>()?;
        let magic = u16::from_le_bytes([*m0, *m1]);
        if !FORMATS
            .iter()
            .any(|(of_format, channels)| *of_format == magic && 2 * channels == pulses.len())
        {
            return None;
        }
        let mut pulses_us = [0; CHANNELS];
        for (pulse_us, bytes) in pulses_us.iter_mut().zip(pulses.chunks_exact(2)) {
            *pulse_us = u16::from_le_bytes([bytes[0], bytes[1]]);
        }
        let step = u32::from_le_bytes([*s0, *s1, *s2, *s3]);
        Some(Outputs {
            rate_hz: u16::from_le_bytes([*r0, *r1]),
            step,
            pulses_us,
        })
    }
}

/// North, east, down (m); roll, pitch, yaw (rad), with the yaw unwrapped.
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
        let yaw = before.map_or(nav.psi_rad, |before| {
            before.value[5] + wrap_pi(nav.psi_rad - before.value[5])
        });
        let value = [
            nav.north_m,
            nav.east_m,
            -truth.heave_m,
            truth.roll_rad,
            truth.pitch_rad,
            yaw,
        ];
        let mut rate = [
            velocity.north,
            velocity.east,
            0.0,
            0.0,
            0.0,
            nav.yaw_rate_rad_s,
        ];
        // The simulation does not publish rates of motions caused by waves alone.
        if let Some(before) = before {
            let dt = (at - before.at).as_s();
            (2..5).for_each(|i| rate[i] = (value[i] - before.value[i]) / dt);
        }
        Moment { at, value, rate }
    }

    /// Values, rates and accelerations at a time between two moments, from the cubics that match
    /// the values and rates of both.
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

/// The reply to one step. The firmware searches for the keys as strings, in this order.
#[derive(Serialize)]
struct State {
    /// Time since the firmware's start, s.
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
    /// Rates of turn about the axes forward, to starboard and down, rad/s.
    gyro: [f64; 3],
    /// Specific force along these axes, m/s².
    accel_body: [f64; 3],
}

impl State {
    fn new(timestamp: f64, [value, rate, acceleration]: [Coordinates; 3]) -> State {
        let [north, east, down, roll, pitch, yaw] = value;
        let [
            north_rate,
            east_rate,
            down_rate,
            roll_rate,
            pitch_rate,
            yaw_rate,
        ] = rate;
        let [(sr, cr), (sp, cp), (sy, cy)] = [roll, pitch, yaw].map(math::sin_cos);
        let gyro = [
            roll_rate - yaw_rate * sp,
            pitch_rate * cr + yaw_rate * cp * sr,
            yaw_rate * cp * cr - pitch_rate * sr,
        ];
        // From the field's axes to the boat's axes: yaw, then pitch, then roll (Fossen 2011, eq.
        // 2.18).
        let [n, e, d] = [
            acceleration[0],
            acceleration[1],
            acceleration[2] - GRAVITY_M_S2,
        ];
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
    /// The boat's motion, oldest first, starting with the last moment before the firmware's time.
    moments: VecDeque<Moment>,
    /// Game time of the last reply, and of the firmware's time zero.
    clock: Option<(SimTime, SimTime)>,
    /// The last servo outputs, and the time of the newest motion when they arrived.
    outputs: Option<(Outputs, SimTime)>,
    /// Whether the firmware is waiting for a reply.
    waits: bool,
    remarks: VecDeque<String>,
    is_silent: bool,
    garbage: u64,
}

impl Sitl {
    /// A front seat that waits for firmware with these servo outputs.
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
        let starts = self
            .outputs
            .as_ref()
            .is_none_or(|(before, _)| outputs.step < before.step);
        if starts {
            self.clock = None;
            self.remarks
                .push_back(format!("firmware started, {} Hz", outputs.rate_hz));
        } else if self.is_silent {
            self.remarks.push_back("firmware continues".to_owned());
        }
        self.is_silent = false;
        self.waits = true;
        let newest = self
            .moments
            .back()
            .map_or(SimTime::ZERO, |moment| moment.at);
        self.outputs = Some((outputs, newest));
    }

    /// Receives the boat's true motion.
    pub fn observe(&mut self, at: SimTime, truth: &VehicleTruth) {
        let before = self.moments.back();
        // A quarantined boat may have no finite motion. For the firmware, the boat stays at its
        // last position.
        if truth.quarantined || before.is_some_and(|before| before.at >= at) {
            return;
        }
        let moment = Moment::new(at, truth, before);
        self.moments.push_back(moment);
        // Discard motion that is past, or that slow firmware will skip.
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
            self.remarks
                .push_back(format!("no servo outputs for {SILENT_S} s: zero thrust"));
        }
    }

    /// The reply that the firmware waits for, once the simulation has reached the time of the
    /// reply.
    pub fn reply(&mut self) -> Option<String> {
        let newest = self.moments.back()?.at;
        let (outputs, _) = self
            .outputs
            .as_ref()
            .filter(|_| self.waits && self.moments.len() >= 2)?;
        let step_s = 1.0 / f64::from(outputs.rate_hz.clamp(RATE_MIN_HZ, RATE_MAX_HZ));
        let last = self.moments[self.moments.len() - 2].at;
        let (mut now, mut zero) = *self.clock.get_or_insert((last, last));
        let lost_s = (newest - now).as_s();
        if lost_s > LOST_S {
            self.remarks.push_back(format!(
                "firmware was {lost_s:.1} s behind the game: skipped to the present"
            ));
            // The firmware's own clock must not jump, or its drivers would consider their sensors
            // dead.
            zero = zero + (last - now);
            now = last;
        }
        let steps = if (newest - now).as_s() > BEHIND_S {
            2.0
        } else {
            1.0
        };
        let next = now + SimTime::from_s(steps * step_s);
        if next > newest {
            return None;
        }
        self.waits = false;
        self.clock = Some((next, zero));
        let after = self
            .moments
            .iter()
            .position(|moment| moment.at >= next)?
            .max(1);
        let motion = Moment::between(&self.moments[after - 1], &self.moments[after], next);
        let state = State::new((next - zero).as_s(), motion);
        let json = serde_json::to_string(&state).expect("numbers are JSON");
        // The firmware reads the characters between the last two line feeds.
        Some(format!("\n{json}\n"))
    }

    /// The thrusters' order.
    pub fn order(&self) -> Order {
        let Some((outputs, _)) = self.outputs.as_ref().filter(|_| !self.is_silent) else {
            return Order::Hold;
        };
        let thrust = |channel: usize| self.servos.thrust(outputs.pulses_us[channel - 1]);
        Order::Thrust {
            port: thrust(self.servos.port),
            starboard: thrust(self.servos.starboard),
        }
    }

    /// The next log message.
    pub fn take_remark(&mut self) -> Option<String> {
        self.remarks.pop_front()
    }
}

#[cfg(test)]
mod tests;
