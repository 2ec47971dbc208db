//! The commands that an emulated ArduPilot boat accepts, and its acknowledgements.

#![expect(
    deprecated,
    reason = "ground stations also send the older commands, and ArduPilot accepts them"
)]

use super::ArduPilot;
use super::set_point::{SPEED_MIN_M_S, is_global};
use crate::mavlink::RoverMode;
use crate::mavlink::dialect::{
    AUTOPILOT_VERSION_DATA, COMMAND_ACK_DATA, COMMAND_INT_DATA, COMMAND_LONG_DATA,
    HOME_POSITION_DATA, MavCmd, MavFrame, MavModeFlag, MavResult, MavSeverity,
};
use ::mavlink::MessageData;
use primitives::SimTime;
use primitives::frame::Ned;

const DONE: MavResult = MavResult::MAV_RESULT_ACCEPTED;
const DENIED: MavResult = MavResult::MAV_RESULT_DENIED;
const FAILED: MavResult = MavResult::MAV_RESULT_FAILED;
/// Rover's modes, emulated or not.
const ROVER_MODES: [u32; 14] = [0, 1, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 15, 16];
/// Minimum change that moves the home of a disarmed boat, m.
const HOME_MOVES_M: f64 = 0.5;
/// The only flag of MAV_CMD_DO_REPOSITION: the boat may change to GUIDED.
const CHANGE_MODE: i32 = 1;

fn result_of(is_done: bool) -> MavResult {
    if is_done { DONE } else { FAILED }
}

impl ArduPilot {
    /// Converts the command to the equivalent COMMAND_INT, as ArduPilot does, and executes it.
    pub(super) fn take_command_long(
        &mut self,
        now: SimTime,
        from: (u8, u8),
        long: &COMMAND_LONG_DATA,
    ) {
        // Rover accepts the position of this command only in a COMMAND_INT.
        if long.command == MavCmd::MAV_CMD_DO_REPOSITION {
            let unsupported = MavResult::MAV_RESULT_UNSUPPORTED;
            return self.acknowledge(from, long.command as u16, unsupported);
        }
        let has_position = long.command == MavCmd::MAV_CMD_DO_SET_HOME;
        let whole =
            |param: f32| (if has_position { 1e7 } else { 1.0 } * f64::from(param)).round() as i32;
        let int = COMMAND_INT_DATA {
            param1: long.param1,
            param2: long.param2,
            param3: long.param3,
            param4: long.param4,
            x: whole(long.param5),
            y: whole(long.param6),
            command: long.command,
            frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
            ..Default::default()
        };
        self.take_command_int(now, from, &int);
    }

    pub(super) fn take_command_int(
        &mut self,
        now: SimTime,
        from: (u8, u8),
        command: &COMMAND_INT_DATA,
    ) {
        let COMMAND_INT_DATA { param1, param2, .. } = *command;
        let result = match command.command {
            MavCmd::MAV_CMD_DO_SET_MODE => {
                let base_mode = MavModeFlag::from_bits_truncate(param1 as u8);
                self.command_own_mode(base_mode, param2 as u32)
            }
            MavCmd::MAV_CMD_COMPONENT_ARM_DISARM if !matches!(param1, 0.0 | 1.0) => {
                MavResult::MAV_RESULT_UNSUPPORTED
            }
            MavCmd::MAV_CMD_COMPONENT_ARM_DISARM => self.command_arming(param1 == 1.0),
            MavCmd::MAV_CMD_RUN_PREARM_CHECKS => DONE,
            MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL => {
                self.streams.set_interval(param1 as u32, f64::from(param2))
            }
            MavCmd::MAV_CMD_REQUEST_MESSAGE => result_of(self.send_message(now, param1 as u32)),
            MavCmd::MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES => {
                result_of(param1 == 1.0 && self.send_message(now, AUTOPILOT_VERSION_DATA::ID))
            }
            MavCmd::MAV_CMD_GET_HOME_POSITION => {
                result_of(self.send_message(now, HOME_POSITION_DATA::ID))
            }
            MavCmd::MAV_CMD_DO_SET_HOME => self.command_home(command),
            MavCmd::MAV_CMD_DO_CHANGE_SPEED => result_of(self.change_speed(f64::from(param2))),
            MavCmd::MAV_CMD_DO_REPOSITION => self.command_reposition(command),
            MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH => self.command_mode(RoverMode::Rtl.number()),
            // Rover does not support partial missions either.
            MavCmd::MAV_CMD_MISSION_START if param1 != 0.0 || param2 != 0.0 => DENIED,
            MavCmd::MAV_CMD_MISSION_START => self.command_mode(RoverMode::Auto.number()),
            MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT
                if param1 >= 0.0 && self.set_current(param1 as u16) =>
            {
                DONE
            }
            MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT => DENIED,
            _ => MavResult::MAV_RESULT_UNSUPPORTED,
        };
        self.acknowledge(from, command.command as u16, result);
    }

    /// Acknowledges a command. It is given as a number, because commands outside the dialect are
    /// also acknowledged.
    pub(super) fn acknowledge(&mut self, from: (u8, u8), command: u16, result: MavResult) {
        let [low, high] = command.to_le_bytes();
        let payload = [low, high, result as u8, 0, 0, 0, 0, 0, from.0, from.1];
        self.writer.write_raw(
            COMMAND_ACK_DATA::ID,
            COMMAND_ACK_DATA::EXTRA_CRC,
            &payload,
            &mut self.outbox,
        );
    }

    /// Changes the mode. Like Rover, the boat accepts only Rover's own modes.
    pub(super) fn command_own_mode(&mut self, base_mode: MavModeFlag, number: u32) -> MavResult {
        if base_mode.contains(MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED) {
            self.command_mode(number)
        } else {
            DENIED
        }
    }

    pub(super) fn command_mode(&mut self, number: u32) -> MavResult {
        let mode = RoverMode::from_number(number);
        if !ROVER_MODES.contains(&number) {
            self.say(
                MavSeverity::MAV_SEVERITY_WARNING,
                &format!("No such mode {number}"),
            );
            return FAILED;
        }
        if mode == RoverMode::Auto && self.mission.waypoints() == 0 {
            let text = "No Mission. Can't set AUTO.";
            self.say(MavSeverity::MAV_SEVERITY_NOTICE, text);
        }
        let can = match mode {
            RoverMode::Manual | RoverMode::Hold | RoverMode::Guided | RoverMode::Loiter => true,
            // Rover rejects a mode without a task and sends the reason in a STATUSTEXT, which the
            // gateway shows to its operator.
            RoverMode::Auto => self.mission.waypoints() > 0,
            RoverMode::Rtl => self.home.is_some(),
            _ => false,
        };
        if !can {
            return self.refuse("Flight mode change failed");
        }
        self.set_mode(mode);
        DONE
    }

    pub(super) fn command_arming(&mut self, arm: bool) -> MavResult {
        if !arm {
            // As in ArduPilot, the mission restarts unless the boat is in AUTO already.
            if self.is_armed && self.mode != RoverMode::Auto {
                self.autopilot.next = 1;
            }
            if std::mem::take(&mut self.is_armed) {
                self.say(MavSeverity::MAV_SEVERITY_INFO, "Throttle disarmed");
            }
            return DONE;
        }
        if self.sensed.own.is_none() {
            return self.refuse("PreArm: GPS 1: Bad fix");
        }
        if !self.is_armed {
            if !self.mode.allows_arming() {
                return self.refuse("Arm: Mode not armable");
            }
            self.is_armed = true;
            self.say(MavSeverity::MAV_SEVERITY_INFO, "Throttle armed");
        }
        DONE
    }

    fn command_home(&mut self, command: &COMMAND_INT_DATA) -> MavResult {
        let at_e7 = (command.x, command.y);
        let is_here = command.param1 == 1.0 || at_e7 == (0, 0);
        if !is_here && command.param1 == 0.0 && !is_global(command.frame) {
            return DENIED;
        }
        let home = if is_here {
            self.sensed.own.map(|own| self.e7(own.nav.at()))
        } else {
            Some(at_e7).filter(|at_e7| command.param1 == 0.0 && self.place(*at_e7).is_some())
        };
        if let Some(home @ (lat_e7, lon_e7)) = home {
            self.set_home(home);
            self.is_home_locked = true;
            let (lat_deg, lon_deg) = (1e-7 * f64::from(lat_e7), 1e-7 * f64::from(lon_e7));
            let text = format!("Set HOME to {lat_deg:.5} {lon_deg:.5} at 0.00m");
            self.say(MavSeverity::MAV_SEVERITY_INFO, &text);
        }
        result_of(home.is_some())
    }

    /// Moves the home of a disarmed boat to its position, as Rover does, unless a ground station
    /// has set the home.
    pub(super) fn update_home(&mut self, here: Ned) {
        let before = self.home.and_then(|home| self.place(home));
        let has_moved = before.is_none_or(|home| home.distance(here) >= HOME_MOVES_M);
        if !self.is_armed && !self.is_home_locked && has_moved {
            self.set_home(self.e7(here));
        }
    }

    fn set_home(&mut self, home: (i32, i32)) {
        self.home = Some(home);
        self.place(home)
            .into_iter()
            .for_each(|place| self.autopilot.set_home(place));
    }

    /// Changes the speed in modes that drive to positions. Returns whether the current mode is such
    /// a mode.
    fn change_speed(&mut self, speed_m_s: f64) -> bool {
        match self.mode {
            RoverMode::Guided => self.set_points.set_speed(speed_m_s),
            RoverMode::Auto | RoverMode::Rtl if speed_m_s >= SPEED_MIN_M_S => {
                self.autopilot.speed_m_s = Some(speed_m_s);
                true
            }
            _ => false,
        }
    }

    /// Drives to a position, at the given speed if any. Like Rover, the boat accepts a speed only
    /// if it is already driving to a position.
    fn command_reposition(&mut self, command: &COMMAND_INT_DATA) -> MavResult {
        let may_change_mode = command.param2 as i32 & CHANGE_MODE != 0;
        let at_e7 = (command.x, command.y);
        let place = self
            .place(at_e7)
            .filter(|_| is_global(command.frame) && at_e7 != (0, 0));
        let (Some(place), true) = (place, self.mode == RoverMode::Guided || may_change_mode) else {
            return DENIED;
        };
        self.set_mode(RoverMode::Guided);
        if command.param1 > 0.0 && !self.change_speed(f64::from(command.param1)) {
            return FAILED;
        }
        result_of(self.set_points.go_to(place))
    }

    /// Continues the mission with the given item; returns whether the item exists.
    pub(super) fn set_current(&mut self, seq: u16) -> bool {
        let waypoint = self.mission.waypoint_of(seq);
        waypoint
            .into_iter()
            .for_each(|waypoint| self.autopilot.next = waypoint);
        waypoint.is_some()
    }

    fn refuse(&mut self, text: &str) -> MavResult {
        self.say(MavSeverity::MAV_SEVERITY_CRITICAL, text);
        FAILED
    }
}
