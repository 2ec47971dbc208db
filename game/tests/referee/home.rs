//! Home: how tagged boats are freed.

use crate::preset::{aquaticus_2023, mctf_2026, pyquaticus};
use crate::scene::{Scene, freed, tagged};
use game::SimTime;
use game::rules::{Rules, UntagOn};

fn corners(untag_on: UntagOn) -> Rules {
    Rules { power_play: SimTime::ZERO, untag_on, ..mctf_2026() }
}

#[test]
fn a_tagged_boat_is_freed_at_its_home() {
    for (rules, x, y, want) in [
        (aquaticus_2023(), 130.0, 40.0, false),
        (aquaticus_2023(), 130.1, 40.0, true),
        (pyquaticus(), 130.1, 40.0, true),
        (pyquaticus(), 20.0, 40.0, false),
        (corners(UntagOn::Inside), 140.0, 40.0, false),
        (corners(UntagOn::Inside), 145.0, 70.0, true),
        (corners(UntagOn::Entering), 145.0, 10.0, true),
        (corners(UntagOn::Inside), 15.0, 10.0, false),
    ] {
        let mut scene = Scene::new(rules, 1);
        assert_eq!(scene.put(0, 60.0, 40.0).put(1, 65.0, 40.0).look(), [tagged(1, 0)]);
        let events = scene.put(1, x, y).look();
        assert_eq!(events, if want { vec![freed(1)] } else { vec![] }, "{} {x} {y}", scene.name());
        assert_eq!(scene.standing.vehicles[1].tagged, !want);
    }
}

#[test]
fn a_boat_tagged_inside_its_home_must_leave_and_come_back_unless_being_there_is_enough() {
    // A home so large that it reaches over the line.
    let rules = |untag_on| Rules { untag_radius_m: 90.0, untag_on, ..aquaticus_2023() };
    for (on, want_staying, want_coming_back) in
        [(UntagOn::Entering, vec![], vec![freed(1)]), (UntagOn::Inside, vec![freed(1)], vec![])]
    {
        let mut scene = Scene::new(rules(on), 1);
        scene.put(1, 65.0, 40.0).look();
        assert_eq!(scene.put(0, 60.0, 40.0).look(), [tagged(1, 0)], "tagged and not freed at once");
        assert_eq!(scene.put(0, 45.0, 5.0).look(), want_staying);
        assert_eq!(scene.put(1, 45.0, 40.0).look(), []);
        assert_eq!(scene.put(1, 65.0, 40.0).look(), want_coming_back);
    }
}

#[test]
fn a_boat_tagged_as_it_comes_home_must_leave_and_come_back() {
    let mut scene = Scene::new(Rules { untag_radius_m: 90.0, ..aquaticus_2023() }, 1);
    scene.put(1, 45.0, 40.0).look();
    assert_eq!(scene.put(0, 60.0, 40.0).put(1, 65.0, 40.0).look(), [tagged(1, 0)]);
    assert_eq!(scene.look(), []);
}
