//! Tests an ArduPilot boat with its gateway: who drives the boat, and which events stop it.

use crate::rig::{Rig, datum, frame, plan};
use gateway::bridge::{Event, Input};
use gateway::config::Drive;
use gateway::emulator::{ArduPilot, FrontSeat};
use gateway::geodesy::LocalFrame;
use gateway::mavlink::dialect::{
    COMMAND_LONG_DATA, MISSION_ACK_DATA, MavCmd, MavFrame, MavMessage, MavMissionResult,
    PositionTargetTypemask, SET_POSITION_TARGET_LOCAL_NED_DATA,
};
use gateway::mavlink::{Framer, RoverMode};
use messages::Order;
use messages::external::{Mission, OperatorCommand};
use primitives::angle::wrap_pi;
use primitives::frame::Ned;

const HOLD: (RoverMode, bool) = (RoverMode::Hold, false);

/// Whether a message moves a boat or prepares it for motion.
fn is_driving(message: &MavMessage) -> bool {
    match message {
        MavMessage::SET_POSITION_TARGET_LOCAL_NED(target) => target.vx != 0.0 || target.vy != 0.0,
        MavMessage::SET_ATTITUDE_TARGET(target) => {
            target.thrust != 0.0 || target.body_yaw_rate != 0.0
        }
        MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
            command,
            param1,
            param2,
            ..
        }) => match command {
            MavCmd::MAV_CMD_COMPONENT_ARM_DISARM => *param1 == 1.0,
            MavCmd::MAV_CMD_DO_SET_MODE => *param2 != 4.0,
            _ => false,
        },
        _ => false,
    }
}

fn is_mode_command(message: &MavMessage) -> bool {
    matches!(message, MavMessage::COMMAND_LONG(command) if matches!(
        command.command,
        MavCmd::MAV_CMD_DO_SET_MODE | MavCmd::MAV_CMD_COMPONENT_ARM_DISARM
    ))
}

#[test]
fn a_boat_is_armed_driven_on_a_true_heading_and_disarmed() {
    for drive in [Drive::Speed, Drive::Thrust] {
        let mut rig = ordered(
            drive,
            Order::Steer {
                heading_rad: 1.0,
                speed_m_s: 1.0,
            },
        );
        assert_eq!(rig.mode(), (RoverMode::Guided, true), "{:?}", rig.events);
        let off_rad = wrap_pi(rig.boat.psi_rad - 1.0).abs();
        assert!(
            off_rad < 0.1 && (rig.boat.speed_m_s - 1.0).abs() < 0.2,
            "{drive:?}: {:?}",
            rig.boat
        );
        let status = rig.bridge.status(rig.now);
        assert_eq!(
            status.battery_pct,
            Some(100.0),
            "as the boat reports it, at {:?} V",
            status.battery_v
        );
        rig.operator(OperatorCommand::Disarm);
        assert_eq!(rig.mode(), HOLD, "at once");
        rig.run(15.0);
        assert!(rig.boat.speed_m_s < 0.05 && rig.state() == "disarmed");
    }
}

/// A boat that was at rest, was armed, and has followed this order for 20 s.
fn ordered(drive: Drive, order: Order) -> Rig {
    let mut plan = plan();
    plan.gateway.drive = drive;
    let mut rig = Rig::of(plan);
    rig.order = Some(order);
    rig.run(2.0);
    assert_eq!(
        (
            rig.mode(),
            rig.sent.iter().any(|(_, sent)| is_driving(sent))
        ),
        (HOLD, false)
    );
    rig.operator(OperatorCommand::Arm);
    rig.run(20.0);
    assert_eq!(rig.state(), "armed", "{order:?}: {:?}", rig.events);
    rig
}

#[test]
fn a_boat_goes_where_it_is_ordered_to_on_every_heading() {
    for drive in [Drive::Speed, Drive::Thrust] {
        for heading_deg in (0..360_i32).step_by(30).map(f64::from) {
            let heading_rad = wrap_pi(heading_deg.to_radians());
            let rig = ordered(
                drive,
                Order::Steer {
                    heading_rad,
                    speed_m_s: 1.0,
                },
            );
            let off_rad = wrap_pi(rig.boat.psi_rad - heading_rad).abs();
            assert!(
                off_rad < 0.1 && (rig.boat.speed_m_s - 1.0).abs() < 0.2,
                "{drive:?} {heading_deg}: {:?}",
                rig.boat
            );
        }
    }
}

#[test]
fn at_speed_zero_a_boat_takes_its_heading_and_makes_no_way() {
    for heading_rad in [2.0, -2.5] {
        let rig = ordered(
            Drive::Speed,
            Order::Steer {
                heading_rad,
                speed_m_s: 0.0,
            },
        );
        let moved_m = rig.boat.at.distance(Ned::from_xy(60.0, 40.0));
        let off_rad = wrap_pi(rig.boat.psi_rad - heading_rad).abs();
        assert!(
            off_rad < 0.1 && moved_m < 0.1,
            "{heading_rad}: {:?}",
            rig.boat
        );
    }
    let rig = ordered(Drive::Speed, Order::Hold);
    assert!(
        rig.boat.psi_rad == 0.0 && rig.boat.speed_m_s == 0.0,
        "{:?}",
        rig.boat
    );
}

/// A velocity set-point with its yaw, in the form that earlier versions sent.
fn with_yaw(message: MavMessage) -> Option<MavMessage> {
    let MavMessage::SET_POSITION_TARGET_LOCAL_NED(target) = message else {
        return Some(message);
    };
    Some(MavMessage::SET_POSITION_TARGET_LOCAL_NED(
        SET_POSITION_TARGET_LOCAL_NED_DATA {
            yaw: target.vy.atan2(target.vx),
            type_mask: target.type_mask
                - PositionTargetTypemask::POSITION_TARGET_TYPEMASK_YAW_IGNORE,
            ..target
        },
    ))
}

#[test]
fn a_boat_that_goes_astern_against_its_orders_is_stopped() {
    for (heading_deg, goes_astern) in [
        (60.0, false),
        (120.0, true),
        (180.0, true),
        (240.0, true),
        (300.0, false),
    ] {
        let mut rig = Rig::new();
        rig.alter = with_yaw;
        rig.boat.psi_rad = wrap_pi(f64::to_radians(heading_deg));
        rig.order = Some(Order::Steer {
            heading_rad: rig.boat.psi_rad,
            speed_m_s: 1.5,
        });
        rig.run(2.0);
        rig.operator(OperatorCommand::Arm);
        if goes_astern {
            rig.run_until(10.0, |rig| rig.state().contains("moves against its orders"));
            assert!(rig.boat.speed_m_s < -0.5, "{heading_deg}: {:?}", rig.boat);
        } else {
            rig.run(20.0);
            assert_eq!(rig.state(), "armed", "{heading_deg}");
        }
    }
}

#[test]
#[expect(
    deprecated,
    reason = "ground stations use frames that move with the boat, and Rover accepts them"
)]
fn an_emulated_boat_takes_the_sign_of_its_speed_from_the_north_as_rover_does() {
    use PositionTargetTypemask as Mask;
    let has_yaw = Mask::from_bits_retain(2535);
    let has_rate = Mask::from_bits_retain(1511);
    let velocity_alone = Mask::from_bits_retain(3559);
    for (frame, type_mask, vx, is_ahead) in [
        (MavFrame::MAV_FRAME_LOCAL_NED, has_yaw, -1.0, false),
        (MavFrame::MAV_FRAME_LOCAL_NED, has_rate, -1.0, false),
        (MavFrame::MAV_FRAME_LOCAL_OFFSET_NED, has_yaw, -1.0, false),
        (MavFrame::MAV_FRAME_BODY_NED, has_yaw, -1.0, false),
        (MavFrame::MAV_FRAME_BODY_OFFSET_NED, has_rate, -1.0, false),
        (MavFrame::MAV_FRAME_LOCAL_NED, has_yaw, 1.0, true),
        (MavFrame::MAV_FRAME_LOCAL_NED, velocity_alone, -1.0, true),
        (MavFrame::MAV_FRAME_BODY_NED, velocity_alone, 1.0, true),
    ] {
        let mut rig = Rig::under_way();
        rig.bridge = gateway::bridge::Bridge::new(plan());
        let target = SET_POSITION_TARGET_LOCAL_NED_DATA {
            vx,
            type_mask,
            target_system: 1,
            target_component: 1,
            coordinate_frame: frame,
            ..SET_POSITION_TARGET_LOCAL_NED_DATA::default()
        };
        let message = MavMessage::SET_POSITION_TARGET_LOCAL_NED(target);
        let bytes = crate::rig::frame(250, 190, &message);
        for _ in 0..10 {
            rig.ardupilot.receive(rig.now, &bytes);
            rig.run(1.0);
        }
        assert_eq!(
            rig.boat.speed_m_s > 0.8,
            is_ahead,
            "{frame:?} {type_mask:?} {vx}: {:?}",
            rig.boat
        );
        assert_eq!(
            rig.boat.speed_m_s < -0.5,
            !is_ahead,
            "{frame:?} {type_mask:?} {vx}: {:?}",
            rig.boat
        );
    }
}

#[test]
fn every_failure_stops_the_boat_within_its_deadline() {
    type Fail = fn(&mut Rig);
    let cases: [(&str, Fail, f64, &str); 5] = [
        ("no orders", |rig| rig.order = None, 1.2, "no fresh order"),
        (
            "an E-stop",
            |rig| rig.operator(OperatorCommand::EStop),
            0.1,
            "e-stopped",
        ),
        ("a deaf boat", |rig| rig.open.1 = false, 1.7, "is 1.5 s old"),
        (
            "a lost link",
            |rig| rig.give(&Input::LinkDown),
            0.1,
            "the link is lost",
        ),
        (
            "a low battery",
            |rig| rig.ardupilot.set_volts(12.0),
            6.5,
            "the battery is low",
        ),
    ];
    for (what, fail, limit_s, words) in cases {
        let mut rig = Rig::under_way();
        fail(&mut rig);
        rig.run_until(limit_s, |rig| rig.state().contains(words));
        let sent = rig.sent.len();
        rig.run(20.0);
        assert!(rig.boat.speed_m_s < 0.05, "{what}: {:?}", rig.boat);
        assert!(
            !rig.sent[sent..].iter().any(|(_, sent)| is_driving(sent)),
            "{what}"
        );
    }
}

#[test]
fn a_boat_without_messages_drops_its_set_point_after_three_seconds() {
    let mut rig = Rig::under_way();
    rig.open.0 = false;
    rig.run(2.9);
    assert!(rig.boat.speed_m_s > 1.0);
    rig.run(12.0);
    assert!(rig.boat.speed_m_s < 0.05);
}

#[test]
fn a_pilot_who_takes_over_by_remote_control_keeps_the_boat() {
    for (mode, words) in [
        (RoverMode::Manual, "the remote control has taken over"),
        (RoverMode::Acro, "the remote control has taken over"),
        (RoverMode::Rtl, "the primary operator has taken over"),
        (RoverMode::Loiter, "the primary operator has taken over"),
    ] {
        let mut rig = Rig::under_way();
        rig.ardupilot.set_mode(mode);
        let sent = rig.sent.len();
        rig.run_until(0.4, |rig| rig.state().contains(words));
        rig.operator(OperatorCommand::EStop);
        rig.run(10.0);
        assert_eq!(
            rig.mode(),
            (mode, true),
            "it is left to its current operator"
        );
        assert!(
            !rig.sent[sent..]
                .iter()
                .any(|(_, sent)| is_mode_command(sent)),
            "{mode:?}"
        );
        rig.operator(OperatorCommand::Release);
        rig.operator(OperatorCommand::Arm);
        assert!(
            rig.refused
                .take()
                .is_some_and(|reason| reason.contains("secondary control"))
        );
        // When the pilot hands the boat back, it goes to standby and waits to be armed.
        rig.ardupilot.set_mode(RoverMode::Guided);
        rig.run(2.0);
        assert_eq!(rig.mode(), HOLD);
        rig.operator(OperatorCommand::Arm);
        rig.run(2.0);
        assert_eq!(rig.mode(), (RoverMode::Guided, true));
    }
}

#[test]
fn a_boat_that_switches_from_guided_to_hold_is_not_retaken() {
    let mut rig = Rig::under_way();
    rig.ardupilot.set_mode(RoverMode::Hold);
    rig.run(2.0);
    assert_eq!(rig.mode().0, RoverMode::Hold);
    rig.run_until(2.0, |rig| {
        rig.state().contains("does not follow its commands")
    });
    rig.run(10.0);
    assert_eq!(rig.mode(), HOLD);
}

#[test]
fn the_first_command_leaves_a_pilot_in_control_and_stops_a_boat_in_guided() {
    for (mode, want) in [
        (RoverMode::Manual, (RoverMode::Manual, true)),
        (RoverMode::Guided, HOLD),
    ] {
        let mut rig = Rig::under_way();
        rig.give(&Input::LinkDown);
        rig.ardupilot.set_mode(mode);
        rig.give(&Input::LinkUp);
        rig.run(2.0);
        assert_eq!(rig.mode(), want);
        assert!(matches!(
            rig.bridge.state().to_string().as_str(),
            "disarmed" | "failsafe: the link is lost"
        ));
    }
}

/// Sends the guard's message to this boat.
fn guarded(rig: &mut Rig) {
    let message = rig.bridge.guard_message();
    rig.ardupilot.receive(rig.now, &message);
}

#[test]
fn the_guards_message_stops_a_boat_that_is_driven_and_leaves_one_to_its_pilot() {
    let mut rig = Rig::under_way();
    guarded(&mut rig);
    assert_eq!(rig.mode(), HOLD);
    let mut rig = Rig::under_way();
    rig.ardupilot.set_mode(RoverMode::Manual);
    rig.run(1.5);
    guarded(&mut rig);
    assert_eq!(rig.mode(), (RoverMode::Manual, true));
    let first = rig.bridge.guard_message();
    let again = rig.bridge.guard_message();
    assert_eq!(
        first, again,
        "the same bytes, so that the guard needs no update"
    );
}

/// A waypoint at 80, 40, and a recovery point at 40, 30.
fn mission() -> Mission {
    let frame = LocalFrame::new(datum());
    let place = |x: f64, y: f64| {
        let at = frame.lat_lon(Ned::from_xy(x, y));
        [at.lat_deg, at.lon_deg]
    };
    Mission {
        throttle_pct: 40.0,
        erp: place(40.0, 30.0),
        waypoints: vec![place(80.0, 40.0)],
    }
}

#[test]
fn a_boat_keeps_its_station_and_goes_to_the_recovery_point_that_it_showed() {
    let mut rig = Rig::under_way();
    rig.operator(OperatorCommand::StationKeep);
    rig.run(2.0);
    assert_eq!(
        (rig.state().as_str(), rig.mode()),
        ("delegated: station keeping", (RoverMode::Loiter, true))
    );
    rig.operator(OperatorCommand::GoToErp);
    assert!(
        rig.refused
            .take()
            .is_some_and(|reason| reason.contains("recovery point")),
        "its home is not ours"
    );
    rig.operator(OperatorCommand::Mission(mission()));
    assert_eq!(rig.refused.take(), None);
    rig.run_until(5.0, |rig| rig.state() == "delegated: mission");
    rig.run(3.0);
    assert_eq!(rig.mode(), (RoverMode::Auto, true));
    assert!(
        rig.remarks
            .iter()
            .any(|remark| remark.contains("a mission of 1 waypoints")),
        "{:?}",
        rig.remarks
    );
    rig.run_until(90.0, |rig| {
        rig.boat.at.distance(Ned::from_xy(80.0, 40.0)) < 4.0
    });
    rig.operator(OperatorCommand::GoToErp);
    assert_eq!(rig.refused.take(), None);
    rig.run(2.0);
    assert_eq!(rig.mode(), (RoverMode::Rtl, true));
    rig.run_until(120.0, |rig| {
        rig.boat.at.distance(Ned::from_xy(40.0, 30.0)) < 4.0
    });
    assert_eq!(rig.state(), "delegated: to the emergency recovery point");
}

#[test]
fn a_boat_at_rest_is_armed_before_it_is_sent_to_its_recovery_point() {
    let mut rig = Rig::under_way();
    rig.operator(OperatorCommand::Mission(mission()));
    rig.run_until(5.0, |rig| rig.state() == "delegated: mission");
    rig.operator(OperatorCommand::Disarm);
    rig.run(2.0);
    assert_eq!(rig.mode(), HOLD);
    rig.operator(OperatorCommand::GoToErp);
    assert_eq!(rig.refused.take(), None);
    rig.run(2.0);
    let found = (rig.state(), rig.mode());
    assert_eq!(
        found,
        (
            "delegated: to the emergency recovery point".to_owned(),
            (RoverMode::Rtl, true)
        )
    );
    // If a pilot disarms the boat on its way, it stays disarmed.
    rig.ardupilot.receive(rig.now, &disarm());
    rig.run(10.0);
    assert!(!rig.mode().1, "{:?}", rig.events);
}

/// A ground station's command that disarms the boat.
fn disarm() -> Vec<u8> {
    let command = COMMAND_LONG_DATA {
        command: MavCmd::MAV_CMD_COMPONENT_ARM_DISARM,
        target_system: 1,
        target_component: 1,
        ..COMMAND_LONG_DATA::default()
    };
    frame(250, 190, &MavMessage::COMMAND_LONG(command))
}

#[test]
fn a_mission_that_the_boat_does_not_take_is_given_up_with_the_reason() {
    let mut rig = Rig::under_way();
    let mission = Mission {
        throttle_pct: 40.0,
        erp: [0.0; 2],
        waypoints: vec![[0.0; 2]],
    };
    rig.operator(OperatorCommand::Mission(mission));
    assert!(
        rig.refused
            .take()
            .is_some_and(|reason| reason.contains("outside the geofence"))
    );
    let there = self::mission().erp;
    rig.open.0 = false;
    rig.operator(OperatorCommand::Mission(Mission {
        throttle_pct: 40.0,
        erp: there,
        waypoints: vec![there],
    }));
    rig.run(8.0);
    let told = |event: &Event| matches!(event, Event::Warning(text) if text.contains("the mission is not uploaded: the boat does not report the home"));
    assert!(rig.events.iter().any(told), "{:?}", rig.events);
}

#[test]
fn an_item_that_the_boat_got_twice_does_not_end_the_upload() {
    let mut rig = Rig::under_way();
    // The boat receives no items until it has refused one.
    rig.alter = |message| (!matches!(message, MavMessage::MISSION_COUNT(_))).then_some(message);
    rig.operator(OperatorCommand::Mission(mission()));
    rig.run(1.5);
    let ours = plan().gateway.mavlink;
    let ack = MISSION_ACK_DATA {
        target_system: ours.system,
        target_component: ours.component,
        mavtype: MavMissionResult::MAV_MISSION_INVALID_SEQUENCE,
        ..Default::default()
    };
    rig.give(&Input::Bytes(frame(1, 1, &MavMessage::MISSION_ACK(ack))));
    rig.alter = Some;
    rig.run_until(5.0, |rig| rig.state() == "delegated: mission");
}

#[test]
fn messages_of_other_systems_are_counted_and_ignored() {
    let mut rig = Rig::under_way();
    let mut other = Vec::new();
    let mut writer = gateway::mavlink::Writer::new(7, 1);
    let mut framer = Framer::new();
    let mut telemetry = Vec::new();
    // A different boat on the same network, in HOLD and with an empty battery.
    let mut another = ArduPilot::new(datum(), None);
    another.set_volts(5.0);
    another.observe(rig.now, &rig.boat.measured(rig.now, rig.boat.at));
    another.telemetry(rig.now, &mut telemetry);
    framer.push(&telemetry, &mut |received| {
        writer.write(&received.message, &mut other)
    });
    for _ in 0..100 {
        rig.give(&Input::Bytes(other.clone()));
        rig.run(0.1);
    }
    assert_eq!(rig.state(), "armed");
    let counts = rig.bridge.status(rig.now).counts;
    assert!(
        counts
            .iter()
            .any(|(name, count)| name == "messages from other systems" && *count >= 100),
        "{counts:?}"
    );
}

#[test]
fn refused_arming_triggers_a_failsafe_with_the_boats_reason() {
    let mut rig = Rig::new();
    rig.order = Some(Order::Hold);
    rig.run(2.0);
    // From now on, the boat replies but receives nothing.
    rig.open.0 = false;
    rig.operator(OperatorCommand::Arm);
    rig.run_until(4.0, |rig| {
        rig.state().contains("does not follow its commands")
    });
}
