//! The emergency recovery point that a boat has from us: uploaded with a mission, and seen taken.

use crate::nmea::{Mode, Operator};
use crate::protocol::ControlReport;
use game::external::Mission;

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
    pub(super) fn take(&mut self, report: &ControlReport, is_uploading: bool) {
        let RecoveryPoint::Uploading(erp, shown) = *self else { return };
        let is_ours = report.operator.is_none_or(|operator| operator == Operator::Secondary);
        *self = match report.shown.mode {
            _ if !is_ours => RecoveryPoint::Unknown,
            Mode::FileDownload => RecoveryPoint::Uploading(erp, true),
            Mode::Waypoint if shown && !is_uploading => RecoveryPoint::Taken(erp),
            _ => *self,
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
