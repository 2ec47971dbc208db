//! A ground station connected in memory to an emulated ArduPilot boat. The test controls time.

use crate::boat::{Boat, STEP_S};
use crate::rig::datum;
use gateway::emulator::{ArduPilot, FrontSeat};
use gateway::mavlink::dialect::{
    COMMAND_ACK_DATA, MISSION_COUNT_DATA, MISSION_ITEM_INT_DATA, MISSION_REQUEST_LIST_DATA, MavCmd,
    MavFrame, MavMessage, MavMissionResult, MavMissionType,
};
use gateway::mavlink::{Frame, Framer, Writer};
use mavlink::MessageData;
use messages::Order;
use primitives::SimTime;
use primitives::frame::Ned;

const TELEMETRY_STEPS: u64 = 10;

pub(crate) struct Station {
    now: SimTime,
    steps: u64,
    pub(crate) boat: Boat,
    pub(crate) ardupilot: ArduPilot,
    pub(crate) order: Order,
    writer: Writer,
    framer: Framer,
    /// The system to which messages are addressed.
    pub(crate) target: u8,
    /// The component to which commands are addressed.
    pub(crate) component: u8,
    /// The systems that sent messages.
    pub(crate) systems: Vec<u8>,
    /// Acknowledgements of commands: number and result.
    acks: Vec<(u16, u8)>,
    /// Messages received after the last command.
    pub(crate) heard: Vec<MavMessage>,
}

impl Station {
    /// A boat in HOLD, disarmed, at 60, 40.
    pub(crate) fn new() -> Station {
        let mut station = Station {
            now: SimTime::ZERO,
            steps: 0,
            boat: Boat {
                at: Ned::from_xy(60.0, 40.0),
                ..Boat::default()
            },
            ardupilot: ArduPilot::new(datum(), None),
            order: Order::Hold,
            writer: Writer::new(255, 190),
            framer: Framer::new(),
            target: 1,
            component: 1,
            systems: vec![],
            acks: vec![],
            heard: vec![],
        };
        station
            .ardupilot
            .set_clock(SimTime::ZERO, 1_795_000_000_000_000_000);
        station.run(0.5);
        station
    }

    pub(crate) fn send(&mut self, message: &MavMessage) {
        let mut bytes = vec![];
        self.writer.write(message, &mut bytes);
        self.ardupilot.receive(self.now, &bytes);
    }

    /// Sends a message; returns the messages that arrive within 0.9 s.
    pub(crate) fn reply(&mut self, message: &MavMessage) -> Vec<MavMessage> {
        self.send(message);
        self.run(0.9)
    }

    /// Runs for this time; returns the messages that the boat sent.
    pub(crate) fn run(&mut self, seconds: f64) -> Vec<MavMessage> {
        let mut heard = vec![];
        for _ in 0..(seconds / STEP_S).round() as u64 {
            self.steps += 1;
            self.now = SimTime::from_s(STEP_S * self.steps as f64);
            self.order = self.ardupilot.order(self.now);
            self.boat.step(self.order);
            if self.steps.is_multiple_of(TELEMETRY_STEPS) {
                self.ardupilot
                    .observe(self.now, &self.boat.measured(self.now, self.boat.at));
                let mut bytes = vec![];
                self.ardupilot.telemetry(self.now, &mut bytes);
                self.hear(&bytes, &mut heard);
            }
        }
        heard
    }

    fn hear(&mut self, bytes: &[u8], heard: &mut Vec<MavMessage>) {
        let systems = &mut self.systems;
        let acks = &mut self.acks;
        self.framer.push_frames(bytes, &mut |frame| match frame {
            Frame::Read(received) => {
                systems.push(received.system);
                if let MavMessage::COMMAND_ACK(ack) = &received.message {
                    acks.push((ack.command as u16, ack.result as u8));
                }
                heard.push(received.message);
            }
            // The result of a command that the dialect does not know.
            Frame::Unreadable(unreadable) if unreadable.id == COMMAND_ACK_DATA::ID => {
                acks.push((
                    u16::from_le_bytes([unreadable.byte(0), unreadable.byte(1)]),
                    unreadable.byte(2),
                ));
            }
            Frame::Unreadable(unreadable) => panic!("{unreadable:?}"),
        });
    }

    /// The number of messages received with a number that the dialect does not know.
    pub(crate) fn unknown(&self, id: u32) -> u64 {
        self.framer.counts().unknown.get(&id).copied().unwrap_or(0)
    }

    /// The result of a command sent as COMMAND_LONG or COMMAND_INT.
    pub(crate) fn command(&mut self, is_long: bool, command: u16, params: [f32; 2]) -> Option<u8> {
        self.command_at(is_long, command, [params[0], params[1], 0.0, 0.0], (0, 0))
    }

    /// Like [`Station::command`], with a position, 1e-7 degrees.
    pub(crate) fn command_at(
        &mut self,
        is_long: bool,
        command: u16,
        params: [f32; 4],
        at: (i32, i32),
    ) -> Option<u8> {
        let mut payload: Vec<u8> = params
            .iter()
            .flat_map(|param| param.to_le_bytes())
            .collect();
        if is_long {
            payload.extend(
                [1e-7 * f64::from(at.0), 1e-7 * f64::from(at.1)]
                    .iter()
                    .flat_map(|deg| (*deg as f32).to_le_bytes()),
            );
        } else {
            payload.extend([at.0, at.1].iter().flat_map(|e7| e7.to_le_bytes()));
        }
        payload.extend([0; 4]);
        payload.extend(command.to_le_bytes());
        payload.extend([self.target, self.component, 0, 0, 0]);
        let (id, extra_crc) = if is_long { (76, 152) } else { (75, 158) };
        self.acks.clear();
        self.heard = self.reply_to_bytes(id, extra_crc, &payload);
        self.acks
            .iter()
            .find(|(known, _)| *known == command)
            .map(|(_, result)| *result)
    }

    /// The messages received within 0.9 s after sending a message outside the dialect.
    pub(crate) fn reply_to_bytes(
        &mut self,
        id: u32,
        extra_crc: u8,
        payload: &[u8],
    ) -> Vec<MavMessage> {
        let mut bytes = vec![];
        self.writer.write_raw(id, extra_crc, payload, &mut bytes);
        self.ardupilot.receive(self.now, &bytes);
        self.run(0.9)
    }

    /// The item that a boat requests.
    #[expect(deprecated, reason = "ArduPilot requests items by MISSION_REQUEST")]
    pub(crate) fn requested(message: &MavMessage) -> Option<u16> {
        match message {
            MavMessage::MISSION_REQUEST(request) => Some(request.seq),
            MavMessage::MISSION_REQUEST_INT(request) => Some(request.seq),
            _ => None,
        }
    }

    /// Uploads waypoints; returns the result.
    pub(crate) fn upload(&mut self, count: u16, mission_type: MavMissionType) -> MavMissionResult {
        let target_system = 1;
        let target_component = 1;
        let count = MISSION_COUNT_DATA {
            count,
            target_system,
            target_component,
            mission_type,
            ..Default::default()
        };
        let mut heard = self.reply(&MavMessage::MISSION_COUNT(count));
        loop {
            let ack = heard.iter().find_map(|message| match message {
                MavMessage::MISSION_ACK(ack) if ack.mission_type == mission_type => {
                    Some(ack.mavtype)
                }
                _ => None,
            });
            if let Some(result) = ack {
                return result;
            }
            let seq = heard
                .iter()
                .find_map(Station::requested)
                .expect("it asks for an item");
            let at = datum();
            let item = MISSION_ITEM_INT_DATA {
                seq,
                x: (1e7 * at.lat_deg) as i32 + 1000 * i32::from(seq),
                y: (1e7 * at.lon_deg) as i32,
                command: MavCmd::MAV_CMD_NAV_WAYPOINT,
                frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
                target_system,
                target_component,
                mission_type,
                ..Default::default()
            };
            heard = self.reply(&MavMessage::MISSION_ITEM_INT(item));
        }
    }

    /// The number of items in the boat's mission.
    pub(crate) fn mission_count(&mut self) -> u16 {
        let list = MISSION_REQUEST_LIST_DATA {
            target_system: 1,
            target_component: 1,
            ..Default::default()
        };
        let heard = self.reply(&MavMessage::MISSION_REQUEST_LIST(list));
        let count = |message: &MavMessage| match message {
            MavMessage::MISSION_COUNT(count) => Some(count.count),
            _ => None,
        };
        heard.iter().find_map(count).expect("a count")
    }
}
