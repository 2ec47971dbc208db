//! An emulated boat with ArduPilot's Rover: MAVLink commands in, telemetry out, with no socket and no clock.
//!
//! It does what the documentation of Rover says for boats: it is driven in mode GUIDED when it is armed, forgets a set-point after three
//! seconds, takes messages for its own system and for all, and acknowledges commands.

mod command;
mod mission;
mod parameter;
mod set_point;
mod telemetry;

use super::autopilot::Autopilot;
use super::battery::{Battery, Pack};
use super::sensed::Sensed;
use crate::geodesy::LocalFrame;
use crate::mavlink::dialect::MavMessage;
use crate::mavlink::{AUTOPILOT, Framer, Received, RoverMode, Writer};
use ::mavlink::Message;
use messages::Order;
use messages::picture::OwnBoat;
use mission::MissionStore;
use parameter::Parameters;
use primitives::SimTime;
use primitives::frame::{LatLon, Ned};
use set_point::SetPoints;
use std::collections::VecDeque;
use telemetry::Streams;

/// The system that it is.
pub const SYSTEM: u8 = 1;
/// How many log messages wait to be read.
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
    parameters: Parameters,
    streams: Streams,
    /// When the ground station whose failure matters was last heard.
    station_at: Option<SimTime>,
    sensed: Sensed,
    /// UTC at time zero, µs since 1970.
    began_us: u64,
    battery: Battery,
    remarks: VecDeque<String>,
    /// What is to be sent, as soon as that can be.
    outbox: Vec<MavMessage>,
}

impl ArduPilot {
    /// A boat in HOLD, disarmed, on a field with this origin; this share of its battery's charge is left, and with `None` it stays full.
    #[must_use]
    pub fn new(datum: LatLon, charge: Option<f64>) -> ArduPilot {
        ArduPilot {
            frame: LocalFrame::new(datum),
            framer: Framer::new(),
            writer: Writer::new(SYSTEM, AUTOPILOT),
            // INITIAL_MODE 4 of our recommended parameters: a boat that has just started is the
            // gateway's, and rests.
            mode: RoverMode::Hold,
            is_armed: false,
            set_points: SetPoints::default(),
            autopilot: Autopilot::default(),
            mission: MissionStore::default(),
            home: None,
            parameters: Parameters::new(),
            streams: Streams::new(),
            station_at: None,
            sensed: Sensed::default(),
            began_us: 0,
            battery: Battery::new(Pack::BLUEBOAT, charge),
            remarks: VecDeque::new(),
            outbox: vec![],
        }
    }

    /// Sets the receiver's clock: UTC, ns since 1970.
    pub fn set_clock(&mut self, now: SimTime, utc_ns: u64) {
        let since_us = (1e6 * now.as_s()) as u64;
        self.began_us = (utc_ns / 1000).saturating_sub(since_us);
    }

    /// Takes bytes from a link.
    pub fn receive(&mut self, now: SimTime, bytes: &[u8]) {
        // Taken out while it runs, since the callback needs the whole boat.
        let mut framer = std::mem::take(&mut self.framer);
        framer.push(bytes, &mut |received| self.apply(now, &received));
        self.framer = framer;
    }

    /// Somebody with a remote control, or the boat itself, sets its mode.
    pub fn set_mode(&mut self, mode: RoverMode) {
        if self.mode != mode {
            self.mode = mode;
            self.set_points.forget();
            if let Some(own) = &self.sensed.own {
                self.autopilot.begin(own.nav.at());
            }
            self.note(format!("mode {mode:?}"));
        }
    }

    /// The mode, and whether the boat is armed.
    #[must_use]
    pub fn mode(&self) -> (RoverMode, bool) {
        (self.mode, self.is_armed)
    }

    fn note(&mut self, remark: String) {
        // Nobody need read them.
        if self.remarks.len() < REMARKS_MAX {
            self.remarks.push_back(remark);
        }
    }

    /// A log message, once.
    pub fn take_remark(&mut self) -> Option<String> {
        self.remarks.pop_front()
    }

    /// Makes the battery show this voltage from now on, V.
    pub fn set_volts(&mut self, volts: f64) {
        self.battery.show_volts(volts);
    }

    /// Takes what its sensors measure.
    pub fn observe(&mut self, now: SimTime, own: &OwnBoat) {
        self.sensed.observe(now, own);
    }

    /// The boat's order to its thrusters now.
    pub fn order(&mut self, now: SimTime) -> Order {
        self.check_failsafe(now);
        let order = self.commanded(now);
        self.battery.carry_out(now, order)
    }

    /// What its mode and set-point ask of the thrusters.
    fn commanded(&mut self, now: SimTime) -> Order {
        let Some(own) = self.sensed.own.filter(|_| self.is_armed) else { return Order::Hold };
        let pose = own.nav.pose();
        match self.mode {
            RoverMode::Manual => self.set_points.manual(now),
            RoverMode::Guided if self.set_points.destination().is_some() => self.autopilot.keep(pose),
            RoverMode::Guided => self.set_points.guided(now, self.parameters.value("CRUISE_SPEED"), pose.psi_rad),
            RoverMode::Loiter => self.autopilot.keep(pose),
            RoverMode::Rtl | RoverMode::SmartRtl => self.autopilot.go_to_erp(pose),
            RoverMode::Auto => self.autopilot.sail(pose),
            _ => Order::Hold,
        }
    }

    /// Appends what is to be sent at once.
    pub fn answers(&mut self, out: &mut Vec<u8>) {
        for message in std::mem::take(&mut self.outbox) {
            self.writer.write(&message, out);
        }
    }

    /// Appends the telemetry that is due.
    pub fn telemetry(&mut self, now: SimTime, out: &mut Vec<u8>) {
        self.answers(out);
        for id in self.streams.due(now) {
            if let Some(message) = self.message(now, id) {
                self.writer.write(&message, out);
            }
        }
    }

    #[expect(deprecated, reason = "ground stations send SET_MODE and REQUEST_DATA_STREAM all the same")]
    fn apply(&mut self, now: SimTime, received: &Received) {
        let Received { system, component, message } = received;
        let is_for_us = message.target_system_id().is_none_or(|target| target == 0 || target == SYSTEM)
            && message.target_component_id().is_none_or(|target| target == 0 || target == AUTOPILOT);
        if !is_for_us || *system == SYSTEM && *component == AUTOPILOT {
            return;
        }
        // Rover obeys commands of anybody, but its failsafe and its manual control listen to
        // one ground station alone.
        let is_station = f64::from(*system) == self.parameters.value("SYSID_MYGCS");
        match message {
            MavMessage::HEARTBEAT(_) if is_station => self.station_at = Some(now),
            MavMessage::SET_MODE(set) => drop(self.command_mode(set.custom_mode)),
            MavMessage::COMMAND_LONG(command) => self.take_command_long(command),
            MavMessage::COMMAND_INT(command) => self.take_command_int(command),
            MavMessage::SET_ATTITUDE_TARGET(target) if self.mode == RoverMode::Guided => {
                self.set_points.take_attitude(now, target);
            }
            MavMessage::SET_POSITION_TARGET_LOCAL_NED(target) if self.mode == RoverMode::Guided => {
                let psi_rad = self.sensed.own.map_or(0.0, |own| own.nav.psi_rad);
                self.set_points.take_velocity(now, target, psi_rad);
            }
            MavMessage::SET_POSITION_TARGET_GLOBAL_INT(target) if self.mode == RoverMode::Guided => {
                self.set_points.take_destination(target);
                if let Some(e7) = self.set_points.destination() {
                    self.autopilot.begin(self.place(e7));
                }
            }
            MavMessage::MANUAL_CONTROL(control) if is_station && control.target == SYSTEM => {
                self.set_points.take_manual(now, control);
            }
            MavMessage::RC_CHANNELS_OVERRIDE(channels) if is_station => self.set_points.take_channels(now, channels),
            MavMessage::REQUEST_DATA_STREAM(request) => self.streams.take_request(request),
            other => {
                self.outbox.extend(self.parameters.answer(other));
                self.take_mission((*system, *component), other);
            }
        }
    }

    fn take_mission(&mut self, from: (u8, u8), message: &MavMessage) {
        let answer = self.mission.answer(from, message);
        self.outbox.extend(answer);
        if let Some((waypoints, speed_m_s)) = self.mission.take_new() {
            let places: Vec<_> = waypoints.iter().map(|at| self.frame.ned(*at)).collect();
            self.note(format!("a mission of {} waypoints is accepted", places.len()));
            self.autopilot.set_mission(places, speed_m_s);
        }
    }

    /// The failsafe for a lost ground station, where its parameters ask for one.
    fn check_failsafe(&mut self, now: SimTime) {
        let limit_s = self.parameters.value("FS_TIMEOUT");
        let is_lost = self.station_at.is_some_and(|at| (now - at).as_s() > limit_s);
        if self.parameters.value("FS_GCS_ENABLE") != 1.0 || !is_lost || !self.is_armed {
            return;
        }
        // Once is enough: the failsafe fires again after the next heartbeat only, so that an
        // operator who takes over is not overruled.
        self.station_at = None;
        self.set_mode(if self.parameters.value("FS_ACTION") == 1.0 { RoverMode::Rtl } else { RoverMode::Hold });
        self.say("GCS failsafe");
    }

    /// Where this latitude and longitude, 1e-7 degrees, are on the field.
    fn place(&self, (lat_e7, lon_e7): (i32, i32)) -> Ned {
        self.frame.ned(LatLon { lat_deg: 1e-7 * f64::from(lat_e7), lon_deg: 1e-7 * f64::from(lon_e7) })
    }

    /// UTC by its receiver, µs since 1970.
    fn utc_us(&self, now: SimTime) -> u64 {
        self.began_us + (1e6 * now.as_s()) as u64
    }
}
