//! Several flags a team, and more than two teams.

use crate::preset::{aquaticus_2023, pyquaticus};
use crate::scene::{Scene, captured, ended, field, flag, grabbed, lost, rectangle, tagged, teams_of};
use game::rules::{CaptureAt, Rules};
use game::{Ned, VehicleId};

#[test]
fn a_boat_between_two_flags_takes_the_nearest_and_only_one() {
    for (y, want) in [(44.0, 1), (48.0, 2), (46.0, 1)] {
        let mut scene = Scene::on(aquaticus_2023(), field(vec![flag(1, 140.0, 52.0)]), teams_of(1, 2));
        assert_eq!(scene.put(0, 140.0, y).look(), [grabbed(0, want)]);
        assert_eq!(scene.look(), []);
    }
}

#[test]
fn two_boats_at_two_flags_take_one_each_but_not_the_second_best_at_once() {
    let two_flags = || Scene::on(aquaticus_2023(), field(vec![flag(1, 140.0, 52.0)]), teams_of(2, 2));
    assert_eq!(two_flags().put(0, 140.0, 50.0).put(1, 140.0, 42.0).look(), [grabbed(1, 1), grabbed(0, 2)]);
    let mut scene = two_flags();
    assert_eq!(scene.put(0, 140.0, 45.0).put(1, 141.0, 41.0).look(), [grabbed(1, 1)]);
    assert_eq!(scene.look(), [grabbed(0, 2)]);
}

#[test]
fn any_own_flag_home_will_do_for_a_capture_but_all_must_be_home_where_that_is_needed() {
    for needed in [false, true] {
        let rules = Rules { capture_needs_own_flag: needed, ..aquaticus_2023() };
        let mut scene = Scene::on(rules, field(vec![flag(0, 20.0, 70.0)]), teams_of(1, 2));
        assert_eq!(scene.put(0, 140.0, 40.0).put(1, 20.0, 40.0).look(), [grabbed(1, 0), grabbed(0, 1)]);
        let events = scene.put(0, 20.0, 70.0).put(1, 100.0, 10.0).look();
        assert_eq!(events, if needed { vec![] } else { vec![captured(0, 1)] });
    }
}

#[test]
fn the_nearest_flag_that_is_home_keeps_its_defenders_out() {
    let mut scene = Scene::on(pyquaticus(), field(vec![flag(0, 20.0, 70.0)]), teams_of(1, 2));
    let circle = |scene: &Scene, y| scene.referee.keepout(&scene.standing, VehicleId(0), Ned::from_xy(20.0, y));
    assert_eq!(circle(&scene, 50.0), Some((Ned::from_xy(20.0, 40.0), 5.0)));
    assert_eq!(circle(&scene, 60.0), Some((Ned::from_xy(20.0, 70.0), 5.0)));
    assert_eq!(scene.put(1, 20.0, 40.0).look(), [grabbed(1, 0)]);
    assert_eq!(circle(&scene, 50.0), Some((Ned::from_xy(20.0, 70.0), 5.0)));
}

/// Three sides of 64 m each, next to each other, one flag in each.
fn three_sided(rules: Rules) -> Scene {
    let mut field = rectangle(0.0, 192.0, vec![flag(2, 160.0, 40.0)]);
    let thirds = [0.0, 64.0, 128.0].map(|x_m| rectangle(x_m, 128.0, vec![]));
    field.zones = thirds.iter().map(|third| third.zones[0].clone()).collect();
    field.own_corners = thirds.iter().map(|third| third.own_corners[0]).collect();
    field.flags[1] = flag(1, 96.0, 40.0);
    Scene::on(rules, field, teams_of(1, 3))
}

#[test]
fn three_teams_play_each_against_the_others() {
    let rules = Rules { win_score: Some(2), capture_at: CaptureAt::OwnSide, ..aquaticus_2023() };
    let mut scene = three_sided(rules);
    scene.put(0, 30.0, 10.0).put(1, 110.0, 10.0).put(2, 170.0, 10.0);
    assert_eq!(scene.look(), []);
    assert_eq!(scene.standing.score, [0, 0, 0]);
    assert_eq!(scene.put(0, 160.0, 40.0).put(2, 96.0, 40.0).look(), [grabbed(2, 1), grabbed(0, 2)]);
    // The first team's boat carries the third's flag home through the second's water.
    assert_eq!(scene.put(0, 103.0, 12.0).look(), [tagged(0, 1), lost(0, 2)]);
    assert_eq!(scene.put(2, 130.0, 40.0).look(), [captured(2, 1), ended(Some(2))]);
}

#[test]
fn three_teams_that_capture_in_a_ring_need_their_flags_home_before_the_captures_not_during_them() {
    // 0 brings in 1's flag, which only then is home: 1, who brings in 2's, has to wait for it.
    let rules = Rules { capture_needs_own_flag: true, ..aquaticus_2023() };
    let mut scene = three_sided(rules);
    scene.put(0, 96.0, 40.0).put(1, 160.0, 40.0).put(2, 170.0, 10.0);
    assert_eq!(scene.look(), [grabbed(0, 1), grabbed(1, 2)]);
    assert_eq!(scene.put(0, 20.0, 40.0).put(1, 96.0, 40.0).look(), [captured(0, 1)]);
    assert_eq!(scene.look(), [captured(1, 2)]);
    // The same the other way round: the one who waits has the lower index.
    scene.put(1, 20.0, 40.0).put(2, 96.0, 40.0).put(0, 30.0, 10.0);
    assert_eq!(scene.look(), [grabbed(1, 0), grabbed(2, 1)]);
    assert_eq!(scene.put(1, 96.0, 40.0).put(2, 160.0, 40.0).look(), [captured(2, 1)]);
    assert_eq!(scene.look(), [captured(1, 0)]);
}
