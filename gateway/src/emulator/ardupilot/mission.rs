//! The mission of an emulated ArduPilot boat: it asks for item after item, and shows them to whoever asks.

use crate::mavlink::dialect::{
    MISSION_ACK_DATA, MISSION_COUNT_DATA, MISSION_ITEM_INT_DATA, MISSION_REQUEST_INT_DATA, MavCmd, MavMessage,
    MavMissionResult,
};
use primitives::LatLon;

/// The most items that it takes.
const ITEMS_MAX: u16 = 700;

/// The mission that it has, and the one that is being uploaded.
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
}

impl MissionStore {
    /// How many waypoints the mission has; the first item is the home.
    pub(super) fn waypoints(&self) -> usize {
        // Item 0 is the home in ArduPilot's missions, whoever uploads them.
        self.items.iter().skip(1).filter(|item| item.command == MavCmd::MAV_CMD_NAV_WAYPOINT).count()
    }

    /// A mission that was just taken: its waypoints, and the speed that it names, m/s.
    pub(super) fn take_new(&mut self) -> Option<(Vec<LatLon>, Option<f64>)> {
        std::mem::take(&mut self.is_new).then(|| {
            let items = self.items.iter().skip(1);
            let waypoints = items.clone().filter(|item| item.command == MavCmd::MAV_CMD_NAV_WAYPOINT);
            let speeds = items.filter(|item| item.command == MavCmd::MAV_CMD_DO_CHANGE_SPEED);
            let place = |item: &MISSION_ITEM_INT_DATA| LatLon {
                lat_deg: 1e-7 * f64::from(item.x),
                lon_deg: 1e-7 * f64::from(item.y),
            };
            let speed = speeds.map(|item| f64::from(item.param2)).find(|speed_m_s| *speed_m_s > 0.0);
            (waypoints.map(place).collect(), speed)
        })
    }

    /// Takes a message of the mission protocol from a system and component; the answer to it.
    #[expect(
        deprecated,
        reason = "a ground station may ask by MISSION_REQUEST, and is answered as the specification says"
    )]
    pub(super) fn answer(&mut self, from: (u8, u8), message: &MavMessage) -> Option<MavMessage> {
        match message {
            // About what a board that runs ArduPilot has room for.
            MavMessage::MISSION_COUNT(count) if count.count > ITEMS_MAX => {
                Some(ack(from, MavMissionResult::MAV_MISSION_NO_SPACE))
            }
            MavMessage::MISSION_COUNT(MISSION_COUNT_DATA { count: 0, .. }) | MavMessage::MISSION_CLEAR_ALL(_) => {
                (self.items, self.upload, self.is_new) = (vec![], None, true);
                Some(ack(from, MavMissionResult::MAV_MISSION_ACCEPTED))
            }
            MavMessage::MISSION_COUNT(count) => {
                self.upload = Some(Upload { from, count: count.count, items: vec![] });
                Some(request(from, 0))
            }
            MavMessage::MISSION_ITEM_INT(item) => self.take_item(from, item),
            MavMessage::MISSION_ACK(_) => {
                self.upload = self.upload.take().filter(|upload| upload.from != from);
                None
            }
            MavMessage::MISSION_REQUEST_LIST(_) => Some(MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
                count: self.items.len() as u16,
                target_system: from.0,
                target_component: from.1,
                ..MISSION_COUNT_DATA::default()
            })),
            MavMessage::MISSION_REQUEST_INT(request) => self.item(from, request.seq),
            MavMessage::MISSION_REQUEST(request) => self.item(from, request.seq),
            _ => None,
        }
    }

    fn take_item(&mut self, from: (u8, u8), item: &MISSION_ITEM_INT_DATA) -> Option<MavMessage> {
        let upload = self.upload.as_mut().filter(|upload| upload.from == from)?;
        let next = upload.items.len() as u16;
        // Another number than the one asked for is answered by asking again, as the protocol
        // says: that is how it survives lost packets.
        if item.seq == next {
            upload.items.push(item.clone());
        }
        let next = upload.items.len() as u16;
        if next < upload.count {
            return Some(request(from, next));
        }
        self.items = std::mem::take(&mut upload.items);
        (self.upload, self.is_new) = (None, true);
        Some(ack(from, MavMissionResult::MAV_MISSION_ACCEPTED))
    }

    fn item(&self, (target_system, target_component): (u8, u8), seq: u16) -> Option<MavMessage> {
        let item = self.items.get(usize::from(seq))?.clone();
        Some(MavMessage::MISSION_ITEM_INT(MISSION_ITEM_INT_DATA { target_system, target_component, ..item }))
    }
}

fn request((target_system, target_component): (u8, u8), seq: u16) -> MavMessage {
    let default = MISSION_REQUEST_INT_DATA::default();
    MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA { seq, target_system, target_component, ..default })
}

fn ack((target_system, target_component): (u8, u8), mavtype: MavMissionResult) -> MavMessage {
    let ack = MISSION_ACK_DATA { target_system, target_component, mavtype, ..MISSION_ACK_DATA::default() };
    MavMessage::MISSION_ACK(ack)
}
