//! The ground station failsafe of an emulated ArduPilot boat, as in Rover. It works without a
//! gateway.

use super::ArduPilot;
use crate::mavlink::RoverMode;
use crate::mavlink::dialect::{MavResult, MavSeverity};
use primitives::SimTime;

/// The state of the ground station (SYSID_MYGCS) whose loss triggers the failsafe.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StationWatch {
    /// When it was last heard; a station that was never heard cannot be lost.
    pub(super) heard_at: Option<SimTime>,
    /// When it was found lost.
    lost_at: Option<SimTime>,
    /// Whether the failsafe has acted on this loss. It acts only once, so that it does not override
    /// an operator who takes over.
    pub(super) is_triggered: bool,
}

impl ArduPilot {
    /// Checks for the loss of the station. The station is lost after FS_GCS_TIMEOUT without a
    /// message; FS_TIMEOUT later, the boat executes FS_ACTION. Only action 5 (terminate) disarms
    /// the boat.
    pub(super) fn check_failsafe(&mut self, now: SimTime) {
        let is_enabled = self.parameters.value("FS_GCS_ENABLE") != 0.0;
        let Some(heard_at) = self.station.heard_at.filter(|_| is_enabled) else {
            return;
        };
        if (now - heard_at).as_s() < self.parameters.value("FS_GCS_TIMEOUT") {
            if self.station.is_triggered {
                self.say(MavSeverity::MAV_SEVERITY_INFO, "GCS Failsafe Cleared");
            }
            (self.station.lost_at, self.station.is_triggered) = (None, false);
            return;
        }
        let lost_at = *self.station.lost_at.get_or_insert(now);
        let is_due = (now - lost_at).as_s() > self.parameters.value("FS_TIMEOUT");
        // The failsafe does not act on a boat at rest or on its way home.
        if is_due
            && !self.station.is_triggered
            && !matches!(self.mode, RoverMode::Hold | RoverMode::Rtl)
        {
            self.station.is_triggered = true;
            self.say(MavSeverity::MAV_SEVERITY_WARNING, "GCS Failsafe");
            self.fail_safe();
        }
    }

    fn fail_safe(&mut self) {
        self.set_points.manual = None;
        // If FS_GCS_ENABLE is 2, a mission continues.
        if self.mode == RoverMode::Auto && self.parameters.value("FS_GCS_ENABLE") == 2.0 {
            return self.say(
                MavSeverity::MAV_SEVERITY_WARNING,
                "Failsafe - Continuing Auto Mode",
            );
        }
        match self.parameters.value("FS_ACTION") as i32 {
            // SmartRTL, which is not emulated, falls back to RTL, and RTL to HOLD.
            1 | 3
                if self.command_mode(RoverMode::Rtl.number()) == MavResult::MAV_RESULT_ACCEPTED => {
            }
            5 => drop(self.command_arming(false)),
            1..=4 => self.set_mode(RoverMode::Hold),
            _ => {}
        }
    }
}
