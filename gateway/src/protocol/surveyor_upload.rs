//! The upload of a mission to a Surveyor: one line after the other, with pauses.

use super::surveyor::{end_of_download, start_of_download};
use crate::nmea::{MissionSettings, Sentence, Waypoint};
use messages::external::Mission;
use primitives::SimTime;
use primitives::frame::LatLon;
use std::collections::VecDeque;

/// The lines still to be sent.
#[derive(Clone, Debug)]
pub(super) struct Upload {
    lines: VecDeque<Sentence>,
    gap: SimTime,
    due: SimTime,
}

/// The next step.
pub(super) enum Next {
    /// Send this line now.
    Line(Box<Sentence>),
    /// Nothing yet.
    Wait,
    /// All lines have been sent.
    Done,
}

impl Upload {
    /// The lines of a mission: start of download, settings, emergency recovery point (index 0), waypoints, end.
    pub(super) fn new(mission: &Mission, gap_s: f64, now: SimTime) -> Upload {
        let places = std::iter::once(&mission.erp).chain(&mission.waypoints);
        let mut lines = VecDeque::from([
            // The lines that follow: settings, recovery point, waypoints.
            start_of_download(mission.waypoints.len() + 2),
            Sentence::MissionSettings(MissionSettings { throttle_pct: mission.throttle_pct }),
        ]);
        for (index, [lat_deg, lon_deg]) in places.enumerate() {
            let at = LatLon { lat_deg: *lat_deg, lon_deg: *lon_deg };
            lines.push_back(Sentence::Waypoint(Waypoint { at, index: index as u16 }));
        }
        lines.push_back(end_of_download());
        Upload { lines, gap: SimTime::from_s(gap_s), due: now }
    }

    pub(super) fn next(&mut self, now: SimTime) -> Next {
        if now < self.due {
            return Next::Wait;
        }
        self.due = now + self.gap;
        self.lines.pop_front().map_or(Next::Done, |line| Next::Line(Box::new(line)))
    }

    /// When the next line is due.
    pub(super) fn due(&self) -> SimTime {
        self.due
    }
}
