//! Tests that an emulated ArduPilot boat answers every request of a ground station as Rover would.

#![expect(deprecated, reason = "ground stations send the older messages, too")]

use crate::rig::e7;
use crate::station::Station;
use gateway::mavlink::dialect::{
    COMMAND_LONG_DATA, FILE_TRANSFER_PROTOCOL_DATA, LOG_REQUEST_DATA_DATA, LOG_REQUEST_LIST_DATA,
    MISSION_CLEAR_ALL_DATA, MISSION_COUNT_DATA, MISSION_ITEM_INT_DATA, MISSION_REQUEST_INT_DATA,
    MISSION_REQUEST_LIST_DATA, MISSION_SET_CURRENT_DATA, MavCmd, MavFrame, MavMessage,
    MavMissionResult, MavMissionType, PARAM_REQUEST_READ_DATA, PARAM_SET_DATA, PARAM_VALUE_DATA,
    PLAY_TUNE_DATA, REQUEST_DATA_STREAM_DATA, SET_GPS_GLOBAL_ORIGIN_DATA, TIMESYNC_DATA,
};
use messages::Order;

const TYPES: [MavMissionType; 2] = [
    MavMissionType::MAV_MISSION_TYPE_FENCE,
    MavMissionType::MAV_MISSION_TYPE_RALLY,
];

#[test]
fn fences_and_rally_points_are_refused_and_leave_the_mission_as_it_is() {
    let mut station = Station::new();
    assert_eq!(
        station.upload(4, MavMissionType::MAV_MISSION_TYPE_MISSION),
        MavMissionResult::MAV_MISSION_ACCEPTED
    );
    for mission_type in TYPES {
        assert_eq!(
            station.upload(3, mission_type),
            MavMissionResult::MAV_MISSION_UNSUPPORTED
        );
        let clear = MISSION_CLEAR_ALL_DATA {
            target_system: 1,
            target_component: 1,
            mission_type,
        };
        let list = MISSION_REQUEST_LIST_DATA {
            target_system: 1,
            target_component: 1,
            mission_type,
        };
        for message in [
            MavMessage::MISSION_CLEAR_ALL(clear),
            MavMessage::MISSION_REQUEST_LIST(list),
        ] {
            let heard = station.reply(&message);
            let is_refused = |heard: &MavMessage| {
                matches!(heard, MavMessage::MISSION_ACK(ack)
                if (ack.mavtype, ack.mission_type) == (MavMissionResult::MAV_MISSION_UNSUPPORTED, mission_type))
            };
            assert!(heard.iter().any(is_refused), "{message:?}: {heard:?}");
        }
        assert_eq!(station.mission_count(), 4);
    }
}

#[test]
fn a_lost_mission_item_is_asked_for_again_and_the_upload_is_given_up_in_the_end() {
    let mut station = Station::new();
    let count = MISSION_COUNT_DATA {
        count: 2,
        target_system: 1,
        target_component: 1,
        ..Default::default()
    };
    let asked = |heard: &[MavMessage]| {
        heard
            .iter()
            .filter(|message| Station::requested(message) == Some(0))
            .count()
    };
    assert_eq!(asked(&station.reply(&MavMessage::MISSION_COUNT(count))), 1);
    let heard = station.run(6.0);
    assert!((4..=6).contains(&asked(&heard)), "once a second: {heard:?}");
    let is_given_up = |message: &MavMessage| matches!(message, MavMessage::MISSION_ACK(ack) if ack.mavtype == MavMissionResult::MAV_MISSION_OPERATION_CANCELLED);
    let heard = station.run(3.0);
    assert!(heard.iter().any(is_given_up), "{heard:?}");
    assert_eq!(asked(&station.run(3.0)), 0);
}

/// A request, and whether a message is the reply to it.
type Request = (MavMessage, fn(&MavMessage) -> bool);

fn requests() -> Vec<Request> {
    use MavMessage as M;
    let target_system = 1;
    let target_component = 1;
    let mission_type = MavMissionType::MAV_MISSION_TYPE_MISSION;
    let read = PARAM_REQUEST_READ_DATA {
        target_system,
        target_component,
        param_id: "ARMING_CHECK".into(),
        param_index: -1,
    };
    let set = PARAM_SET_DATA {
        target_system,
        target_component,
        param_id: "NO_SUCH".into(),
        ..Default::default()
    };
    let item = MISSION_REQUEST_INT_DATA {
        seq: 9,
        target_system,
        target_component,
        mission_type,
    };
    let current = MISSION_SET_CURRENT_DATA {
        seq: 9,
        target_system,
        target_component,
    };
    let list = LOG_REQUEST_LIST_DATA {
        target_system,
        target_component,
        ..Default::default()
    };
    let data = LOG_REQUEST_DATA_DATA {
        target_system,
        target_component,
        ..Default::default()
    };
    let ftp = FILE_TRANSFER_PROTOCOL_DATA {
        target_system,
        target_component,
        ..Default::default()
    };
    let origin = SET_GPS_GLOBAL_ORIGIN_DATA {
        target_system,
        ..Default::default()
    };
    let tune = PLAY_TUNE_DATA {
        target_system,
        target_component,
        ..Default::default()
    };
    let no_parameter =
        |reply: &M| matches!(reply, M::PARAM_ERROR(error) if error.param_id.to_str() != Ok(""));
    let is_unsupported = |reply: &M| matches!(reply, M::STATUSTEXT(text) if text.text.to_str().is_ok_and(|text| text.ends_with(" is not supported")));
    vec![
        (
            M::TIMESYNC(TIMESYNC_DATA {
                ts1: 7,
                ..Default::default()
            }),
            |reply| matches!(reply, M::TIMESYNC(sync) if sync.ts1 == 7 && sync.tc1 > 0),
        ),
        (M::PARAM_REQUEST_READ(read), no_parameter),
        (M::PARAM_SET(set), no_parameter),
        (
            M::MISSION_REQUEST_INT(item),
            |reply| matches!(reply, M::MISSION_ACK(ack) if ack.mavtype != MavMissionResult::MAV_MISSION_ACCEPTED),
        ),
        (M::MISSION_SET_CURRENT(current), |reply| {
            matches!(reply, M::MISSION_CURRENT(_))
        }),
        (M::LOG_REQUEST_LIST(list), is_unsupported),
        (M::LOG_REQUEST_DATA(data), is_unsupported),
        (M::FILE_TRANSFER_PROTOCOL(ftp), is_unsupported),
        (M::SET_GPS_GLOBAL_ORIGIN(origin), is_unsupported),
        (M::PLAY_TUNE(tune), is_unsupported),
    ]
}

#[test]
fn every_request_of_a_ground_station_gets_its_reply() {
    for (message, is_reply) in requests() {
        let mut station = Station::new();
        let heard = station.reply(&message);
        assert!(heard.iter().any(is_reply), "{message:?}: {heard:?}");
    }
}

#[test]
fn the_old_requests_for_fences_and_rally_points_get_a_reply() {
    // FENCE_POINT, FENCE_FETCH_POINT, RALLY_POINT, RALLY_FETCH_POINT: number, CRC_EXTRA, length and
    // offset of the target system, as in pymavlink's ardupilotmega.
    for (id, extra_crc, len, target_at) in [
        (160, 78, 12, 8),
        (161, 68, 3, 0),
        (175, 138, 19, 14),
        (176, 234, 3, 0),
    ] {
        let said = |target: u8| {
            let mut payload = vec![0; len];
            payload[target_at] = target;
            let heard = Station::new().reply_to_bytes(id, extra_crc, &payload);
            let want = format!("message {id} is not supported");
            heard.iter().any(|message| {
                matches!(message, MavMessage::STATUSTEXT(text) if text.text.to_str() == Ok(&want))
            })
        };
        assert!(said(1), "{id}");
        assert!(!said(9), "{id} for another system");
    }
}

/// A command with its first parameters, and its result in HOLD, disarmed.
const RESULTS: [(u16, [f32; 2], u8); 18] = [
    (60_000, [0.0; 2], 3),
    // DO_START_MAG_CAL and DO_SEND_BANNER, of ArduPilot's own dialect.
    (42_424, [0.0; 2], 3),
    (42_428, [0.0; 2], 3),
    (MavCmd::MAV_CMD_NAV_TAKEOFF as u16, [0.0; 2], 3),
    (
        MavCmd::MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES as u16,
        [1.0, 0.0],
        0,
    ),
    (MavCmd::MAV_CMD_GET_HOME_POSITION as u16, [0.0; 2], 0),
    (MavCmd::MAV_CMD_GET_MESSAGE_INTERVAL as u16, [33.0, 0.0], 3),
    (
        MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL as u16,
        [60_000.0, 1e6],
        2,
    ),
    // An interval below -1, a mode without the custom-mode flag, and an arming value other than 0
    // or 1.
    (MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL as u16, [33.0, -2.0], 2),
    (MavCmd::MAV_CMD_DO_SET_MODE as u16, [8.0, 15.0], 2),
    (MavCmd::MAV_CMD_COMPONENT_ARM_DISARM as u16, [0.5, 0.0], 3),
    (MavCmd::MAV_CMD_RUN_PREARM_CHECKS as u16, [0.0; 2], 0),
    (MavCmd::MAV_CMD_DO_CHANGE_SPEED as u16, [1.0, 1.0], 4),
    (MavCmd::MAV_CMD_MISSION_START as u16, [0.0; 2], 4),
    (MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT as u16, [9.0, 0.0], 2),
    (
        MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT as u16,
        [-1.0, 0.0],
        2,
    ),
    // A command that is not in Rover's default build, and a rate that its loop cannot reach.
    (MavCmd::MAV_CMD_NAV_SET_YAW_SPEED as u16, [90.0, 1.0], 3),
    (MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL as u16, [33.0, 1e4], 2),
];

#[test]
fn every_command_is_acknowledged_even_if_the_dialect_lacks_it() {
    for (command, params, result) in RESULTS {
        for is_long in [true, false] {
            let mut station = Station::new();
            assert_eq!(
                station.command(is_long, command, params),
                Some(result),
                "{command} {is_long}"
            );
        }
    }
    let mut station = Station::new();
    let command = MavCmd::MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES;
    let ask = COMMAND_LONG_DATA {
        command,
        param1: 1.0,
        target_system: 1,
        ..Default::default()
    };
    let heard = station.reply(&MavMessage::COMMAND_LONG(ask));
    assert!(
        heard
            .iter()
            .any(|message| matches!(message, MavMessage::AUTOPILOT_VERSION(_))),
        "{heard:?}"
    );
}

#[test]
fn a_mission_item_that_the_boat_would_not_carry_out_is_refused() {
    for (command, frame, x, result) in [
        (
            MavCmd::MAV_CMD_NAV_LOITER_TURNS,
            MavFrame::MAV_FRAME_GLOBAL,
            0,
            MavMissionResult::MAV_MISSION_UNSUPPORTED,
        ),
        (
            MavCmd::MAV_CMD_NAV_WAYPOINT,
            MavFrame::MAV_FRAME_LOCAL_NED,
            0,
            MavMissionResult::MAV_MISSION_UNSUPPORTED_FRAME,
        ),
        (
            MavCmd::MAV_CMD_NAV_WAYPOINT,
            MavFrame::MAV_FRAME_GLOBAL,
            1_000_000_000,
            MavMissionResult::MAV_MISSION_INVALID_PARAM5_X,
        ),
    ] {
        let mut station = Station::new();
        let count = MISSION_COUNT_DATA {
            count: 1,
            target_system: 1,
            target_component: 1,
            ..Default::default()
        };
        station.reply(&MavMessage::MISSION_COUNT(count));
        let item = MISSION_ITEM_INT_DATA {
            command,
            frame,
            x,
            target_system: 1,
            target_component: 1,
            ..Default::default()
        };
        let heard = station.reply(&MavMessage::MISSION_ITEM_INT(item));
        assert!(
            heard.iter().any(
                |reply| matches!(reply, MavMessage::MISSION_ACK(ack) if ack.mavtype == result)
            ),
            "{heard:?}"
        );
    }
}

#[test]
fn a_mission_begins_at_the_item_that_was_set_and_continues_after_an_interruption() {
    let mut station = Station::new();
    station.upload(4, MavMissionType::MAV_MISSION_TYPE_MISSION);
    station.command(true, MavCmd::MAV_CMD_DO_SET_HOME as u16, [1.0, 0.0]);
    assert_eq!(
        station.command(
            true,
            MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT as u16,
            [2.0, 0.0]
        ),
        Some(0)
    );
    for mode in [10.0, 5.0, 10.0] {
        assert_eq!(
            station.command(true, MavCmd::MAV_CMD_DO_SET_MODE as u16, [1.0, mode]),
            Some(0)
        );
        let heard = station.run(2.0);
        let current = |message: &MavMessage| {
            if let MavMessage::MISSION_CURRENT(current) = message {
                Some((current.seq, current.total))
            } else {
                None
            }
        };
        assert_eq!(heard.iter().find_map(current), Some((2, 3)), "mode {mode}");
    }
}

#[test]
fn a_disarmed_boat_begins_its_mission_anew_unless_it_is_in_auto() {
    let (set_mode, arm) = (
        MavCmd::MAV_CMD_DO_SET_MODE as u16,
        MavCmd::MAV_CMD_COMPONENT_ARM_DISARM as u16,
    );
    for (mode, seq) in [(10.0, 2), (5.0, 1)] {
        let mut station = Station::new();
        station.upload(4, MavMissionType::MAV_MISSION_TYPE_MISSION);
        let current = MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT as u16;
        station.command(true, current, [2.0, 0.0]);
        for (command, params) in [(set_mode, [1.0, mode]), (arm, [1.0, 0.0]), (arm, [0.0; 2])] {
            assert_eq!(station.command(true, command, params), Some(0));
        }
        let shown = station.run(2.0);
        let is_it = |message: &MavMessage| matches!(message, MavMessage::MISSION_CURRENT(current) if current.seq == seq);
        assert!(shown.iter().any(is_it), "{mode}: {shown:?}");
    }
}

#[test]
fn a_home_without_a_position_is_where_the_boat_is() {
    let mut station = Station::new();
    let set_home = MavCmd::MAV_CMD_DO_SET_HOME as u16;
    assert_eq!(station.command(true, set_home, [2.0, 0.0]), Some(0));
    let at = e7(station.boat.at);
    let elsewhere = (at.0 + 500, at.1);
    assert_eq!(
        station.command_at(false, set_home, [2.0, 0.0, 0.0, 0.0], elsewhere),
        Some(4)
    );
    let command = MavCmd::MAV_CMD_GET_HOME_POSITION;
    let ask = COMMAND_LONG_DATA {
        command,
        target_system: 1,
        ..Default::default()
    };
    let heard = station.reply(&MavMessage::COMMAND_LONG(ask));
    let is_here = |message: &MavMessage| {
        matches!(message, MavMessage::HOME_POSITION(home)
        if home.latitude.abs_diff(at.0) < 20 && home.longitude.abs_diff(at.1) < 20)
    };
    assert!(heard.iter().any(is_here), "{heard:?}");
}

#[test]
fn a_new_system_number_takes_effect_after_the_reply_to_it() {
    let mut station = Station::new();
    let set = PARAM_SET_DATA {
        param_value: 9.0,
        target_system: 1,
        target_component: 1,
        param_id: "SYSID_THISMAV".into(),
        ..Default::default()
    };
    let heard = station.reply(&MavMessage::PARAM_SET(set));
    let is_set = |message: &MavMessage| {
        matches!(
            message,
            MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
                param_value: 9.0,
                ..
            })
        )
    };
    assert!(heard.iter().any(is_set), "{heard:?}");
    station.run(1.0);
    station.systems.clear();
    station.run(2.0);
    assert!(
        !station.systems.is_empty() && station.systems.iter().all(|system| *system == 9),
        "{:?}",
        station.systems
    );
    // Commands to the old system number are for a different boat.
    assert_eq!(
        station.command(true, MavCmd::MAV_CMD_RUN_PREARM_CHECKS as u16, [0.0; 2]),
        None
    );
    station.target = 9;
    assert_eq!(
        station.command(true, MavCmd::MAV_CMD_RUN_PREARM_CHECKS as u16, [0.0; 2]),
        Some(0)
    );
}

#[test]
fn a_stream_request_speeds_telemetry_up_and_never_slows_it_down() {
    let mut station = Station::new();
    let mut count = |start_stop, req_message_rate| {
        station.send(&MavMessage::REQUEST_DATA_STREAM(REQUEST_DATA_STREAM_DATA {
            req_message_rate,
            target_system: 1,
            start_stop,
            ..Default::default()
        }));
        let heard = station.run(10.0);
        let is_attitude = |message: &&MavMessage| matches!(message, MavMessage::ATTITUDE(_));
        heard.iter().filter(is_attitude).count()
    };
    let counts = [(1, 5), (1, 2), (0, 0)].map(|(start, rate_hz)| count(start, rate_hz));
    assert!(
        counts.iter().all(|count| (48..=52).contains(count)),
        "{counts:?}"
    );
}

#[test]
fn the_state_of_the_estimator_is_sent() {
    let mut station = Station::new();
    station.run(3.0);
    // EKF_STATUS_REPORT, of ArduPilot's own dialect.
    assert!(station.unknown(193) >= 2, "{}", station.unknown(193));
    assert!(matches!(station.order, Order::Hold));
}

#[test]
fn the_boat_shows_no_battery_fault_and_no_sensor_that_it_lacks() {
    let heard = Station::new().run(2.0);
    let faults = heard.iter().filter_map(|message| match message {
        MavMessage::BATTERY_STATUS(battery) => Some(battery.fault_bitmask.bits()),
        MavMessage::SYS_STATUS(status) => {
            Some(status.onboard_control_sensors_present_extended.bits())
        }
        _ => None,
    });
    let faults: Vec<u32> = faults.collect();
    assert!(
        faults.len() >= 2 && faults.iter().all(|bits| *bits == 0),
        "{faults:?}"
    );
}
