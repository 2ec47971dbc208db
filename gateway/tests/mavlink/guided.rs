//! Tests an emulated ArduPilot boat in GUIDED: like Rover, it either follows the set-points of
//! ground stations or reports that it ignores them.

#![expect(
    deprecated,
    reason = "ground stations send the older messages and frames, and Rover accepts them"
)]

use crate::rig::e7;
use crate::station::Station;
use gateway::mavlink::RoverMode;
use gateway::mavlink::dialect::{
    HEARTBEAT_DATA, MISSION_ITEM_DATA, MISSION_ITEM_INT_DATA, MavCmd, MavFrame, MavMessage,
    MavState, PARAM_SET_DATA, PositionTargetTypemask, RC_CHANNELS_OVERRIDE_DATA,
    SET_POSITION_TARGET_GLOBAL_INT_DATA, SET_POSITION_TARGET_LOCAL_NED_DATA,
};
use messages::Order;
use primitives::angle::wrap_pi;
use primitives::frame::Ned;
use std::f64::consts::FRAC_PI_2;

/// The part of a set-point that ground stations fill in: a position, velocity, heading or rate of
/// turn.
const POSITION: u16 = 0b1101_1111_1000;
const VELOCITY: u16 = 0b1101_1100_0111;
const HEADING: u16 = 0b1001_1111_1111;
const TURN: u16 = 0b0101_1111_1111;

/// The start of the boat, and a place 20 m north and 10 m east of it.
fn start() -> Ned {
    Ned::from_xy(60.0, 40.0)
}

fn goal() -> Ned {
    start()
        + Ned {
            north: 20.0,
            east: 10.0,
        }
}

/// A boat in GUIDED, armed and pointing east.
fn guided() -> Station {
    let mut station = Station::new();
    station.boat.psi_rad = FRAC_PI_2;
    assert_eq!(
        station.command(true, MavCmd::MAV_CMD_DO_SET_MODE as u16, [1.0, 15.0]),
        Some(0)
    );
    assert_eq!(
        station.command(
            true,
            MavCmd::MAV_CMD_COMPONENT_ARM_DISARM as u16,
            [1.0, 0.0]
        ),
        Some(0)
    );
    assert_eq!(station.ardupilot.mode(), (RoverMode::Guided, true));
    station
}

fn local(
    frame: MavFrame,
    mask: u16,
    [x, y]: [f32; 2],
    yaw: f32,
) -> SET_POSITION_TARGET_LOCAL_NED_DATA {
    let type_mask = PositionTargetTypemask::from_bits_retain(mask);
    SET_POSITION_TARGET_LOCAL_NED_DATA {
        x: 10.0 * x,
        y: 10.0 * y,
        vx: x,
        vy: y,
        yaw,
        yaw_rate: yaw,
        type_mask,
        target_system: 1,
        coordinate_frame: frame,
        ..Default::default()
    }
}

/// The boat after a set-point that arrives twice a second.
fn after(mut station: Station, message: &MavMessage, seconds: u32) -> Station {
    for _ in 0..2 * seconds {
        station.send(message);
        station.run(0.5);
    }
    station
}

#[test]
fn positions_in_every_frame_that_rover_takes_are_reached_and_kept() {
    let mut messages: Vec<MavMessage> = [
        (MavFrame::MAV_FRAME_LOCAL_NED, [2.0, 1.0]),
        (MavFrame::MAV_FRAME_LOCAL_OFFSET_NED, [2.0, 1.0]),
        // Relative to a boat that points east: 10 m ahead, and 20 m to port.
        (MavFrame::MAV_FRAME_BODY_NED, [1.0, -2.0]),
        (MavFrame::MAV_FRAME_BODY_OFFSET_NED, [1.0, -2.0]),
    ]
    .map(|(frame, at)| MavMessage::SET_POSITION_TARGET_LOCAL_NED(local(frame, POSITION, at, 0.0)))
    .into();
    // Rover ignores the accelerations in any set-point with a position.
    let (mask, at) = (POSITION & !0b1_1100_0000, [2.0, 1.0]);
    let target = local(MavFrame::MAV_FRAME_LOCAL_NED, mask, at, 0.0);
    messages.push(MavMessage::SET_POSITION_TARGET_LOCAL_NED(target));
    let (lat_int, lon_int) = e7(goal());
    for coordinate_frame in [
        MavFrame::MAV_FRAME_GLOBAL,
        MavFrame::MAV_FRAME_GLOBAL_INT,
        MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
        MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
        MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT,
        MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT_INT,
    ] {
        let type_mask = PositionTargetTypemask::from_bits_retain(POSITION);
        let target = SET_POSITION_TARGET_GLOBAL_INT_DATA {
            lat_int,
            lon_int,
            type_mask,
            coordinate_frame,
            ..Default::default()
        };
        messages.push(MavMessage::SET_POSITION_TARGET_GLOBAL_INT(target));
    }
    // Set-points sent by MAVProxy's `guided` and dronekit's `simple_goto`.
    let command = MavCmd::MAV_CMD_NAV_WAYPOINT;
    let current = 2;
    let frame = MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT;
    let item = MISSION_ITEM_INT_DATA {
        x: lat_int,
        y: lon_int,
        command,
        current,
        frame,
        ..Default::default()
    };
    messages.push(MavMessage::MISSION_ITEM_INT(item));
    let x = 1e-7 * lat_int as f32;
    let y = 1e-7 * lon_int as f32;
    messages.push(MavMessage::MISSION_ITEM(MISSION_ITEM_DATA {
        x,
        y,
        command,
        current,
        frame,
        ..Default::default()
    }));
    for message in &messages {
        // A destination need be sent only once, and the boat reports it.
        let mut station = guided();
        station.send(message);
        let heard = station.run(60.0);
        assert!(
            station.boat.at.distance(goal()) < 5.0,
            "{message:?}: {:?}",
            station.boat
        );
        let is_shown = |message: &MavMessage| {
            matches!(message, MavMessage::POSITION_TARGET_GLOBAL_INT(shown)
            if shown.type_mask.bits() == 0xFDF8 && shown.lat_int.abs_diff(lat_int) < 200 && shown.lon_int.abs_diff(lon_int) < 200)
        };
        assert!(heard.iter().any(is_shown), "{message:?}");
    }
}

#[test]
fn velocities_headings_and_rates_of_turn_are_followed_in_every_frame_that_rover_takes() {
    for (frame, mask, velocity, yaw, heading_rad, speed_m_s) in [
        (
            MavFrame::MAV_FRAME_LOCAL_NED,
            VELOCITY,
            [-1.0, 0.0],
            0.0,
            std::f64::consts::PI,
            1.0,
        ),
        (
            MavFrame::MAV_FRAME_LOCAL_OFFSET_NED,
            VELOCITY,
            [0.0, -1.0],
            0.0,
            -FRAC_PI_2,
            1.0,
        ),
        (
            MavFrame::MAV_FRAME_LOCAL_NED,
            VELOCITY,
            [0.0, 9.0],
            0.0,
            FRAC_PI_2,
            2.0,
        ),
        (
            MavFrame::MAV_FRAME_LOCAL_NED,
            HEADING,
            [0.0, 1.0],
            -0.5,
            -0.5,
            0.0,
        ),
    ] {
        let message = MavMessage::SET_POSITION_TARGET_LOCAL_NED(local(frame, mask, velocity, yaw));
        let station = after(guided(), &message, 20);
        let off_rad = wrap_pi(station.boat.psi_rad - heading_rad).abs();
        assert!(
            off_rad < 0.1 && (station.boat.speed_m_s - speed_m_s).abs() < 0.1,
            "{message:?}: {:?}",
            station.boat
        );
    }
    for frame in [
        MavFrame::MAV_FRAME_BODY_NED,
        MavFrame::MAV_FRAME_BODY_OFFSET_NED,
    ] {
        let message =
            MavMessage::SET_POSITION_TARGET_LOCAL_NED(local(frame, VELOCITY, [1.0, 0.0], 0.0));
        let moved = after(guided(), &message, 10).boat.at.distance(
            start()
                + Ned {
                    north: 0.0,
                    east: 8.0,
                },
        );
        assert!(moved < 2.0, "{frame:?}: {moved} m off");
    }
    let message = MavMessage::SET_POSITION_TARGET_LOCAL_NED(local(
        MavFrame::MAV_FRAME_LOCAL_NED,
        TURN,
        [0.0; 2],
        0.2,
    ));
    let station = after(guided(), &message, 5);
    assert!(
        (station.boat.turn_rad_s - 0.2).abs() < 0.02 && station.boat.speed_m_s.abs() < 0.01,
        "{:?}",
        station.boat
    );
}

#[test]
fn a_set_point_that_rover_ignores_is_reported_and_moves_nothing() {
    let north = [1.0, 0.0];
    for (frame, mask, words) in [
        (MavFrame::MAV_FRAME_BODY_FRD, VELOCITY, "unsupported frame"),
        (MavFrame::MAV_FRAME_GLOBAL, VELOCITY, "unsupported frame"),
        (
            MavFrame::MAV_FRAME_LOCAL_NED,
            VELOCITY & !0b1_1100_0000,
            "ACC_IGNORE",
        ),
        (
            MavFrame::MAV_FRAME_LOCAL_NED,
            VELOCITY & !0b1100_0000_0000,
            "yaw and yaw rate",
        ),
        (
            MavFrame::MAV_FRAME_LOCAL_NED,
            VELOCITY | POSITION,
            "mask without a target",
        ),
    ] {
        let mut station = guided();
        let heard = station.reply(&MavMessage::SET_POSITION_TARGET_LOCAL_NED(local(
            frame, mask, north, 0.0,
        )));
        let is_said = |message: &MavMessage| matches!(message, MavMessage::STATUSTEXT(text) if text.text.to_str().is_ok_and(|text| text.contains(words)));
        assert!(heard.iter().any(is_said), "{frame:?} {mask:b}: {heard:?}");
        assert!(station.boat.speed_m_s == 0.0);
    }
}

#[test]
fn a_boat_whose_set_points_stop_says_so_and_keeps_its_station() {
    let message = MavMessage::SET_POSITION_TARGET_LOCAL_NED(local(
        MavFrame::MAV_FRAME_LOCAL_NED,
        VELOCITY,
        [1.0, 0.0],
        0.0,
    ));
    let mut station = after(guided(), &message, 10);
    let heard = station.run(4.0);
    let is_said = |message: &MavMessage| matches!(message, MavMessage::STATUSTEXT(text) if text.text.to_str() == Ok("target not received last 3secs, stopping"));
    assert_eq!(
        heard.iter().filter(|message| is_said(message)).count(),
        1,
        "{heard:?}"
    );
    let shown = station.run(20.0);
    assert!(
        shown
            .iter()
            .any(|message| matches!(message, MavMessage::POSITION_TARGET_GLOBAL_INT(_)))
    );
    let place = station.boat.at;
    station.boat.at = place
        + Ned {
            north: 10.0,
            east: 0.0,
        };
    station.run(60.0);
    assert!(
        station.boat.at.distance(place) < 6.0,
        "{place:?} {:?}",
        station.boat
    );
}

#[test]
fn commands_of_ground_stations_send_the_boat_to_a_place_at_a_speed() {
    let reposition = MavCmd::MAV_CMD_DO_REPOSITION as u16;
    let mut station = guided();
    assert_eq!(
        station.command(true, MavCmd::MAV_CMD_DO_CHANGE_SPEED as u16, [1.0, 0.5]),
        Some(4),
        "without a destination"
    );
    assert_eq!(
        station.command_at(false, reposition, [-1.0, 0.0, 0.0, 0.0], (0, 0)),
        Some(2)
    );
    assert_eq!(
        station.command_at(false, reposition, [-1.0, 0.0, 0.0, 0.0], e7(goal())),
        Some(0)
    );
    assert_eq!(
        station.command(true, MavCmd::MAV_CMD_DO_CHANGE_SPEED as u16, [1.0, 0.5]),
        Some(0)
    );
    assert_eq!(
        station.command(true, MavCmd::MAV_CMD_DO_CHANGE_SPEED as u16, [2.0, 0.5]),
        Some(0),
        "the type of speed is not read"
    );
    station.run(12.0);
    assert!(
        (station.boat.speed_m_s - 0.5).abs() < 0.1,
        "{:?}",
        station.boat
    );
    station.run(60.0);
    assert!(station.boat.at.distance(goal()) < 5.0, "{:?}", station.boat);
    assert_eq!(
        station.command(true, MavCmd::MAV_CMD_DO_SET_MODE as u16, [1.0, 5.0]),
        Some(0)
    );
    assert_eq!(
        station.command_at(false, reposition, [-1.0, 0.0, 0.0, 0.0], e7(start())),
        Some(2)
    );
    assert_eq!(
        station.command_at(false, reposition, [-1.0, 1.0, 0.0, 0.0], e7(start())),
        Some(0)
    );
    assert_eq!(
        station.ardupilot.mode(),
        (RoverMode::Guided, true),
        "with the flag to change the mode"
    );
}

fn set(station: &mut Station, name: &str, param_value: f32) {
    let set = PARAM_SET_DATA {
        param_value,
        target_system: 1,
        param_id: name.into(),
        ..Default::default()
    };
    station.send(&MavMessage::PARAM_SET(set));
}

/// The state in the boat's heartbeat.
fn state(station: &mut Station) -> MavState {
    let heard = station.run(1.0);
    let beat = |message: &MavMessage| match message {
        MavMessage::HEARTBEAT(beat) => Some(beat.system_status),
        _ => None,
    };
    heard.iter().rev().find_map(beat).expect("a heartbeat")
}

#[test]
fn a_boat_is_in_standby_in_hold_alone_armed_or_not() {
    let mut station = Station::new();
    for (mode, arm, want) in [
        (4.0, 1.0, MavState::MAV_STATE_STANDBY),
        (4.0, 0.0, MavState::MAV_STATE_STANDBY),
        (0.0, 0.0, MavState::MAV_STATE_ACTIVE),
        (15.0, 1.0, MavState::MAV_STATE_ACTIVE),
    ] {
        station.command(true, MavCmd::MAV_CMD_DO_SET_MODE as u16, [1.0, mode]);
        let arming = MavCmd::MAV_CMD_COMPONENT_ARM_DISARM as u16;
        station.command(true, arming, [arm, 0.0]);
        assert_eq!(state(&mut station), want, "mode {mode}, armed {arm}");
    }
}

#[test]
fn a_remote_control_steers_the_stern_when_the_boat_goes_astern() {
    let mut station = guided();
    station.ardupilot.set_mode(RoverMode::Manual);
    for (chan3_raw, port_is_more) in [(1700, true), (1300, false)] {
        let channels = RC_CHANNELS_OVERRIDE_DATA {
            chan1_raw: 1600,
            chan3_raw,
            target_system: 1,
            ..Default::default()
        };
        station.reply(&MavMessage::RC_CHANNELS_OVERRIDE(channels));
        assert!(
            matches!(station.order, Order::Thrust { port, starboard } if (port > starboard) == port_is_more),
            "{:?}",
            station.order
        );
    }
}

#[test]
fn a_lost_ground_station_stops_the_boat_after_the_time_that_rover_takes() {
    for (gcs_timeout_s, action, after_s, mode) in [
        (None, 2.0, 6.5, (RoverMode::Hold, true)),
        (Some(2.0), 2.0, 3.5, (RoverMode::Hold, true)),
        (None, 1.0, 6.5, (RoverMode::Rtl, true)),
        // SmartRTL is not emulated.
        (None, 3.0, 6.5, (RoverMode::Rtl, true)),
        (None, 4.0, 6.5, (RoverMode::Hold, true)),
        (None, 5.0, 6.5, (RoverMode::Guided, false)),
        (None, 6.0, 6.5, (RoverMode::Guided, true)),
    ] {
        let mut station = guided();
        set(&mut station, "FS_GCS_ENABLE", 1.0);
        set(&mut station, "FS_ACTION", action);
        gcs_timeout_s
            .into_iter()
            .for_each(|value| set(&mut station, "FS_GCS_TIMEOUT", value));
        let beat = MavMessage::HEARTBEAT(HEARTBEAT_DATA::default());
        (0..5).for_each(|_| drop(station.reply(&beat)));
        station.send(&beat);
        station.run(after_s - 0.2);
        assert_eq!(
            station.ardupilot.mode(),
            (RoverMode::Guided, true),
            "{action}"
        );
        station.run(0.4);
        assert_eq!(station.ardupilot.mode(), mode, "{action}");
        assert_eq!(state(&mut station), MavState::MAV_STATE_CRITICAL);
        // An operator who then takes control of the boat keeps it, although the station is still
        // lost.
        station.ardupilot.set_mode(RoverMode::Guided);
        station.run(10.0);
        assert_eq!(station.ardupilot.mode().0, RoverMode::Guided, "{action}");
    }
}
