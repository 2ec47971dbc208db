//! What people ask of a boat beside orders: keep your station, come home, sail this mission.

use crate::pool::{Pool, steer};
use game::external::{Mission, OperatorCommand};
use game::frame::Ned;
use gateway::geodesy::LocalFrame;

fn mission(places: &[(f64, f64)]) -> Mission {
    let frame = LocalFrame::new(crate::pool::plan("surveyor.toml", false).field.plan.datum);
    let spot = |(x, y): &(f64, f64)| {
        let at = frame.lat_lon(Ned::from_xy(*x, *y));
        [at.lat_deg, at.lon_deg]
    };
    Mission { throttle_pct: 40.0, erp: spot(&(20.0, 40.0)), waypoints: places.iter().map(spot).collect() }
}

#[test]
fn a_boat_keeps_its_station_by_its_own_means_and_is_told_so_once() {
    let mut pool = Pool::under_way("surveyor.toml", None);
    pool.operate(OperatorCommand::StationKeep);
    assert_eq!((pool.mode(), pool.refused.take()), ('R', None));
    let last = pool.sent.last().map(|(_, bytes)| String::from_utf8_lossy(bytes).into_owned());
    assert_eq!(last.as_deref(), Some("$PSEAC,T,0,0,0,*0C\r\n$PSEAC,R,,,,*3A\r\n"), "thrust zero first");
    let (here, sent) = (pool.boat.at, pool.sent.len());
    pool.run(30.0);
    assert!(pool.boat.at.distance(here) < 6.0, "{:?}", pool.boat);
    assert_eq!(pool.sent.len(), sent, "telling it again would set a new station");
    pool.run(60.0);
    assert!(pool.is_at_rest() && pool.boat.at.distance(here) < 4.0, "it does not circle: {:?}", pool.boat);
    pool.operate(OperatorCommand::Arm);
    assert_eq!(pool.state(), "armed");
}

#[test]
fn a_mission_is_taken_up_line_by_line_and_sailed() {
    let mut pool = Pool::under_way("surveyor.toml", None);
    pool.sent.clear();
    pool.operate(OperatorCommand::Mission(mission(&[(80.0, 60.0), (100.0, 40.0)])));
    assert_eq!((pool.state().as_str(), pool.refused.take()), ("safed", None));
    pool.run(2.0);
    let lines: Vec<String> = pool
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
    assert_eq!((pool.mode(), pool.state().as_str()), ('W', "the boat sails its mission"));
    for (x, y) in [(80.0, 60.0), (100.0, 40.0)] {
        pool.run_until(90.0, |pool| pool.boat.at.distance(Ned::from_xy(x, y)) < 4.0);
    }
    pool.run(20.0);
    assert!(pool.boat.at.distance(Ned::from_xy(100.0, 40.0)) < 8.0, "it stays at its end: {:?}", pool.boat);
    pool.operate(OperatorCommand::GoToErp);
    pool.run_until(120.0, |pool| pool.boat.at.distance(Ned::from_xy(20.0, 40.0)) < 4.0);
}

#[test]
fn an_e_stop_breaks_a_mission_off_before_and_after_it_is_taken_up() {
    for wait_s in [0.25, 5.0] {
        let mut pool = Pool::under_way("surveyor.toml", None);
        pool.operate(OperatorCommand::Mission(mission(&[(80.0, 60.0)])));
        pool.run(wait_s);
        pool.operate(OperatorCommand::EStop);
        assert_eq!((pool.mode(), pool.state().as_str()), ('L', "e-stopped"), "{wait_s}");
        pool.run(10.0);
        assert!(pool.is_at_rest() && pool.mode() == 'L');
    }
}

#[test]
fn trouble_stops_a_boat_on_a_mission_too() {
    let mut pool = Pool::under_way("surveyor.toml", None);
    pool.operate(OperatorCommand::Mission(mission(&[(80.0, 60.0)])));
    pool.run(5.0);
    pool.frozen = true;
    pool.run_until(1.8, |pool| pool.mode() == 'L');
    assert!(pool.state().contains("navigation"), "{}", pool.state());
}

#[test]
fn missions_that_make_no_sense_are_refused_with_the_reason() {
    for (change, why) in [
        ((|m: &mut Mission| m.throttle_pct = 90.0) as fn(&mut Mission), "throttle_pct is 90, expected 0 to 70"),
        (|m| m.waypoints.clear(), "waypoints are 0, expected 1 to 200"),
        (|m| m.waypoints[0] = [91.0, 0.0], "waypoint 1 is [91, 0], expected latitude and longitude"),
        (|m| m.waypoints[0][0] += 0.02, "a place of it is outside of the fence"),
        (|m| m.erp = [f64::NAN, 0.0], "waypoint 0 is [NaN, 0]"),
    ] {
        let mut pool = Pool::under_way("surveyor.toml", None);
        let mut bad = mission(&[(80.0, 60.0)]);
        change(&mut bad);
        pool.operate(OperatorCommand::Mission(bad));
        let refused = pool.refused.take().unwrap_or_default();
        assert!(refused.contains(why), "{refused}");
        assert_eq!(pool.state(), "armed", "and nothing else happens");
    }
    let mut pool = Pool::new("surveyor.toml", None);
    pool.mind = Some(steer(0.0, 1.0));
    pool.operate(OperatorCommand::Mission(mission(&[(80.0, 60.0)])));
    assert!(pool.refused.is_some_and(|refused| refused.contains("navigation: no fix yet")));
}

#[test]
fn a_mission_of_which_a_line_is_lost_is_refused_by_the_boat_and_the_one_before_is_gone() {
    let mut pool = Pool::under_way("surveyor.toml", None);
    pool.operate(OperatorCommand::Mission(mission(&[(80.0, 60.0)])));
    pool.run(2.0);
    assert_eq!(pool.emulator.take_remark().as_deref(), Some("a mission of 2 places is taken up"));
    pool.operate(OperatorCommand::Disarm);
    pool.run(20.0);
    pool.operate(OperatorCommand::Mission(mission(&[(80.0, 60.0), (100.0, 40.0)])));
    pool.run(0.35);
    pool.open.0 = false;
    pool.run(0.1);
    pool.open.0 = true;
    pool.run(2.0);
    let remark = pool.emulator.take_remark().unwrap_or_default();
    assert!(remark.starts_with("mission refused: 4 lines were announced"), "{remark:?}");
    let here = pool.boat.at;
    pool.run(20.0);
    assert!(pool.boat.at.distance(here) < 4.0, "without a mission it stays");
}
