//! MAVLink with an ArduPilot boat: reports from its messages, messages from commands.
//!
//! The boat follows set-points when it is armed and in mode GUIDED; standby is mode HOLD, disarmed.
//! A boat in any other mode that we did not request is under other control (a remote control, a
//! ground station, a failsafe of its own), and receives nothing that would take it over. A mode is
//! requested until the boat reports it once, and never again after the boat has left it, so that an
//! operator who takes the boat out of GUIDED keeps control.

use super::codec::{Codec, Command, UploadStep, named};
use super::mavlink_boat::{Asked, Boat, Target};
use super::mavlink_upload::Upload;
use super::mission_check;
use super::report::{Report, Shown};
use crate::config::{Gateway, Mavlink as Settings};
use crate::mavlink::dialect::{
    ATTITUDE_DATA, AttitudeTargetTypemask, COMMAND_LONG_DATA, GLOBAL_POSITION_INT_DATA,
    GPS_RAW_INT_DATA, HEARTBEAT_DATA, HOME_POSITION_DATA, MISSION_ACK_DATA, MavAutopilot, MavCmd,
    MavFrame, MavMessage, MavMissionResult, MavModeFlag, MavState, MavType,
    NAV_CONTROLLER_OUTPUT_DATA, POSITION_TARGET_GLOBAL_INT_DATA, PositionTargetTypemask,
    SERVO_OUTPUT_RAW_DATA, SET_ATTITUDE_TARGET_DATA, SET_POSITION_TARGET_LOCAL_NED_DATA,
    SYS_STATUS_DATA, SYSTEM_TIME_DATA,
};
use crate::mavlink::{Framer, Received, RoverMode, Writer, lat_lon};
use crate::nmea::Mode;
use crate::set_point::SetPoint;
use crate::supervisor::Task;
use ::mavlink::MessageData;
use messages::external::Mission;
use primitives::{SimTime, math};

/// Interval of our heartbeat, s.
const HEARTBEAT_S: f64 = 1.0;
/// Time (s) after which a mode or arming that the boat does not report is requested again.
const AGAIN_S: f64 = 0.5;
/// Minimum speed of a velocity that is sent, m/s: below this, the direction would be a rounding
/// error.
const VELOCITY_MIN_M_S: f64 = 0.01;
/// The messages that we need from the boat: number and rate, 1/s.
const STREAMS: [(u32, f64); 10] = [
    // Five times a second instead of once, so that the gateway notices quickly if someone has taken
    // over the boat, which travels two metres in a second.
    (HEARTBEAT_DATA::ID, 5.0),
    (GLOBAL_POSITION_INT_DATA::ID, 10.0),
    (ATTITUDE_DATA::ID, 10.0),
    (GPS_RAW_INT_DATA::ID, 5.0),
    (SYS_STATUS_DATA::ID, 1.0),
    (SYSTEM_TIME_DATA::ID, 1.0),
    (HOME_POSITION_DATA::ID, 0.5),
    // The set-points that the boat follows, for comparison with ours.
    (NAV_CONTROLLER_OUTPUT_DATA::ID, 5.0),
    (POSITION_TARGET_GLOBAL_INT_DATA::ID, 5.0),
    // The gateway does not use these, but records them: boats are identified from their thrust.
    (SERVO_OUTPUT_RAW_DATA::ID, 10.0),
];
/// Interval at which the messages are requested again, s: the boat may have restarted.
const STREAMS_AGAIN_S: f64 = 10.0;

/// The state of a link.
#[derive(Clone, Debug)]
pub struct Mavlink {
    settings: Settings,
    /// Pairs of throttle and speed, including the maximum speed, m/s.
    thrust_map: Vec<(f64, f64)>,
    speed_max_m_s: f64,
    framer: Framer,
    writer: Writer,
    boat: Boat,
    asked: Option<Asked>,
    heartbeat_due: SimTime,
    streams_due: SimTime,
    upload: Option<Upload>,
    /// Replies to the boat's requests that are still to be sent.
    answers: Vec<MavMessage>,
}

impl Mavlink {
    pub(super) fn new(gateway: &Gateway) -> Mavlink {
        let settings = gateway.mavlink;
        Mavlink {
            thrust_map: gateway.loops.thrust_map.clone(),
            speed_max_m_s: gateway.limits.speed_max_m_s,
            framer: Framer::new(),
            writer: Writer::new(settings.system, settings.component),
            boat: Boat::new(settings.boat_system),
            asked: None,
            heartbeat_due: SimTime::LONG_AGO,
            streams_due: SimTime::LONG_AGO,
            upload: None,
            answers: vec![],
            settings,
        }
    }

    fn read_message(&mut self, now: SimTime, received: &Received, take: &mut dyn FnMut(Report)) {
        let ours = (self.settings.system, self.settings.component);
        if !self.boat.is_its(received) {
            if (received.system, received.component) != ours {
                self.boat.report_stranger(received, take);
            }
            return;
        }
        match &received.message {
            MavMessage::HEARTBEAT(heartbeat) => {
                let control = self.boat.take_heartbeat(now, heartbeat, &mut self.asked);
                take(Report::Control(control));
            }
            MavMessage::HOME_POSITION(home) => {
                let upload = self.upload.iter_mut();
                upload.for_each(|upload| upload.take_home((home.latitude, home.longitude), now));
                let at = lat_lon((home.latitude, home.longitude));
                take(Report::Home([at.lat_deg, at.lon_deg]));
            }
            MavMessage::MISSION_ACK(ack) if (ack.target_system, ack.target_component) == ours => {
                // Check that the message is for our system and component: ground stations on the
                // same link also upload missions.
                self.upload
                    .iter_mut()
                    .for_each(|upload| upload.take_ack(ack.mavtype, now));
            }
            other => match item_request(other) {
                Some((seq, from)) if from == ours => {
                    let item = self
                        .upload
                        .as_mut()
                        .and_then(|upload| upload.take_request(seq, now));
                    self.answers.extend(item);
                }
                _ => self.boat.report(now, other, take),
            },
        }
    }

    /// Requests that the boat arm and enter a mode, until it reports both.
    fn engage(&mut self, now: SimTime, wanted: RoverMode, out: &mut Vec<u8>) {
        let asked = self.asked.filter(|asked| asked.is_armed);
        let is_done = asked.is_some_and(|asked| asked.mode == wanted && asked.is_shown);
        let is_armed = self.boat.mode.is_some_and(|shown| shown.is_armed);
        // Rover does not arm in RTL ("Mode not armable"): a boat at rest is armed in HOLD first.
        let mode = if is_done || is_armed || wanted.allows_arming() {
            wanted
        } else {
            RoverMode::Hold
        };
        let before = asked.filter(|asked| asked.mode == mode);
        if before.is_some_and(|asked| asked.is_shown || (now - asked.at).as_s() < AGAIN_S) {
            return;
        }
        self.asked = Some(Asked::new(mode, true, now));
        self.write_mode(mode, out);
        self.write_arming(true, out);
    }

    /// If the boat is ours, requests mode HOLD, disarmed, until the boat reports it, and again
    /// whenever the boat is being driven.
    fn stand_by(&mut self, now: SimTime, out: &mut Vec<u8>) {
        let Some(shown) = self
            .boat
            .mode
            .filter(|_| self.boat.is_ours(self.asked.as_ref()))
        else {
            return;
        };
        let before = self.asked.filter(|asked| !asked.is_armed);
        let is_driven = shown.is_armed && shown.mode != RoverMode::Hold;
        if before.is_some_and(|asked| asked.is_shown) && !is_driven {
            return;
        }
        // The mode of a task that we requested counts as ours until the boat has left it.
        if shown.mode == RoverMode::Hold && !shown.is_armed {
            self.asked = Some(Asked {
                is_shown: true,
                ..Asked::new(RoverMode::Hold, false, now)
            });
            return;
        }
        self.write_mode(RoverMode::Hold, out);
        self.write_arming(false, out);
        if matches!(shown.mode, RoverMode::Hold | RoverMode::Guided) {
            self.asked = Some(Asked::new(RoverMode::Hold, false, now));
        }
    }

    fn send(&mut self, message: MavMessage, out: &mut Vec<u8>) {
        self.writer.write(&message, out);
    }

    fn write_command(&mut self, command: MavCmd, [param1, param2]: [f32; 2], out: &mut Vec<u8>) {
        let Target {
            system: target_system,
            component: target_component,
        } = self.boat.target();
        let message = COMMAND_LONG_DATA {
            param1,
            param2,
            command,
            target_system,
            target_component,
            ..COMMAND_LONG_DATA::default()
        };
        self.send(MavMessage::COMMAND_LONG(message), out);
    }

    fn write_mode(&mut self, mode: RoverMode, out: &mut Vec<u8>) {
        // In the base mode, only the flag for a custom mode matters.
        self.write_command(
            MavCmd::MAV_CMD_DO_SET_MODE,
            [1.0, mode.number() as f32],
            out,
        );
    }

    fn write_arming(&mut self, arm: bool, out: &mut Vec<u8>) {
        self.write_command(
            MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
            [f32::from(u8::from(arm)), 0.0],
            out,
        );
    }

    /// See "Rover commands in guided mode" in ArduPilot's documentation. A boat drops a set-point
    /// after three seconds.
    fn write_set_point(&mut self, set_point: SetPoint, out: &mut Vec<u8>) {
        let Target {
            system: target_system,
            component: target_component,
        } = self.boat.target();
        let no_roll_no_pitch =
            AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_ROLL_RATE_IGNORE
                | AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_PITCH_RATE_IGNORE;
        let message = match set_point {
            // `thrust` is a fraction of the boat's cruise speed, positive ahead; `body_yaw_rate` is
            // positive to starboard.
            SetPoint::Thrust {
                thrust_pct,
                difference_pct,
            } => MavMessage::SET_ATTITUDE_TARGET(SET_ATTITUDE_TARGET_DATA {
                body_yaw_rate: (0.01 * difference_pct * self.settings.turn_rate_max_rad_s) as f32,
                thrust: (0.01 * thrust_pct) as f32,
                target_system,
                target_component,
                type_mask: no_roll_no_pitch
                    | AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE,
                ..SET_ATTITUDE_TARGET_DATA::default()
            }),
            // A zero velocity has no direction, and the boat would turn north. Send the heading and
            // zero thrust instead.
            SetPoint::Speed {
                heading_deg,
                speed_m_s,
            } if speed_m_s < VELOCITY_MIN_M_S => {
                let (z, w) = math::sin_cos(0.5 * heading_deg.to_radians());
                MavMessage::SET_ATTITUDE_TARGET(SET_ATTITUDE_TARGET_DATA {
                    q: [w as f32, 0.0, 0.0, z as f32],
                    target_system,
                    target_component,
                    type_mask: no_roll_no_pitch
                        | AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE,
                    ..SET_ATTITUDE_TARGET_DATA::default()
                })
            }
            SetPoint::Speed {
                heading_deg,
                speed_m_s,
            } => {
                let (east, north) = math::sin_cos(heading_deg.to_radians());
                // Send no yaw, which the velocity implies. With a yaw or a yaw rate, Rover takes
                // the sign of `vx`, which points north, for the sign of the speed in every frame: a
                // boat ordered south goes astern (Rover/GCS_MAVLink_Rover.cpp,
                // handle_set_position_target_local_ned; seen with ArduRover's SITL).
                let type_mask = PositionTargetTypemask::POSITION_TARGET_TYPEMASK_X_IGNORE
                    | PositionTargetTypemask::POSITION_TARGET_TYPEMASK_Y_IGNORE
                    | PositionTargetTypemask::POSITION_TARGET_TYPEMASK_Z_IGNORE
                    | PositionTargetTypemask::POSITION_TARGET_TYPEMASK_VZ_IGNORE
                    | PositionTargetTypemask::POSITION_TARGET_TYPEMASK_AX_IGNORE
                    | PositionTargetTypemask::POSITION_TARGET_TYPEMASK_AY_IGNORE
                    | PositionTargetTypemask::POSITION_TARGET_TYPEMASK_AZ_IGNORE
                    | PositionTargetTypemask::POSITION_TARGET_TYPEMASK_YAW_IGNORE
                    | PositionTargetTypemask::POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE;
                MavMessage::SET_POSITION_TARGET_LOCAL_NED(SET_POSITION_TARGET_LOCAL_NED_DATA {
                    vx: (speed_m_s * north) as f32,
                    vy: (speed_m_s * east) as f32,
                    type_mask,
                    target_system,
                    target_component,
                    coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
                    ..SET_POSITION_TARGET_LOCAL_NED_DATA::default()
                })
            }
        };
        self.send(message, out);
    }
}

impl Codec for Mavlink {
    fn begin_link(&mut self) {
        self.framer.interrupt();
        self.boat.forget(self.settings.boat_system);
        // The boat may be a different one, or have restarted, so earlier requests no longer apply.
        (self.asked, self.upload) = (None, None);
        (self.heartbeat_due, self.streams_due) = (SimTime::LONG_AGO, SimTime::LONG_AGO);
        self.answers.clear();
    }

    fn read(&mut self, now: SimTime, bytes: &[u8], take: &mut dyn FnMut(Report)) {
        let mut framer = std::mem::take(&mut self.framer);
        framer.push(bytes, &mut |received| {
            self.read_message(now, &received, take)
        });
        self.framer = framer;
    }

    fn write(&mut self, now: SimTime, command: Command, out: &mut Vec<u8>) {
        match command {
            Command::Zero => self.write_set_point(SetPoint::ZERO, out),
            Command::SetPoint(set_point) => {
                self.engage(now, RoverMode::Guided, out);
                self.write_set_point(set_point, out);
            }
            Command::Task(task) => self.engage(now, mode_of(task).0, out),
            Command::Standby | Command::Switch(_) => self.stand_by(now, out),
            Command::EndOfUpload => self.send(
                MavMessage::MISSION_ACK(MISSION_ACK_DATA {
                    target_system: self.boat.target().system,
                    target_component: self.boat.target().component,
                    mavtype: MavMissionResult::MAV_MISSION_OPERATION_CANCELLED,
                    ..MISSION_ACK_DATA::default()
                }),
                out,
            ),
        }
    }

    /// Writes the messages due without a command: our heartbeat, requests for messages, and replies
    /// to the boat.
    fn keep_up(&mut self, now: SimTime, out: &mut Vec<u8>) {
        for message in std::mem::take(&mut self.answers) {
            self.send(message, out);
        }
        if now >= self.heartbeat_due {
            self.heartbeat_due = now + SimTime::from_s(HEARTBEAT_S);
            self.send(
                MavMessage::HEARTBEAT(HEARTBEAT_DATA {
                    mavtype: MavType::MAV_TYPE_GCS,
                    autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID,
                    // By default the crate sets the first flag, which marks an armed vehicle.
                    base_mode: MavModeFlag::empty(),
                    system_status: MavState::MAV_STATE_ACTIVE,
                    ..HEARTBEAT_DATA::default()
                }),
                out,
            );
        }
        // Wait until the boat is known: ArduPilot also answers a broadcast request, as would every
        // other system on the link.
        if self.boat.system.is_some() && now >= self.streams_due {
            self.streams_due = now + SimTime::from_s(STREAMS_AGAIN_S);
            for (id, rate_hz) in STREAMS {
                let interval_us = 1e6 / rate_hz;
                self.write_command(
                    MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
                    [id as f32, interval_us as f32],
                    out,
                );
            }
        }
    }

    fn has_boat_modes(&self) -> bool {
        false
    }

    fn shown(&self, command: Command) -> Shown {
        let mode = match command {
            Command::Standby | Command::Switch(_) | Command::Zero | Command::EndOfUpload => {
                Mode::Standby
            }
            Command::SetPoint(_) => Mode::Speed,
            Command::Task(task) => mode_of(task).1,
        };
        let heading_deg = match command {
            Command::SetPoint(SetPoint::Speed { heading_deg, .. }) => Some(heading_deg),
            _ => None,
        };
        Shown {
            mode,
            heading_deg,
            thrust: None,
            difference: None,
        }
    }

    fn text(&self, command: Command) -> String {
        match command {
            Command::Standby | Command::Switch(_) => "HOLD, disarm".to_owned(),
            Command::Zero => "SET_ATTITUDE_TARGET thrust 0".to_owned(),
            Command::SetPoint(SetPoint::Thrust {
                thrust_pct,
                difference_pct,
            }) => {
                format!(
                    "GUIDED, SET_ATTITUDE_TARGET thrust {thrust_pct:.0} %, turn {difference_pct:.0} %"
                )
            }
            Command::SetPoint(SetPoint::Speed {
                heading_deg,
                speed_m_s,
            }) if speed_m_s < VELOCITY_MIN_M_S => {
                format!("GUIDED, SET_ATTITUDE_TARGET heading {heading_deg:.1}, thrust 0")
            }
            Command::SetPoint(SetPoint::Speed {
                heading_deg,
                speed_m_s,
            }) => {
                format!(
                    "GUIDED, SET_POSITION_TARGET_LOCAL_NED heading {heading_deg:.1}, speed {speed_m_s:.2} m/s"
                )
            }
            Command::Task(task) => mode_of(task).2.to_owned(),
            Command::EndOfUpload => "MISSION_ITEM_INT".to_owned(),
        }
    }

    /// The stop message for a boat that is ours. A boat under other control receives a set-point of
    /// zero, which it ignores.
    fn stop_message(&self) -> Vec<u8> {
        let mut copy = self.clone();
        let mut out = Vec::new();
        // A new writer, so that the bytes stay the same as long as nothing changes.
        copy.writer = Writer::new(self.settings.system, self.settings.component);
        copy.write_set_point(SetPoint::ZERO, &mut out);
        if copy.boat.mode.is_some() && copy.boat.is_ours(copy.asked.as_ref()) {
            copy.write_mode(RoverMode::Hold, &mut out);
            copy.write_arming(false, &mut out);
        }
        out
    }

    /// The stop message for a boat, regardless of who commands it.
    fn forced_stop_message(&self) -> Vec<u8> {
        let mut copy = self.clone();
        let mut out = Vec::new();
        copy.write_set_point(SetPoint::ZERO, &mut out);
        copy.write_mode(RoverMode::Hold, &mut out);
        copy.write_arming(false, &mut out);
        out
    }

    fn begin_upload(&mut self, now: SimTime, mission: &Mission) -> Result<(), String> {
        mission_check::check(mission)?;
        // A mission in the game specifies a throttle, like a Surveyor's; an ArduPilot mission
        // specifies a speed.
        let speed_m_s = math::interpolate(self.thrust_map.iter().copied(), mission.throttle_pct);
        let speed_m_s = speed_m_s.clamp(0.0, self.speed_max_m_s);
        self.upload = Some(Upload::new(mission, speed_m_s, self.boat.target(), now));
        Ok(())
    }

    fn continue_upload(&mut self, now: SimTime, out: &mut Vec<u8>) -> UploadStep {
        let Some(upload) = &mut self.upload else {
            return UploadStep::Done;
        };
        let mut messages = vec![];
        let step = upload.next(now, self.boat.target(), &mut messages);
        messages
            .into_iter()
            .for_each(|message| self.send(message, out));
        if matches!(step, UploadStep::Done | UploadStep::Failed(_)) {
            self.upload = None;
        }
        step
    }

    fn is_uploading(&self) -> bool {
        self.upload.is_some()
    }

    fn abort_upload(&mut self) -> bool {
        self.upload.take().is_some()
    }

    /// MAVLink needs a message every second even without commands; otherwise a boat may enter its
    /// own failsafe.
    fn due(&self) -> Option<SimTime> {
        let upload = self.upload.as_ref().map_or(SimTime::NEVER, Upload::due);
        Some(upload.min(self.heartbeat_due))
    }

    fn counts(&self) -> [Vec<(String, u64)>; 2] {
        let framed = self.framer.counts();
        let known = named([
            ("messages in", framed.messages),
            ("bad checksums", framed.bad_checksum),
            ("bytes of garbage", framed.garbage),
            ("unreadable", framed.unreadable),
            ("messages from other systems", self.boat.others),
        ]);
        let unknown = framed
            .unknown
            .iter()
            .map(|(id, count)| (format!("unknown message {id}"), *count));
        [known, unknown.collect()]
    }
}

/// The mode in which a boat executes a task: Rover's mode, the mode to be reported, and the name.
fn mode_of(task: Task) -> (RoverMode, Mode, &'static str) {
    match task {
        Task::StationKeep => (RoverMode::Loiter, Mode::StationKeep, "LOITER"),
        // The closest equivalent on an ArduPilot boat: the boat returns to its home or to a rally
        // point.
        Task::GoToErp => (RoverMode::Rtl, Mode::GoToErp, "RTL"),
        Task::Mission => (RoverMode::Auto, Mode::Waypoint, "AUTO"),
        // Such tasks are refused earlier.
        Task::Mode(_) => (RoverMode::Hold, Mode::Standby, "HOLD"),
    }
}

/// The mission item that a boat requests, and the addressee of the request.
#[expect(
    deprecated,
    reason = "ArduPilot also sends MISSION_REQUEST, which gets the same reply"
)]
fn item_request(message: &MavMessage) -> Option<(u16, (u8, u8))> {
    match message {
        MavMessage::MISSION_REQUEST_INT(request) => Some((
            request.seq,
            (request.target_system, request.target_component),
        )),
        MavMessage::MISSION_REQUEST(request) => Some((
            request.seq,
            (request.target_system, request.target_component),
        )),
        _ => None,
    }
}
