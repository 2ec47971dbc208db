//! The upload of a mission by MAVLink: the boat's home is set and confirmed, then the boat requests
//! the items one by one.

use super::codec::UploadStep;
use super::mavlink_boat::Target;
use crate::mavlink::dialect::HOME_POSITION_DATA;
use crate::mavlink::dialect::{
    COMMAND_INT_DATA, COMMAND_LONG_DATA, MISSION_COUNT_DATA, MISSION_ITEM_INT_DATA, MavCmd,
    MavFrame, MavMessage, MavMissionResult,
};
use crate::mavlink::e7;
use ::mavlink::MessageData;
use messages::external::Mission;
use primitives::SimTime;

/// Time after which an unanswered message is sent again (s), and the maximum number of attempts.
const AGAIN_S: f64 = 1.0;
const TRIES_MAX: u32 = 5;
/// Maximum difference between the boat's home and the recovery point that counts as equal, 1e-7
/// degrees: one metre.
const SAME_E7: u32 = 90;

/// The upload.
#[derive(Clone, Debug)]
pub(super) struct Upload {
    items: Vec<MISSION_ITEM_INT_DATA>,
    /// The position of the boat's new home: latitude and longitude, 1e-7 degrees.
    home: (i32, i32),
    phase: Phase,
    tries: u32,
    due: SimTime,
}

/// The step that the boat must take next.
#[derive(Clone, Debug, PartialEq)]
enum Phase {
    /// The boat must report the home that it was sent.
    Home,
    /// The boat requests items, and then accepts them.
    Items,
    /// No next step: the boat has accepted everything.
    Done,
    /// No next step: the boat has refused the mission, for this reason.
    Refused(String),
}

impl Upload {
    /// The items of a mission at this speed (m/s). The first is the home, as in ArduPilot's
    /// numbering.
    pub(super) fn new(mission: &Mission, speed_m_s: f64, target: Target, now: SimTime) -> Upload {
        let item = |command: MavCmd, [lat_deg, lon_deg]: [f64; 2]| MISSION_ITEM_INT_DATA {
            x: e7(lat_deg),
            y: e7(lon_deg),
            command,
            target_system: target.system,
            target_component: target.component,
            frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
            autocontinue: 1,
            ..MISSION_ITEM_INT_DATA::default()
        };
        // Specifies the speed over the ground, and no throttle.
        let speed = MISSION_ITEM_INT_DATA {
            param1: 1.0,
            param2: speed_m_s as f32,
            param3: -1.0,
            ..item(MavCmd::MAV_CMD_DO_CHANGE_SPEED, [0.0; 2])
        };
        let mut items = vec![item(MavCmd::MAV_CMD_NAV_WAYPOINT, mission.erp), speed];
        items.extend(
            mission
                .waypoints
                .iter()
                .map(|at| item(MavCmd::MAV_CMD_NAV_WAYPOINT, *at)),
        );
        for (seq, item) in items.iter_mut().enumerate() {
            item.seq = seq as u16;
        }
        let [lat_deg, lon_deg] = mission.erp;
        Upload {
            items,
            home: (e7(lat_deg), e7(lon_deg)),
            phase: Phase::Home,
            tries: 0,
            due: now,
        }
    }

    /// When the next step is due.
    pub(super) fn due(&self) -> SimTime {
        self.due
    }

    /// Appends the messages that are due.
    pub(super) fn next(
        &mut self,
        now: SimTime,
        target: Target,
        messages: &mut Vec<MavMessage>,
    ) -> UploadStep {
        let unanswered = match &self.phase {
            Phase::Done => return UploadStep::Done,
            Phase::Refused(reason) => return UploadStep::Failed(reason.clone()),
            Phase::Home | Phase::Items if now < self.due => return UploadStep::Waiting,
            Phase::Home => "does not report the home position that it was sent",
            Phase::Items => "requests no item",
        };
        if self.tries == TRIES_MAX {
            return UploadStep::Failed(format!("the boat {unanswered}"));
        }
        self.tries += 1;
        self.due = now + SimTime::from_s(AGAIN_S);
        if self.phase == Phase::Home {
            messages.extend(self.home(target));
        } else {
            messages.push(self.count(target));
        }
        UploadStep::Sent
    }

    /// Handles the home reported by the boat.
    pub(super) fn take_home(&mut self, (lat_e7, lon_e7): (i32, i32), now: SimTime) {
        let is_near =
            lat_e7.abs_diff(self.home.0) <= SAME_E7 && lon_e7.abs_diff(self.home.1) <= SAME_E7;
        if self.phase == Phase::Home && is_near {
            // RTL goes to the home, so a boat that has not accepted our home must not get a mission
            // with that recovery point.
            (self.phase, self.tries, self.due) = (Phase::Items, 0, now);
        }
    }

    /// Handles the boat's request for an item.
    pub(super) fn take_request(&mut self, seq: u16, now: SimTime) -> Option<MavMessage> {
        let item = self
            .items
            .get(usize::from(seq))
            .filter(|_| self.phase == Phase::Items)?;
        // Each request shows that the upload is progressing, so restart the count of attempts.
        (self.tries, self.due) = (1, now + SimTime::from_s(AGAIN_S));
        Some(MavMessage::MISSION_ITEM_INT(item.clone()))
    }

    /// Handles the boat's acceptance or rejection of the mission.
    pub(super) fn take_ack(&mut self, result: MavMissionResult, now: SimTime) {
        // ArduPilot sends this for an item that arrives twice because the first copy was slow, and
        // continues.
        if self.phase == Phase::Items && result != MavMissionResult::MAV_MISSION_INVALID_SEQUENCE {
            let is_taken = result == MavMissionResult::MAV_MISSION_ACCEPTED;
            self.phase = if is_taken {
                Phase::Done
            } else {
                Phase::Refused(format!("the boat answers {result:?}"))
            };
            self.due = now;
        }
    }

    fn home(&self, target: Target) -> [MavMessage; 2] {
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
        [MavMessage::COMMAND_INT(set), MavMessage::COMMAND_LONG(show)]
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
