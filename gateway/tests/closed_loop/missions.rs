//! Operator commands beside orders: station keeping, return to the recovery point, missions.

use crate::rig::{Rig, steer};
use game::external::{Mission, OperatorCommand};
use game::frame::Ned;
use gateway::geodesy::LocalFrame;

fn mission(places: &[(f64, f64)]) -> Mission {
    let frame = LocalFrame::new(crate::rig::plan("surveyor.toml", false).field.plan.datum);
    let spot = |(x, y): &(f64, f64)| {
        let at = frame.lat_lon(Ned::from_xy(*x, *y));
        [at.lat_deg, at.lon_deg]
    };
    Mission { throttle_pct: 40.0, erp: spot(&(20.0, 40.0)), waypoints: places.iter().map(spot).collect() }
}

#[test]
fn station_keeping_is_delegated_to_the_boat_with_one_command() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.operate(OperatorCommand::StationKeep);
    assert_eq!((rig.mode(), rig.refused.take()), ('R', None));
    let last = rig.sent.last().map(|(_, bytes)| String::from_utf8_lossy(bytes).into_owned());
    assert_eq!(last.as_deref(), Some("$PSEAC,T,0,0,0,*0C\r\n$PSEAC,R,,,,*3A\r\n"), "thrust zero first");
    let (here, sent) = (rig.boat.at, rig.sent.len());
    rig.run(30.0);
    assert!(rig.boat.at.distance(here) < 6.0, "{:?}", rig.boat);
    assert_eq!(rig.sent.len(), sent, "a second command would set a new station");
    rig.run(60.0);
    assert!(rig.is_at_rest() && rig.boat.at.distance(here) < 4.0, "it does not circle: {:?}", rig.boat);
    rig.operate(OperatorCommand::Arm);
    assert_eq!(rig.state(), "armed");
}

#[test]
fn a_mission_is_uploaded_line_by_line_and_sailed() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.sent.clear();
    rig.operate(OperatorCommand::Mission(mission(&[(80.0, 60.0), (100.0, 40.0)])));
    assert_eq!((rig.state().as_str(), rig.refused.take()), ("safed", None));
    rig.run(2.0);
    let lines: Vec<String> = rig
        .sent
        .iter()
        .flat_map(|(_, bytes)| String::from_utf8_lossy(bytes).lines().map(str::to_owned).collect::<Vec<_>>())
        .collect();
    let short: Vec<&str> = lines.iter().map(|line| &line[1..8.min(line.len())]).collect();
    assert_eq!(
        short,
        ["PSEAC,T", "PSEAC,L", "PSEAC,F", "PSEAR,0", "OIWPL,4", "OIWPL,4", "OIWPL,4", "PSEAC,F", "PSEAC,W"],
        "{lines:?}"
    );
    assert_eq!(lines[2], "$PSEAC,F,4,000,000,*1A");
    assert_eq!((rig.mode(), rig.state().as_str()), ('W', "delegated: mission"));
    for (x, y) in [(80.0, 60.0), (100.0, 40.0)] {
        rig.run_until(90.0, |rig| rig.boat.at.distance(Ned::from_xy(x, y)) < 4.0);
    }
    rig.run(20.0);
    assert!(rig.boat.at.distance(Ned::from_xy(100.0, 40.0)) < 8.0, "it stays at its end: {:?}", rig.boat);
    rig.operate(OperatorCommand::GoToErp);
    rig.run_until(120.0, |rig| rig.boat.at.distance(Ned::from_xy(20.0, 40.0)) < 4.0);
}

#[test]
fn an_e_stop_cancels_a_mission_during_and_after_its_upload() {
    for wait_s in [0.25, 5.0] {
        let mut rig = Rig::under_way("surveyor.toml", None);
        rig.operate(OperatorCommand::Mission(mission(&[(80.0, 60.0)])));
        rig.run(wait_s);
        rig.operate(OperatorCommand::EStop);
        assert_eq!((rig.mode(), rig.state().as_str()), ('L', "e-stopped"), "{wait_s}");
        rig.run(10.0);
        assert!(rig.is_at_rest() && rig.mode() == 'L');
    }
}

#[test]
fn a_failsafe_stops_a_boat_on_a_mission_too() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.operate(OperatorCommand::Mission(mission(&[(80.0, 60.0)])));
    rig.run(5.0);
    rig.frozen = true;
    rig.run_until(1.8, |rig| rig.mode() == 'L');
    assert!(rig.state().contains("navigation"), "{}", rig.state());
}

#[test]
fn invalid_missions_are_refused_with_the_reason() {
    for (change, why) in [
        ((|m: &mut Mission| m.throttle_pct = 90.0) as fn(&mut Mission), "throttle_pct is 90, expected 0 to 70"),
        (|m| m.waypoints.clear(), "waypoints are 0, expected 1 to 200"),
        (|m| m.waypoints[0] = [91.0, 0.0], "waypoint 1 is [91, 0], expected latitude and longitude"),
        (|m| m.waypoints[0][0] += 0.02, "a place of it is outside of the geofence"),
        (|m| m.erp = [f64::NAN, 0.0], "waypoint 0 is [NaN, 0]"),
    ] {
        let mut rig = Rig::under_way("surveyor.toml", None);
        let mut bad = mission(&[(80.0, 60.0)]);
        change(&mut bad);
        rig.operate(OperatorCommand::Mission(bad));
        let refused = rig.refused.take().unwrap_or_default();
        assert!(refused.contains(why), "{refused}");
        assert_eq!(rig.state(), "armed", "and nothing else happens");
    }
    let mut rig = Rig::new("surveyor.toml", None);
    rig.order = Some(steer(0.0, 1.0));
    rig.operate(OperatorCommand::Mission(mission(&[(80.0, 60.0)])));
    assert!(rig.refused.is_some_and(|refused| refused.contains("navigation: no fix yet")));
}

#[test]
fn a_mission_of_which_a_line_is_lost_is_refused_by_the_boat_and_the_one_before_is_gone() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.operate(OperatorCommand::Mission(mission(&[(80.0, 60.0)])));
    rig.run(2.0);
    assert_eq!(rig.emulator.take_remark().as_deref(), Some("a mission of 2 places is accepted"));
    rig.operate(OperatorCommand::Disarm);
    rig.run(20.0);
    rig.operate(OperatorCommand::Mission(mission(&[(80.0, 60.0), (100.0, 40.0)])));
    rig.run(0.35);
    rig.open.0 = false;
    rig.run(0.1);
    rig.open.0 = true;
    rig.run(2.0);
    let remark = rig.emulator.take_remark().unwrap_or_default();
    assert!(remark.starts_with("mission refused: 4 lines were announced"), "{remark:?}");
    let here = rig.boat.at;
    rig.run(20.0);
    assert!(rig.boat.at.distance(here) < 4.0, "without a mission it stays");
}
