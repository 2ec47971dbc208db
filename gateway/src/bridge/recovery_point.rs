//! The emergency recovery point that a boat has from us: uploaded with a mission, and seen taken.

use crate::nmea::{Mode, Operator};
use crate::protocol::ControlReport;
use messages::external::Mission;

/// A home that is as near to the recovery point as this is the one that was set, degrees: one metre.
const HOME_DEG: f64 = 9e-6;

/// How far the boat has come with it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum RecoveryPoint {
    /// It has none that we know of.
    #[default]
    Unknown,
    /// A mission with it is on its way: latitude and longitude, degrees, and whether the boat has shown that it takes lines.
    Uploading([f64; 2], bool),
    /// The boat has it.
    Taken([f64; 2]),
}

impl RecoveryPoint {
    /// The upload of a mission begins, with which the boat forgets what it had.
    pub(super) fn begin(&mut self, mission: &Mission) {
        *self = RecoveryPoint::Uploading(mission.erp, false);
    }

    /// The boat's report: taken is what it sails after it has shown that it took lines.
    pub(super) fn observe(&mut self, report: &ControlReport, is_uploading: bool) {
        let RecoveryPoint::Uploading(erp, shown) = *self else { return };
        let is_ours = report.operator.is_none_or(|operator| operator == Operator::Secondary);
        *self = match report.shown.mode {
            // Another operator may upload a mission of their own, and a boat does not say which
            // one it has.
            _ if !is_ours => RecoveryPoint::Unknown,
            Mode::FileDownload => RecoveryPoint::Uploading(erp, true),
            // No sentence acknowledges an upload. What can be seen is that the boat went into
            // mode F for the lines and then into W by our command; over TCP no line is lost on
            // the way.
            Mode::Waypoint if shown && !is_uploading => RecoveryPoint::Taken(erp),
            _ => *self,
        };
    }

    /// The boat shows its home, to which it goes for recovery.
    pub(super) fn take_home(&mut self, [lat_deg, lon_deg]: [f64; 2]) {
        let (RecoveryPoint::Uploading(erp, _) | RecoveryPoint::Taken(erp)) = *self else { return };
        let is_it = (lat_deg - erp[0]).abs() <= HOME_DEG && (lon_deg - erp[1]).abs() <= HOME_DEG;
        *self = match *self {
            _ if is_it => RecoveryPoint::Taken(erp),
            // It has another one now.
            RecoveryPoint::Taken(_) => RecoveryPoint::Unknown,
            before => before,
        };
    }

    /// Where it is: latitude and longitude, degrees.
    pub(super) fn taken(self) -> Option<[f64; 2]> {
        match self {
            RecoveryPoint::Taken(erp) => Some(erp),
            RecoveryPoint::Unknown | RecoveryPoint::Uploading(..) => None,
        }
    }
}
