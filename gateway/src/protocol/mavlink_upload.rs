//! The upload of a mission by MAVLink: the boat's home is set and seen taken, then the boat asks for item after item.

use super::mavlink::{Target, global_e7};
use crate::mavlink::dialect::HOME_POSITION_DATA;
use crate::mavlink::dialect::{
    COMMAND_INT_DATA, COMMAND_LONG_DATA, MISSION_COUNT_DATA, MISSION_ITEM_INT_DATA, MavCmd, MavFrame, MavMessage,
    MavMissionResult,
};
use ::mavlink::MessageData;
use messages::external::Mission;
use primitives::SimTime;

/// What the boat does not answer is sent again after this time, s, and so often in all.
const AGAIN_S: f64 = 1.0;
const TRIES_MAX: u32 = 5;
/// A home that is as near to the recovery point as this is the one that was set, 1e-7 degrees: one metre.
const SAME_E7: u32 = 90;

/// The upload.
#[derive(Clone, Debug)]
pub(super) struct Upload {
    items: Vec<MISSION_ITEM_INT_DATA>,
    /// Where the boat's home is to be: latitude and longitude, 1e-7 degrees.
    home: (i32, i32),
    phase: Phase,
    tries: u32,
    due: SimTime,
}

/// What the boat has to do next.
#[derive(Clone, Debug, PartialEq)]
enum Phase {
    /// Show the home that it was sent.
    Home,
    /// Ask for items, and take them.
    Items,
    /// Nothing.
    Done,
    /// Nothing any more: it has refused this.
    Refused(String),
}

/// How an upload goes on.
pub(super) enum Next {
    /// These are sent.
    Send(Vec<MavMessage>),
    Wait,
    Done,
    Failed(String),
}

impl Upload {
    /// The items of a mission that is sailed at this speed, m/s. The first is the home, as ArduPilot counts.
    pub(super) fn new(mission: &Mission, speed_m_s: f64, target: Target, now: SimTime) -> Upload {
        let item = |command: MavCmd, [lat_deg, lon_deg]: [f64; 2]| MISSION_ITEM_INT_DATA {
            x: global_e7(lat_deg),
            y: global_e7(lon_deg),
            command,
            target_system: target.system,
            target_component: target.component,
            frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
            autocontinue: 1,
            ..MISSION_ITEM_INT_DATA::default()
        };
        // Speed over the ground, and no throttle.
        let speed = MISSION_ITEM_INT_DATA {
            param1: 1.0,
            param2: speed_m_s as f32,
            param3: -1.0,
            ..item(MavCmd::MAV_CMD_DO_CHANGE_SPEED, [0.0; 2])
        };
        let mut items = vec![item(MavCmd::MAV_CMD_NAV_WAYPOINT, mission.erp), speed];
        items.extend(mission.waypoints.iter().map(|at| item(MavCmd::MAV_CMD_NAV_WAYPOINT, *at)));
        for (seq, item) in items.iter_mut().enumerate() {
            item.seq = seq as u16;
        }
        let [lat_deg, lon_deg] = mission.erp;
        Upload { items, home: (global_e7(lat_deg), global_e7(lon_deg)), phase: Phase::Home, tries: 0, due: now }
    }

    /// When it goes on by itself.
    pub(super) fn due(&self) -> SimTime {
        self.due
    }

    pub(super) fn next(&mut self, now: SimTime, target: Target) -> Next {
        match &self.phase {
            Phase::Done => return Next::Done,
            Phase::Refused(reason) => return Next::Failed(reason.clone()),
            Phase::Home | Phase::Items if now < self.due => return Next::Wait,
            Phase::Home | Phase::Items => {}
        }
        if self.tries == TRIES_MAX {
            let what = if self.phase == Phase::Home {
                "does not report the home position that it was sent"
            } else {
                "requests no item"
            };
            return Next::Failed(format!("the boat {what}"));
        }
        self.tries += 1;
        self.due = now + SimTime::from_s(AGAIN_S);
        Next::Send(if self.phase == Phase::Home { self.home(target) } else { vec![self.count(target)] })
    }

    /// The boat shows its home.
    pub(super) fn take_home(&mut self, (lat_e7, lon_e7): (i32, i32), now: SimTime) {
        let is_near = lat_e7.abs_diff(self.home.0) <= SAME_E7 && lon_e7.abs_diff(self.home.1) <= SAME_E7;
        if self.phase == Phase::Home && is_near {
            // RTL goes to the home, so a boat that has not taken it must not get a mission
            // whose recovery point it is.
            (self.phase, self.tries, self.due) = (Phase::Items, 0, now);
        }
    }

    /// The boat asks for an item.
    pub(super) fn take_request(&mut self, seq: u16, now: SimTime) -> Option<MavMessage> {
        let item = self.items.get(usize::from(seq)).filter(|_| self.phase == Phase::Items)?;
        // Each request shows that the boat is still at it: the tries begin anew.
        (self.tries, self.due) = (1, now + SimTime::from_s(AGAIN_S));
        Some(MavMessage::MISSION_ITEM_INT(item.clone()))
    }

    /// The boat takes the mission, or does not.
    pub(super) fn take_ack(&mut self, result: MavMissionResult, now: SimTime) {
        // ArduPilot answers so to an item that comes twice, since it was slow to come once, and goes on.
        if self.phase == Phase::Items && result != MavMissionResult::MAV_MISSION_INVALID_SEQUENCE {
            let is_taken = result == MavMissionResult::MAV_MISSION_ACCEPTED;
            self.phase = if is_taken { Phase::Done } else { Phase::Refused(format!("the boat answers {result:?}")) };
            self.due = now;
        }
    }

    fn home(&self, target: Target) -> Vec<MavMessage> {
        let set = COMMAND_INT_DATA {
            x: self.home.0,
            y: self.home.1,
            command: MavCmd::MAV_CMD_DO_SET_HOME,
            target_system: target.system,
            target_component: target.component,
            frame: MavFrame::MAV_FRAME_GLOBAL,
            ..COMMAND_INT_DATA::default()
        };
        let show = COMMAND_LONG_DATA {
            param1: HOME_POSITION_DATA::ID as f32,
            command: MavCmd::MAV_CMD_REQUEST_MESSAGE,
            target_system: target.system,
            target_component: target.component,
            ..COMMAND_LONG_DATA::default()
        };
        vec![MavMessage::COMMAND_INT(set), MavMessage::COMMAND_LONG(show)]
    }

    fn count(&self, target: Target) -> MavMessage {
        MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
            count: self.items.len() as u16,
            target_system: target.system,
            target_component: target.component,
            ..MISSION_COUNT_DATA::default()
        })
    }
}
