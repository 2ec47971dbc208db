//! The mission of an emulated ArduPilot boat. The boat requests the items of an upload one by one,
//! and sends its items on request.

#![expect(
    deprecated,
    reason = "ground stations send the older messages, and ArduPilot answers them"
)]

use super::set_point::is_global;
use crate::mavlink::dialect::{
    MISSION_ACK_DATA, MISSION_COUNT_DATA, MISSION_CURRENT_DATA, MISSION_ITEM_DATA,
    MISSION_ITEM_INT_DATA, MISSION_REQUEST_DATA, MavCmd, MavFrame, MavMessage, MavMissionResult,
    MavMissionType,
};
use crate::mavlink::position::{LAT_MAX_E7, LON_MAX_E7};
use crate::mavlink::{e7, lat_lon};
use primitives::{LatLon, SimTime};

/// Maximum number of items accepted.
// About the capacity of a board that runs ArduPilot.
const ITEMS_MAX: u16 = 700;
/// Time after which a missing item is requested again, s.
const AGAIN_S: f64 = 1.0;
/// Time without an item after which an upload is abandoned, s.
const UPLOAD_AGE_MAX_S: f64 = 8.0;

/// The current mission, and the mission being uploaded.
#[derive(Clone, Debug, Default)]
pub(super) struct MissionStore {
    items: Vec<MISSION_ITEM_INT_DATA>,
    upload: Option<Upload>,
    is_new: bool,
}

#[derive(Clone, Debug)]
struct Upload {
    from: (u8, u8),
    count: u16,
    items: Vec<MISSION_ITEM_INT_DATA>,
    /// When the last item arrived, and when an item was last requested.
    came_at: SimTime,
    asked_at: SimTime,
}

impl Upload {
    fn request(&mut self, now: SimTime) -> MavMessage {
        self.asked_at = now;
        // ArduPilot requests items with this message, and dronekit supports no other.
        MavMessage::MISSION_REQUEST(MISSION_REQUEST_DATA {
            seq: self.items.len() as u16,
            target_system: self.from.0,
            target_component: self.from.1,
            ..Default::default()
        })
    }
}

fn is_waypoint(item: &MISSION_ITEM_INT_DATA) -> bool {
    item.command == MavCmd::MAV_CMD_NAV_WAYPOINT
}

impl MissionStore {
    /// The number of waypoints.
    pub(super) fn waypoints(&self) -> usize {
        // Item 0 is always the home in ArduPilot's missions.
        self.items
            .iter()
            .skip(1)
            .filter(|item| is_waypoint(item))
            .count()
    }

    /// The number of the waypoint, from 1, to which an item leads.
    pub(super) fn waypoint_of(&self, seq: u16) -> Option<u16> {
        let before = self.items.get(1..usize::from(seq.max(1)))?;
        (usize::from(seq) < self.items.len())
            .then(|| before.iter().filter(|item| is_waypoint(item)).count() as u16 + 1)
    }

    /// `MISSION_CURRENT` with the number of the item that leads to a waypoint.
    pub(super) fn current(&self, waypoint: u16) -> MavMessage {
        let waypoints = self
            .items
            .iter()
            .enumerate()
            .skip(1)
            .filter(|(_, item)| is_waypoint(item));
        let seq = waypoints
            .map(|(seq, _)| seq)
            .take(usize::from(waypoint.max(1)))
            .last()
            .unwrap_or(0) as u16;
        MavMessage::MISSION_CURRENT(MISSION_CURRENT_DATA {
            seq,
            total: self.items.len().saturating_sub(1) as u16,
            ..Default::default()
        })
    }

    /// The mission just accepted: its waypoints, and its speed, m/s, if specified.
    pub(super) fn take_new(&mut self) -> Option<(Vec<LatLon>, Option<f64>)> {
        std::mem::take(&mut self.is_new).then(|| {
            let items = self.items.iter().skip(1);
            let waypoints = items.clone().filter(|item| is_waypoint(item));
            let speeds = items.filter(|item| item.command == MavCmd::MAV_CMD_DO_CHANGE_SPEED);
            let speed = speeds
                .map(|item| f64::from(item.param2))
                .find(|speed_m_s| *speed_m_s > 0.0);
            (
                waypoints.map(|item| lat_lon((item.x, item.y))).collect(),
                speed,
            )
        })
    }

    /// Repeats the request of a stalled upload, and finally abandons the upload.
    pub(super) fn overdue(&mut self, now: SimTime) -> Option<MavMessage> {
        let upload = self.upload.as_mut()?;
        if (now - upload.came_at).as_s() > UPLOAD_AGE_MAX_S {
            let from = upload.from;
            self.upload = None;
            return Some(ack(from, MavMissionResult::MAV_MISSION_OPERATION_CANCELLED));
        }
        ((now - upload.asked_at).as_s() > AGAIN_S).then(|| upload.request(now))
    }

    /// Abandons this sender's upload; returns the reply, with the reason.
    pub(super) fn refuse(&mut self, from: (u8, u8), reason: MavMissionResult) -> MavMessage {
        self.end_upload(from);
        ack(from, reason)
    }

    fn end_upload(&mut self, from: (u8, u8)) {
        self.upload = self.upload.take().filter(|upload| upload.from != from);
    }

    /// Handles a message of the mission protocol from a system and component; returns the reply, if
    /// one is due. The outer `None` means that the message is not part of this protocol. `home` is
    /// item 0: latitude and longitude, 1e-7 degrees.
    pub(super) fn answer(
        &mut self,
        now: SimTime,
        from: (u8, u8),
        home: Option<(i32, i32)>,
        message: &MavMessage,
    ) -> Option<Option<MavMessage>> {
        if let Some(mission_type) =
            type_of(message).filter(|kind| *kind != MavMissionType::MAV_MISSION_TYPE_MISSION)
        {
            // The reply of a board without fences or rally points.
            return Some(Some(typed_ack(
                from,
                MavMissionResult::MAV_MISSION_UNSUPPORTED,
                mission_type,
            )));
        }
        let no_item = ack(from, MavMissionResult::MAV_MISSION_ERROR);
        Some(match message {
            MavMessage::MISSION_COUNT(MISSION_COUNT_DATA { count: 0, .. })
            | MavMessage::MISSION_CLEAR_ALL(_) => {
                (self.items, self.upload, self.is_new) = (vec![], None, true);
                Some(ack(from, MavMissionResult::MAV_MISSION_ACCEPTED))
            }
            MavMessage::MISSION_COUNT(count) => Some(self.begin(now, from, count.count)),
            MavMessage::MISSION_ITEM_INT(item) => Some(self.take_item(now, from, item)),
            MavMessage::MISSION_ITEM(item) => {
                Some(self.take_item(now, from, &int_from_float(item)))
            }
            MavMessage::MISSION_ACK(_) => {
                self.end_upload(from);
                None
            }
            MavMessage::MISSION_REQUEST_LIST(_) => {
                Some(MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
                    count: self.items.len() as u16,
                    target_system: from.0,
                    target_component: from.1,
                    ..MISSION_COUNT_DATA::default()
                }))
            }
            MavMessage::MISSION_REQUEST_INT(request) => Some(
                self.item(from, home, request.seq)
                    .map_or(no_item, MavMessage::MISSION_ITEM_INT),
            ),
            MavMessage::MISSION_REQUEST(request) => {
                Some(self.item(from, home, request.seq).map_or(no_item, |item| {
                    MavMessage::MISSION_ITEM(float_from_int(&item))
                }))
            }
            MavMessage::MISSION_REQUEST_PARTIAL_LIST(_)
            | MavMessage::MISSION_WRITE_PARTIAL_LIST(_) => {
                Some(ack(from, MavMissionResult::MAV_MISSION_UNSUPPORTED))
            }
            _ => return None,
        })
    }

    fn begin(&mut self, now: SimTime, from: (u8, u8), count: u16) -> MavMessage {
        if count > ITEMS_MAX {
            return ack(from, MavMissionResult::MAV_MISSION_NO_SPACE);
        }
        if self
            .upload
            .as_ref()
            .is_some_and(|upload| upload.from != from)
        {
            return ack(from, MavMissionResult::MAV_MISSION_DENIED);
        }
        self.upload
            .insert(Upload {
                from,
                count,
                items: vec![],
                came_at: now,
                asked_at: now,
            })
            .request(now)
    }

    fn take_item(
        &mut self,
        now: SimTime,
        from: (u8, u8),
        item: &MISSION_ITEM_INT_DATA,
    ) -> MavMessage {
        let Some(upload) = self.upload.as_mut().filter(|upload| upload.from == from) else {
            return ack(from, MavMissionResult::MAV_MISSION_ERROR);
        };
        // The upload continues; the request is repeated later.
        if usize::from(item.seq) != upload.items.len() {
            return ack(from, MavMissionResult::MAV_MISSION_INVALID_SEQUENCE);
        }
        if let Some(reason) = fault_of(item) {
            return self.refuse(from, reason);
        }
        upload.items.push(item.clone());
        upload.came_at = now;
        if upload.items.len() < usize::from(upload.count) {
            return upload.request(now);
        }
        self.items = std::mem::take(&mut upload.items);
        (self.upload, self.is_new) = (None, true);
        ack(from, MavMissionResult::MAV_MISSION_ACCEPTED)
    }

    /// The item with this number, if it exists. The home (item 0) always does.
    fn item(
        &self,
        from: (u8, u8),
        home: Option<(i32, i32)>,
        seq: u16,
    ) -> Option<MISSION_ITEM_INT_DATA> {
        let stored = self.items.get(usize::from(seq)).cloned();
        let item = if seq == 0 {
            let (x, y) = home.unwrap_or_else(|| stored.map_or((0, 0), |item| (item.x, item.y)));
            MISSION_ITEM_INT_DATA {
                x,
                y,
                command: MavCmd::MAV_CMD_NAV_WAYPOINT,
                frame: MavFrame::MAV_FRAME_GLOBAL,
                ..Default::default()
            }
        } else {
            stored?
        };
        Some(MISSION_ITEM_INT_DATA {
            target_system: from.0,
            target_component: from.1,
            ..item
        })
    }
}

/// Why the boat rejects an item, if it cannot execute it.
fn fault_of(item: &MISSION_ITEM_INT_DATA) -> Option<MavMissionResult> {
    match item.command {
        _ if item.param1.is_nan() => Some(MavMissionResult::MAV_MISSION_INVALID_PARAM1),
        _ if item.param2.is_nan() => Some(MavMissionResult::MAV_MISSION_INVALID_PARAM2),
        MavCmd::MAV_CMD_DO_CHANGE_SPEED => None,
        MavCmd::MAV_CMD_NAV_WAYPOINT if !is_global(item.frame) => {
            Some(MavMissionResult::MAV_MISSION_UNSUPPORTED_FRAME)
        }
        MavCmd::MAV_CMD_NAV_WAYPOINT if item.x.unsigned_abs() > LAT_MAX_E7 => {
            Some(MavMissionResult::MAV_MISSION_INVALID_PARAM5_X)
        }
        MavCmd::MAV_CMD_NAV_WAYPOINT if item.y.unsigned_abs() > LON_MAX_E7 => {
            Some(MavMissionResult::MAV_MISSION_INVALID_PARAM6_Y)
        }
        MavCmd::MAV_CMD_NAV_WAYPOINT => None,
        _ => Some(MavMissionResult::MAV_MISSION_UNSUPPORTED),
    }
}

/// The type of mission that a message is about: missions, fences or rally points. `None` for
/// acknowledgements, which need no reply, and for messages of other protocols.
fn type_of(message: &MavMessage) -> Option<MavMissionType> {
    Some(match message {
        MavMessage::MISSION_CLEAR_ALL(clear) => clear.mission_type,
        MavMessage::MISSION_COUNT(count) => count.mission_type,
        MavMessage::MISSION_ITEM(item) => item.mission_type,
        MavMessage::MISSION_ITEM_INT(item) => item.mission_type,
        MavMessage::MISSION_REQUEST_LIST(list) => list.mission_type,
        MavMessage::MISSION_REQUEST(request) => request.mission_type,
        MavMessage::MISSION_REQUEST_INT(request) => request.mission_type,
        MavMessage::MISSION_REQUEST_PARTIAL_LIST(list) => list.mission_type,
        MavMessage::MISSION_WRITE_PARTIAL_LIST(list) => list.mission_type,
        _ => return None,
    })
}

/// Converts an item of the older message, whose positions are in degrees.
pub(super) fn int_from_float(item: &MISSION_ITEM_DATA) -> MISSION_ITEM_INT_DATA {
    MISSION_ITEM_INT_DATA {
        param1: item.param1,
        param2: item.param2,
        param3: item.param3,
        param4: item.param4,
        x: e7(item.x.into()),
        y: e7(item.y.into()),
        z: item.z,
        seq: item.seq,
        command: item.command,
        frame: item.frame,
        current: item.current,
        autocontinue: item.autocontinue,
        mission_type: item.mission_type,
        ..Default::default()
    }
}

fn float_from_int(item: &MISSION_ITEM_INT_DATA) -> MISSION_ITEM_DATA {
    let at = lat_lon((item.x, item.y));
    MISSION_ITEM_DATA {
        param1: item.param1,
        param2: item.param2,
        param3: item.param3,
        param4: item.param4,
        x: at.lat_deg as f32,
        y: at.lon_deg as f32,
        z: item.z,
        seq: item.seq,
        command: item.command,
        target_system: item.target_system,
        target_component: item.target_component,
        frame: item.frame,
        current: item.current,
        autocontinue: item.autocontinue,
        mission_type: item.mission_type,
    }
}

/// The acknowledgement of an upload or of a single item, with its result.
pub(super) fn ack(from: (u8, u8), mavtype: MavMissionResult) -> MavMessage {
    typed_ack(from, mavtype, MavMissionType::MAV_MISSION_TYPE_MISSION)
}

fn typed_ack(
    from: (u8, u8),
    mavtype: MavMissionResult,
    mission_type: MavMissionType,
) -> MavMessage {
    MavMessage::MISSION_ACK(MISSION_ACK_DATA {
        target_system: from.0,
        target_component: from.1,
        mavtype,
        mission_type,
        ..Default::default()
    })
}
