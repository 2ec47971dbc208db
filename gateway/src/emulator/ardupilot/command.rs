//! The commands that an emulated ArduPilot boat takes, and its acknowledgements.

use super::ArduPilot;
use crate::mavlink::RoverMode;
use crate::mavlink::dialect::{
    COMMAND_ACK_DATA, COMMAND_INT_DATA, COMMAND_LONG_DATA, MavCmd, MavMessage, MavResult, MavSeverity, STATUSTEXT_DATA,
};

const DONE: MavResult = MavResult::MAV_RESULT_ACCEPTED;
const FAILED: MavResult = MavResult::MAV_RESULT_FAILED;

impl ArduPilot {
    pub(super) fn take_command_long(&mut self, command: &COMMAND_LONG_DATA) {
        let COMMAND_LONG_DATA { param1, param2, param5, param6, .. } = *command;
        let at_e7 = ((1e7 * f64::from(param5)).round() as i32, (1e7 * f64::from(param6)).round() as i32);
        self.take_command(command.command, [param1, param2], at_e7);
    }

    pub(super) fn take_command_int(&mut self, command: &COMMAND_INT_DATA) {
        self.take_command(command.command, [command.param1, command.param2], (command.x, command.y));
    }

    fn take_command(&mut self, command: MavCmd, [param1, param2]: [f32; 2], at_e7: (i32, i32)) {
        let result = match command {
            MavCmd::MAV_CMD_DO_SET_MODE => self.command_mode(param2 as u32),
            MavCmd::MAV_CMD_COMPONENT_ARM_DISARM => self.command_arming(param1 == 1.0),
            MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL => self.streams.set_interval(param1 as u32, f64::from(param2)),
            MavCmd::MAV_CMD_REQUEST_MESSAGE => self.streams.request(param1 as u32),
            MavCmd::MAV_CMD_DO_SET_HOME => self.command_home(param1 == 1.0, at_e7),
            _ => MavResult::MAV_RESULT_UNSUPPORTED,
        };
        self.outbox.push(MavMessage::COMMAND_ACK(COMMAND_ACK_DATA { command, result, ..COMMAND_ACK_DATA::default() }));
    }

    pub(super) fn command_mode(&mut self, number: u32) -> MavResult {
        let mode = RoverMode::from_number(number);
        let can = match mode {
            RoverMode::Manual | RoverMode::Hold | RoverMode::Guided | RoverMode::Loiter => true,
            // Rover refuses a mode that has nothing to do, and says so in a STATUSTEXT, which
            // the gateway shows to its operator.
            RoverMode::Auto => self.mission.waypoints() > 0,
            RoverMode::Rtl => self.home.is_some(),
            _ => false,
        };
        if !can {
            self.say("Flight mode change failed");
            return FAILED;
        }
        self.set_mode(mode);
        DONE
    }

    fn command_arming(&mut self, arm: bool) -> MavResult {
        let Some(own) = self.sensed.own.filter(|_| arm) else {
            self.is_armed = false;
            return if arm { self.refuse("PreArm: GPS 1: Bad fix") } else { DONE };
        };
        if !self.is_armed {
            if !self.mode.allows_arming() {
                return self.refuse("Arm: Mode not armable");
            }
            self.is_armed = true;
            // Where it is armed is its home, unless that was set.
            let at = self.frame.lat_lon(own.nav.at());
            let here = ((1e7 * at.lat_deg).round() as i32, (1e7 * at.lon_deg).round() as i32);
            // As ArduPilot does: the home is where the boat is first armed, unless a ground
            // station has set it.
            if self.home.is_none() {
                self.set_home(here);
            }
        }
        DONE
    }

    fn command_home(&mut self, is_here: bool, at_e7: (i32, i32)) -> MavResult {
        let here = || {
            let at = self.frame.lat_lon(self.sensed.own?.nav.at());
            Some(((1e7 * at.lat_deg).round() as i32, (1e7 * at.lon_deg).round() as i32))
        };
        let Some(home) = (if is_here { here() } else { Some(at_e7) }) else { return FAILED };
        self.set_home(home);
        DONE
    }

    fn set_home(&mut self, home: (i32, i32)) {
        self.home = Some(home);
        self.autopilot.set_home(self.place(home));
    }

    fn refuse(&mut self, text: &str) -> MavResult {
        self.say(text);
        FAILED
    }

    /// Tells operators something.
    pub(super) fn say(&mut self, text: &str) {
        let severity = MavSeverity::MAV_SEVERITY_CRITICAL;
        let status = STATUSTEXT_DATA { severity, text: text.into(), ..STATUSTEXT_DATA::default() };
        self.outbox.push(MavMessage::STATUSTEXT(status));
    }
}
