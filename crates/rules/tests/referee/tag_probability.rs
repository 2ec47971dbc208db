//! Tags that succeed at random.

use crate::preset::pyquaticus;
use crate::scene::{Scene, tagged};
use rules::{Resolution, Rules};

const CHECKS: u32 = 10_000;

/// How often each of two defenders (0 nearer, 1 listed later) tags the same intruder in [`CHECKS`]
/// checks, and how often each attempts to.
fn counts(resolution: Resolution, tag_probability: f64) -> [[u32; 2]; 2] {
    let rules = Rules {
        resolution,
        tag_probability,
        ..pyquaticus()
    };
    let mut scene = Scene::new(rules, 2);
    scene
        .put(0, 60.0, 40.0)
        .put(1, 68.0, 40.0)
        .put(2, 62.0, 40.0);
    let before = scene.standing.clone();
    let mut counts = [[0; 2]; 2];
    for _ in 0..CHECKS {
        scene.standing = before.clone();
        let events = scene.look();
        for by in [0, 1] {
            counts[0][by] += u32::from(events.contains(&tagged(2, by as u16)));
            let waits = scene.standing.vehicles[by].tag_ready > scene.now;
            counts[1][by] += u32::from(waits);
        }
    }
    counts
}

#[test]
fn the_share_of_successful_tags_is_that_of_the_rules_and_failures_cost_the_cooldown() {
    for p in [0.0, 0.3, 0.8, 1.0] {
        // With `InTurn`, the second boat makes an attempt only if the first one failed; this agrees
        // with 20,000 checks of Pyquaticus' branch mctf2026. With `AtOnce`, only the nearest boat
        // makes an attempt.
        for (resolution, want) in [
            (Resolution::InTurn, [[p, (1.0 - p) * p], [1.0, 1.0 - p]]),
            (Resolution::AtOnce, [[p, 0.0], [1.0, 0.0]]),
        ] {
            let got = counts(resolution, p);
            for (got, want) in got.iter().flatten().zip(want.iter().flatten()) {
                let n = f64::from(CHECKS);
                // Four standard deviations of a binomial count.
                let within = 4.0 * (n * want * (1.0 - want)).sqrt();
                let error = (f64::from(*got) - n * want).abs();
                assert!(
                    error <= within + 1e-6,
                    "{p} {resolution:?}: {got} of {n}, want {want}"
                );
            }
        }
    }
}
