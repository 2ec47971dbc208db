//! Tests that an emulated ArduPilot boat answers as ArduRover 4.6.3 did in SITL, which provided the
//! expected values.

#![expect(deprecated, reason = "ground stations send the older messages, too")]

use crate::rig::e7;
use crate::station::Station;
use gateway::mavlink::RoverMode;
use gateway::mavlink::dialect::{
    MANUAL_CONTROL_DATA, MISSION_CLEAR_ALL_DATA, MISSION_COUNT_DATA, MISSION_ITEM_INT_DATA, MavCmd,
    MavMessage, MavMissionResult, MavMissionType, MavModeFlag, MavParamType,
    PARAM_REQUEST_READ_DATA, PARAM_SET_DATA, PARAM_VALUE_DATA, SET_MODE_DATA,
};
use messages::Order;
use primitives::frame::Ned;

const SET_MODE: u16 = MavCmd::MAV_CMD_DO_SET_MODE as u16;
const ARM: u16 = MavCmd::MAV_CMD_COMPONENT_ARM_DISARM as u16;
const SET_HOME: u16 = MavCmd::MAV_CMD_DO_SET_HOME as u16;

fn texts(station: &mut Station, command: u16, params: [f32; 2]) -> (Option<u8>, Vec<String>) {
    let result = station.command(true, command, params);
    let said = station.heard.iter().filter_map(|message| match message {
        MavMessage::STATUSTEXT(text) => Some(text.text.to_str().expect("it is text").to_owned()),
        _ => None,
    });
    (result, said.collect())
}

#[test]
fn commands_are_explained_in_the_words_of_rover() {
    let mut station = Station::new();
    for (command, params, result, words) in [
        (SET_MODE, [1.0, 99.0], 4, &["No such mode 99"][..]),
        (SET_MODE, [1.0, 6.0], 4, &["Flight mode change failed"]),
        (SET_MODE, [1.0, 16.0], 4, &["Flight mode change failed"]),
        (
            SET_MODE,
            [1.0, 10.0],
            4,
            &["No Mission. Can't set AUTO.", "Flight mode change failed"],
        ),
        (ARM, [1.0, 0.0], 0, &["Throttle armed"]),
        (ARM, [1.0, 0.0], 0, &[]),
        (ARM, [0.0, 0.0], 0, &["Throttle disarmed"]),
        (ARM, [0.0, 0.0], 0, &[]),
        (SET_MODE, [1.0, 11.0], 0, &[]),
        (ARM, [1.0, 0.0], 4, &["Arm: Mode not armable"]),
    ] {
        let (shown, said) = texts(&mut station, command, params);
        assert_eq!(
            (shown, said.as_slice()),
            (
                Some(result),
                &words.iter().map(ToString::to_string).collect::<Vec<_>>()[..]
            ),
            "{command} {params:?}"
        );
    }
    let at = e7(station.boat.at);
    let (_, said) = texts(&mut station, SET_HOME, [1.0, 0.0]);
    let (lat_deg, lon_deg) = (1e-7 * f64::from(at.0), 1e-7 * f64::from(at.1));
    assert_eq!(
        said,
        [format!("Set HOME to {lat_deg:.5} {lon_deg:.5} at 0.00m")]
    );
}

#[test]
fn a_new_mode_is_shown_at_once_and_set_mode_has_no_acknowledgement() {
    let mut station = Station::new();
    station.run(2.05);
    let set = SET_MODE_DATA {
        custom_mode: 15,
        target_system: 1,
        base_mode: MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED,
    };
    station.send(&MavMessage::SET_MODE(set));
    let heard = station.run(0.2);
    let is_shown = |message: &MavMessage| matches!(message, MavMessage::HEARTBEAT(beat) if beat.custom_mode == 15);
    assert!(heard.iter().any(is_shown), "{heard:?}");
    let is_ack = |message: &MavMessage| matches!(message, MavMessage::COMMAND_ACK(_));
    assert!(!heard.iter().any(is_ack), "{heard:?}");
}

#[test]
fn commands_to_a_component_that_the_boat_lacks_are_its_own_and_reposition_is_no_command_long() {
    let mut station = Station::new();
    station.component = 190;
    assert_eq!(station.command(true, ARM, [1.0, 0.0]), Some(0));
    assert_eq!(station.ardupilot.mode(), (RoverMode::Hold, true));
    let reposition = MavCmd::MAV_CMD_DO_REPOSITION as u16;
    let there = e7(station.boat.at);
    for (is_long, result) in [(true, 3), (false, 0)] {
        let params = [-1.0, 1.0, 0.0, 0.0];
        assert_eq!(
            station.command_at(is_long, reposition, params, there),
            Some(result)
        );
    }
    // The slowest speed is 0.05 m/s.
    let change_speed = MavCmd::MAV_CMD_DO_CHANGE_SPEED as u16;
    for (speed_m_s, result) in [(0.0, 4), (0.9, 0)] {
        assert_eq!(
            station.command(true, change_speed, [1.0, speed_m_s]),
            Some(result)
        );
    }
}

#[test]
fn the_home_follows_a_disarmed_boat_until_it_is_set() {
    let mut station = Station::new();
    let start = station.boat.at;
    let tow = |station: &mut Station| {
        station.boat.at = station.boat.at
            + Ned {
                north: 20.0,
                east: 0.0,
            };
        station.run(1.0);
        station.boat.at
    };
    let home = |station: &mut Station| {
        station.command(true, MavCmd::MAV_CMD_GET_HOME_POSITION as u16, [0.0; 2]);
        let home = station.heard.iter().find_map(|message| match message {
            MavMessage::HOME_POSITION(home) => Some((home.latitude, home.longitude)),
            _ => None,
        });
        home.expect("it has one")
    };
    let is_at = |home: (i32, i32), place: Ned| {
        let at = e7(place);
        home.0.abs_diff(at.0) < 60 && home.1.abs_diff(at.1) < 60
    };
    assert!(is_at(home(&mut station), start));
    let armed_at = tow(&mut station);
    assert!(is_at(home(&mut station), armed_at));
    station.command(true, ARM, [1.0, 0.0]);
    let disarmed_at = tow(&mut station);
    assert!(is_at(home(&mut station), armed_at), "armed");
    station.command(true, ARM, [0.0; 2]);
    assert!(is_at(home(&mut station), disarmed_at), "disarmed");
    station.command(true, SET_HOME, [1.0, 0.0]);
    tow(&mut station);
    assert!(is_at(home(&mut station), disarmed_at), "set");
}

#[test]
fn parameters_have_types_and_no_index_when_they_are_named() {
    let (target_system, target_component) = (1, 1);
    let int8 = MavParamType::MAV_PARAM_TYPE_INT8;
    let int16 = MavParamType::MAV_PARAM_TYPE_INT16;
    for (name, sent, shown, param_type) in [
        ("FS_ACTION", 2.7, 2.0, int8),
        ("FS_ACTION", 300.0, 127.0, int8),
        ("SYSID_MYGCS", 256.0, 256.0, int16),
        ("WP_SPEED", -3.0, -3.0, MavParamType::MAV_PARAM_TYPE_REAL32),
    ] {
        let set = MavMessage::PARAM_SET(PARAM_SET_DATA {
            param_value: sent,
            target_system,
            target_component,
            param_id: name.into(),
            ..Default::default()
        });
        let read = MavMessage::PARAM_REQUEST_READ(PARAM_REQUEST_READ_DATA {
            param_index: -1,
            target_system,
            target_component,
            param_id: name.to_lowercase().as_str().into(),
        });
        let mut station = Station::new();
        for request in [set, read] {
            let heard = station.reply(&request);
            let is_it = |message: &MavMessage| {
                matches!(message, MavMessage::PARAM_VALUE(PARAM_VALUE_DATA { param_value, param_type: kind, param_index: u16::MAX, .. })
                    if *param_value == shown && *kind == param_type)
            };
            assert!(heard.iter().any(is_it), "{name} {sent}: {heard:?}");
        }
    }
}

#[test]
fn the_throttle_of_manual_control_rests_at_zero() {
    let mut station = Station::new();
    let interval = MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL as u16;
    assert_eq!(station.command(true, interval, [36.0, 1e5]), Some(0));
    station.command(true, SET_MODE, [1.0, 0.0]);
    station.command(true, ARM, [1.0, 0.0]);
    for (x, y, z, thrusts) in [
        (500, 0, 0, (0.0, 0.0)),
        (500, 0, 500, (0.5, 0.5)),
        (0, 0, 750, (0.75, 0.75)),
        (0, 500, 0, (0.5, -0.5)),
    ] {
        let control = MANUAL_CONTROL_DATA {
            x,
            y,
            z,
            target: 1,
            ..Default::default()
        };
        let heard = station.reply(&MavMessage::MANUAL_CONTROL(control));
        let (port, starboard) = thrusts;
        assert_eq!(
            station.order,
            Order::Thrust { port, starboard },
            "{x} {y} {z}"
        );
        // Outputs 1 and 3, as with the firmware's default pulses of 1100 to 1900 µs.
        let outputs = heard.iter().rev().find_map(|message| match message {
            MavMessage::SERVO_OUTPUT_RAW(servo) => Some([servo.servo1_raw, servo.servo3_raw]),
            _ => None,
        });
        let pulse_us = |share: f64| (1500.0 + 400.0 * share) as u16;
        assert_eq!(
            outputs,
            Some([port, starboard].map(pulse_us)),
            "{x} {y} {z}"
        );
    }
}

#[test]
fn a_mission_with_a_missing_number_and_a_request_for_all_missions_are_refused() {
    let mut station = Station::new();
    let (target_system, target_component) = (1, 1);
    let ack = |heard: &[MavMessage]| {
        heard.iter().find_map(|message| match message {
            MavMessage::MISSION_ACK(ack) => Some((ack.mavtype, ack.mission_type)),
            _ => None,
        })
    };
    let mission_type = MavMissionType::MAV_MISSION_TYPE_ALL;
    let clear = MISSION_CLEAR_ALL_DATA {
        target_system,
        target_component,
        mission_type,
    };
    let heard = station.reply(&MavMessage::MISSION_CLEAR_ALL(clear));
    assert_eq!(
        ack(&heard),
        Some((MavMissionResult::MAV_MISSION_UNSUPPORTED, mission_type))
    );
    let count = MISSION_COUNT_DATA {
        count: 1,
        target_system,
        target_component,
        ..Default::default()
    };
    station.send(&MavMessage::MISSION_COUNT(count));
    let item = MISSION_ITEM_INT_DATA {
        param2: f32::NAN,
        command: MavCmd::MAV_CMD_NAV_WAYPOINT,
        target_system,
        target_component,
        ..Default::default()
    };
    let heard = station.reply(&MavMessage::MISSION_ITEM_INT(item));
    assert_eq!(
        ack(&heard).map(|(result, _)| result),
        Some(MavMissionResult::MAV_MISSION_INVALID_PARAM2)
    );
}
