//! The state of an ArduPilot boat, from its messages.

use super::report::{ControlReport, Fix, Heading, North, Power, Report, Shown};
use super::status_text::StatusTexts;
use crate::mavlink::dialect::{
    ATTITUDE_DATA, COMMAND_ACK_DATA, GLOBAL_POSITION_INT_DATA, GPS_RAW_INT_DATA, GpsFixType,
    HEARTBEAT_DATA, MavAutopilot, MavCmd, MavMessage, MavModeFlag, MavResult, MavSeverity, MavType,
};
use crate::mavlink::{AUTOPILOT, Received, RoverMode, on_globe};
use crate::nmea::{FixQuality, Mode, Operator, date_and_time};
use ::mavlink::Message;
use primitives::SimTime;
use primitives::frame::Ned;

/// Time (s) without a reported fix after which a receiver counts as having none.
const FIX_TYPE_AGE_MAX_S: f64 = 2.0;
/// Time (s) without ATTITUDE after which the heading comes from the position message.
const ATTITUDE_AGE_MAX_S: f64 = 1.0;
/// Lifetime of the set-point reported by the boat, s: three report intervals.
const TARGET_AGE_MAX_S: f64 = 0.6;
/// Maximum number of ground stations stored.
const STATIONS_MAX: usize = 8;

/// A mode, and whether the boat is armed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ShownMode {
    pub(super) mode: RoverMode,
    pub(super) is_armed: bool,
}

/// A mode requested from the boat.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked {
    pub(super) mode: RoverMode,
    pub(super) is_armed: bool,
    pub(super) at: SimTime,
    /// Whether the boat has reported the mode.
    pub(super) is_shown: bool,
}

impl Asked {
    /// A request that the boat has not answered yet.
    pub(super) fn new(mode: RoverMode, is_armed: bool, at: SimTime) -> Asked {
        Asked {
            mode,
            is_armed,
            at,
            is_shown: false,
        }
    }
}

/// The system and component that a message addresses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Target {
    pub(super) system: u8,
    pub(super) component: u8,
}

/// The data from the boat's messages.
#[derive(Clone, Debug)]
pub(super) struct Boat {
    /// The boat's system number, once known.
    pub(super) system: Option<u8>,
    pub(super) mode: Option<ShownMode>,
    /// Number of messages from other systems and components.
    pub(super) others: u64,
    /// The receiver's report of its fix, and when it arrived.
    fix: Option<(SimTime, Fix)>,
    position_ms: Option<u32>,
    attitude_at: SimTime,
    has_volts: bool,
    /// The ordered heading reported in GUIDED (degrees), and when it arrived.
    ordered: Option<(SimTime, f64)>,
    /// When the boat last reported a destination in GUIDED.
    position_target_at: SimTime,
    texts: StatusTexts,
    /// Other ground stations that were heard: system and component.
    stations: Vec<(u8, u8)>,
}

impl Boat {
    /// The boat with this system number; 0 means the first boat heard.
    pub(super) fn new(system: u8) -> Boat {
        Boat {
            system: (system != 0).then_some(system),
            mode: None,
            others: 0,
            fix: None,
            position_ms: None,
            attitude_at: SimTime::LONG_AGO,
            has_volts: false,
            ordered: None,
            position_target_at: SimTime::LONG_AGO,
            texts: StatusTexts::default(),
            stations: vec![],
        }
    }

    pub(super) fn forget(&mut self, system: u8) {
        *self = Boat {
            others: self.others,
            ..Boat::new(system)
        };
    }

    /// The target of messages for the boat.
    pub(super) fn target(&self) -> Target {
        // While the boat is unknown, broadcast: a zero set-point may go to everyone.
        let system = self.system.unwrap_or(0);
        Target {
            system,
            component: if system == 0 { 0 } else { AUTOPILOT },
        }
    }

    /// Whether a message is from this boat. If no system number is set, the first boat heard
    /// becomes this boat.
    pub(super) fn is_its(&mut self, received: &Received) -> bool {
        if let (None, MavMessage::HEARTBEAT(heartbeat)) = (self.system, &received.message)
            && received.component == AUTOPILOT
            && is_boat(heartbeat)
        {
            self.system = Some(received.system);
        }
        // Cameras and gimbals on the boat share its system number and also send heartbeats.
        let is_its = self.system == Some(received.system) && received.component == AUTOPILOT;
        self.others += u64::from(!is_its);
        is_its
    }

    /// Whether no one else commands the boat: it is in GUIDED or HOLD, or in the mode that we
    /// requested.
    pub(super) fn is_ours(&self, asked: Option<&Asked>) -> bool {
        self.mode.is_none_or(|shown| {
            matches!(shown.mode, RoverMode::Guided | RoverMode::Hold)
                || asked.is_some_and(|asked| asked.mode == shown.mode)
        })
    }

    /// Reports other senders' set-points for the boat, and other ground stations, if the boat or a
    /// router forwards them to us.
    pub(super) fn report_stranger(&mut self, received: &Received, take: &mut dyn FnMut(Report)) {
        let Received {
            system,
            component,
            message,
        } = received;
        let is_for_it = message
            .target_system_id()
            .is_some_and(|target| target == 0 || Some(target) == self.system);
        match message {
            MavMessage::SET_ATTITUDE_TARGET(_)
            | MavMessage::SET_POSITION_TARGET_LOCAL_NED(_)
            | MavMessage::SET_POSITION_TARGET_GLOBAL_INT(_)
                if is_for_it =>
            {
                take(Report::ForeignOrder);
            }
            MavMessage::HEARTBEAT(heartbeat)
                if heartbeat.mavtype == MavType::MAV_TYPE_GCS
                    && self.stations.len() < STATIONS_MAX
                    && !self.stations.contains(&(*system, *component)) =>
            {
                self.stations.push((*system, *component));
                let text = format!(
                    "another ground station is on the link: system {system}, component {component}"
                );
                take(Report::Station(text));
            }
            _ => {}
        }
    }

    pub(super) fn take_heartbeat(
        &mut self,
        now: SimTime,
        heartbeat: &HEARTBEAT_DATA,
        asked: &mut Option<Asked>,
    ) -> ControlReport {
        let is_armed = heartbeat
            .base_mode
            .contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED);
        let shown = ShownMode {
            mode: RoverMode::from_number(heartbeat.custom_mode),
            is_armed,
        };
        self.mode = Some(shown);
        let is_ours = self.is_ours(asked.as_ref());
        if !is_ours {
            // Another operator took over the boat: our earlier request must not count if the boat
            // happens to enter that mode later.
            *asked = None;
        }
        if let Some(asked) = asked {
            asked.is_shown |= (asked.mode, asked.is_armed) == (shown.mode, is_armed);
        }
        let is_fresh = |at: SimTime| (now - at).as_s() <= TARGET_AGE_MAX_S;
        let mode = match shown.mode {
            // Whatever the mode, a boat that is not armed does not move.
            _ if is_ours && !is_armed => Mode::Standby,
            RoverMode::Hold => Mode::Standby,
            // We never send the boat a position.
            RoverMode::Guided if is_fresh(self.position_target_at) => Mode::Waypoint,
            RoverMode::Guided => Mode::Speed,
            RoverMode::Loiter => Mode::StationKeep,
            RoverMode::Rtl | RoverMode::SmartRtl => Mode::GoToErp,
            RoverMode::Auto => Mode::Waypoint,
            RoverMode::Manual => Mode::Thruster,
            RoverMode::Acro | RoverMode::Steering => Mode::Heading,
            RoverMode::Initialising => Mode::BootLoader,
            RoverMode::Other(_) => Mode::Autopilot,
        };
        let operator = match shown.mode {
            _ if is_ours => Operator::Secondary,
            RoverMode::Manual | RoverMode::Acro | RoverMode::Steering => Operator::Rc,
            // A ground station, or one of the boat's own failsafes.
            _ => Operator::Primary,
        };
        let heading_deg = self
            .ordered
            .filter(|(at, _)| is_fresh(*at))
            .map(|(_, heading_deg)| heading_deg);
        let shown = Shown {
            mode,
            heading_deg,
            thrust: None,
            difference: None,
        };
        ControlReport {
            shown,
            operator: Some(operator),
        }
    }

    /// The reports in a message.
    pub(super) fn report(
        &mut self,
        now: SimTime,
        message: &MavMessage,
        take: &mut dyn FnMut(Report),
    ) {
        self.texts
            .take_overdue(now, &mut |text| take(Report::Notice(text)));
        let is_guided = self.mode
            == Some(ShownMode {
                mode: RoverMode::Guided,
                is_armed: true,
            });
        match message {
            // From version 4.7 on, this contains the ordered heading; in earlier versions 0, or the
            // bearing to a position.
            MavMessage::NAV_CONTROLLER_OUTPUT(shown) if is_guided => {
                self.ordered = Some((now, f64::from(shown.nav_bearing)));
            }
            // Rover sends this message only for positions, and when it keeps station without a
            // set-point.
            MavMessage::POSITION_TARGET_GLOBAL_INT(_) if is_guided => self.position_target_at = now,
            // Until the boat reports that it is armed in GUIDED, no set-point that it reports is
            // ours.
            MavMessage::NAV_CONTROLLER_OUTPUT(_) | MavMessage::POSITION_TARGET_GLOBAL_INT(_) => {
                (self.ordered, self.position_target_at) = (None, SimTime::LONG_AGO);
            }
            MavMessage::GPS_RAW_INT(gps) => self.fix = Some((now, fix(gps))),
            MavMessage::GLOBAL_POSITION_INT(position) => self.take_position(now, position, take),
            MavMessage::ATTITUDE(ATTITUDE_DATA {
                roll,
                pitch,
                yaw,
                yawspeed,
                ..
            }) => {
                take(Report::Tilt(
                    [*roll, *pitch].map(|angle| f64::from(angle).to_degrees()),
                ));
                self.attitude_at = now;
                let deg = f64::from(*yaw).to_degrees();
                let yaw_rate = f64::from(*yawspeed).to_degrees();
                take(Report::Heading(Heading {
                    deg,
                    north: North::True,
                    yaw_rate_deg_s: Some(yaw_rate),
                }));
            }
            MavMessage::SYS_STATUS(status) => {
                // SYS_STATUS and BATTERY_STATUS may report the same battery; every board sends
                // SYS_STATUS.
                let volts = millivolts(status.voltage_battery);
                self.has_volts = volts.is_some();
                let left_pct = charge_pct(status.battery_remaining);
                volts.into_iter().for_each(|volts| {
                    take(Report::Power(Power {
                        volts: Some(volts),
                        left_pct,
                        ..Power::default()
                    }))
                });
            }
            MavMessage::BATTERY_STATUS(battery) if battery.id == 0 && !self.has_volts => {
                let cells: Vec<f64> = battery
                    .voltages
                    .iter()
                    .filter_map(|cell| millivolts(*cell))
                    .collect();
                let volts = (!cells.is_empty()).then(|| cells.iter().sum());
                let left_pct = charge_pct(battery.battery_remaining);
                take(Report::Power(Power {
                    volts,
                    left_pct,
                    ..Power::default()
                }));
            }
            MavMessage::SYSTEM_TIME(time) if time.time_unix_usec > 0 => {
                let (_, time) = date_and_time(time.time_unix_usec.saturating_mul(1000));
                take(Report::Clock(time));
            }
            // Messages below the severity of a warning are sent all the time, and would hide
            // important ones.
            MavMessage::STATUSTEXT(status)
                if status.severity as u8 <= MavSeverity::MAV_SEVERITY_WARNING as u8 =>
            {
                self.texts
                    .take(now, status, &mut |text| take(Report::Notice(text)));
            }
            MavMessage::COMMAND_ACK(COMMAND_ACK_DATA {
                command, result, ..
            }) => {
                // Accept replies only to commands that we send ourselves: a reply goes to everyone
                // on the link.
                let is_orderly = matches!(
                    command,
                    MavCmd::MAV_CMD_DO_SET_MODE
                        | MavCmd::MAV_CMD_COMPONENT_ARM_DISARM
                        | MavCmd::MAV_CMD_DO_SET_HOME
                        | MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL
                );
                let is_taken = matches!(
                    result,
                    MavResult::MAV_RESULT_ACCEPTED | MavResult::MAV_RESULT_IN_PROGRESS
                );
                if is_orderly && !is_taken {
                    take(Report::Notice(format!("{command:?}: {result:?}")));
                }
            }
            _ => {}
        }
    }

    fn take_position(
        &mut self,
        now: SimTime,
        position: &GLOBAL_POSITION_INT_DATA,
        take: &mut dyn FnMut(Report),
    ) {
        let GLOBAL_POSITION_INT_DATA {
            time_boot_ms,
            lat,
            lon,
            vx,
            vy,
            hdg,
            ..
        } = *position;
        // Ignore repeats: a router may deliver a message by two routes.
        if self.position_ms.replace(time_boot_ms) == Some(time_boot_ms) {
            return;
        }
        if hdg < 36_000 && (now - self.attitude_at).as_s() > ATTITUDE_AGE_MAX_S {
            let deg = 0.01 * f64::from(hdg);
            take(Report::Heading(Heading {
                deg,
                north: North::True,
                yaw_rate_deg_s: None,
            }));
        }
        take(Report::Velocity(Ned {
            north: 0.01 * f64::from(vx),
            east: 0.01 * f64::from(vy),
        }));
        // The position is an estimate that continues without a receiver; the fix states its
        // quality.
        let fix = self
            .fix
            .filter(|(at, _)| (now - *at).as_s() <= FIX_TYPE_AGE_MAX_S);
        let fix = fix.map_or(
            Fix {
                quality: Some(FixQuality::NONE),
                ..Fix::default()
            },
            |(_, fix)| fix,
        );
        take(Report::Fix(Fix {
            at: on_globe((lat, lon)),
            ..fix
        }));
    }
}

/// Whether this is ArduPilot on a boat, or on a rover, which runs the same firmware.
fn is_boat(heartbeat: &HEARTBEAT_DATA) -> bool {
    let is_vehicle = matches!(
        heartbeat.mavtype,
        MavType::MAV_TYPE_SURFACE_BOAT | MavType::MAV_TYPE_GROUND_ROVER
    );
    is_vehicle && heartbeat.autopilot == MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA
}

/// A fix without its position.
fn fix(gps: &GPS_RAW_INT_DATA) -> Fix {
    Fix {
        quality: Some(quality(gps)),
        // The maximum values mean unknown.
        hdop: (gps.eph != u16::MAX).then(|| 0.01 * f64::from(gps.eph)),
        satellites: (gps.satellites_visible != u8::MAX).then_some(gps.satellites_visible),
        ..Fix::default()
    }
}

/// The quality of a fix in GGA's numbering.
fn quality(gps: &GPS_RAW_INT_DATA) -> FixQuality {
    FixQuality::from_gga(match gps.fix_type {
        GpsFixType::GPS_FIX_TYPE_NO_GPS
        | GpsFixType::GPS_FIX_TYPE_NO_FIX
        | GpsFixType::GPS_FIX_TYPE_2D_FIX => 0,
        GpsFixType::GPS_FIX_TYPE_3D_FIX => 1,
        GpsFixType::GPS_FIX_TYPE_DGPS | GpsFixType::GPS_FIX_TYPE_PPP => 2,
        GpsFixType::GPS_FIX_TYPE_RTK_FLOAT => 5,
        GpsFixType::GPS_FIX_TYPE_RTK_FIXED => 4,
        // A base station knows its position only because someone entered it.
        GpsFixType::GPS_FIX_TYPE_STATIC => 7,
    })
}

/// The charge left, per cent, if known.
fn charge_pct(value: i8) -> Option<f64> {
    (0..=100).contains(&value).then(|| f64::from(value))
}

/// A voltage, V, if measured.
fn millivolts(value: u16) -> Option<f64> {
    (value != 0 && value != u16::MAX).then(|| 0.001 * f64::from(value))
}
