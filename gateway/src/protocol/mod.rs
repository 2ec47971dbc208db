//! The protocol of a boat: its bytes become [`Report`]s, and a [`Command`] becomes bytes.
//!
//! Nothing in here decides whether a boat may move: that is the supervisor's, and what a bridge sends follows from it.

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

/// What a boat is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Stop, and do nothing.
    Standby,
    /// Standby, and switch this on or off, where the boat has such a switch.
    Switch(SwitchWord),
    /// Thrust zero, whatever the boat does; it does not make it follow set-points.
    Zero,
    /// Follow this set-point.
    SetPoint(SetPoint),
    /// Do this by its own controller.
    Task(Task),
    /// The upload of a mission is over, finished or not.
    EndOfUpload,
}

/// How far the upload of a mission is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum UploadStep {
    /// Something was sent.
    Sent,
    /// Nothing is due yet.
    Waiting,
    /// The boat has all of it.
    Done,
    /// The boat does not take it: why.
    Failed(String),
}

/// A protocol, with what it must remember of a link.
#[derive(Clone, Debug)]
pub enum Protocol {
    /// The Surveyor's NMEA.
    Surveyor(Box<Surveyor>),
    /// MAVLink, with an ArduPilot boat.
    Mavlink(Box<Mavlink>),
}

impl Protocol {
    /// For a boat that this gateway drives.
    #[must_use]
    pub fn new(gateway: &Gateway) -> Protocol {
        match gateway.protocol {
            BoatProtocol::Surveyor => Protocol::Surveyor(Box::new(Surveyor::new(gateway.upload_gap_s))),
            BoatProtocol::Mavlink => Protocol::Mavlink(Box::new(Mavlink::new(gateway))),
        }
    }

    /// A new link: nothing of the one before counts.
    pub fn begin_link(&mut self) {
        match self {
            Protocol::Surveyor(surveyor) => surveyor.begin_link(),
            Protocol::Mavlink(mavlink) => mavlink.begin_link(),
        }
    }

    /// Reads bytes from the boat, cut as they come.
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

    /// Appends what is due without a command, such as a heartbeat and answers to the boat.
    pub fn keep_up(&mut self, now: SimTime, out: &mut Vec<u8>) {
        match self {
            // A Surveyor sends everything unasked and wants no heartbeat.
            Protocol::Surveyor(_) => {}
            Protocol::Mavlink(mavlink) => mavlink.keep_up(now, out),
        }
    }

    /// Whether its boats have the modes of [`messages::external::BoatMode`].
    #[must_use]
    pub fn has_boat_modes(&self) -> bool {
        matches!(self, Protocol::Surveyor(_))
    }

    /// What a boat should show that has been told this.
    #[must_use]
    pub fn shown(&self, command: Command) -> Shown {
        match self {
            Protocol::Surveyor(_) => surveyor::shown(command),
            Protocol::Mavlink(_) => mavlink::shown(command),
        }
    }

    /// A command as people read it.
    #[must_use]
    pub fn text(&self, command: Command) -> String {
        match self {
            Protocol::Surveyor(_) => surveyor::text(command),
            Protocol::Mavlink(_) => mavlink::text(command),
        }
    }

    /// What stops the boat, whatever it does: thrust zero, then standby. It takes nothing from others who command the boat.
    #[must_use]
    pub fn stop_message(&self) -> Vec<u8> {
        match self {
            Protocol::Surveyor(_) => surveyor::stop_message(),
            Protocol::Mavlink(mavlink) => mavlink.stop_message(),
        }
    }

    /// As [`Protocol::stop_message`], whoever commands the boat, as far as its protocol allows that.
    #[must_use]
    pub fn forced_stop_message(&self) -> Vec<u8> {
        match self {
            // A Surveyor follows only the operator in control, and no sentence of ours changes
            // who that is.
            Protocol::Surveyor(_) => surveyor::stop_message(),
            Protocol::Mavlink(mavlink) => mavlink.forced_stop_message(),
        }
    }

    /// As [`Protocol::stop_message`], after whatever was being written when the gateway died.
    #[must_use]
    pub fn guard_message(&self) -> Vec<u8> {
        match self {
            // A sentence that was cut off ends first.
            Protocol::Surveyor(_) => [b"\r\n".to_vec(), self.stop_message()].concat(),
            Protocol::Mavlink(mavlink) => mavlink.stop_message(),
        }
    }

    /// Begins the upload of a mission.
    ///
    /// # Errors
    /// What is wrong with the mission.
    pub fn begin_upload(&mut self, now: SimTime, mission: &Mission) -> Result<(), String> {
        match self {
            Protocol::Surveyor(surveyor) => surveyor.begin_upload(now, mission),
            Protocol::Mavlink(mavlink) => mavlink.begin_upload(now, mission),
        }
    }

    /// Goes on with the upload of a mission; without one it is done.
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

    /// Forgets the upload, if there is one; returns whether there was. The boat is not told.
    pub fn abort_upload(&mut self) -> bool {
        match self {
            Protocol::Surveyor(surveyor) => surveyor.abort_upload(),
            Protocol::Mavlink(mavlink) => mavlink.abort_upload(),
        }
    }

    /// When something of its own is due, if anything is.
    #[must_use]
    pub fn due(&self) -> Option<SimTime> {
        match self {
            Protocol::Surveyor(surveyor) => surveyor.due(),
            // MAVLink wants a word every second even when nothing is commanded: without it a
            // boat may go into a failsafe of their own.
            Protocol::Mavlink(mavlink) => Some(mavlink.due()),
        }
    }

    /// What was counted so far, by name, and what was received under names that nothing is known of.
    #[must_use]
    pub fn counts(&self) -> [Vec<(String, u64)>; 2] {
        match self {
            Protocol::Surveyor(surveyor) => surveyor.counts(),
            Protocol::Mavlink(mavlink) => mavlink.counts(),
        }
    }
}
