//! The telemetry of an emulated ArduPilot boat: messages, rates and contents.

#![expect(
    deprecated,
    reason = "ground stations still request streams by REQUEST_DATA_STREAM"
)]

use super::ArduPilot;
use crate::mavlink::RoverMode;
use crate::mavlink::dialect::{
    ATTITUDE_DATA, AUTOPILOT_VERSION_DATA, BATTERY_STATUS_DATA, GLOBAL_POSITION_INT_DATA,
    GPS_GLOBAL_ORIGIN_DATA, GPS_RAW_INT_DATA, GpsFixType, HEARTBEAT_DATA, HOME_POSITION_DATA,
    LOCAL_POSITION_NED_DATA, MESSAGE_INTERVAL_DATA, MISSION_CURRENT_DATA, MavAutopilot,
    MavBatteryFault, MavDataStream, MavMessage, MavModeFlag, MavProtocolCapability, MavResult,
    MavState, MavSysStatusSensor, MavSysStatusSensorExtended, MavType, NAV_CONTROLLER_OUTPUT_DATA,
    POSITION_TARGET_GLOBAL_INT_DATA, PositionTargetTypemask, REQUEST_DATA_STREAM_DATA,
    SYS_STATUS_DATA, SYSTEM_TIME_DATA, VFR_HUD_DATA,
};
use ::mavlink::MessageData;
use primitives::SimTime;
use primitives::angle::compass_deg_from_rad;
use primitives::frame::Ned;
use std::collections::BTreeMap;

/// Mask of Rover's POSITION_TARGET_GLOBAL_INT: only the position is valid.
const POSITION_ALONE: u16 = 0xFDF8;
/// Minimum interval of a message, s: four fifths of Rover's 50 loops a second.
const INTERVAL_MIN_S: f64 = 0.025;
/// Version 4.6.3, in ArduPilot's encoding.
const VERSION: u32 = 0x0406_03FF;

/// EKF_STATUS_REPORT of ArduPilot's own dialect: number, CRC_EXTRA byte, and flags when healthy and
/// without a fix.
const EKF_STATUS_REPORT: u32 = 193;
const EKF_EXTRA_CRC: u8 = 71;
const EKF_WELL: u16 = 831;
const EKF_WITHOUT_FIX: u16 = 165;

/// The messages of each stream, sent once a second by default.
const STREAMS: [(MavDataStream, &[u32]); 6] = [
    (MavDataStream::MAV_DATA_STREAM_ALL, &[HEARTBEAT_DATA::ID]),
    (
        MavDataStream::MAV_DATA_STREAM_EXTENDED_STATUS,
        &[
            SYS_STATUS_DATA::ID,
            GPS_RAW_INT_DATA::ID,
            NAV_CONTROLLER_OUTPUT_DATA::ID,
            POSITION_TARGET_GLOBAL_INT_DATA::ID,
            MISSION_CURRENT_DATA::ID,
        ],
    ),
    (
        MavDataStream::MAV_DATA_STREAM_POSITION,
        &[GLOBAL_POSITION_INT_DATA::ID, LOCAL_POSITION_NED_DATA::ID],
    ),
    (MavDataStream::MAV_DATA_STREAM_EXTRA1, &[ATTITUDE_DATA::ID]),
    (MavDataStream::MAV_DATA_STREAM_EXTRA2, &[VFR_HUD_DATA::ID]),
    (
        MavDataStream::MAV_DATA_STREAM_EXTRA3,
        &[
            SYSTEM_TIME_DATA::ID,
            BATTERY_STATUS_DATA::ID,
            EKF_STATUS_REPORT,
        ],
    ),
];
const INTERVAL_S: f64 = 1.0;
/// The messages sent only on request.
const ON_REQUEST: [u32; 3] = [
    HOME_POSITION_DATA::ID,
    GPS_GLOBAL_ORIGIN_DATA::ID,
    AUTOPILOT_VERSION_DATA::ID,
];

/// The messages of all streams.
fn streamed() -> impl Iterator<Item = u32> {
    STREAMS.iter().flat_map(|(_, ids)| *ids).copied()
}

/// The interval of each message, s, and when it is due.
#[derive(Clone, Debug)]
pub(super) struct Streams {
    regular: BTreeMap<u32, (f64, SimTime)>,
}

impl Streams {
    pub(super) fn new() -> Streams {
        Streams {
            regular: streamed()
                .map(|id| (id, (INTERVAL_S, SimTime::ZERO)))
                .collect(),
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

    /// Sets the interval of a message, µs; -1 means never, 0 means the default.
    // Zero requests the default rate, and a negative interval stops the message
    // (MAV_CMD_SET_MESSAGE_INTERVAL).
    pub(super) fn set_interval(&mut self, id: u32, interval_us: f64) -> MavResult {
        let is_streamed = streamed().any(|known| known == id);
        let is_too_fast = interval_us > 0.0 && interval_us < 1e6 * INTERVAL_MIN_S;
        if !is_streamed && !ON_REQUEST.contains(&id) || interval_us < -1.0 || is_too_fast {
            return MavResult::MAV_RESULT_DENIED;
        }
        let every_s = if interval_us > 0.0 {
            Some(1e-6 * interval_us)
        } else {
            (is_streamed && interval_us == 0.0).then_some(INTERVAL_S)
        };
        self.set(id, every_s);
        MavResult::MAV_RESULT_ACCEPTED
    }

    /// The interval of a message, µs: -1 means never; 0 means that the message is unsupported.
    fn interval_us(&self, id: u32) -> i32 {
        let is_known = streamed().chain(ON_REQUEST).any(|known| known == id);
        let never = if is_known { -1 } else { 0 };
        self.regular
            .get(&id)
            .map_or(never, |(every_s, _)| (1e6 * every_s).round() as i32)
    }

    /// Sets the rate of one stream, or of all.
    pub(super) fn take_request(&mut self, request: &REQUEST_DATA_STREAM_DATA) {
        let every_s = (request.start_stop == 1 && request.req_message_rate > 0)
            .then(|| 1.0 / f64::from(request.req_message_rate));
        let is_all = request.req_stream_id == MavDataStream::MAV_DATA_STREAM_ALL;
        let asked = STREAMS
            .iter()
            .filter(|(stream, _)| is_all || *stream == request.req_stream_id);
        // The heartbeat always continues.
        for id in asked
            .flat_map(|(_, ids)| *ids)
            .filter(|id| **id != HEARTBEAT_DATA::ID)
        {
            self.set(*id, every_s);
        }
    }

    fn set(&mut self, id: u32, every_s: Option<f64>) {
        match every_s {
            Some(every_s) => {
                let due = self.regular.get(&id).map_or(SimTime::ZERO, |(_, at)| *at);
                self.regular.insert(id, (every_s.max(INTERVAL_MIN_S), due));
            }
            None => drop(self.regular.remove(&id)),
        }
    }
}

impl ArduPilot {
    /// Reports the interval of a message.
    pub(super) fn show_interval(&mut self, id: u32) -> MavResult {
        let interval_us = self.streams.interval_us(id);
        let shown = MESSAGE_INTERVAL_DATA {
            interval_us,
            message_id: id as u16,
        };
        self.send(&MavMessage::MESSAGE_INTERVAL(shown));
        if interval_us == 0 {
            MavResult::MAV_RESULT_FAILED
        } else {
            MavResult::MAV_RESULT_ACCEPTED
        }
    }

    /// Sends a message with current data; returns whether there were any.
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
            GPS_RAW_INT_DATA::ID => MavMessage::GPS_RAW_INT(self.gps_raw(now)?),
            GLOBAL_POSITION_INT_DATA::ID => MavMessage::GLOBAL_POSITION_INT(self.position(now)?),
            ATTITUDE_DATA::ID => MavMessage::ATTITUDE(self.attitude(now)?),
            NAV_CONTROLLER_OUTPUT_DATA::ID if self.mode == RoverMode::Guided => {
                MavMessage::NAV_CONTROLLER_OUTPUT(NAV_CONTROLLER_OUTPUT_DATA {
                    nav_bearing: self.set_points.nav_bearing(now),
                    ..Default::default()
                })
            }
            // It contains no velocities.
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
            LOCAL_POSITION_NED_DATA::ID => {
                MavMessage::LOCAL_POSITION_NED(self.local_position(now)?)
            }
            GPS_GLOBAL_ORIGIN_DATA::ID if self.origin.is_some() => self.origin_message(),
            VFR_HUD_DATA::ID => MavMessage::VFR_HUD(self.vfr_hud()?),
            SYSTEM_TIME_DATA::ID => MavMessage::SYSTEM_TIME(SYSTEM_TIME_DATA {
                time_unix_usec: self.utc_us(now),
                time_boot_ms: boot_ms(now),
            }),
            BATTERY_STATUS_DATA::ID => MavMessage::BATTERY_STATUS(self.battery()),
            HOME_POSITION_DATA::ID => MavMessage::HOME_POSITION(HOME_POSITION_DATA {
                latitude: self.home?.0,
                longitude: self.home?.1,
                q: [1.0, 0.0, 0.0, 0.0],
                ..HOME_POSITION_DATA::default()
            }),
            AUTOPILOT_VERSION_DATA::ID => MavMessage::AUTOPILOT_VERSION(version()),
            _ => return None,
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
            // Depends on the mode, whether armed or not.
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
            // The crate's default for flags is the first one.
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

    fn gps_raw(&self, now: SimTime) -> Option<GPS_RAW_INT_DATA> {
        let (lat, lon) = self.lat_lon_e7()?;
        let nav = self.sensed.own?.nav;
        let has_fix = self.sensed.has_fix(now);
        let velocity = nav.velocity_m_s();
        let course_deg = compass_deg_from_rad(velocity.direction_rad());
        Some(GPS_RAW_INT_DATA {
            time_usec: self.utc_us(now),
            lat,
            lon,
            alt: 5500,
            eph: if has_fix { 98 } else { u16::MAX },
            epv: if has_fix { 150 } else { u16::MAX },
            vel: (100.0 * velocity.length()) as u16,
            cog: ((100.0 * course_deg) as u16).min(35_999),
            fix_type: if has_fix {
                GpsFixType::GPS_FIX_TYPE_DGPS
            } else {
                GpsFixType::GPS_FIX_TYPE_NO_FIX
            },
            satellites_visible: if has_fix { 11 } else { 0 },
            ..GPS_RAW_INT_DATA::default()
        })
    }

    pub(super) fn lat_lon_e7(&self) -> Option<(i32, i32)> {
        Some(self.e7(self.sensed.own?.nav.at()))
    }

    /// The destination in GUIDED, or the point where the boat keeps station without a set-point.
    fn position_target(&self) -> Option<Ned> {
        let destination = self.set_points.destination().map(|(place, _)| place);
        destination.or_else(|| {
            self.autopilot
                .station
                .filter(|_| self.set_points.guided.is_none())
        })
    }

    /// The origin of positions in the frame LOCAL_NED.
    pub(super) fn origin_message(&self) -> MavMessage {
        let (latitude, longitude) = self.e7(self.origin.unwrap_or_default());
        MavMessage::GPS_GLOBAL_ORIGIN(GPS_GLOBAL_ORIGIN_DATA {
            latitude,
            longitude,
            ..Default::default()
        })
    }

    fn local_position(&self, now: SimTime) -> Option<LOCAL_POSITION_NED_DATA> {
        let nav = self.sensed.own?.nav;
        let origin = self.origin?;
        let at = nav.at();
        let velocity = nav.velocity_m_s();
        Some(LOCAL_POSITION_NED_DATA {
            time_boot_ms: boot_ms(now),
            x: (at.north - origin.north) as f32,
            y: (at.east - origin.east) as f32,
            vx: velocity.north as f32,
            vy: velocity.east as f32,
            ..LOCAL_POSITION_NED_DATA::default()
        })
    }

    fn position(&self, now: SimTime) -> Option<GLOBAL_POSITION_INT_DATA> {
        let (lat, lon) = self.lat_lon_e7()?;
        let nav = self.sensed.own?.nav;
        let velocity = nav.velocity_m_s();
        Some(GLOBAL_POSITION_INT_DATA {
            time_boot_ms: boot_ms(now),
            lat,
            lon,
            alt: 5500,
            relative_alt: 0,
            vx: (100.0 * velocity.north).round() as i16,
            vy: (100.0 * velocity.east).round() as i16,
            vz: 0,
            // Kept below 36000, which is not a valid heading.
            hdg: ((100.0 * compass_deg_from_rad(nav.psi_rad)) as u16).min(35_999),
        })
    }

    fn attitude(&self, now: SimTime) -> Option<ATTITUDE_DATA> {
        let nav = self.sensed.own?.nav;
        Some(ATTITUDE_DATA {
            time_boot_ms: boot_ms(now),
            yaw: primitives::angle::wrap_pi(nav.psi_rad) as f32,
            yawspeed: nav.yaw_rate_rad_s as f32,
            ..ATTITUDE_DATA::default()
        })
    }

    fn vfr_hud(&self) -> Option<VFR_HUD_DATA> {
        let nav = self.sensed.own?.nav;
        Some(VFR_HUD_DATA {
            groundspeed: nav.velocity_m_s().length() as f32,
            heading: compass_deg_from_rad(nav.psi_rad) as i16,
            ..VFR_HUD_DATA::default()
        })
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
