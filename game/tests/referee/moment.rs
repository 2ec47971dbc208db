//! One moment, two claims: what happens when things happen at once.

use crate::preset::{aquaticus_2023, pyquaticus};
use crate::scene::{Scene, captured, freed, grabbed, left, lost, stopped_at_the_boundary, tagged};
use game::SimTime;
use game::rules::Rules;

#[test]
fn two_taggers_at_one_intruder_only_the_nearest_spends_its_tag() {
    for (x0, x1, by) in [(60.0, 68.0, 1), (62.0, 70.0, 0), (60.0, 70.0, 0)] {
        let mut scene = Scene::new(aquaticus_2023(), 2);
        assert_eq!(scene.put(0, x0, 40.0).put(1, x1, 40.0).put(2, 65.0, 40.0).look(), [tagged(2, by)]);
        let other = usize::from(1 - by);
        assert_eq!(scene.standing.vehicles[other].tag_ready, SimTime::LONG_AGO);
        assert_eq!(scene.put(3, 65.0, 41.0).look(), [tagged(3, 1 - by)], "the other can still tag");
    }
}

#[test]
fn one_tagger_and_two_intruders_only_the_nearest_is_tagged() {
    let mut scene = Scene::new(aquaticus_2023(), 2);
    assert_eq!(scene.put(0, 60.0, 40.0).put(2, 68.0, 40.0).put(3, 60.0, 45.0).look(), [tagged(3, 0)]);
    let mut scene = Scene::new(aquaticus_2023(), 2);
    let events = scene.put(0, 60.0, 40.0).put(2, 65.0, 40.0).put(3, 60.0, 45.0).look();
    assert_eq!(events, [tagged(2, 0)], "equally far: the lower index");
}

#[test]
fn a_tagger_that_came_second_looks_for_another_intruder_at_the_next_look() {
    let mut scene = Scene::new(aquaticus_2023(), 2);
    scene.put(0, 60.0, 40.0).put(1, 61.0, 46.0).put(2, 60.0, 42.0).put(3, 61.0, 53.0);
    assert_eq!(scene.look(), [tagged(2, 0)], "both reach for boat 2 first");
    assert_eq!(scene.look(), [tagged(3, 1)]);
}

#[test]
fn two_boats_that_meet_on_the_line_cannot_tag_each_other() {
    let mut scene = Scene::new(aquaticus_2023(), 1);
    assert!(
        !scene.put(0, 80.0, 40.0).put(1, 80.0, 46.0).look().iter().any(|e| matches!(e, game::Event::Tagged { .. }))
    );
}

#[test]
fn a_boat_tagged_at_this_look_grabs_nothing() {
    let mut scene = Scene::new(aquaticus_2023(), 1);
    assert_eq!(scene.put(0, 25.0, 40.0).put(1, 29.0, 40.0).look(), [tagged(1, 0)]);
    assert_eq!(scene.carrier(0), None);
}

#[test]
fn a_tag_comes_before_a_capture() {
    let mut scene = Scene::new(Rules { capture_radius_m: 70.0, ..aquaticus_2023() }, 1);
    assert_eq!(scene.put(1, 20.0, 40.0).look(), [grabbed(1, 0)]);
    let events = scene.put(0, 70.0, 40.0).put(1, 75.0, 40.0).look();
    assert_eq!(events, [tagged(1, 0), lost(1, 0)], "in its capture place, but tagged");
    assert_eq!(scene.standing.score, [0, 1], "a point for the grab only");
}

#[test]
fn of_two_boats_at_one_flag_the_nearest_gets_it() {
    for (x0, x1, by) in [(134.0, 135.0, 1), (135.0, 146.0, 0), (135.0, 145.0, 0)] {
        let mut scene = Scene::new(aquaticus_2023(), 2);
        assert_eq!(scene.put(0, x0, 40.0).put(1, x1, 40.0).look(), [grabbed(by, 1)]);
        assert_eq!(scene.standing.vehicles[usize::from(1 - by)].carrying, None);
    }
}

#[test]
fn a_flag_dropped_at_this_look_can_be_grabbed_at_the_next() {
    let mut scene = Scene::new(aquaticus_2023(), 2);
    assert_eq!(scene.put(2, 20.0, 40.0).look(), [grabbed(2, 0)]);
    scene.put(3, 20.0, 45.0);
    assert_eq!(scene.put(2, 60.0, -1.0).look(), [left(2), stopped_at_the_boundary(2), lost(2, 0)]);
    assert_eq!(scene.look(), [grabbed(3, 0)]);
}

#[test]
fn a_flag_captured_at_this_look_can_be_grabbed_at_the_next() {
    let mut scene = Scene::new(pyquaticus(), 2);
    assert_eq!(scene.put(0, 140.0, 40.0).look(), [grabbed(0, 1)]);
    assert_eq!(scene.put(0, 80.0, 40.0).put(1, 140.0, 40.0).look(), [captured(0, 1)]);
    assert_eq!(scene.look(), [grabbed(1, 1)]);
}

#[test]
fn both_teams_can_capture_at_once_unless_each_needs_its_own_flag() {
    for needed in [false, true] {
        let mut scene = Scene::new(Rules { capture_needs_own_flag: needed, ..aquaticus_2023() }, 1);
        assert_eq!(scene.put(0, 140.0, 40.0).put(1, 20.0, 40.0).look(), [grabbed(1, 0), grabbed(0, 1)]);
        let events = scene.put(0, 20.0, 40.0).put(1, 140.0, 40.0).look();
        assert_eq!(events, if needed { vec![] } else { vec![captured(1, 0), captured(0, 1)] });
        assert_eq!(scene.standing.score, if needed { [1, 1] } else { [3, 3] });
    }
}

#[test]
fn a_flag_returned_by_a_tag_is_home_for_a_capture_at_the_same_look() {
    let mut scene = Scene::new(Rules { capture_needs_own_flag: true, ..aquaticus_2023() }, 2);
    assert_eq!(scene.put(0, 140.0, 40.0).put(2, 20.0, 40.0).look(), [grabbed(2, 0), grabbed(0, 1)]);
    scene.put(0, 20.0, 40.0).put(1, 60.0, 60.0).put(2, 62.0, 60.0);
    assert_eq!(scene.look(), [tagged(2, 1), lost(2, 0), captured(0, 1)]);
}

#[test]
fn the_boundary_comes_before_a_tag() {
    // The boundary itself is out of the field, although it is still part of the sides.
    let mut scene = Scene::new(aquaticus_2023(), 1);
    assert_eq!(scene.put(0, 60.0, 3.0).put(1, 62.0, 0.0).look(), [left(1), stopped_at_the_boundary(1)]);
    assert_eq!(scene.standing.vehicles[0].tag_ready, SimTime::LONG_AGO);
    let mut scene = Scene::new(aquaticus_2023(), 1);
    let events = scene.put(0, 60.0, 0.0).put(1, 62.0, 3.0).look();
    assert_eq!(events, [left(0), stopped_at_the_boundary(0)], "the tagger left: it tags nobody");
}

#[test]
fn two_taggers_with_an_intruder_each_tag_both() {
    let mut scene = Scene::new(aquaticus_2023(), 2);
    scene.put(0, 60.0, 60.0).put(1, 60.0, 20.0).put(2, 65.0, 20.0).put(3, 65.0, 60.0);
    assert_eq!(scene.look(), [tagged(2, 1), tagged(3, 0)]);
}

#[test]
fn a_boat_freed_at_this_look_grabs_and_tags_at_the_next() {
    // Another flag of the first team stands in the second team's home.
    let extra = vec![crate::scene::flag(0, 145.0, 40.0)];
    let mut scene = Scene::on(aquaticus_2023(), crate::scene::field(extra), crate::scene::teams_of(1, 2));
    assert_eq!(scene.put(0, 60.0, 40.0).put(1, 65.0, 40.0).look(), [tagged(1, 0)]);
    assert_eq!(scene.put(1, 142.0, 40.0).look(), [freed(1)]);
    assert_eq!(scene.look(), [grabbed(1, 2)]);
}
