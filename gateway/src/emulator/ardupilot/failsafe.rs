//! The failsafe of an emulated ArduPilot boat for a lost ground station, as Rover has it: it needs no gateway.

use super::ArduPilot;
use crate::mavlink::RoverMode;
use crate::mavlink::dialect::{MavResult, MavSeverity};
use primitives::SimTime;

/// What is known of the ground station whose failure matters, SYSID_MYGCS.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StationWatch {
    /// When it was last heard; one that was never heard is not missed.
    pub(super) heard_at: Option<SimTime>,
    /// Since when it counts as lost.
    lost_at: Option<SimTime>,
    /// Whether the failsafe has acted on this loss: once, so that an operator who takes over is not overruled.
    is_triggered: bool,
}

impl ArduPilot {
    /// Without a message for FS_GCS_TIMEOUT the station is lost; after FS_TIMEOUT more the boat does what FS_ACTION asks for. It stays
    /// armed, whatever the mode, but for the action that ends everything.
    pub(super) fn check_failsafe(&mut self, now: SimTime) {
        let is_enabled = self.parameters.value("FS_GCS_ENABLE") != 0.0;
        let Some(heard_at) = self.station.heard_at.filter(|_| is_enabled) else { return };
        if (now - heard_at).as_s() < self.parameters.value("FS_GCS_TIMEOUT") {
            if self.station.is_triggered {
                self.say(MavSeverity::MAV_SEVERITY_INFO, "GCS Failsafe Cleared");
            }
            (self.station.lost_at, self.station.is_triggered) = (None, false);
            return;
        }
        let lost_at = *self.station.lost_at.get_or_insert(now);
        let is_due = (now - lost_at).as_s() > self.parameters.value("FS_TIMEOUT");
        // A boat that rests or goes home is left alone.
        if is_due && !self.station.is_triggered && !matches!(self.mode, RoverMode::Hold | RoverMode::Rtl) {
            self.station.is_triggered = true;
            self.say(MavSeverity::MAV_SEVERITY_WARNING, "GCS Failsafe");
            self.fail_safe();
        }
    }

    fn fail_safe(&mut self) {
        self.set_points.release_manual();
        // With 2 a mission goes on.
        if self.mode == RoverMode::Auto && self.parameters.value("FS_GCS_ENABLE") == 2.0 {
            return self.say(MavSeverity::MAV_SEVERITY_WARNING, "Failsafe - Continuing Auto Mode");
        }
        match self.parameters.value("FS_ACTION") as i32 {
            0 => {}
            // SmartRTL, which is not emulated, falls back to RTL, and that to HOLD.
            1 | 3 if self.command_mode(RoverMode::Rtl.number()) == MavResult::MAV_RESULT_ACCEPTED => {}
            5 => self.is_armed = false,
            _ => self.set_mode(RoverMode::Hold),
        }
    }
}
