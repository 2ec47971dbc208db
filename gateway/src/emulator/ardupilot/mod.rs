//! An emulated ArduPilot Rover boat: MAVLink commands in, telemetry out, without sockets or clocks.
//!
//! The boat follows Rover's documentation: it is driven in mode GUIDED when armed, drops a
//! set-point after three seconds, accepts broadcasts and messages addressed to its own system, and
//! acknowledges commands.

mod command;
mod failsafe;
mod mission;
mod parameter;
mod reply;
mod set_point;
mod telemetry;

use super::autopilot::Autopilot;
use super::battery::{Battery, Pack};
use super::sensed::Sensed;
use super::{FrontSeat, Port};
use crate::geodesy::LocalFrame;
use crate::mavlink::dialect::{
    MISSION_ITEM_INT_DATA, MavCmd, MavMessage, MavMissionResult, MavSeverity,
};
use crate::mavlink::{AUTOPILOT, Frame, Framer, Received, RoverMode, Writer, e7, on_globe};
use crate::nmea::Operator;
use ::mavlink::Message;
use failsafe::StationWatch;
use messages::Order;
use messages::picture::OwnBoat;
use mission::MissionStore;
use parameter::Parameters;
use primitives::SimTime;
use primitives::frame::{LatLon, Ned};
use set_point::{FORGOTTEN, SetPoints};
use std::collections::{BTreeMap, VecDeque};
use telemetry::Streams;

/// System number until SYSID_THISMAV is set.
pub const SYSTEM: u8 = 1;
/// Maximum number of unread log messages.
const REMARKS_MAX: usize = 64;

/// The front seat of an emulated boat that speaks MAVLink.
pub struct ArduPilot {
    frame: LocalFrame,
    framer: Framer,
    writer: Writer,
    mode: RoverMode,
    is_armed: bool,
    set_points: SetPoints,
    autopilot: Autopilot,
    mission: MissionStore,
    /// Latitude and longitude, 1e-7 degrees.
    home: Option<(i32, i32)>,
    /// Whether a ground station has set the home.
    is_home_locked: bool,
    parameters: Parameters,
    streams: Streams,
    station: StationWatch,
    sensed: Sensed,
    /// The last thruster order.
    order: Order,
    /// The position of the first fix: the origin of the frame LOCAL_NED.
    origin: Option<Ned>,
    /// UTC at time zero, µs since 1970.
    began_us: u64,
    battery: Battery,
    remarks: VecDeque<String>,
    /// When the boat last reported each message number as unsupported.
    complaints: BTreeMap<u32, SimTime>,
    /// Frames to send as soon as possible.
    outbox: Vec<u8>,
}

impl ArduPilot {
    /// A boat in HOLD, disarmed, on a field with the given origin, with the given fraction of its
    /// charge; `None` means full, without drain.
    pub fn new(datum: LatLon, charge: Option<f64>) -> ArduPilot {
        ArduPilot {
            frame: LocalFrame::new(datum),
            framer: Framer::new(),
            writer: Writer::new(SYSTEM, AUTOPILOT),
            // INITIAL_MODE is 4 in our recommended parameters: a boat that has just started belongs
            // to the gateway, and stays at rest.
            mode: RoverMode::Hold,
            is_armed: false,
            set_points: SetPoints::default(),
            autopilot: Autopilot::default(),
            mission: MissionStore::default(),
            home: None,
            is_home_locked: false,
            parameters: Parameters::new(),
            streams: Streams::new(),
            station: StationWatch::default(),
            sensed: Sensed::default(),
            order: Order::Hold,
            origin: None,
            began_us: 0,
            battery: Battery::new(Pack::BLUEBOAT, charge),
            remarks: VecDeque::new(),
            complaints: BTreeMap::new(),
            outbox: vec![],
        }
    }

    /// Receives bytes from a link.
    pub fn receive(&mut self, now: SimTime, bytes: &[u8]) {
        // Move the framer out during the call, because the callback needs the whole boat.
        let mut framer = std::mem::take(&mut self.framer);
        framer.push_frames(bytes, &mut |frame| match frame {
            Frame::Read(received) => self.apply(now, &received),
            Frame::Unreadable(message) => self.answer_unreadable(now, &message),
        });
        self.framer = framer;
    }

    /// Sets the mode, as a remote control or the boat itself does.
    pub fn set_mode(&mut self, mode: RoverMode) {
        if self.mode != mode {
            self.mode = mode;
            self.set_points.forget();
            if let Some(own) = &self.sensed.own {
                let next = self.autopilot.next;
                self.autopilot.begin(own.nav.at());
                // An interrupted mission continues, as with MIS_RESTART at its default.
                if usize::from(next) <= self.mission.waypoints() {
                    self.autopilot.next = next;
                }
            }
            self.note(format!("mode {mode:?}"));
            // Rover reports the new mode at once.
            self.send(&MavMessage::HEARTBEAT(self.heartbeat()));
        }
    }

    /// The mode, and whether the boat is armed.
    pub fn mode(&self) -> (RoverMode, bool) {
        (self.mode, self.is_armed)
    }

    fn note(&mut self, remark: String) {
        // Log messages may go unread.
        if self.remarks.len() < REMARKS_MAX {
            self.remarks.push_back(remark);
        }
    }

    /// Makes the battery show this voltage from now on, V.
    pub fn set_volts(&mut self, volts: f64) {
        self.battery.shown_v = Some(volts);
    }

    /// The thruster order that follows from mode and set-point.
    fn commanded(&mut self, now: SimTime) -> Order {
        let Some(own) = self.sensed.own else {
            return Order::Hold;
        };
        let pose = own.nav.pose();
        if self.mode == RoverMode::Guided && self.set_points.expires(now) {
            // Without a set-point in this mode, a boat keeps station, whereas a car stops.
            self.autopilot.begin(pose.at);
            self.say(MavSeverity::MAV_SEVERITY_WARNING, FORGOTTEN);
        }
        match self.mode {
            _ if !self.is_armed => Order::Hold,
            RoverMode::Manual => self.set_points.manual(now),
            RoverMode::Guided => match self.set_points.destination() {
                Some((place, speed_m_s)) => {
                    self.autopilot
                        .go_to(pose, place, speed_m_s.unwrap_or(self.speed_max_m_s()))
                }
                None => self
                    .set_points
                    .guided(pose.psi_rad)
                    .unwrap_or_else(|| self.autopilot.keep(pose)),
            },
            RoverMode::Loiter => self.autopilot.keep(pose),
            RoverMode::Rtl | RoverMode::SmartRtl => self.autopilot.go_to_erp(pose),
            RoverMode::Auto => self.autopilot.sail(pose),
            _ => Order::Hold,
        }
    }

    /// The maximum speed of set-points, m/s.
    fn speed_max_m_s(&self) -> f64 {
        self.parameters.value("WP_SPEED")
    }

    /// The boat's system number.
    fn system(&self) -> u8 {
        self.parameters.value("SYSID_THISMAV") as u8
    }

    /// Appends the frames to send at once.
    pub fn answers(&mut self, out: &mut Vec<u8>) {
        out.append(&mut self.outbox);
        // Change the system number only here: the reply to the message that sets a new number must
        // come from the old one.
        self.writer.system = self.system();
    }

    #[expect(
        deprecated,
        reason = "ground stations still send SET_MODE and REQUEST_DATA_STREAM"
    )]
    fn apply(&mut self, now: SimTime, received: &Received) {
        let Received {
            system,
            component,
            message,
        } = received;
        let from = (*system, *component);
        let is_for_us = message
            .target_system_id()
            .is_none_or(|target| target == 0 || target == self.system());
        if !is_for_us || from == (self.system(), AUTOPILOT) {
            return;
        }
        // Rover obeys commands from anyone, but its failsafe and manual control accept only one
        // ground station.
        let is_station = f64::from(*system) == self.parameters.value("SYSID_MYGCS");
        match message {
            MavMessage::HEARTBEAT(_) if is_station => self.station.heard_at = Some(now),
            // Rover has not acknowledged this message since version 4.6.
            MavMessage::SET_MODE(set) => {
                self.command_own_mode(set.base_mode, set.custom_mode);
            }
            MavMessage::COMMAND_LONG(command) => self.take_command_long(now, from, command),
            MavMessage::COMMAND_INT(command) => self.take_command_int(now, from, command),
            MavMessage::MANUAL_CONTROL(control)
                if is_station && control.target == self.system() =>
            {
                self.station.heard_at = Some(now);
                self.set_points.take_manual(now, control);
            }
            MavMessage::RC_CHANNELS_OVERRIDE(channels) if is_station => {
                self.station.heard_at = Some(now);
                self.set_points.take_channels(now, channels);
            }
            // Like Rover, ignore these messages from any system but the ground station.
            MavMessage::HEARTBEAT(_)
            | MavMessage::MANUAL_CONTROL(_)
            | MavMessage::RC_CHANNELS_OVERRIDE(_) => {}
            MavMessage::SET_ATTITUDE_TARGET(_)
            | MavMessage::SET_POSITION_TARGET_LOCAL_NED(_)
            | MavMessage::SET_POSITION_TARGET_GLOBAL_INT(_) => self.take_set_point(now, message),
            MavMessage::REQUEST_DATA_STREAM(request) => self.streams.take_request(request),
            MavMessage::MISSION_ITEM(item) if item.current > 1 => {
                self.take_guided(from, &mission::int_from_float(item))
            }
            MavMessage::MISSION_ITEM_INT(item) if item.current > 1 => self.take_guided(from, item),
            MavMessage::MISSION_SET_CURRENT(set) => {
                self.set_current(set.seq);
                self.send(&self.mission.current(self.autopilot.next));
            }
            other => self.answer(now, from, other),
        }
    }

    fn answer(&mut self, now: SimTime, from: (u8, u8), message: &MavMessage) {
        if let Some(replies) = self.parameters.answer(from, message) {
            replies.iter().for_each(|reply| self.send(reply));
        } else if let Some(reply) = self.mission.answer(now, from, self.home, message) {
            reply.iter().for_each(|reply| self.send(reply));
            self.begin_mission(message);
        } else {
            self.answer_other(now, from, message);
        }
    }

    fn begin_mission(&mut self, message: &MavMessage) {
        let Some((waypoints, speed_m_s)) = self.mission.take_new() else {
            return;
        };
        let places: Vec<_> = waypoints.iter().map(|at| self.frame.ned(*at)).collect();
        if !matches!(message, MavMessage::MISSION_CLEAR_ALL(_)) {
            self.say(MavSeverity::MAV_SEVERITY_INFO, "Flight plan received");
        }
        self.note(format!(
            "a mission of {} waypoints is accepted",
            places.len()
        ));
        self.autopilot.set_mission(places, speed_m_s);
    }

    /// Handles a set-point, which takes effect only in mode GUIDED.
    fn take_set_point(&mut self, now: SimTime, message: &MavMessage) {
        let (Some(own), Some(origin), RoverMode::Guided) =
            (self.sensed.own, self.origin, self.mode)
        else {
            return;
        };
        let speed_max_m_s = self.speed_max_m_s();
        let taken = match message {
            MavMessage::SET_ATTITUDE_TARGET(target) => {
                self.set_points.take_attitude(now, target, speed_max_m_s)
            }
            MavMessage::SET_POSITION_TARGET_LOCAL_NED(target) => {
                self.set_points
                    .take_local(now, target, (own.nav.pose(), origin), speed_max_m_s)
            }
            MavMessage::SET_POSITION_TARGET_GLOBAL_INT(target) => {
                let place = self.place((target.lat_int, target.lon_int));
                self.set_points
                    .take_global(now, target, place, speed_max_m_s)
            }
            _ => Ok(()),
        };
        if let Err(reason) = taken {
            self.complain(now, message.message_id(), reason);
        }
    }

    /// Handles a position as a mission item, which older programs send in mode GUIDED. A change of
    /// altitude has no effect on a boat.
    fn take_guided(&mut self, from: (u8, u8), item: &MISSION_ITEM_INT_DATA) {
        let place = self
            .place((item.x, item.y))
            .filter(|_| set_point::is_global(item.frame));
        let is_waypoint =
            item.command == MavCmd::MAV_CMD_NAV_WAYPOINT && self.mode == RoverMode::Guided;
        let is_taken = item.current == 3
            || is_waypoint && place.is_some_and(|place| self.set_points.go_to(place));
        let result = if is_taken {
            MavMissionResult::MAV_MISSION_ACCEPTED
        } else {
            MavMissionResult::MAV_MISSION_ERROR
        };
        self.send(&mission::ack(from, result));
    }

    /// The point on the field for a latitude and longitude, 1e-7 degrees, if they are on the globe.
    fn place(&self, at_e7: (i32, i32)) -> Option<Ned> {
        on_globe(at_e7).map(|at| self.frame.ned(at))
    }

    /// The latitude and longitude of a point on the field, 1e-7 degrees.
    fn e7(&self, place: Ned) -> (i32, i32) {
        let at = self.frame.lat_lon(place);
        (e7(at.lat_deg), e7(at.lon_deg))
    }

    /// UTC from the receiver, µs since 1970.
    fn utc_us(&self, now: SimTime) -> u64 {
        self.began_us + (1e6 * now.as_s()) as u64
    }
}

impl FrontSeat for ArduPilot {
    fn set_clock(&mut self, now: SimTime, utc_ns: u64) {
        let since_us = (1e6 * now.as_s()) as u64;
        self.began_us = (utc_ns / 1000).saturating_sub(since_us);
    }

    fn receive(&mut self, now: SimTime, _: Port, bytes: &[u8]) {
        self.receive(now, bytes);
    }

    fn take_remark(&mut self) -> Option<String> {
        self.remarks.pop_front()
    }

    fn operator(&self) -> Option<Operator> {
        None
    }

    fn observe(&mut self, now: SimTime, own: &OwnBoat) {
        self.sensed.observe(now, own);
        self.origin.get_or_insert(own.nav.at());
        self.update_home(own.nav.at());
    }

    fn order(&mut self, now: SimTime) -> Order {
        self.check_failsafe(now);
        let order = self.commanded(now);
        self.order = self.battery.carry_out(now, order);
        self.order
    }

    fn telemetry(&mut self, now: SimTime, out: &mut Vec<u8>) {
        let overdue = self.mission.overdue(now);
        overdue.iter().for_each(|message| self.send(message));
        self.answers(out);
        for id in self.streams.due(now) {
            self.send_message(now, id);
        }
        self.answers(out);
    }
}
