//! Flags: grabs and captures.

use crate::preset::{aquaticus_2023, mctf_2026, pyquaticus};
use crate::scene::{Scene, captured, grabbed};
use game::SimTime;
use game::rules::Rules;

fn mctf_without_power_play() -> Rules {
    Rules { power_play: SimTime::ZERO, ..mctf_2026() }
}

#[test]
fn a_flag_is_grabbed_by_coming_near() {
    for (x, want) in [(130.1, true), (130.0, false), (140.0, true), (149.9, true), (150.0, false)] {
        let mut scene = Scene::new(aquaticus_2023(), 1);
        let events = scene.put(0, x, 40.0).look();
        assert_eq!(events.contains(&grabbed(0, 1)), want, "{x}");
        assert_eq!(scene.standing.score, [u32::from(want), 0]);
    }
}

#[test]
fn nobody_grabs_the_own_flag_or_one_that_is_carried() {
    let mut scene = Scene::new(aquaticus_2023(), 2);
    assert_eq!(scene.put(0, 20.0, 40.0).look(), []);
    assert_eq!(scene.put(0, 140.0, 40.0).look(), [grabbed(0, 1)]);
    assert_eq!(scene.put(1, 140.0, 46.0).look(), []);
    assert_eq!(scene.carrier(1), Some(0));
}

#[test]
fn a_capture_needs_the_right_place() {
    let aquaticus = aquaticus_2023;
    for (rules, x, y, want) in [
        (aquaticus(), 79.0, 40.0, false),
        (aquaticus(), 30.0, 40.0, false),
        (aquaticus(), 29.9, 40.0, true),
        (pyquaticus(), 80.1, 40.0, false),
        (pyquaticus(), 80.0, 40.0, true),
        (mctf_without_power_play(), 20.0, 40.0, false),
        (mctf_without_power_play(), 19.9, 0.1, true),
        (mctf_without_power_play(), 0.1, 60.1, true),
        (mctf_without_power_play(), 140.1, 0.1, false),
    ] {
        let mut scene = Scene::new(rules, 1);
        scene.put(0, 140.0, 40.0).put(1, 100.0, 60.0).look();
        assert_eq!(scene.put(0, x, y).look().contains(&captured(0, 1)), want, "{} {x} {y}", scene.name());
        assert_eq!(scene.carrier(1).is_none(), want);
    }
}

#[test]
fn a_capture_may_need_the_own_flag_at_home() {
    for needed in [false, true] {
        let mut scene = Scene::new(Rules { capture_needs_own_flag: needed, ..aquaticus_2023() }, 2);
        assert_eq!(scene.put(0, 140.0, 40.0).put(2, 20.0, 40.0).look(), [grabbed(2, 0), grabbed(0, 1)]);
        let events = scene.put(2, 100.0, 60.0).put(0, 20.0, 40.0).look();
        assert_eq!(events, if needed { vec![] } else { vec![captured(0, 1)] });
        if needed {
            assert_eq!(scene.put(1, 70.0, 60.0).put(2, 75.0, 60.0).look().last(), Some(&captured(0, 1)));
        }
    }
}

#[test]
fn a_grab_at_the_place_of_capture_counts_as_a_capture_one_look_later() {
    let mut scene = Scene::new(Rules { grab_radius_m: 70.0, ..pyquaticus() }, 1);
    assert_eq!(scene.put(0, 75.0, 40.0).look(), [grabbed(0, 1)]);
    assert_eq!(scene.look(), [captured(0, 1)]);
    assert_eq!(scene.look(), [grabbed(0, 1)]);
}
