//! The four rule books that the referee must support, and checks that scenes cannot express.

use crate::scene::Scene;
use primitives::{Ned, SimTime, VehicleId};
use rules::Rules;
use std::path::Path;
use std::sync::LazyLock;

/// The shipped rule books, with a short collision distance, so that boats may be side by side, and
/// with all checks in every tick.
static SHIPPED: LazyLock<[Rules; 4]> = LazyLock::new(|| {
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let folder = tempfile::tempdir().expect("a folder for files");
    ["aquaticus_2023", "pyquaticus", "mctf_2025", "mctf_2026"].map(|name| {
        let base = "games/pav01_vs_pav01.toml";
        let rules = format!("rules/{name}.toml");
        let text = format!(
            "base = {:?}\nrules = {:?}\n",
            scenarios.join(base),
            scenarios.join(rules)
        );
        std::fs::write(folder.path().join("game.toml"), text).expect("a file in it");
        let scenario =
            scenario::load(&folder.path().join("game.toml")).unwrap_or_else(|e| panic!("{e}"));
        let looks = Rules {
            tag_look_period: SimTime::ZERO,
            flag_look_period: SimTime::ZERO,
            ..scenario.rules
        };
        Rules {
            collision_distance_m: 0.5,
            ..looks
        }
    })
});

pub(crate) fn all() -> [Rules; 4] {
    SHIPPED.clone()
}

/// The paper's rules: grab 1, capture 2 at the team's own flag, tag cooldown 10 s.
pub(crate) fn aquaticus_2023() -> Rules {
    SHIPPED[0].clone()
}

/// Pyquaticus: sequential resolution.
pub(crate) fn pyquaticus() -> Rules {
    SHIPPED[1].clone()
}

/// The 2026 competition: corners instead of flags, no keep-out, power play.
pub(crate) fn mctf_2026() -> Rules {
    SHIPPED[3].clone()
}

#[test]
fn only_pyquaticus_keeps_defenders_from_their_flag_and_only_2026_has_power_play() {
    for (rules, (keepout_m, power_plays)) in
        all()
            .into_iter()
            .zip([(None, 0), (Some(5.0), 0), (Some(5.0), 0), (None, 2)])
    {
        let scene = Scene::new(rules, 2);
        let circle = scene
            .referee
            .keepout(&scene.standing, VehicleId(0), Ned::from_xy(50.0, 40.0));
        assert_eq!(
            circle,
            keepout_m.map(|radius_m| (Ned::from_xy(20.0, 40.0), radius_m)),
            "{}",
            scene.name()
        );
        let drawn = scene
            .standing
            .disabled
            .iter()
            .filter(|(from, _)| *from < SimTime::NEVER)
            .count();
        assert_eq!(drawn, power_plays, "{}", scene.name());
    }
}

#[test]
fn the_reach_covers_tags_and_collisions() {
    for (tag_radius_m, collision_distance_m, want_m) in [(10.0, 4.0, 10.0), (1.0, 4.0, 4.0)] {
        let scene = Scene::new(
            Rules {
                tag_radius_m,
                collision_distance_m,
                ..aquaticus_2023()
            },
            1,
        );
        assert_eq!(scene.referee.rules.reach_m(), want_m);
    }
}
