//! The solver compared with an exhaustive search of the grid.

use crate::scene::{self, random_table, solved};
use agent::ivp::{
    Approach, Choice, Closest, Closing, Decision, FUNCTIONS_MAX, Grid, Objective, Peak,
};
use agent::ivp::{Preference, Problem, QUANTUM, Table, WEIGHT_MAX};
use primitives::Ned;
use primitives::angle::wrap_pi;
use primitives::stream::Stream;

/// Every sum on the grid, in quanta, by course and speed.
fn sums(grid: &Grid, functions: &[(f64, Objective)]) -> Vec<i64> {
    let at = |(k, j)| {
        functions
            .iter()
            .map(|(w, f)| i64::from(f.contribution(grid, *w, k, j)))
            .sum()
    };
    grid.points().map(at).collect()
}

fn decision(course: usize, speed: usize) -> Decision {
    Decision { course, speed }
}

/// The best decision by exhaustive search, with the documented tie-break.
fn searched(grid: &Grid, sums: &[i64], preference: Preference) -> (Decision, f64) {
    let largest = sums.iter().copied().max().expect("a grid has points");
    let key = |(k, j): (usize, usize)| {
        let away = wrap_pi(grid.course_rad(k) - preference.course_rad);
        (
            (away.abs(), away < 0.0),
            (grid.speed_m_s(j) - preference.speed_m_s).abs(),
            j,
        )
    };
    let equal = grid
        .points()
        .zip(sums)
        .filter(|(_, sum)| **sum == largest)
        .map(|(point, _)| point);
    let (k, j) = equal
        .min_by(|a, b| key(*a).partial_cmp(&key(*b)).expect("values are not NaN"))
        .expect("the grid has points");
    (decision(k, j), largest as f64 * QUANTUM)
}

#[test]
fn the_solver_finds_what_a_search_of_the_whole_grid_finds_with_all_instructions() {
    let mut ties = 0;
    let mut passed_over = 0;
    for seed in 0..4_000 {
        let mut stream = Stream::new(seed, "ivp/exact");
        let grid = scene::grid(&mut stream);
        let table = random_table(&mut stream, &grid);
        let functions = scene::functions(&mut stream, &grid, &table);
        let preference = scene::preference(&mut stream, &grid);
        let sums = sums(&grid, &functions);
        let (want, value) = searched(&grid, &sums, preference);
        let got = solved(&grid, &functions, preference);
        assert_eq!(
            (got.decision, got.value),
            (want, value),
            "seed {seed}: {functions:?} {preference:?}"
        );
        ties += usize::from(
            sums.iter()
                .filter(|&&sum| sum as f64 * QUANTUM == value)
                .count()
                > 1,
        );
        passed_over += grid.points().count().saturating_sub(got.evaluated);
    }
    assert!(ties > 400, "only {ties} scenes with ties");
    assert!(passed_over > 400_000, "only {passed_over} points skipped");
}

#[test]
fn the_solver_finds_the_best_of_a_full_grid_among_contacts() {
    let grid = Grid::new(360, 36, 3.5);
    for seed in 0..60 {
        let mut stream = Stream::new(seed, "ivp/contacts");
        let summit = stream.between(0.0, 6.0);
        let waypoint = Objective::Coupled {
            course: Peak::tent(summit, 3.1),
            speed: Peak {
                peak_width: 1.0,
                summit_delta: 20.0,
                ..Peak::tent(2.0, 1.6)
            },
            course_share: 0.5,
        };
        let mut functions = vec![(100.0, waypoint)];
        for _ in 0..3 {
            functions.push((
                stream.between(50.0, 300.0),
                Objective::Closest(scene::closest(&mut stream, &grid)),
            ));
        }
        let preference = scene::preference(&mut stream, &grid);
        let (want, value) = searched(&grid, &sums(&grid, &functions), preference);
        let got = solved(&grid, &functions, preference);
        assert_eq!((got.decision, got.value), (want, value), "seed {seed}");
    }
}

#[test]
fn the_order_of_functions_changes_nothing() {
    for seed in 0..1_000 {
        let mut stream = Stream::new(seed, "ivp/order");
        let grid = scene::grid(&mut stream);
        let table = random_table(&mut stream, &grid);
        let mut functions = scene::functions(&mut stream, &grid, &table);
        let preference = scene::preference(&mut stream, &grid);
        let first = solved(&grid, &functions, preference);
        for _ in 0..3 {
            stream.shuffle(&mut functions);
            assert_eq!(solved(&grid, &functions, preference), first, "seed {seed}");
        }
    }
}

#[test]
fn a_problem_that_was_cleared_is_as_new() {
    let grid = Grid::new(36, 9, 3.0);
    let mut old = Problem::new(grid.clone());
    for seed in 0..200 {
        let mut stream = Stream::new(seed, "ivp/again");
        let table = random_table(&mut stream, &grid);
        let functions = scene::functions(&mut stream, &grid, &table);
        let preference = scene::preference(&mut stream, &grid);
        old.clear();
        assert!(old.is_empty() && !old.decides_course && !old.decides_speed);
        functions
            .iter()
            .for_each(|(weight, objective)| old.add(*weight, objective));
        assert_eq!(old.len(), functions.len());
        let got: Choice = old.solve(preference);
        let want = solved(&grid, &functions, preference);
        // The solver starts from its previous result, so the number of evaluated points varies.
        assert_eq!(
            got,
            Choice {
                evaluated: got.evaluated,
                ..want
            },
            "seed {seed}"
        );
    }
}

#[test]
fn without_functions_the_boat_goes_on_as_it_does() {
    let grid = Grid::new(360, 36, 3.5);
    let preference = Preference {
        course_rad: 1.0,
        speed_m_s: 1.23,
    };
    let got = Problem::new(grid.clone()).solve(preference);
    assert_eq!((got.decision, got.value), (decision(57, 12), 0.0));
}

#[test]
fn of_equal_courses_the_one_to_starboard_and_of_equal_speeds_the_lower_is_taken() {
    let grid = Grid::new(4, 3, 2.0);
    let courses = Table::of(&grid, |k, _| [0.0, 70.0, 0.0, 70.0][k]);
    let speeds = Table::of(&grid, |_, j| [60.0, 0.0, 60.0][j]);
    for (course_rad, want) in [(0.0, 1), (std::f64::consts::PI, 3), (-0.1, 3), (0.1, 1)] {
        let preference = Preference {
            course_rad,
            speed_m_s: 1.0,
        };
        let got = solved(
            &grid,
            &[
                (1.0, Objective::Table(&courses)),
                (2.0, Objective::Table(&speeds)),
            ],
            preference,
        );
        assert_eq!(got.decision, decision(want, 0), "{course_rad} rad");
        assert_eq!(got.value, 190.0);
    }
}

#[test]
fn as_many_functions_as_there_may_be_do_not_overflow() {
    // Speeds and courses that do not fill their lanes.
    let grid = Grid::new(9, 9, 3.0);
    let mut stream = Stream::new(1, "ivp/many");
    let far = Closest {
        offset: Ned {
            north: 5e4,
            east: 0.0,
        },
        min_m: 0.0,
        max_m: 1.0,
        touch_m: 0.0,
        approach: Approach::Avoid {
            at_min: 0.0,
            leave_to: None,
        },
        lag: None,
        ..scene::closest(&mut stream, &grid)
    };
    let functions = vec![(1e9, Objective::Closest(far)); FUNCTIONS_MAX];
    let preference = Preference {
        course_rad: grid.course_rad(8),
        speed_m_s: 9.0,
    };
    let got = solved(&grid, &functions, preference);
    assert_eq!(
        (got.decision, got.value),
        (decision(8, 8), FUNCTIONS_MAX as f64 * WEIGHT_MAX * 100.0)
    );
}

/// A waypoint ahead to starboard, and three crossing contacts.
#[test]
fn a_scene_is_pinned_so_that_every_machine_decides_alike() {
    let grid = Grid::new(360, 21, 4.0);
    let avoid = |north: f64, east: f64, course_deg: f64, speed_m_s: f64| {
        Objective::Closest(Closest {
            offset: Ned { north, east },
            velocity: Ned::toward_deg(course_deg).scaled(speed_m_s),
            horizon_s: 120.0,
            min_m: 10.0,
            max_m: 75.0,
            touch_m: 0.0,
            approach: Approach::Avoid {
                at_min: 25.0,
                leave_to: None,
            },
            lag: None,
        })
    };
    let waypoint = Closing {
        offset: Ned {
            north: 45.0,
            east: 70.0,
        },
        velocity: Ned::default(),
    };
    let functions = [
        (100.0, Objective::Closing(waypoint)),
        (300.0, avoid(20.0, 35.0, 250.0, 1.5)),
        (300.0, avoid(38.0, 20.0, 160.0, 1.2)),
        (300.0, avoid(5.0, 55.0, 330.0, 1.8)),
    ];
    let two = solved(&grid, &functions[..2], Preference::default());
    assert_eq!(
        (two.decision, two.value),
        (decision(332, 20), 22_282.484_375)
    );
    let four = solved(&grid, &functions, Preference::default());
    assert_eq!((four.decision, four.value), (decision(277, 9), 63_275.25));
}

#[test]
fn a_problem_tells_what_is_decided() {
    let grid = Grid::new(8, 4, 2.0);
    let peak = Peak::tent(0.0, 1.0);
    let coupled = |course_share| Objective::Coupled {
        course: peak,
        speed: peak,
        course_share,
    };
    let table = Table::of(&grid, |_, _| 1.0);
    let cases = [
        (1.0, Objective::course(peak), (true, false)),
        (1.0, Objective::speed(peak), (false, true)),
        (1.0, coupled(0.5), (true, true)),
        (1.0, coupled(1.0), (true, false)),
        (0.0, coupled(0.5), (false, false)),
        (1.0, Objective::Table(&table), (true, true)),
    ];
    for (weight, objective, want) in cases {
        let mut problem = Problem::new(grid.clone());
        problem.add(weight, &objective);
        assert_eq!(
            (problem.decides_course, problem.decides_speed),
            want,
            "{objective:?}"
        );
    }
}

#[test]
#[cfg(not(debug_assertions))]
fn numbers_that_are_not_finite_count_nothing() {
    let grid = Grid::new(36, 9, 3.0);
    let mut stream = Stream::new(1, "ivp/nan");
    let closest = scene::closest(&mut stream, &grid);
    let peak = Peak::tent(1.0, 1.0);
    let sound = [(10.0, Objective::course(peak))];
    let preference = Preference {
        course_rad: 1.0,
        speed_m_s: 1.0,
    };
    let want = solved(&grid, &sound, preference);
    let nan = f64::NAN;
    let no_numbers = Table::of(&grid, |_, _| f32::NAN);
    let unsound = [
        (
            5.0,
            Objective::Closest(Closest {
                offset: Ned {
                    north: nan,
                    east: 0.0,
                },
                ..closest
            }),
        ),
        (
            5.0,
            Objective::Closest(Closest {
                horizon_s: f64::INFINITY,
                ..closest
            }),
        ),
        (
            5.0,
            Objective::course(Peak {
                summit: nan,
                ..peak
            }),
        ),
        (
            5.0,
            Objective::speed(Peak {
                summit: f64::INFINITY,
                ..peak
            }),
        ),
        (
            5.0,
            Objective::speed(Peak {
                peak_width: nan,
                ..peak
            }),
        ),
        (5.0, Objective::Table(&no_numbers)),
        (nan, Objective::speed(peak)),
        (-3.0, Objective::speed(peak)),
    ];
    for bad in unsound {
        let got = solved(&grid, &[sound[0], bad], preference);
        assert_eq!(
            (got.decision, got.value),
            (want.decision, want.value),
            "{bad:?}"
        );
    }
}
