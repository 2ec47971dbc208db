//! NMEA 0183 as used by a Surveyor and similar devices: converts bytes to sentences and back,
//! without ports or clocks.
//!
//! [`Framer`] splits a stream into sentences, [`Sentence::parse`] reads one, and
//! [`Sentence::write`] writes one. Both use the field tables in `surveyor` and `standard`. Reading
//! is tolerant where real boats differ (extra fields, leading zeros, unusual talkers) and strict
//! where a wrong guess would move a boat. The output is acceptable to the strictest known reader,
//! and never contains a non-finite number.

mod date_time;
#[cfg(test)]
mod fields;
mod fix_quality;
mod framer;
mod layout;
mod mode;
mod number;
mod operator;
mod position;
mod reader;
mod standard;
mod surveyor;
mod talker;
mod writer;

pub use date_time::{Date, TimeOfDay, date_and_time};
pub use fix_quality::FixQuality;
pub use framer::{ACCEPTED_MAX, Counts, Framer, Rejected};
pub use mode::Mode;
pub use operator::Operator;
pub use standard::{Gga, Hdg, Hdt, Rmc, Vtg, Zda};
pub use surveyor::{
    Attitude, Battery, BoatError, Command, ControlState, MissionSettings, Waypoint,
};
pub use talker::Talker;

use layout::Layout;
use reader::Reader;
use thiserror::Error;
use writer::Writer;

/// One knot in m/s.
pub const M_S_PER_KN: f64 = 1852.0 / 3600.0;

/// Maximum bytes of a written sentence, with `$` and CR LF (NMEA 0183 v3.01, 5.3).
pub const EMITTED_MAX: usize = 82;

/// A sentence, received or to be sent.
#[derive(Clone, Debug, PartialEq)]
pub enum Sentence {
    /// `PSEAC`: a command to the boat.
    Command(Command),
    /// `PSEAA`: attitude and compass.
    Attitude(Attitude),
    /// `PSEAB`: battery and currents.
    Battery(Battery),
    /// `PSEAD`: the command that the boat follows, and its operator.
    ControlState(ControlState),
    /// `PSEAG`: the boat's error code.
    BoatError(BoatError),
    /// `PSEAR`: settings of a mission being uploaded.
    MissionSettings(MissionSettings),
    /// `OIWPL`: a waypoint of a mission being uploaded.
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
}

/// Why a body is rejected.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ParseError {
    /// No supported sentence has this address.
    #[error("{address}: unsupported sentence")]
    Unknown {
        /// The characters before the first comma.
        address: String,
    },
    /// A field does not match the sentence's layout.
    #[error("{address} field {field} is {found:?}, expected {expected}")]
    Field {
        /// The characters before the first comma.
        address: String,
        /// The data field, counted from 1.
        field: usize,
        /// The contents of the field.
        found: String,
        /// The allowed contents.
        expected: &'static str,
    },
    /// The sentence is too short.
    #[error("{address} has {found} data fields, expected {expected} or more")]
    TooFew {
        /// The characters before the first comma.
        address: String,
        /// The number of data fields found.
        found: usize,
        /// The minimum number of data fields.
        expected: usize,
    },
}

impl Sentence {
    /// Parses a body (the characters between `$` and `*`).
    ///
    /// # Errors
    /// [`ParseError::Unknown`] for an unsupported sentence, other errors for a malformed one.
    pub fn parse(body: &str) -> Result<Sentence, ParseError> {
        let reader = Reader::of(body);
        let blank = Sentence::blank(reader.address);
        let mut sentence = blank.ok_or_else(|| ParseError::Unknown {
            address: reader.address.to_owned(),
        })?;
        reader.read(sentence.layout())?;
        Ok(sentence)
    }

    /// Appends [`Sentence::line`].
    pub fn write(&self, out: &mut Vec<u8>) {
        out.extend_from_slice(self.line().as_bytes());
    }

    /// The sentence as sent: `$body*HH\r\n`, at most [`EMITTED_MAX`] bytes, all ASCII.
    ///
    /// A non-finite number becomes an empty field, as does any field that would make the sentence
    /// too long.
    pub fn line(&self) -> String {
        // Round before writing, so that the sum of thrust and difference stays within 100 %.
        let mut rounded = match self.clone() {
            Sentence::Command(command) => Sentence::Command(command.rounded()),
            Sentence::ControlState(state) => Sentence::ControlState(state.rounded()),
            Sentence::MissionSettings(settings) => Sentence::MissionSettings(settings.rounded()),
            other => other,
        };
        Writer::line(rounded.layout())
    }

    /// An empty sentence with this address: one of the Surveyor's proprietary sentences, or a
    /// standard sentence with a two-character talker.
    fn blank(address: &str) -> Option<Sentence> {
        Some(
            match (address, Talker::split(address).map_or("", |(_, kind)| kind)) {
                ("PSEAC", _) => Sentence::Command(Command::default()),
                ("PSEAA", _) => Sentence::Attitude(Attitude::default()),
                ("PSEAB", _) => Sentence::Battery(Battery::default()),
                ("PSEAD", _) => Sentence::ControlState(ControlState::default()),
                ("PSEAG", _) => Sentence::BoatError(BoatError::default()),
                ("PSEAR", _) => Sentence::MissionSettings(MissionSettings::default()),
                ("OIWPL", _) => Sentence::Waypoint(Waypoint::default()),
                // Standard sentences are identified by their last three letters, whatever the
                // talker: GP, GN and others are all in use.
                (_, "GGA") => Sentence::Gga(Gga::default()),
                (_, "RMC") => Sentence::Rmc(Rmc::default()),
                (_, "VTG") => Sentence::Vtg(Vtg::default()),
                (_, "HDT") => Sentence::Hdt(Hdt::default()),
                (_, "HDG") => Sentence::Hdg(Hdg::default()),
                (_, "ZDA") => Sentence::Zda(Zda::default()),
                _ => return None,
            },
        )
    }

    fn layout(&mut self) -> Layout<'_> {
        match self {
            Sentence::Command(command) => command.layout(),
            Sentence::Attitude(attitude) => attitude.layout(),
            Sentence::Battery(battery) => battery.layout(),
            Sentence::ControlState(state) => state.layout(),
            Sentence::BoatError(error) => error.layout(),
            Sentence::MissionSettings(settings) => settings.layout(),
            Sentence::Waypoint(waypoint) => waypoint.layout(),
            Sentence::Gga(gga) => gga.layout(),
            Sentence::Rmc(rmc) => rmc.layout(),
            Sentence::Vtg(vtg) => vtg.layout(),
            Sentence::Hdt(hdt) => hdt.layout(),
            Sentence::Hdg(hdg) => hdg.layout(),
            Sentence::Zda(zda) => zda.layout(),
        }
    }
}

/// The sentence with this body: `$body*HH\r\n`.
pub fn with_checksum(body: &str) -> String {
    format!("${body}*{:02X}\r\n", checksum(body.as_bytes()))
}

/// The exclusive or of all bytes of a body.
pub fn checksum(body: &[u8]) -> u8 {
    body.iter().fold(0, |sum, byte| sum ^ byte)
}
