//! The replies of an emulated ArduPilot boat to TIMESYNC and to messages that it does not support.

use super::ArduPilot;
use super::mission::ack;
use crate::mavlink::Unreadable;
use crate::mavlink::dialect::{
    MavMessage, MavMissionResult, MavResult, MavSeverity, STATUSTEXT_DATA, TIMESYNC_DATA,
};
use ::mavlink::Message;
use primitives::SimTime;

/// Minimum time between reports that a message is not supported, s.
const COMPLAINT_S: f64 = 1.0;
/// Message number, and offset of the target system, for messages that contain enumerations.
const TARGET_AT: [(u32, usize); 16] = [
    (23, 4),
    (39, 32),
    (40, 2),
    (43, 0),
    (44, 2),
    (45, 0),
    (51, 2),
    (73, 32),
    (75, 30),
    (76, 30),
    (84, 50),
    (86, 50),
    (160, 8),
    (161, 0),
    (175, 14),
    (176, 0),
];

impl ArduPilot {
    /// Answers a message that is not a command, parameter or mission message.
    pub(super) fn answer_other(&mut self, now: SimTime, from: (u8, u8), message: &MavMessage) {
        match message {
            MavMessage::TIMESYNC(sync) if sync.tc1 == 0 => {
                self.send(&MavMessage::TIMESYNC(TIMESYNC_DATA {
                    tc1: (1e9 * now.as_s()) as i64,
                    target_system: from.0,
                    target_component: from.1,
                    ..sync.clone()
                }));
            }
            // A reply to another system.
            MavMessage::TIMESYNC(_) => {}
            other if other.target_system_id().is_some_and(|target| target != 0) => {
                let text = format!("{} is not supported", other.message_name());
                self.complain(now, other.message_id(), &text);
            }
            _ => {}
        }
    }

    /// Answers a message with a value unknown to the dialect.
    pub(super) fn answer_unreadable(&mut self, now: SimTime, message: &Unreadable) {
        let Some((_, at)) = TARGET_AT.iter().find(|(id, _)| *id == message.id) else {
            return;
        };
        if ![0, self.system()].contains(&message.byte(*at)) {
            return;
        }
        let from = (message.system, message.component);
        match message.id {
            75 | 76 => {
                let command = u16::from_le_bytes([message.byte(28), message.byte(29)]);
                self.acknowledge(from, command, MavResult::MAV_RESULT_UNSUPPORTED);
            }
            39 | 73 => {
                let reason = MavMissionResult::MAV_MISSION_UNSUPPORTED;
                let refusal = self.mission.refuse(from, reason);
                self.send(&refusal);
            }
            40 | 43 | 44 | 45 | 51 => {
                self.send(&ack(from, MavMissionResult::MAV_MISSION_UNSUPPORTED));
            }
            160 | 161 | 175 | 176 => {
                let text = format!("message {} is not supported", message.id);
                self.complain(now, message.id, &text);
            }
            id => self.complain(now, id, &format!("message {id} has an unknown value")),
        }
    }

    /// Warns that a message is not supported, at most once per [`COMPLAINT_S`] and message number.
    pub(super) fn complain(&mut self, now: SimTime, id: u32, text: &str) {
        let said = self.complaints.get(&id);
        if said.is_none_or(|said| (now - *said).as_s() >= COMPLAINT_S) {
            self.complaints.insert(id, now);
            self.say(MavSeverity::MAV_SEVERITY_WARNING, text);
        }
    }

    /// Sends a string to operators, 50 characters at most.
    pub(super) fn say(&mut self, severity: MavSeverity, text: &str) {
        let status = STATUSTEXT_DATA {
            severity,
            text: text.into(),
            ..STATUSTEXT_DATA::default()
        };
        self.send(&MavMessage::STATUSTEXT(status));
    }

    /// Sends a message with the next telemetry.
    pub(super) fn send(&mut self, message: &MavMessage) {
        self.writer.write(message, &mut self.outbox);
    }
}
