//! The protocol of a boat: converts its bytes to [`Report`]s, and [`Command`]s to bytes.
//!
//! This module does not decide whether a boat may move: the supervisor does, and a bridge sends the
//! result.

mod codec;
mod mavlink;
mod mavlink_boat;
mod mavlink_upload;
mod mission_check;
mod report;
mod status_text;
mod surveyor;

use crate::config::{BoatProtocol, Gateway};
pub(crate) use codec::named;
pub use codec::{Codec, Command, UploadStep};
use mavlink::Mavlink;
pub use report::{ControlReport, Fix, Heading, North, Power, Report, Shown};
use std::ops::{Deref, DerefMut};
use surveyor::Surveyor;

/// A protocol, with the state of its link.
#[derive(Clone, Debug)]
pub enum Protocol {
    /// The Surveyor's NMEA.
    Surveyor(Box<Surveyor>),
    /// MAVLink, with an ArduPilot boat.
    Mavlink(Box<Mavlink>),
}

impl Protocol {
    /// The protocol of the boat that a gateway drives.
    pub fn new(gateway: &Gateway) -> Protocol {
        match gateway.protocol {
            BoatProtocol::Surveyor => {
                Protocol::Surveyor(Box::new(Surveyor::new(gateway.upload_gap_s)))
            }
            BoatProtocol::Mavlink => Protocol::Mavlink(Box::new(Mavlink::new(gateway))),
        }
    }
}

impl Deref for Protocol {
    type Target = dyn Codec;

    fn deref(&self) -> &Self::Target {
        match self {
            Protocol::Surveyor(surveyor) => &**surveyor,
            Protocol::Mavlink(mavlink) => &**mavlink,
        }
    }
}

impl DerefMut for Protocol {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Protocol::Surveyor(surveyor) => &mut **surveyor,
            Protocol::Mavlink(mavlink) => &mut **mavlink,
        }
    }
}
