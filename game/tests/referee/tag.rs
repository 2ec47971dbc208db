//! Tags: who can tag whom.

use crate::preset::aquaticus_2023;
use crate::scene::{Scene, captured, freed, grabbed, lost, stopped_at_the_boundary, tagged};
use game::rules::{Points, Rules};
use game::{SimTime, VehicleId};

#[test]
fn only_an_intruder_in_reach_of_a_boat_on_its_own_side_is_tagged() {
    for (why, tagger, target, want) in [
        ("in reach", (60.0, 30.0), (69.9, 30.0), true),
        ("exactly at the radius is out of reach", (60.0, 30.0), (70.0, 30.0), false),
        ("the intruder is still on its own side", (75.0, 30.0), (80.5, 30.0), false),
        ("the intruder on the line is on its own side", (75.0, 30.0), (80.0, 30.0), false),
        ("the tagger on the line is on its own side", (80.0, 30.0), (79.9, 30.0), true),
        ("on the line both are safe", (80.0, 30.0), (80.0, 31.0), false),
        ("the tagger is abroad too: it is tagged itself, not the other", (85.0, 30.0), (86.0, 30.0), false),
    ] {
        let mut scene = Scene::new(aquaticus_2023(), 1);
        let events = scene.put(0, tagger.0, tagger.1).put(1, target.0, target.1).look();
        assert_eq!(events.contains(&tagged(1, 0)), want, "{why}: {events:?}");
    }
}

#[test]
fn team_mates_do_not_tag_each_other() {
    let mut scene = Scene::new(aquaticus_2023(), 2);
    assert_eq!(scene.put(0, 100.0, 40.0).put(1, 105.0, 40.0).look(), []);
}

#[test]
fn a_tagged_boat_neither_tags_nor_is_tagged_again() {
    let mut scene = Scene::new(aquaticus_2023(), 2);
    assert_eq!(scene.put(0, 60.0, 40.0).put(2, 65.0, 40.0).look(), [tagged(2, 0)]);
    assert_eq!(scene.put(1, 66.0, 45.0).look(), [], "boat 1 is ready, but 2 is tagged already");
    assert_eq!(scene.put(0, 120.0, 5.0).put(1, 45.0, 60.0).put(2, 115.0, 6.0).put(3, 150.0, 70.0).look(), []);
}

#[test]
fn a_boat_out_of_the_field_neither_tags_nor_is_tagged_by_opponents() {
    let rules = Rules { boundary_tags: false, ..aquaticus_2023() };
    for (tagger, target, want) in [((60.0, 1.0), (62.0, 1.0), true), ((60.0, -1.0), (62.0, 1.0), false)] {
        let mut scene = Scene::new(rules.clone(), 1);
        let events = scene.put(0, tagger.0, tagger.1).put(1, target.0, target.1).look();
        assert_eq!(events.contains(&tagged(1, 0)), want);
    }
    let mut scene = Scene::new(rules, 1);
    assert!(!scene.put(0, 60.0, 1.0).put(1, 62.0, -1.0).look().contains(&tagged(1, 0)));
    let mut scene = Scene::new(aquaticus_2023(), 1);
    assert!(scene.put(0, 60.0, 1.0).put(1, 62.0, -1.0).look().contains(&stopped_at_the_boundary(1)));
}

#[test]
fn a_tagged_carrier_drops_the_flag_at_its_home() {
    let mut scene = Scene::new(aquaticus_2023(), 1);
    assert_eq!(scene.put(1, 20.0, 40.0).look(), [grabbed(1, 0)]);
    assert_eq!(scene.put(0, 55.0, 40.0).put(1, 50.0, 40.0).look(), [tagged(1, 0), lost(1, 0)]);
    assert_eq!((scene.carrier(0), scene.standing.vehicles[1].carrying), (None, None));
    assert_eq!(scene.put(0, 45.0, 5.0).put(1, 20.0, 40.0).look(), [], "tagged boats do not grab");
    assert_eq!(scene.put(1, 140.0, 40.0).look(), [freed(1)]);
    assert_eq!(scene.put(1, 20.0, 40.0).look(), [grabbed(1, 0)]);
    assert_eq!(scene.put(1, 140.0, 40.0).look(), [captured(1, 0)]);
}

#[test]
fn a_tag_is_worth_its_points_and_only_a_tag_starts_the_cooldown() {
    let rules = Rules { points: Points { tag: 3, ..aquaticus_2023().points }, ..aquaticus_2023() };
    let mut scene = Scene::new(rules, 2);
    let ready = |scene: &Scene| scene.standing.vehicles.iter().map(|boat| boat.tag_ready).collect::<Vec<_>>();
    scene.look();
    assert_eq!(ready(&scene), [SimTime::LONG_AGO; 4]);
    assert_eq!(scene.put(0, 60.0, 40.0).put(2, 65.0, 40.0).look(), [tagged(2, 0)]);
    let (again, never) = (scene.now + SimTime::from_s(10.0), SimTime::LONG_AGO);
    assert_eq!(ready(&scene), [again, never, never, never]);
    assert_eq!(scene.standing.score, [3, 0]);
}

#[test]
fn a_boat_out_of_play_takes_no_part_and_loses_its_flag() {
    let mut scene = Scene::new(aquaticus_2023(), 1);
    assert_eq!(scene.put(1, 20.0, 40.0).look(), [grabbed(1, 0)]);
    let mut events = vec![];
    scene.referee.retire(&mut scene.standing, VehicleId(1), &mut events);
    assert_eq!(events, [lost(1, 0)]);
    for (x, y) in [(20.0, 40.0), (20.0, -40.0), (44.0, 7.0), (140.0, 40.0)] {
        let events = scene.put(1, x, y).look();
        assert!(events.iter().all(|event| matches!(event, game::Event::Collided { .. })), "{x}, {y}: {events:?}");
    }
    assert_eq!(scene.directive(1), game::rules::Directive::Hold);
}
