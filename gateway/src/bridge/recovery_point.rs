//! The emergency recovery point that we set: uploaded with a mission, then confirmed by
//! observation.

use crate::nmea::{Mode, Operator};
use crate::protocol::ControlReport;

/// Maximum distance (degrees) at which a reported home counts as our recovery point: one metre.
const HOME_DEG: f64 = 9e-6;

/// The state of the boat's recovery point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum RecoveryPoint {
    /// The boat has no known recovery point.
    #[default]
    Unknown,
    /// The mission with the point is being uploaded: latitude and longitude, degrees, and whether
    /// the boat has reported that it accepts lines.
    Uploading([f64; 2], bool),
    /// The boat has accepted the point (latitude and longitude in degrees).
    Taken([f64; 2]),
}

impl RecoveryPoint {
    /// Checks the boat's report: the point counts as accepted when the boat runs the mission after
    /// it has accepted lines.
    pub(super) fn observe(&mut self, report: &ControlReport, is_uploading: bool) {
        let RecoveryPoint::Uploading(erp, shown) = *self else {
            return;
        };
        let is_ours = report
            .operator
            .is_none_or(|operator| operator == Operator::Secondary);
        *self = match report.shown.mode {
            // Another operator may upload a different mission, and boats do not report which one
            // they have.
            _ if !is_ours => RecoveryPoint::Unknown,
            Mode::FileDownload => RecoveryPoint::Uploading(erp, true),
            // No sentence acknowledges an upload. We can only observe that the boat entered mode F
            // for the lines, then mode W at our command; over TCP no line is lost on the way.
            Mode::Waypoint if shown && !is_uploading => RecoveryPoint::Taken(erp),
            _ => *self,
        };
    }

    /// Compares the boat's reported home, which is its recovery point, with ours.
    pub(super) fn take_home(&mut self, [lat_deg, lon_deg]: [f64; 2]) {
        let (RecoveryPoint::Uploading(erp, _) | RecoveryPoint::Taken(erp)) = *self else {
            return;
        };
        let is_it = (lat_deg - erp[0]).abs() <= HOME_DEG && (lon_deg - erp[1]).abs() <= HOME_DEG;
        *self = match *self {
            _ if is_it => RecoveryPoint::Taken(erp),
            // The boat now has a different recovery point.
            RecoveryPoint::Taken(_) => RecoveryPoint::Unknown,
            before => before,
        };
    }

    /// The accepted point: latitude and longitude, degrees.
    pub(super) fn taken(self) -> Option<[f64; 2]> {
        match self {
            RecoveryPoint::Taken(erp) => Some(erp),
            RecoveryPoint::Unknown | RecoveryPoint::Uploading(..) => None,
        }
    }
}
