//! NMEA 0183 as a Surveyor and its neighbours speak it: bytes to sentences and back, with no port and no clock.
//!
//! [`Framer`] cuts a stream into sentences, [`Sentence::parse`] reads one, [`Sentence::write`] makes one. What is
//! read is tolerant where real boats differ (fields too many, zeros before numbers, odd talkers) and strict where
//! a wrong guess would move a boat. What is written is what the strictest known reader accepts, and never has a
//! number on the wire that is none.

mod attitude;
mod battery;
mod boat_error;
mod clock;
mod command;
mod control_state;
mod field;
mod framer;
mod gga;
mod gll;
mod hdg;
mod hdt;
mod line;
mod mission_settings;
mod mode;
mod mwv;
mod position;
mod rmc;
mod talker;
mod vhw;
mod vtg;
mod waypoint;
mod zda;

pub use attitude::Attitude;
pub use battery::Battery;
pub use boat_error::BoatError;
pub use clock::{Date, TimeOfDay};
pub use command::Command;
pub use control_state::{ControlState, Operator};
pub use framer::{ACCEPTED_MAX, Counts, Framer};
pub use gga::Gga;
pub use gll::Gll;
pub use hdg::Hdg;
pub use hdt::Hdt;
pub use mission_settings::MissionSettings;
pub use mode::Mode;
pub use mwv::{Mwv, SpeedUnit, WindReference};
pub use rmc::Rmc;
pub use talker::Talker;
pub use vhw::Vhw;
pub use vtg::Vtg;
pub use waypoint::Waypoint;
pub use zda::Zda;

use field::Fields;
use line::Line;
use thiserror::Error;

/// The longest sentence written, bytes with `$` and CR LF (NMEA 0183 v3.01, 5.3).
pub const EMITTED_MAX: usize = 82;

/// A knot, m/s.
pub const M_S_PER_KN: f64 = 1852.0 / 3600.0;

/// A sentence, read or to be written.
#[derive(Clone, Debug, PartialEq)]
pub enum Sentence {
    /// `PSEAC`: what the boat is told to do.
    Command(Command),
    /// `PSEAA`: how the boat lies, and its compass.
    Attitude(Attitude),
    /// `PSEAB`: battery and currents.
    Battery(Battery),
    /// `PSEAD`: which command the boat follows, and whose.
    ControlState(ControlState),
    /// `PSEAG`: an error code of the boat.
    BoatError(BoatError),
    /// `PSEAR`: settings of a mission that is being uploaded.
    MissionSettings(MissionSettings),
    /// `OIWPL`: a waypoint of a mission that is being uploaded.
    Waypoint(Waypoint),
    /// `GGA`: a fix.
    Gga(Gga),
    /// `RMC`: a fix with course, speed and date.
    Rmc(Rmc),
    /// `VTG`: course and speed over ground.
    Vtg(Vtg),
    /// `HDT`: true heading.
    Hdt(Hdt),
    /// `HDG`: magnetic heading, deviation and variation.
    Hdg(Hdg),
    /// `ZDA`: time and date.
    Zda(Zda),
    /// `GLL`: a position.
    Gll(Gll),
    /// `MWV`: wind.
    Mwv(Mwv),
    /// `VHW`: heading, and speed through the water.
    Vhw(Vhw),
}

/// Why a body is not a sentence that this codec reads.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ParseError {
    /// No sentence of ours has this address.
    #[error("{address}: not a sentence that is read here")]
    Unknown {
        /// What stands before the first comma.
        address: String,
    },
    /// A field is not what the sentence's layout says.
    #[error("{address} field {field} is {found:?}, expected {expected}")]
    Field {
        /// What stands before the first comma.
        address: String,
        /// The data field, from 1.
        field: usize,
        /// Its text.
        found: String,
        /// What may stand there.
        expected: &'static str,
    },
    /// The sentence ends too early.
    #[error("{address} has {found} data fields, expected {expected} or more")]
    TooFew {
        /// What stands before the first comma.
        address: String,
        /// How many there are.
        found: usize,
        /// How many there must be.
        expected: usize,
    },
}

impl Sentence {
    /// The sentence in a body (what stands between `$` and `*`).
    ///
    /// # Errors
    /// [`ParseError::Unknown`] for a sentence that this codec does not read, the others for one that it should
    /// have been able to.
    pub fn parse(body: &str) -> Result<Sentence, ParseError> {
        let fields = Fields::of(body);
        let address = fields.address();
        Ok(match address {
            "PSEAC" => Sentence::Command(Command::read(&fields)?),
            "PSEAA" => Sentence::Attitude(Attitude::read(&fields)?),
            "PSEAB" => Sentence::Battery(Battery::read(&fields)?),
            "PSEAD" => Sentence::ControlState(ControlState::read(&fields)?),
            "PSEAG" => Sentence::BoatError(BoatError::read(&fields)?),
            "PSEAR" => Sentence::MissionSettings(MissionSettings::read(&fields)?),
            "OIWPL" => Sentence::Waypoint(Waypoint::read(&fields)?),
            _ => return Sentence::read_standard(&fields),
        })
    }

    /// A sentence of the standard: two characters of talker, three of kind.
    fn read_standard(fields: &Fields) -> Result<Sentence, ParseError> {
        let unknown = || ParseError::Unknown { address: fields.address().to_owned() };
        let (talker, kind) = Talker::split(fields.address()).ok_or_else(unknown)?;
        Ok(match kind {
            "GGA" => Sentence::Gga(Gga::read(talker, fields)?),
            "RMC" => Sentence::Rmc(Rmc::read(talker, fields)?),
            "VTG" => Sentence::Vtg(Vtg::read(talker, fields)?),
            "HDT" => Sentence::Hdt(Hdt::read(talker, fields)?),
            "HDG" => Sentence::Hdg(Hdg::read(talker, fields)?),
            "ZDA" => Sentence::Zda(Zda::read(talker, fields)?),
            "GLL" => Sentence::Gll(Gll::read(talker, fields)?),
            "MWV" => Sentence::Mwv(Mwv::read(talker, fields)?),
            "VHW" => Sentence::Vhw(Vhw::read(talker, fields)?),
            _ => return Err(unknown()),
        })
    }

    /// Appends `$body*HH\r\n`, at most [`EMITTED_MAX`] bytes.
    ///
    /// What is no finite number becomes an empty field, as does what would make the sentence too long.
    pub fn write(&self, out: &mut Vec<u8>) {
        match self {
            Sentence::Command(command) => command.write(Line::new(out, "PSEAC")),
            Sentence::Attitude(attitude) => attitude.write(Line::new(out, "PSEAA")),
            Sentence::Battery(battery) => battery.write(Line::new(out, "PSEAB")),
            Sentence::ControlState(state) => state.write(Line::new(out, "PSEAD")),
            Sentence::BoatError(error) => error.write(Line::new(out, "PSEAG")),
            Sentence::MissionSettings(settings) => settings.write(Line::new(out, "PSEAR")),
            Sentence::Waypoint(waypoint) => waypoint.write(Line::new(out, "OIWPL")),
            Sentence::Gga(gga) => gga.write(gga.talker.line(out, "GGA")),
            Sentence::Rmc(rmc) => rmc.write(rmc.talker.line(out, "RMC")),
            Sentence::Vtg(vtg) => vtg.write(vtg.talker.line(out, "VTG")),
            Sentence::Hdt(hdt) => hdt.write(hdt.talker.line(out, "HDT")),
            Sentence::Hdg(hdg) => hdg.write(hdg.talker.line(out, "HDG")),
            Sentence::Zda(zda) => zda.write(zda.talker.line(out, "ZDA")),
            Sentence::Gll(gll) => gll.write(gll.talker.line(out, "GLL")),
            Sentence::Mwv(mwv) => mwv.write(mwv.talker.line(out, "MWV")),
            Sentence::Vhw(vhw) => vhw.write(vhw.talker.line(out, "VHW")),
        }
    }
}

/// The exclusive or of all bytes of a body.
#[must_use]
pub fn checksum(body: &[u8]) -> u8 {
    body.iter().fold(0, |sum, byte| sum ^ byte)
}
