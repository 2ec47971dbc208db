//! The quality of synthetic tracks with known results.

use super::encounter::Nearness;
use super::*;
use messages::picture::Nav;
use primitives::SimTime;
use rules::event::{Event, Logged, TagCause};
use std::path::Path;

/// Two blue boats with the two roles of Pav01, then two red ones, on a field that extends 160 m
/// east and 80 m north of the datum.
fn scenario() -> Scenario {
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/games/pav01_vs_pav01.toml");
    scenario::load(&file).unwrap_or_else(|e| panic!("{e}"))
}

/// At rest in the middle of their own half, teammates 30 m apart.
fn at_rest(i: usize) -> Sample {
    let nav = Nav {
        north_m: [25.0, 55.0][i % 2],
        east_m: [40.0, 120.0][i / 2],
        ..Nav::default()
    };
    Sample {
        truth: nav,
        is_free: true,
        ..Sample::default()
    }
}

fn in_mode(role: &str, mode: &str) -> MindState {
    MindState {
        role: role.to_owned(),
        mode: mode.to_owned(),
    }
}

/// The quality of a game of `steps` steps of 0.1 s, in which all boats rest in mode `m` unless
/// `change` alters that.
fn quality(
    steps: usize,
    change: impl Fn(usize, &mut [Sample], &mut [Option<MindState>], &mut Vec<Logged>),
) -> Quality {
    let scenario = scenario();
    let mut game = GameQuality::new(&scenario);
    for step in 0..=steps {
        let mut samples: Vec<Sample> = (0..4).map(at_rest).collect();
        let mut minds: Vec<_> = ["a", "b", "a", "b"]
            .map(|role| Some(in_mode(role, "m")))
            .to_vec();
        let mut events = vec![];
        change(step, &mut samples, &mut minds, &mut events);
        game.add(
            &Step {
                time_s: step as f64 / 10.0,
                samples,
                events,
                ..Step::default()
            },
            &minds,
        );
    }
    game.end()
}

fn mode<'a>(quality: &'a Quality, role: &str, mode: &str) -> &'a ModeQuality {
    &quality.strategies["pav01"].roles[role].modes[mode]
}

fn steer(heading_deg: f64, speed_m_s: f64) -> Order {
    Order::Steer {
        heading_rad: heading_deg.to_radians(),
        speed_m_s,
    }
}

#[test]
fn a_square_is_four_jumps_a_round_and_a_circle_is_none() {
    // Two minutes; a side takes 10 s, one lap 40 s.
    let square = quality(1200, |step, samples, _, _| {
        samples[0].order = steer(90.0 * (step / 100) as f64, 2.0);
        samples[1].order = steer(360.0 * step as f64 / 400.0, 2.0);
    });
    let a = mode(&square, "a", "m");
    assert_eq!(
        (a.course_jumps, a.speed_jumps, a.begun),
        (12, 0, 2),
        "two boats have the role"
    );
    assert!((a.time_s - 240.0).abs() < 1e-9 && (square.time_s - 120.0).abs() < 1e-9);
    assert_eq!(mode(&square, "b", "m").course_jumps, 0);
}

#[test]
fn only_what_is_more_than_45_degrees_or_1_m_s_jumps_and_only_in_the_same_mode() {
    for (what, first, second, want) in [
        (
            "44 degrees across north",
            steer(340.0, 2.0),
            steer(24.0, 2.0),
            (0, 0),
        ),
        (
            "46 degrees across north",
            steer(340.0, 2.0),
            steer(26.0, 2.0),
            (1, 0),
        ),
        ("0.9 m/s", steer(0.0, 2.0), steer(0.0, 1.1), (0, 0)),
        ("1.1 m/s", steer(0.0, 2.0), steer(0.0, 0.9), (0, 1)),
        ("both", steer(0.0, 2.0), steer(180.0, 0.0), (1, 1)),
        ("a stop", steer(0.0, 2.0), Order::Hold, (0, 1)),
    ] {
        for (changes_mode, want) in [(false, want), (true, (0, 0))] {
            let got = quality(10, |step, samples, minds, _| {
                samples[0].order = if step < 5 { first } else { second };
                if changes_mode && step >= 5 {
                    minds[0] = Some(in_mode("a", "n"));
                }
            });
            let modes: Vec<&ModeQuality> =
                got.strategies["pav01"].roles["a"].modes.values().collect();
            let jumps = modes.iter().fold((0, 0), |sum, m| {
                (sum.0 + m.course_jumps, sum.1 + m.speed_jumps)
            });
            assert_eq!(jumps, want, "{what}, in another mode: {changes_mode}");
        }
    }
}

#[test]
fn standing_still_and_the_edge_are_told_by_speed_and_place() {
    let got = quality(100, |step, samples, minds, _| {
        samples[0].truth.surge_m_s = if step <= 50 { 0.3 } else { 0.1 };
        samples[2].truth.surge_m_s = 1.0;
        // 2.9 m from the edge, then 3.1 m; the other boat is always beyond it.
        samples[0].truth.north_m = if step <= 30 { 2.9 } else { 3.1 };
        samples[2].truth.north_m = 85.0;
        minds[2] = None;
    });
    let a = mode(&got, "a", "m");
    let other = mode(&got, "unknown", "unknown");
    assert!(
        (a.standing_s - 5.0).abs() < 1e-9 && (a.edge_s - 3.0).abs() < 1e-9,
        "{a:?}"
    );
    assert!(
        other.standing_s == 0.0 && (other.edge_s - 10.0).abs() < 1e-9,
        "{other:?}"
    );
}

/// One boat comes alongside another at a step, stays for a second, and leaves.
fn visit(
    samples: &mut [Sample],
    step: usize,
    (begin, boat, other, gap_m): (usize, usize, usize, f64),
) {
    if (begin..begin + 10).contains(&step) {
        let Nav {
            north_m, east_m, ..
        } = samples[other].truth;
        samples[boat].truth = Nav {
            north_m,
            east_m: east_m + gap_m,
            ..Nav::default()
        };
    }
}

#[test]
fn encounters_are_told_by_nearness_and_relation() {
    // Surveyors are 0.91 m wide, and less than 3 m is a near miss. The tag is at 8 s.
    let visits = [
        (10, 0, 1, 0.9),  // teammates, touching
        (30, 0, 1, 1.5),  // teammates, near
        (50, 0, 2, 2.9),  // enemies, near
        (70, 0, 2, 3.1),  // enemies, not so near
        (90, 0, 3, 0.5),  // tagged and tagger, touching
        (120, 3, 0, 1.5), // tagger and tagged, near
        (140, 1, 2, 0.5), // two others, touching
        (190, 0, 3, 0.5), // tagged and tagger, touching when the tag is 11 s old
    ];
    let got = quality(300, |step, samples, _, events| {
        visits.into_iter().for_each(|of| visit(samples, step, of));
        if step == 80 {
            let cause = TagCause::Opponent(VehicleId(3));
            events.push(Logged {
                tick: 0,
                at: SimTime::from_s(8.0),
                event: Event::Tagged {
                    vehicle: VehicleId(0),
                    cause,
                },
            });
        }
    });
    let nearness = |contacts, near_misses| Nearness {
        contacts,
        near_misses,
    };
    let want = Encounters {
        mate: nearness(1, 1),
        enemy: nearness(2, 1),
        tagger_and_tagged: nearness(1, 1),
    };
    assert_eq!(got.encounters, want);
    // Both sides have the same strategy, and each counts; an encounter of teammates counts once.
    assert_eq!(
        got.strategies["pav01"].encounters.all(),
        nearness(1 + 2 * 3, 1 + 2 * 2)
    );
}

#[test]
fn one_that_bounces_is_one_encounter_and_an_open_one_counts_at_the_end() {
    let bounce = quality(100, |step, samples, _, _| {
        let gap_m = if step % 10 < 5 { 0.8 } else { 3.5 };
        samples[0].truth.north_m = samples[1].truth.north_m;
        samples[0].truth.east_m = samples[1].truth.east_m + gap_m;
    });
    assert_eq!(
        bounce.encounters.mate,
        Nearness {
            contacts: 1,
            near_misses: 0
        }
    );
    // An encounter of two teammates with one strategy counts once.
    assert_eq!(
        bounce.strategies["pav01"].encounters.mate,
        Nearness {
            contacts: 1,
            near_misses: 0
        }
    );
}

#[test]
fn a_team_attacks_while_a_free_boat_is_beyond_its_side_or_a_flag_is_carried() {
    let got = quality(100, |step, samples, _, _| {
        // Blue: 2 s beyond its side, 3 s there but tagged, 1 s with a flag on its own side.
        samples[0].truth.east_m = if step <= 50 { 100.0 } else { 40.0 };
        samples[0].is_free = step <= 20;
        samples[0].tagged = step > 20;
        samples[1].carrying = step > 90;
    });
    let pav01 = &got.strategies["pav01"];
    assert!((pav01.time_s - 20.0).abs() < 1e-9 && pav01.teams == 2);
    // Blue for 7 s, red for all 10 s.
    assert!((pav01.nobody_attacks_s - 17.0).abs() < 1e-9, "{pav01:?}");
}

#[test]
fn a_boat_that_goes_round_and_round_is_in_an_orbit() {
    let got = quality(1000, |step, samples, _, _| {
        let (sin, cos) = primitives::math::sin_cos(std::f64::consts::TAU * step as f64 / 180.0);
        samples[0].truth.north_m += 4.0 * sin;
        samples[0].truth.east_m += 4.0 * cos;
    });
    let role = &got.strategies["pav01"].roles["a"];
    assert!(
        role.orbits == 1 && (role.orbit_s - 100.0).abs() < 1.0 + 1e-9,
        "{role:?}"
    );
    assert_eq!(got.strategies["pav01"].roles["b"].orbits, 0);
}

#[test]
fn games_add_up_and_the_text_fits_a_terminal() {
    let one = quality(100, |_, samples, _, _| samples[0].order = steer(0.0, 1.0));
    let mut sum = Quality::default();
    (0..3).for_each(|_| sum.merge(&one));
    assert_eq!((sum.games, sum.strategies["pav01"].teams), (3, 6));
    assert!((sum.time_s - 30.0).abs() < 1e-9);
    assert!((mode(&sum, "a", "m").time_s - 60.0).abs() < 1e-9);
    let text = sum.to_string();
    assert!(
        text.starts_with("quality of play in 3 games, 0.0 h\n"),
        "{text}"
    );
    for line in text.lines() {
        assert!(line.chars().count() <= 80, "{line:?}");
    }
}
