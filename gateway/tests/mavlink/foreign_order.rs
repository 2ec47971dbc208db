//! Tests foreign orders to an ArduPilot boat: from a second gateway, or from a ground station that
//! steers it.

use crate::rig::{Rig, e7, frame, plan};
use gateway::bridge::{Bridge, Input};
use gateway::mavlink::RoverMode;
use gateway::mavlink::dialect::{
    HEARTBEAT_DATA, MavFrame, MavMessage, MavType, PositionTargetTypemask,
    SET_POSITION_TARGET_GLOBAL_INT_DATA, SET_POSITION_TARGET_LOCAL_NED_DATA,
};
use messages::Order;
use messages::external::OperatorCommand;
use primitives::frame::Ned;

/// Time limit for two gateways to detect each other, s. Most of it is the time the boat takes to
/// move.
const LIMIT_S: f64 = 15.0;

fn steer(heading_deg: f64) -> Order {
    Order::Steer {
        heading_rad: heading_deg.to_radians(),
        speed_m_s: 1.5,
    }
}

/// The messages of a boat with firmware before version 4.7.
fn without_bearing(message: MavMessage) -> Option<MavMessage> {
    Some(match message {
        MavMessage::NAV_CONTROLLER_OUTPUT(shown) => MavMessage::NAV_CONTROLLER_OUTPUT(
            gateway::mavlink::dialect::NAV_CONTROLLER_OUTPUT_DATA {
                nav_bearing: 0,
                ..shown
            },
        ),
        other => other,
    })
}

/// Two gateways of one boat, armed at the same time, with these headings as their orders.
fn two_gateways(headings_deg: [f64; 2], alter: fn(MavMessage) -> Option<MavMessage>) -> Rig {
    let mut rig = Rig::new();
    (rig.alter, rig.second) = (alter, Some(Bridge::new(plan())));
    rig.order = Some(steer(headings_deg[0]));
    rig.put_second(&Input::LinkUp);
    rig.run(2.0);
    rig.put_second(&Input::Order(steer(headings_deg[1]), rig.now));
    rig.operator(OperatorCommand::Arm);
    rig.put_second(&Input::Operator(OperatorCommand::Arm));
    let start = rig.now;
    let is_armed = |bridge: &Bridge| bridge.state() == gateway::supervisor::State::Armed;
    while is_armed(&rig.bridge) || rig.second.as_ref().is_some_and(is_armed) {
        assert!(
            (rig.now - start).as_s() < LIMIT_S,
            "{headings_deg:?}: {:?}",
            rig.events
        );
        rig.put_second(&Input::Order(steer(headings_deg[1]), rig.now));
        rig.run(0.1);
    }
    rig
}

#[test]
fn two_gateways_at_one_boat_find_each_other_and_both_stop() {
    for headings_deg in [
        [90.0, 0.0],
        [0.0, 90.0],
        [90.0, 95.0],
        [90.0, 270.0],
        [180.0, 225.0],
    ] {
        let mut rig = two_gateways(headings_deg, Some);
        let both = [
            rig.state(),
            rig.second
                .as_ref()
                .map(|second| second.state().to_string())
                .unwrap_or_default(),
        ];
        assert!(
            both.iter().all(|state| state.starts_with("failsafe")),
            "{headings_deg:?}: {both:?}"
        );
        rig.run(10.0);
        assert_eq!(rig.mode(), (RoverMode::Hold, false));
        assert!(rig.boat.speed_m_s.abs() < 0.05, "{:?}", rig.boat);
    }
}

/// A ground station sends this message at this rate (1/s) to a boat under way; returns the time
/// until the gateway's failsafe (s) and its cause.
fn steered_by_another(mut rig: Rig, message: &MavMessage, rate_hz: f64) -> (f64, String) {
    let bytes = frame(250, 190, message);
    let start = rig.now;
    while rig.state() == "armed" {
        assert!(
            (rig.now - start).as_s() < LIMIT_S,
            "{message:?}: {:?} {:?}",
            rig.boat,
            rig.events
        );
        rig.ardupilot.receive(rig.now, &bytes);
        rig.run(1.0 / rate_hz);
    }
    ((rig.now - start).as_s(), rig.state())
}

fn velocity(heading_deg: f64, speed_m_s: f64) -> MavMessage {
    let velocity = Ned::toward_deg(heading_deg).scaled(speed_m_s);
    MavMessage::SET_POSITION_TARGET_LOCAL_NED(SET_POSITION_TARGET_LOCAL_NED_DATA {
        vx: velocity.north as f32,
        vy: velocity.east as f32,
        type_mask: PositionTargetTypemask::from_bits_retain(3559),
        target_system: 1,
        target_component: 1,
        coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
        ..SET_POSITION_TARGET_LOCAL_NED_DATA::default()
    })
}

fn position() -> MavMessage {
    let (lat_int, lon_int) = e7(Ned::from_xy(60.0, 10.0));
    MavMessage::SET_POSITION_TARGET_GLOBAL_INT(SET_POSITION_TARGET_GLOBAL_INT_DATA {
        lat_int,
        lon_int,
        type_mask: PositionTargetTypemask::from_bits_retain(0b1111_1111_1000),
        target_system: 1,
        target_component: 1,
        ..SET_POSITION_TARGET_GLOBAL_INT_DATA::default()
    })
}

#[test]
fn a_ground_station_that_steers_in_guided_is_detected_by_the_orders_shown() {
    for (message, limit_s, words) in [
        (velocity(0.0, 1.5), 1.0, "orders that are not ours"),
        (velocity(180.0, 1.0), 1.0, "orders that are not ours"),
        (
            position(),
            4.0,
            "does not follow its commands: it is in mode W",
        ),
    ] {
        let (after_s, state) = steered_by_another(Rig::under_way(), &message, 10.0);
        assert!(
            after_s < limit_s && state.contains(words),
            "{message:?}: {after_s} s, {state}"
        );
    }
}

#[test]
fn foreign_orders_that_the_boat_does_not_show_are_detected_by_its_motion() {
    for (message, rate_hz, words) in [
        (velocity(0.0, 1.5), 20.0, "moves against its orders"),
        (velocity(270.0, 1.5), 20.0, "moves against its orders"),
        (position(), 10.0, "it is in mode W"),
    ] {
        let mut rig = Rig::new();
        rig.alter = without_bearing;
        let (after_s, state) = steered_by_another(rig.gets_under_way(), &message, rate_hz);
        assert!(state.contains(words), "{message:?}: {after_s} s, {state}");
    }
}

#[test]
fn set_points_and_heartbeats_of_others_on_the_link_are_told() {
    let on_the_link = |message: &MavMessage| {
        let mut rig = Rig::under_way();
        let bytes = frame(250, 190, message);
        (0..3).for_each(|_| rig.give(&Input::Bytes(bytes.clone())));
        rig
    };
    assert!(
        on_the_link(&velocity(90.0, 1.5))
            .state()
            .contains("orders that are not ours")
    );
    let mavtype = MavType::MAV_TYPE_GCS;
    let rig = on_the_link(&MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        mavtype,
        ..HEARTBEAT_DATA::default()
    }));
    let told = rig
        .events
        .iter()
        .filter(|event| format!("{event:?}").contains("another ground station"))
        .count();
    assert_eq!((rig.state().as_str(), told), ("armed", 1));
}
