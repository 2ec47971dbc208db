//! The four rule books the referee must be able to apply, and a scene that tells each from the others.

use crate::scene::{Scene, captured, freed, grabbed, tagged};
use game::link::Sharing;
use game::rules::{CaptureAt, Directive, Points, Rules, TagChoice, TaggedBoat, UntagAt, UntagOn};
use game::{Ned, SimTime, VehicleId};

/// The paper's rules: grab 1, capture 2 at the own flag, tags cool down for 10 s.
pub(crate) fn aquaticus_2023() -> Rules {
    Rules {
        name: "aquaticus_2023".into(),
        points: Points { grab: 1, capture: 2, tag: 0 },
        grab_radius_m: 10.0,
        tag_radius_m: 10.0,
        untag_radius_m: 10.0,
        capture_radius_m: 10.0,
        // Small, so that scenes may set boats down side by side.
        collision_distance_m: 0.5,
        capture_at: CaptureAt::OwnFlag,
        capture_needs_own_flag: false,
        untag_at: UntagAt::OwnFlag,
        untag_on: UntagOn::Entering,
        tag_cooldown: SimTime::from_s(10.0),
        tag_choice: TagChoice::Nearest,
        boundary_tags: true,
        tagged_boat: TaggedBoat::DrivesItself,
        tagged_speed_factor: 1.0,
        outside_speed_factor: 1.0,
        sharing: Sharing::default(),
        flag_keepout_m: 0.0,
        win_score: None,
        time_limit: SimTime::from_s(600.0),
        power_play: SimTime::ZERO,
    }
}

/// Pyquaticus: captures only, at the scrimmage line; tags cool down for 60 s.
pub(crate) fn pyquaticus() -> Rules {
    Rules {
        name: "pyquaticus".into(),
        points: Points { grab: 0, capture: 1, tag: 0 },
        capture_at: CaptureAt::OwnSide,
        untag_on: UntagOn::Inside,
        tag_cooldown: SimTime::from_s(60.0),
        tag_choice: TagChoice::First,
        tagged_boat: TaggedBoat::IsDriven,
        outside_speed_factor: 0.5,
        sharing: Sharing::default(),
        flag_keepout_m: 5.0,
        win_score: Some(20),
        ..aquaticus_2023()
    }
}

/// The 2025 competition: Pyquaticus, sailed with other boats.
pub(crate) fn mctf_2025() -> Rules {
    Rules { name: "mctf_2025".into(), ..pyquaticus() }
}

/// The 2026 competition: corners instead of flags, no keep-out, power play.
pub(crate) fn mctf_2026() -> Rules {
    Rules {
        name: "mctf_2026".into(),
        capture_at: CaptureAt::OwnCorners,
        capture_radius_m: 20.0,
        untag_at: UntagAt::OwnCorners,
        untag_radius_m: 20.0,
        tagged_speed_factor: 0.5,
        sharing: Sharing::default(),
        flag_keepout_m: 0.0,
        power_play: SimTime::from_s(120.0),
        ..mctf_2025()
    }
}

pub(crate) fn all() -> [Rules; 4] {
    [aquaticus_2023(), pyquaticus(), mctf_2025(), mctf_2026()]
}

#[test]
fn a_flag_is_captured_where_the_rules_say_and_for_the_points_they_give() {
    // Over the line, then to the own flag, then into the own corner.
    let way = [(80.0, 40.0), (20.0, 40.0), (10.0, 10.0)];
    for (rules, want_stop, want_score) in
        [(aquaticus_2023(), 1, 3), (pyquaticus(), 0, 1), (mctf_2025(), 0, 1), (mctf_2026(), 2, 1)]
    {
        let mut scene = Scene::new(Rules { power_play: SimTime::ZERO, ..rules }, 2);
        assert_eq!(scene.put(0, 140.0, 40.0).look(), [grabbed(0, 1)]);
        let stops: Vec<_> = way.iter().map(|(x, y)| scene.put(0, *x, *y).look().contains(&captured(0, 1))).collect();
        let stop = stops.iter().position(|captured| *captured);
        assert_eq!((stop, scene.standing.score[0]), (Some(want_stop), want_score), "{}", scene.name());
    }
}

#[test]
fn tags_cool_down_and_choose_as_the_rules_say() {
    for (rules, want_first, want_s) in
        [(aquaticus_2023(), 3, 10.0), (pyquaticus(), 2, 60.0), (mctf_2025(), 2, 60.0), (mctf_2026(), 2, 60.0)]
    {
        let mut scene = Scene::new(Rules { power_play: SimTime::ZERO, ..rules }, 2);
        let events = scene.put(0, 60.0, 40.0).put(2, 67.0, 40.0).put(3, 55.0, 40.0).look();
        assert_eq!(events, [tagged(want_first, 0)], "{}", scene.name());
        let second = tagged(5 - want_first, 0);
        assert_eq!(scene.wait(want_s - 0.1).look(), [], "{}", scene.name());
        assert_eq!(scene.wait(0.1).look(), [second], "{}", scene.name());
    }
}

#[test]
fn tagged_boats_are_sent_home_as_the_rules_say() {
    let (flag, corner) = (Ned::from_xy(140.0, 40.0), Ned::from_xy(160.0, 80.0));
    let driven = |to, speed_factor| Directive::DrivenHome { to, speed_factor };
    for (rules, want) in [
        (aquaticus_2023(), Directive::Free { speed_factor: 1.0 }),
        (pyquaticus(), driven(flag, 1.0)),
        (mctf_2025(), driven(flag, 1.0)),
        (mctf_2026(), driven(corner, 0.5)),
    ] {
        let mut scene = Scene::new(Rules { power_play: SimTime::ZERO, ..rules }, 1);
        assert_eq!(scene.put(0, 60.0, 50.0).put(1, 65.0, 50.0).look(), [tagged(1, 0)]);
        assert_eq!(scene.directive(1), want, "{}", scene.name());
        let home = scene.referee.rules().untag_at;
        let (x, y) = if home == UntagAt::OwnFlag { (131.0, 40.0) } else { (150.0, 70.0) };
        assert_eq!(scene.put(1, x, y).look(), [freed(1)], "{}", scene.name());
        assert_eq!(scene.directive(1), Directive::Free { speed_factor: 1.0 });
    }
}

#[test]
fn only_pyquaticus_keeps_defenders_from_their_flag_and_only_2026_has_power_play() {
    for (rules, keepout_m, power_plays) in
        [(aquaticus_2023(), None, 0), (pyquaticus(), Some(5.0), 0), (mctf_2025(), Some(5.0), 0), (mctf_2026(), None, 2)]
    {
        let scene = Scene::new(rules, 2);
        let circle = scene.referee.keepout(&scene.standing, VehicleId(0), Ned::from_xy(50.0, 40.0));
        assert_eq!(circle, keepout_m.map(|radius_m| (Ned::from_xy(20.0, 40.0), radius_m)), "{}", scene.name());
        let drawn = scene.standing.disabled.iter().filter(|(from, _)| *from < SimTime::NEVER).count();
        assert_eq!(drawn, power_plays, "{}", scene.name());
    }
}
