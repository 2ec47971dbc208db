//! The replies of an emulated ArduPilot boat to unsupported requests: each gets a reply.

#![expect(deprecated, reason = "ground stations send the older messages, too")]

use super::ArduPilot;
use super::mission::ack;
use crate::mavlink::Unreadable;
use crate::mavlink::dialect::{
    FILE_TRANSFER_PROTOCOL_DATA, LOG_DATA_DATA, LOG_ENTRY_DATA, MavMessage, MavMissionResult,
    MavSeverity, STATUSTEXT_DATA, TIMESYNC_DATA,
};
use ::mavlink::Message;
use primitives::SimTime;

/// Minimum time between reports that a message is not supported, s.
const COMPLAINT_S: f64 = 1.0;
/// Negative reply of the file transfer protocol, for an unknown command.
const NAK: u8 = 129;
const UNKNOWN_COMMAND: u8 = 7;
/// The offset of the target system, by number of the message, for messages with enumerations; the
/// target component follows it.
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
        let (target_system, target_component) = from;
        let reply = match message {
            MavMessage::TIMESYNC(sync) if sync.tc1 == 0 => MavMessage::TIMESYNC(TIMESYNC_DATA {
                tc1: (1e9 * now.as_s()) as i64,
                target_system,
                target_component,
                ..sync.clone()
            }),
            MavMessage::LOG_REQUEST_LIST(_) => MavMessage::LOG_ENTRY(LOG_ENTRY_DATA::default()),
            MavMessage::LOG_REQUEST_DATA(wanted) => MavMessage::LOG_DATA(LOG_DATA_DATA {
                id: wanted.id,
                ofs: wanted.ofs,
                ..LOG_DATA_DATA::default()
            }),
            MavMessage::FILE_TRANSFER_PROTOCOL(request) => {
                MavMessage::FILE_TRANSFER_PROTOCOL(FILE_TRANSFER_PROTOCOL_DATA {
                    target_system,
                    target_component,
                    payload: refused(&request.payload),
                    ..FILE_TRANSFER_PROTOCOL_DATA::default()
                })
            }
            MavMessage::SET_GPS_GLOBAL_ORIGIN(_) => self.origin_message(),
            // These request nothing, and Rover answers no PING.
            MavMessage::TIMESYNC(_) | MavMessage::PING(_) | MavMessage::LOG_REQUEST_END(_) => {
                return;
            }
            other if other.target_system_id().is_some_and(|target| target != 0) => {
                return self.complain(
                    now,
                    other.message_id(),
                    &format!("{} is not supported", other.message_name()),
                );
            }
            _ => return,
        };
        self.send(&reply);
    }

    /// Answers a message with a value unknown to the dialect.
    pub(super) fn answer_unreadable(&mut self, now: SimTime, message: &Unreadable) {
        let Some((_, at)) = TARGET_AT.iter().find(|(id, _)| *id == message.id) else {
            return;
        };
        let from = (message.system, message.component);
        let is_for = |byte: usize, own: u8| message.byte(byte) == 0 || message.byte(byte) == own;
        if !is_for(*at, self.system()) {
            return;
        }
        match message.id {
            75 | 76 => self.take_unknown_command(
                from,
                u16::from_le_bytes([message.byte(28), message.byte(29)]),
            ),
            39 | 73 => {
                let refusal = self
                    .mission
                    .refuse(from, MavMissionResult::MAV_MISSION_UNSUPPORTED);
                self.send(&refusal);
            }
            40 | 43 | 44 | 45 | 51 => {
                self.send(&ack(from, MavMissionResult::MAV_MISSION_UNSUPPORTED))
            }
            160 | 161 | 175 | 176 => self.complain(
                now,
                message.id,
                &format!("message {} is not supported", message.id),
            ),
            id => self.complain(now, id, &format!("message {id} has an unknown value")),
        }
    }

    /// Reports that a message is not supported: at once, but not as often as set-points arrive.
    pub(super) fn complain(&mut self, now: SimTime, id: u32, text: &str) {
        let said = self
            .complaints
            .get(&id)
            .copied()
            .unwrap_or(SimTime::LONG_AGO);
        if (now - said).as_s() >= COMPLAINT_S {
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

/// The negative reply to a file transfer request: sequence number, session, opcode, size, the
/// request's opcode, then data.
fn refused(request: &[u8; 251]) -> [u8; 251] {
    let mut reply = [0; 251];
    let next = u16::from_le_bytes([request[0], request[1]]).wrapping_add(1);
    reply[..2].copy_from_slice(&next.to_le_bytes());
    reply[2..6].copy_from_slice(&[request[2], NAK, 1, request[3]]);
    reply[12] = UNKNOWN_COMMAND;
    reply
}
