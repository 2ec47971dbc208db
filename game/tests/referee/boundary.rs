//! The boundary: leaving the field.

use crate::preset::{aquaticus_2023, mctf_2026, pyquaticus};
use crate::scene::{Scene, back, freed, grabbed, left, lost, stopped_at_the_boundary};
use game::SimTime;
use game::rules::{Directive, Rules};

#[test]
fn a_boat_that_leaves_is_tagged_once_and_comes_back_tagged() {
    let mut scene = Scene::new(aquaticus_2023(), 1);
    assert_eq!(scene.put(0, 50.0, 0.1).look(), []);
    assert_eq!(scene.put(0, 50.0, 0.0).look(), [left(0), stopped_at_the_boundary(0)]);
    assert_eq!(scene.put(0, 50.0, -5.0).look(), []);
    assert_eq!(scene.put(0, 50.0, 5.0).look(), [back(0)]);
    assert!(scene.standing.vehicles[0].tagged);
    assert_eq!(scene.standing.score, [0, 0], "the boundary's tags are nobody's");
    assert_eq!(scene.put(0, 50.0, -5.0).look(), [left(0)], "it is tagged already");
}

#[test]
fn without_boundary_tags_leaving_is_only_noted() {
    let mut scene = Scene::new(Rules { boundary_tags: false, ..aquaticus_2023() }, 1);
    assert_eq!(scene.put(0, 50.0, -1.0).look(), [left(0)]);
    assert_eq!(scene.put(0, 50.0, 5.0).look(), [back(0)]);
}

#[test]
fn a_carrier_that_leaves_loses_its_flag_tagged_or_not() {
    for boundary_tags in [true, false] {
        let mut scene = Scene::new(Rules { boundary_tags, ..aquaticus_2023() }, 1);
        assert_eq!(scene.put(0, 140.0, 40.0).look(), [grabbed(0, 1)]);
        let tags = if boundary_tags { vec![stopped_at_the_boundary(0)] } else { vec![] };
        assert_eq!(scene.put(0, 140.0, 80.0).look(), [vec![left(0)], tags, vec![lost(0, 1)]].concat());
        assert_eq!(scene.carrier(1), None);
    }
}

#[test]
fn nobody_grabs_from_outside() {
    let mut scene = Scene::new(Rules { boundary_tags: false, grab_radius_m: 50.0, ..aquaticus_2023() }, 1);
    assert_eq!(scene.put(0, 140.0, -1.0).look(), [left(0)]);
}

#[test]
fn a_boat_outside_is_slow() {
    let mut scene = Scene::new(Rules { boundary_tags: false, ..pyquaticus() }, 1);
    scene.put(0, 50.0, -1.0).look();
    assert_eq!(scene.directive(0), Directive::Free { speed_factor: 0.5 });
    scene.put(0, 50.0, 1.0).look();
    assert_eq!(scene.directive(0), Directive::Free { speed_factor: 1.0 });
}

#[test]
fn a_boat_that_left_near_its_corner_is_freed_on_the_field_only() {
    let mut scene = Scene::new(Rules { power_play: SimTime::ZERO, ..mctf_2026() }, 1);
    assert_eq!(scene.put(0, -1.0, 5.0).look(), [left(0), stopped_at_the_boundary(0)]);
    assert_eq!(scene.look(), []);
    assert_eq!(scene.put(0, 1.0, 5.0).look(), [back(0), freed(0)]);
}
