//! The protocol of a boat: its bytes become [`Report`]s, and a [`Command`] becomes bytes.
//!
//! Nothing here decides whether a boat may move: the supervisor does, and a bridge sends what
//! follows from that.

mod mavlink;
mod mavlink_boat;
mod mavlink_upload;
mod mission_check;
mod report;
mod status_text;
mod surveyor;
mod surveyor_upload;

use crate::config::{BoatProtocol, Gateway, SwitchWord};
use crate::set_point::SetPoint;
use crate::supervisor::Task;
use mavlink::Mavlink;
use messages::external::Mission;
use primitives::SimTime;
pub use report::{ControlReport, Fix, Heading, North, Power, Report, Shown};
use surveyor::Surveyor;

/// A command to a boat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Stop, and stay passive.
    Standby,
    /// Standby, and set this switch, if the boat has such a switch.
    Switch(SwitchWord),
    /// Zero thrust, whatever the boat does; it does not make it follow set-points.
    Zero,
    /// Follow this set-point.
    SetPoint(SetPoint),
    /// Execute this task with the boat's own controller.
    Task(Task),
    /// The upload of a mission is over, finished or not.
    EndOfUpload,
}

/// The progress of a mission upload.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum UploadStep {
    /// Something was sent.
    Sent,
    /// Nothing is due yet.
    Waiting,
    /// The boat has all of it.
    Done,
    /// The boat rejects it, for this reason.
    Failed(String),
}

/// A protocol, with the state of its link.
#[derive(Clone, Debug)]
pub enum Protocol {
    /// The Surveyor's NMEA.
    Surveyor(Box<Surveyor>),
    /// MAVLink, with an ArduPilot boat.
    Mavlink(Box<Mavlink>),
}

impl Protocol {
    /// The protocol of a boat that this gateway drives.
    #[must_use]
    pub fn new(gateway: &Gateway) -> Protocol {
        match gateway.protocol {
            BoatProtocol::Surveyor => Protocol::Surveyor(Box::new(Surveyor::new(gateway.upload_gap_s))),
            BoatProtocol::Mavlink => Protocol::Mavlink(Box::new(Mavlink::new(gateway))),
        }
    }

    /// Starts a new link: the state of the previous one is discarded.
    pub fn begin_link(&mut self) {
        match self {
            Protocol::Surveyor(surveyor) => surveyor.begin_link(),
            Protocol::Mavlink(mavlink) => mavlink.begin_link(),
        }
    }

    /// Reads bytes from the boat, in any split.
    pub fn read(&mut self, now: SimTime, bytes: &[u8], take: &mut dyn FnMut(Report)) {
        match self {
            Protocol::Surveyor(surveyor) => surveyor.read(bytes, take),
            Protocol::Mavlink(mavlink) => mavlink.read(now, bytes, take),
        }
    }

    /// Appends the bytes of a command.
    pub fn write(&mut self, now: SimTime, command: Command, out: &mut Vec<u8>) {
        match self {
            Protocol::Surveyor(_) => surveyor::write(command, out),
            Protocol::Mavlink(mavlink) => mavlink.write(now, command, out),
        }
    }

    /// Appends messages due without a command, such as a heartbeat or answers to the boat.
    pub fn keep_up(&mut self, now: SimTime, out: &mut Vec<u8>) {
        match self {
            // A Surveyor sends everything unasked and needs no heartbeat.
            Protocol::Surveyor(_) => {}
            Protocol::Mavlink(mavlink) => mavlink.keep_up(now, out),
        }
    }

    /// Whether its boats have the modes of [`messages::external::BoatMode`].
    #[must_use]
    pub fn has_boat_modes(&self) -> bool {
        matches!(self, Protocol::Surveyor(_))
    }

    /// The report expected from a boat that has received this command.
    #[must_use]
    pub fn shown(&self, command: Command) -> Shown {
        match self {
            Protocol::Surveyor(_) => surveyor::shown(command),
            Protocol::Mavlink(_) => mavlink::shown(command),
        }
    }

    /// A command in readable form.
    #[must_use]
    pub fn text(&self, command: Command) -> String {
        match self {
            Protocol::Surveyor(_) => surveyor::text(command),
            Protocol::Mavlink(_) => mavlink::text(command),
        }
    }

    /// The stop message for any state of the boat: zero thrust, then standby. It does not take over
    /// a boat from others.
    #[must_use]
    pub fn stop_message(&self) -> Vec<u8> {
        match self {
            Protocol::Surveyor(_) => surveyor::stop_message(),
            Protocol::Mavlink(mavlink) => mavlink.stop_message(),
        }
    }

    /// Like [`Protocol::stop_message`], regardless of who commands the boat, as far as its protocol allows.
    #[must_use]
    pub fn forced_stop_message(&self) -> Vec<u8> {
        match self {
            // A Surveyor follows only the operator in control, and no sentence of ours changes
            // that.
            Protocol::Surveyor(_) => surveyor::stop_message(),
            Protocol::Mavlink(mavlink) => mavlink.forced_stop_message(),
        }
    }

    /// Like [`Protocol::stop_message`], after an incomplete write by a gateway that died.
    #[must_use]
    pub fn guard_message(&self) -> Vec<u8> {
        match self {
            // An incomplete sentence is ended first.
            Protocol::Surveyor(_) => [b"\r\n".to_vec(), self.stop_message()].concat(),
            Protocol::Mavlink(mavlink) => mavlink.stop_message(),
        }
    }

    /// Begins the upload of a mission.
    ///
    /// # Errors
    /// The fault of the mission.
    pub fn begin_upload(&mut self, now: SimTime, mission: &Mission) -> Result<(), String> {
        match self {
            Protocol::Surveyor(surveyor) => surveyor.begin_upload(now, mission),
            Protocol::Mavlink(mavlink) => mavlink.begin_upload(now, mission),
        }
    }

    /// Continues the upload of a mission; done if there is none.
    pub fn continue_upload(&mut self, now: SimTime, out: &mut Vec<u8>) -> UploadStep {
        match self {
            Protocol::Surveyor(surveyor) => surveyor.continue_upload(now, out),
            Protocol::Mavlink(mavlink) => mavlink.continue_upload(now, out),
        }
    }

    /// Whether a mission is being uploaded.
    #[must_use]
    pub fn is_uploading(&self) -> bool {
        match self {
            Protocol::Surveyor(surveyor) => surveyor.is_uploading(),
            Protocol::Mavlink(mavlink) => mavlink.is_uploading(),
        }
    }

    /// Discards the upload, if any; returns whether there was one. The boat is not notified.
    pub fn abort_upload(&mut self) -> bool {
        match self {
            Protocol::Surveyor(surveyor) => surveyor.abort_upload(),
            Protocol::Mavlink(mavlink) => mavlink.abort_upload(),
        }
    }

    /// When its next own message is due, if any.
    #[must_use]
    pub fn due(&self) -> Option<SimTime> {
        match self {
            Protocol::Surveyor(surveyor) => surveyor.due(),
            // MAVLink needs a message every second even without commands: otherwise a boat may
            // enter a failsafe of its own.
            Protocol::Mavlink(mavlink) => Some(mavlink.due()),
        }
    }

    /// The counters by name, including those for unknown names received.
    #[must_use]
    pub fn counts(&self) -> [Vec<(String, u64)>; 2] {
        match self {
            Protocol::Surveyor(surveyor) => surveyor.counts(),
            Protocol::Mavlink(mavlink) => mavlink.counts(),
        }
    }
}
