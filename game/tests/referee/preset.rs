//! The four rule books the referee must be able to apply, and what scenes cannot tell of them.

use crate::scene::Scene;
use game::link::Sharing;
use game::rules::{CaptureAt, Points, Rules, TagChoice, TaggedBoat, UntagAt, UntagOn};
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

#[test]
fn the_reach_covers_tags_and_collisions() {
    for (tag_radius_m, collision_distance_m, want_m) in [(10.0, 4.0, 10.0), (1.0, 4.0, 4.0)] {
        let scene = Scene::new(Rules { tag_radius_m, collision_distance_m, ..aquaticus_2023() }, 1);
        assert_eq!(scene.referee.rules().reach_m(), want_m);
    }
}
