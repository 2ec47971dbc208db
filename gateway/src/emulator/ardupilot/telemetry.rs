//! The telemetry of an emulated ArduPilot boat: messages, rates and contents.

#![expect(
    deprecated,
    reason = "ground stations still request streams by REQUEST_DATA_STREAM"
)]

use super::ArduPilot;
use crate::mavlink::RoverMode;
use crate::mavlink::dialect::{
    ATTITUDE_DATA, AUTOPILOT_VERSION_DATA, BATTERY_STATUS_DATA, GLOBAL_POSITION_INT_DATA,
    GPS_RAW_INT_DATA, GpsFixType, HEARTBEAT_DATA, HOME_POSITION_DATA, LOCAL_POSITION_NED_DATA,
    MISSION_CURRENT_DATA, MavAutopilot, MavBatteryFault, MavMessage, MavModeFlag,
    MavProtocolCapability, MavResult, MavState, MavSysStatusSensor, MavSysStatusSensorExtended,
    MavType, NAV_CONTROLLER_OUTPUT_DATA, POSITION_TARGET_GLOBAL_INT_DATA, PositionTargetTypemask,
    REQUEST_DATA_STREAM_DATA, SERVO_OUTPUT_RAW_DATA, SYS_STATUS_DATA, SYSTEM_TIME_DATA,
    VFR_HUD_DATA,
};
use ::mavlink::MessageData;
use messages::Order;
use primitives::SimTime;
use primitives::angle::compass_deg_from_rad;
use primitives::frame::Ned;
use std::collections::BTreeMap;

/// Mask of Rover's POSITION_TARGET_GLOBAL_INT: only the position is valid.
const POSITION_ALONE: u16 = 0xFDF8;
/// Minimum interval of a message, s: Rover sends at no more than four fifths of its 50 Hz loop
/// rate.
const INTERVAL_MIN_S: f64 = 0.025;
/// Version 4.6.3, in ArduPilot's encoding.
const VERSION: u32 = 0x0406_03FF;

/// EKF_STATUS_REPORT of ArduPilot's own dialect: number, CRC_EXTRA byte, and flags when healthy and
/// without a fix.
const EKF_STATUS_REPORT: u32 = 193;
const EKF_EXTRA_CRC: u8 = 71;
const EKF_WELL: u16 = 831;
const EKF_WITHOUT_FIX: u16 = 165;

/// The messages sent once a second by default.
const STREAMED: [u32; 13] = [
    HEARTBEAT_DATA::ID,
    SYS_STATUS_DATA::ID,
    GPS_RAW_INT_DATA::ID,
    NAV_CONTROLLER_OUTPUT_DATA::ID,
    POSITION_TARGET_GLOBAL_INT_DATA::ID,
    MISSION_CURRENT_DATA::ID,
    GLOBAL_POSITION_INT_DATA::ID,
    LOCAL_POSITION_NED_DATA::ID,
    ATTITUDE_DATA::ID,
    VFR_HUD_DATA::ID,
    SYSTEM_TIME_DATA::ID,
    BATTERY_STATUS_DATA::ID,
    EKF_STATUS_REPORT,
];
const INTERVAL_S: f64 = 1.0;
/// The messages sent only on request.
const ON_REQUEST: [u32; 3] = [
    HOME_POSITION_DATA::ID,
    AUTOPILOT_VERSION_DATA::ID,
    SERVO_OUTPUT_RAW_DATA::ID,
];

/// The interval of each message, s, and when it is due.
#[derive(Clone, Debug)]
pub(super) struct Streams {
    regular: BTreeMap<u32, (f64, SimTime)>,
}

impl Streams {
    pub(super) fn new() -> Streams {
        Streams {
            regular: STREAMED.map(|id| (id, (INTERVAL_S, SimTime::ZERO))).into(),
        }
    }

    /// The messages that are due now.
    pub(super) fn due(&mut self, now: SimTime) -> Vec<u32> {
        let mut due = vec![];
        for (id, (every_s, at)) in &mut self.regular {
            if now >= *at {
                // Keep in step with the caller, which polls at its own intervals.
                *at = (*at + SimTime::from_s(*every_s)).max(now);
                due.push(*id);
            }
        }
        due
    }

    /// Sets the interval of a message, µs; -1 means never, 0 means the default
    /// (MAV_CMD_SET_MESSAGE_INTERVAL).
    pub(super) fn set_interval(&mut self, id: u32, interval_us: f64) -> MavResult {
        let is_streamed = STREAMED.contains(&id);
        let is_too_fast = interval_us > 0.0 && interval_us < 1e6 * INTERVAL_MIN_S;
        if !is_streamed && !ON_REQUEST.contains(&id) || interval_us < -1.0 || is_too_fast {
            return MavResult::MAV_RESULT_DENIED;
        }
        let due = self.regular.get(&id).map_or(SimTime::ZERO, |(_, at)| *at);
        if interval_us > 0.0 {
            self.regular.insert(id, (1e-6 * interval_us, due));
        } else if is_streamed && interval_us == 0.0 {
            self.regular.insert(id, (INTERVAL_S, due));
        } else {
            self.regular.remove(&id);
        }
        MavResult::MAV_RESULT_ACCEPTED
    }

    /// Raises the rate of all messages except the heartbeat to the requested rate, whatever the
    /// stream.
    // Never lowers a rate: the gateway depends on the intervals that it has set.
    pub(super) fn take_request(&mut self, request: &REQUEST_DATA_STREAM_DATA) {
        if request.start_stop != 1 || request.req_message_rate == 0 {
            return;
        }
        let every_s = (1.0 / f64::from(request.req_message_rate)).max(INTERVAL_MIN_S);
        for (id, (interval_s, _)) in &mut self.regular {
            if *id != HEARTBEAT_DATA::ID {
                *interval_s = interval_s.min(every_s);
            }
        }
    }
}

impl ArduPilot {
    /// Sends the message with this number and current data. Returns `false` if the boat has no such
    /// message or no data for it.
    pub(super) fn send_message(&mut self, now: SimTime, id: u32) -> bool {
        if id == EKF_STATUS_REPORT {
            let flags = if self.sensed.has_fix(now) {
                EKF_WELL
            } else {
                EKF_WITHOUT_FIX
            };
            // Five variances that are 0, then the flags.
            let payload = [&[0; 20][..], &flags.to_le_bytes()].concat();
            self.writer
                .write_raw(id, EKF_EXTRA_CRC, &payload, &mut self.outbox);
            return true;
        }
        let message = self.message(now, id);
        message.iter().for_each(|message| self.send(message));
        message.is_some()
    }

    fn message(&self, now: SimTime, id: u32) -> Option<MavMessage> {
        Some(match id {
            HEARTBEAT_DATA::ID => MavMessage::HEARTBEAT(self.heartbeat()),
            SYS_STATUS_DATA::ID => MavMessage::SYS_STATUS(self.sys_status()),
            NAV_CONTROLLER_OUTPUT_DATA::ID if self.mode == RoverMode::Guided => {
                MavMessage::NAV_CONTROLLER_OUTPUT(NAV_CONTROLLER_OUTPUT_DATA {
                    nav_bearing: self.set_points.nav_bearing(now),
                    ..Default::default()
                })
            }
            // Rover's message contains no velocities.
            POSITION_TARGET_GLOBAL_INT_DATA::ID if self.mode == RoverMode::Guided => {
                let (lat_int, lon_int) = self.e7(self.position_target()?);
                MavMessage::POSITION_TARGET_GLOBAL_INT(POSITION_TARGET_GLOBAL_INT_DATA {
                    time_boot_ms: boot_ms(now),
                    type_mask: PositionTargetTypemask::from_bits_retain(POSITION_ALONE),
                    lat_int,
                    lon_int,
                    ..Default::default()
                })
            }
            MISSION_CURRENT_DATA::ID => self.mission.current(self.autopilot.next),
            SYSTEM_TIME_DATA::ID => MavMessage::SYSTEM_TIME(SYSTEM_TIME_DATA {
                time_unix_usec: self.utc_us(now),
                time_boot_ms: boot_ms(now),
            }),
            SERVO_OUTPUT_RAW_DATA::ID => MavMessage::SERVO_OUTPUT_RAW(self.outputs(now)?),
            BATTERY_STATUS_DATA::ID => MavMessage::BATTERY_STATUS(self.battery()),
            HOME_POSITION_DATA::ID => MavMessage::HOME_POSITION(HOME_POSITION_DATA {
                latitude: self.home?.0,
                longitude: self.home?.1,
                q: [1.0, 0.0, 0.0, 0.0],
                ..HOME_POSITION_DATA::default()
            }),
            AUTOPILOT_VERSION_DATA::ID => MavMessage::AUTOPILOT_VERSION(version()),
            _ => return self.motion(now, id),
        })
    }

    /// The message with the measured position and motion.
    fn motion(&self, now: SimTime, id: u32) -> Option<MavMessage> {
        let nav = self.sensed.own?.nav;
        let (at, velocity) = (nav.at(), nav.velocity_m_s());
        let (lat, lon) = self.e7(at);
        let has_fix = self.sensed.has_fix(now);
        // Stay below 36000, which is not a valid angle.
        let centidegrees = |rad| ((100.0 * compass_deg_from_rad(rad)) as u16).min(35_999);
        let time_boot_ms = boot_ms(now);
        Some(match id {
            GPS_RAW_INT_DATA::ID => MavMessage::GPS_RAW_INT(GPS_RAW_INT_DATA {
                time_usec: self.utc_us(now),
                lat,
                lon,
                alt: 5500,
                eph: if has_fix { 98 } else { u16::MAX },
                epv: if has_fix { 150 } else { u16::MAX },
                vel: (100.0 * velocity.length()) as u16,
                cog: centidegrees(velocity.direction_rad()),
                fix_type: if has_fix {
                    GpsFixType::GPS_FIX_TYPE_DGPS
                } else {
                    GpsFixType::GPS_FIX_TYPE_NO_FIX
                },
                satellites_visible: if has_fix { 11 } else { 0 },
                ..GPS_RAW_INT_DATA::default()
            }),
            GLOBAL_POSITION_INT_DATA::ID => {
                MavMessage::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA {
                    time_boot_ms,
                    lat,
                    lon,
                    alt: 5500,
                    vx: (100.0 * velocity.north).round() as i16,
                    vy: (100.0 * velocity.east).round() as i16,
                    hdg: centidegrees(nav.psi_rad),
                    ..GLOBAL_POSITION_INT_DATA::default()
                })
            }
            ATTITUDE_DATA::ID => MavMessage::ATTITUDE(ATTITUDE_DATA {
                time_boot_ms,
                yaw: primitives::angle::wrap_pi(nav.psi_rad) as f32,
                yawspeed: nav.yaw_rate_rad_s as f32,
                ..ATTITUDE_DATA::default()
            }),
            LOCAL_POSITION_NED_DATA::ID => {
                let origin = self.origin?;
                MavMessage::LOCAL_POSITION_NED(LOCAL_POSITION_NED_DATA {
                    time_boot_ms,
                    x: (at.north - origin.north) as f32,
                    y: (at.east - origin.east) as f32,
                    vx: velocity.north as f32,
                    vy: velocity.east as f32,
                    ..LOCAL_POSITION_NED_DATA::default()
                })
            }
            VFR_HUD_DATA::ID => MavMessage::VFR_HUD(VFR_HUD_DATA {
                groundspeed: velocity.length() as f32,
                heading: compass_deg_from_rad(nav.psi_rad) as i16,
                ..VFR_HUD_DATA::default()
            }),
            _ => return None,
        })
    }

    /// The pulses for the thrusters, outputs 1 and 3. `None` for a set-point of speed and heading:
    /// the simulation carries it out, so its thrust is unknown here.
    fn outputs(&self, now: SimTime) -> Option<SERVO_OUTPUT_RAW_DATA> {
        let [port, starboard] = match self.order {
            Order::Thrust { port, starboard } => [port, starboard],
            Order::Hold => [0.0; 2],
            _ => return None,
        };
        let pulse_us = |share: f64| match self.is_armed {
            true => (1500.0 + 400.0 * share).round() as u16,
            false => 0,
        };
        Some(SERVO_OUTPUT_RAW_DATA {
            time_usec: boot_ms(now).wrapping_mul(1000),
            servo1_raw: pulse_us(port),
            servo3_raw: pulse_us(starboard),
            ..SERVO_OUTPUT_RAW_DATA::default()
        })
    }

    pub(super) fn heartbeat(&self) -> HEARTBEAT_DATA {
        let mut base_mode = MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED;
        base_mode |= match self.mode {
            RoverMode::Manual | RoverMode::Acro | RoverMode::Steering => {
                MavModeFlag::MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
            }
            RoverMode::Hold => MavModeFlag::empty(),
            _ => MavModeFlag::MAV_MODE_FLAG_GUIDED_ENABLED,
        };
        if self.is_armed {
            base_mode |= MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED;
        }
        HEARTBEAT_DATA {
            custom_mode: self.mode.number(),
            mavtype: MavType::MAV_TYPE_SURFACE_BOAT,
            autopilot: MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
            base_mode,
            // Rover's state depends on the mode, not on whether the boat is armed.
            system_status: match self.mode {
                _ if self.station.is_triggered => MavState::MAV_STATE_CRITICAL,
                RoverMode::Hold => MavState::MAV_STATE_STANDBY,
                _ => MavState::MAV_STATE_ACTIVE,
            },
            ..HEARTBEAT_DATA::default()
        }
    }

    fn sys_status(&self) -> SYS_STATUS_DATA {
        let sensors = MavSysStatusSensor::MAV_SYS_STATUS_SENSOR_3D_GYRO
            | MavSysStatusSensor::MAV_SYS_STATUS_SENSOR_3D_MAG
            | MavSysStatusSensor::MAV_SYS_STATUS_SENSOR_GPS
            | MavSysStatusSensor::MAV_SYS_STATUS_SENSOR_BATTERY;
        SYS_STATUS_DATA {
            onboard_control_sensors_present: sensors,
            onboard_control_sensors_enabled: sensors,
            onboard_control_sensors_health: sensors,
            // By default, the crate sets the first flag of these fields.
            onboard_control_sensors_present_extended: MavSysStatusSensorExtended::empty(),
            onboard_control_sensors_enabled_extended: MavSysStatusSensorExtended::empty(),
            onboard_control_sensors_health_extended: MavSysStatusSensorExtended::empty(),
            load: 120,
            voltage_battery: self.millivolts(),
            current_battery: self.centiamps(),
            battery_remaining: self.percent_left(),
            ..SYS_STATUS_DATA::default()
        }
    }

    fn millivolts(&self) -> u16 {
        (1000.0 * self.battery.volts()).round().clamp(0.0, 65_534.0) as u16
    }

    /// The current, in units of 10 mA.
    fn centiamps(&self) -> i16 {
        (100.0 * self.battery.amps())
            .round()
            .clamp(0.0, f64::from(i16::MAX)) as i16
    }

    fn percent_left(&self) -> i8 {
        (100.0 * self.battery.left).round() as i8
    }

    fn battery(&self) -> BATTERY_STATUS_DATA {
        let mut voltages = [u16::MAX; 10];
        // The first cell shows the voltage of the whole pack and the others are unused, as on
        // boards without cell monitors.
        voltages[0] = self.millivolts();
        BATTERY_STATUS_DATA {
            current_consumed: self.battery.used_mah().round() as i32,
            energy_consumed: -1,
            temperature: i16::MAX,
            voltages,
            fault_bitmask: MavBatteryFault::empty(),
            current_battery: self.centiamps(),
            battery_remaining: self.percent_left(),
            ..BATTERY_STATUS_DATA::default()
        }
    }

    /// The destination in GUIDED, or the point where the boat keeps station without a set-point.
    fn position_target(&self) -> Option<Ned> {
        match self.set_points.destination() {
            Some((place, _)) => Some(place),
            None if self.set_points.guided.is_none() => self.autopilot.station,
            None => None,
        }
    }
}

fn boot_ms(now: SimTime) -> u32 {
    (1000.0 * now.as_s()) as u32
}

fn version() -> AUTOPILOT_VERSION_DATA {
    let capabilities = MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_MISSION_FLOAT
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_MISSION_INT
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_COMMAND_INT
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_SET_ATTITUDE_TARGET
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_GLOBAL_INT
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_MAVLINK2;
    AUTOPILOT_VERSION_DATA {
        capabilities,
        flight_sw_version: VERSION,
        ..AUTOPILOT_VERSION_DATA::default()
    }
}
