//! Tests the pre-flight check of a MAVLink boat.

use crate::boat::Boat;
use crate::rig::plan;
use gateway::emulator::{ArduPilot, FrontSeat, SYSTEM};
use gateway::geofence::GeofenceArea;
use gateway::mavlink::dialect::{
    GLOBAL_POSITION_INT_DATA, HEARTBEAT_DATA, MavAutopilot, MavCmd, MavMessage, MavType,
};
use gateway::mavlink::{AUTOPILOT, Framer, RoverMode, Writer};
use gateway::preflight::{Check, Verdict, Water, boat_checks};
use gateway::sensor_check::{HostTime, SensorCheck};
use primitives::SimTime;
use primitives::frame::Ned;

const BEGAN_UTC_NS: u64 = 1_795_000_000_000_000_000;

/// Listens to a boat at this place for 30 s; returns the sensor check and its results.
fn checked(place: Ned, change: impl Fn(&mut ArduPilot)) -> (SensorCheck, Vec<Check>) {
    let plan = plan();
    let site = plan.site.as_ref().expect("the rig has one");
    let mut ardupilot = ArduPilot::new(site.field.plan.datum, Some(1.0));
    ardupilot.set_clock(SimTime::ZERO, BEGAN_UTC_NS);
    change(&mut ardupilot);
    let mut seen = SensorCheck::new(&plan.gateway);
    let mut now = SimTime::ZERO;
    for tenth in 0..300_u64 {
        now = SimTime::from_s(0.1 * tenth as f64);
        let mut to_boat = vec![];
        let mut from_boat = vec![];
        seen.write_questions(now, &mut to_boat);
        ardupilot.receive(now, &to_boat);
        let boat = Boat {
            at: place,
            psi_rad: 1.0,
            ..Boat::default()
        };
        ardupilot.observe(now, &boat.measured(now, boat.at));
        ardupilot.telemetry(now, &mut from_boat);
        seen.receive(now, &from_boat);
    }
    let host = HostTime {
        now,
        utc_ns: BEGAN_UTC_NS + 29_900_000_000,
    };
    let area = GeofenceArea::new(&site.field, &plan.gateway.geofence);
    let checks = boat_checks(
        &seen,
        host,
        &plan.gateway,
        Some(&Water {
            field: site.field.clone(),
            area,
        }),
    );
    (seen, checks)
}

fn wrong(checks: &[Check]) -> Vec<(&str, Verdict)> {
    checks
        .iter()
        .filter(|check| check.verdict != Verdict::Passed)
        .map(|check| (check.name.as_str(), check.verdict))
        .collect()
}

#[test]
fn a_sound_boat_passes_and_each_thing_that_is_wrong_fails_its_own_check() {
    let inside = Ned::from_xy(80.0, 40.0);
    let pumps = ("bilge", Verdict::NotChecked);
    let (seen, checks) = checked(inside, |_| {});
    assert_eq!(wrong(&checks), [pumps], "{checks:?}");
    assert!(
        seen.findings(HostTime {
            now: SimTime::from_s(29.9),
            utc_ns: BEGAN_UTC_NS
        })
        .iter()
        .any(|line| line == "heading: 57.3 true")
    );
    let failed = |name| vec![(name, Verdict::Failed), pumps];
    let (_, checks) = checked(Ned::from_xy(80.0, 400.0), |_| {});
    assert_eq!(wrong(&checks), failed("geofence"), "{checks:?}");
    let (_, checks) = checked(inside, |boat| boat.set_volts(12.0));
    assert_eq!(wrong(&checks), failed("battery"), "{checks:?}");
    let (seen, checks) = checked(inside, |boat| boat.set_mode(RoverMode::Manual));
    let control = checks
        .iter()
        .find(|check| check.name == "control")
        .expect("it is checked");
    assert!(
        control.verdict == Verdict::Failed && control.found.contains("commanded by Rc"),
        "{control:?}"
    );
    assert_eq!(
        seen.missing(),
        ["control: Rc has control, and the mode is neither GUIDED nor HOLD"]
    );
}

#[test]
fn it_asks_for_what_it_needs_and_says_what_does_not_come() {
    let mut seen = SensorCheck::new(&plan().gateway);
    let mut asked = Framer::new();
    let mut wanted = vec![];
    let mut heartbeats = vec![];
    let mut writer = Writer::new(SYSTEM, AUTOPILOT);
    let heartbeat = HEARTBEAT_DATA {
        custom_mode: 4,
        mavtype: MavType::MAV_TYPE_SURFACE_BOAT,
        autopilot: MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
        ..HEARTBEAT_DATA::default()
    };
    writer.write(&MavMessage::HEARTBEAT(heartbeat), &mut heartbeats);
    for s in 0..30 {
        let now = SimTime::from_s(f64::from(s));
        let mut to_boat = vec![];
        seen.receive(now, &heartbeats);
        seen.write_questions(now, &mut to_boat);
        asked.push(&to_boat, &mut |received| wanted.push(received.message));
    }
    let is_request = |message: &MavMessage| match message {
        MavMessage::HEARTBEAT(_) => true,
        MavMessage::COMMAND_LONG(command) => {
            matches!(
                command.command,
                MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL | MavCmd::MAV_CMD_REQUEST_MESSAGE
            )
        }
        _ => false,
    };
    assert!(
        wanted.len() > 30 && wanted.iter().all(is_request),
        "{wanted:?}"
    );
    let missing = seen.missing().join("\n");
    for name in [
        "GLOBAL_POSITION_INT",
        "GPS_RAW_INT",
        "ATTITUDE",
        "SYS_STATUS",
    ] {
        assert!(missing.contains(name), "{missing}");
    }
    assert!(!missing.contains("HEARTBEAT"), "{missing}");
}

#[test]
fn a_vehicle_that_is_no_boat_is_named_and_a_heading_that_is_unknown_is_missing() {
    let mut seen = SensorCheck::new(&plan().gateway);
    let mut writer = Writer::new(SYSTEM, AUTOPILOT);
    let copter = HEARTBEAT_DATA {
        mavtype: MavType::MAV_TYPE_QUADROTOR,
        autopilot: MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
        ..HEARTBEAT_DATA::default()
    };
    let boat = HEARTBEAT_DATA {
        mavtype: MavType::MAV_TYPE_SURFACE_BOAT,
        ..copter.clone()
    };
    let mut send = |seen: &mut SensorCheck, heartbeat, s: u32| {
        let mut bytes = vec![];
        writer.write(&MavMessage::HEARTBEAT(heartbeat), &mut bytes);
        let position = GLOBAL_POSITION_INT_DATA {
            time_boot_ms: s,
            lat: 1,
            lon: 1,
            hdg: u16::MAX,
            ..Default::default()
        };
        writer.write(&MavMessage::GLOBAL_POSITION_INT(position), &mut bytes);
        seen.receive(SimTime::from_s(f64::from(s)), &bytes);
    };
    (0..9).for_each(|s| send(&mut seen, copter.clone(), s));
    assert_eq!(
        seen.missing(),
        ["a boat: all messages are from other systems (a QUADROTOR is system 1)"]
    );
    (10..20).for_each(|s| send(&mut seen, boat.clone(), s));
    let missing = seen.missing().join("\n");
    assert!(
        missing.contains("a heading: missing in GLOBAL_POSITION_INT"),
        "{missing}"
    );
}
