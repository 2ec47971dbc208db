//! The solver against the whole grid.

use crate::scene::{self, Tables, decision, points, solved};
use agent::ivp::{Approach, Choice, Closest, Closing, Decision, FUNCTIONS_MAX, Grid, Objective, Peak, Peaks};
use agent::ivp::{Problem, QUANTUM, WEIGHT_MAX, Wish};
use game::angle::wrap_pi;
use game::stream::Stream;

/// Every sum on the grid, in quanta, by course and speed.
fn sums(grid: &Grid, functions: &[(f64, Objective)]) -> Vec<i64> {
    let at = |(k, j)| functions.iter().map(|(w, f)| i64::from(f.contribution(grid, *w, k, j))).sum();
    points(grid).map(at).collect()
}

/// The best decision, the slow way: every point, and the tie-break as it is told.
fn searched(grid: &Grid, sums: &[i64], wish: Wish) -> (Decision, f64) {
    let largest = sums.iter().copied().max().expect("a grid has points");
    let key = |(k, j): (usize, usize)| {
        let away = wrap_pi(grid.course_rad(k) - wish.course_rad);
        ((away.abs(), away < 0.0), (grid.speed_m_s(j) - wish.speed_m_s).abs(), j)
    };
    let equal = points(grid).zip(sums).filter(|(_, sum)| **sum == largest).map(|(point, _)| point);
    let (k, j) = equal.min_by(|a, b| key(*a).partial_cmp(&key(*b)).expect("numbers")).expect("one is largest");
    (decision(k, j), largest as f64 * QUANTUM)
}

#[test]
fn the_solver_finds_what_a_search_of_the_whole_grid_finds() {
    let mut ties = 0;
    let mut passed_over = 0;
    for seed in 0..4_000 {
        let mut stream = Stream::new(seed, "ivp/exact");
        let grid = scene::grid(&mut stream);
        let tables = Tables::random(&mut stream, &grid);
        let functions = scene::functions(&mut stream, &grid, &tables);
        let wish = scene::wish(&mut stream, &grid);
        let sums = sums(&grid, &functions);
        let (want, value) = searched(&grid, &sums, wish);
        let got = solved(&grid, &functions, wish);
        assert_eq!((got.decision, got.value), (want, value), "seed {seed}: {functions:?} {wish:?}");
        ties += usize::from(sums.iter().filter(|&&sum| sum as f64 * QUANTUM == value).count() > 1);
        passed_over += points(&grid).count() - got.asked;
    }
    assert!(ties > 400, "{ties} scenes in which equals had to be told apart");
    assert!(passed_over > 400_000, "{passed_over} points passed over");
}

#[test]
fn the_solver_finds_the_best_of_a_full_grid_among_contacts() {
    let grid = Grid::default();
    for seed in 0..60 {
        let mut stream = Stream::new(seed, "ivp/contacts");
        let summit = stream.between(0.0, 6.0);
        let waypoint = Objective::Coupled {
            course: Peaks::one(Peak::tent(summit, 3.1)),
            speed: Peaks::one(Peak { peak_width: 1.0, summit_delta: 20.0, ..Peak::tent(2.0, 1.6) }),
            course_share: 0.5,
        };
        let mut functions = vec![(100.0, waypoint)];
        for _ in 0..3 {
            functions.push((stream.between(50.0, 300.0), Objective::Closest(scene::closest(&mut stream, &grid))));
        }
        let wish = scene::wish(&mut stream, &grid);
        let (want, value) = searched(&grid, &sums(&grid, &functions), wish);
        let got = solved(&grid, &functions, wish);
        assert_eq!((got.decision, got.value), (want, value), "seed {seed}");
    }
}

#[test]
fn the_order_of_functions_changes_nothing() {
    for seed in 0..1_000 {
        let mut stream = Stream::new(seed, "ivp/order");
        let grid = scene::grid(&mut stream);
        let tables = Tables::random(&mut stream, &grid);
        let mut functions = scene::functions(&mut stream, &grid, &tables);
        let wish = scene::wish(&mut stream, &grid);
        let first = solved(&grid, &functions, wish);
        for _ in 0..3 {
            stream.shuffle(&mut functions);
            assert_eq!(solved(&grid, &functions, wish), first, "seed {seed}");
        }
    }
}

#[test]
fn a_problem_that_was_cleared_is_as_new() {
    let grid = Grid::new(36, 9, 3.0);
    let mut old = Problem::new(grid.clone());
    for seed in 0..200 {
        let mut stream = Stream::new(seed, "ivp/again");
        let tables = Tables::random(&mut stream, &grid);
        let functions = scene::functions(&mut stream, &grid, &tables);
        let wish = scene::wish(&mut stream, &grid);
        old.clear();
        assert!(old.is_empty() && !old.decides_course() && !old.decides_speed());
        functions.iter().for_each(|(weight, objective)| old.add(*weight, objective));
        assert_eq!(old.len(), functions.len());
        let got: Choice = old.solve(wish);
        assert_eq!(got, solved(&grid, &functions, wish), "seed {seed}");
        let Decision { course, speed } = got.decision;
        assert_eq!(old.collective(course.into(), speed.into()), got.value, "seed {seed}");
    }
}

#[test]
fn without_functions_the_boat_goes_on_as_it_does() {
    let grid = Grid::default();
    let wish = Wish { course_rad: 1.0, speed_m_s: 1.23, keep: None };
    let got = Problem::new(grid.clone()).solve(wish);
    assert_eq!(got.decision, decision(grid.nearest_course(1.0), grid.nearest_speed(1.23)));
    assert_eq!((got.decision, got.value), (decision(57, 12), 0.0));
}

#[test]
fn of_equal_courses_the_one_to_starboard_and_of_equal_speeds_the_lower_is_taken() {
    let grid = Grid::new(4, 3, 2.0);
    let courses = Objective::CourseTable(&[0.0, 70.0, 0.0, 70.0]);
    let speeds = Objective::SpeedTable(&[60.0, 0.0, 60.0]);
    for (course_rad, want) in [(0.0, 1), (std::f64::consts::PI, 3), (-0.1, 3), (0.1, 1)] {
        let wish = Wish { course_rad, speed_m_s: 1.0, keep: None };
        let got = solved(&grid, &[(1.0, courses), (2.0, speeds)], wish);
        assert_eq!(got.decision, decision(want, 0), "{course_rad} rad");
        assert_eq!(got.value, 190.0);
    }
}

#[test]
fn an_earlier_decision_stays_while_it_is_nearly_as_good() {
    let grid = Grid::new(4, 2, 2.0);
    let table = [90.0, 92.0, 100.0, 10.0];
    let functions = [(3.0, Objective::CourseTable(&table))];
    for (old, share, want) in [(0, 0.05, 2), (0, 0.1, 0), (0, 0.11, 0), (1, 0.09, 1), (2, 0.0, 2), (3, 0.5, 2)] {
        let keep = Some((decision(old, 1), share));
        let got = solved(&grid, &functions, Wish { course_rad: 0.0, speed_m_s: 0.0, keep });
        assert_eq!(usize::from(got.decision.course), want, "from {old} with {share}");
        assert_eq!((got.value, got.best), (3.0 * f64::from(table[want]), 300.0));
        assert_eq!(got.is_kept, want == old, "from {old} with {share}");
    }
    let nowhere = Some((decision(9, 9), 1.0));
    assert!(!solved(&grid, &functions, Wish { keep: nowhere, ..Wish::default() }).is_kept);
    let nonsense = Some((decision(0, 0), f64::NAN));
    assert!(!solved(&grid, &functions, Wish { keep: nonsense, ..Wish::default() }).is_kept);
}

#[test]
fn as_many_functions_as_there_may_be_do_not_overflow() {
    // Speeds and courses that do not fill their lanes.
    let grid = Grid::new(9, 9, 3.0);
    let mut stream = Stream::new(1, "ivp/many");
    let far = Closest {
        north_m: 5e4,
        min_m: 0.0,
        max_m: 1.0,
        touch_m: 0.0,
        approach: Approach::Avoid { at_min: 0.0 },
        lag: None,
        ..scene::closest(&mut stream, &grid)
    };
    let functions = vec![(1e9, Objective::Closest(far)); FUNCTIONS_MAX];
    let wish = Wish { course_rad: grid.course_rad(8), speed_m_s: 9.0, keep: None };
    let got = solved(&grid, &functions, wish);
    assert_eq!((got.decision, got.value), (decision(8, 8), FUNCTIONS_MAX as f64 * WEIGHT_MAX * 100.0));
}

/// A waypoint ahead to starboard, and three contacts that cross.
#[test]
fn a_scene_is_pinned_so_that_every_machine_decides_alike() {
    let grid = Grid::new(360, 21, 4.0);
    let avoid = |north_m: f64, east_m: f64, course_deg: f64, speed_m_s: f64| {
        let (sin, cos) = game::math::sin_cos_deg(course_deg);
        Objective::Closest(Closest {
            north_m,
            east_m,
            velocity_north_m_s: speed_m_s * cos,
            velocity_east_m_s: speed_m_s * sin,
            horizon_s: 120.0,
            min_m: 10.0,
            max_m: 75.0,
            touch_m: 0.0,
            approach: Approach::Avoid { at_min: 25.0 },
            lag: None,
        })
    };
    let waypoint =
        Closing { north_m: 45.0, east_m: 70.0, velocity_north_m_s: 0.0, velocity_east_m_s: 0.0, flee: false };
    let functions = [
        (100.0, Objective::Closing(waypoint)),
        (300.0, avoid(20.0, 35.0, 250.0, 1.5)),
        (300.0, avoid(38.0, 20.0, 160.0, 1.2)),
        (300.0, avoid(5.0, 55.0, 330.0, 1.8)),
    ];
    let two = solved(&grid, &functions[..2], Wish::default());
    assert_eq!((two.decision, two.value), (decision(332, 20), 22_282.484_375));
    let four = solved(&grid, &functions, Wish::default());
    assert_eq!((four.decision, four.value), (decision(277, 9), 63_275.25));
}

#[test]
fn a_problem_tells_what_is_decided() {
    let grid = Grid::new(8, 4, 2.0);
    let peaks = Peaks::one(Peak::tent(0.0, 1.0));
    let coupled = |course_share| Objective::Coupled { course: peaks, speed: peaks, course_share };
    let cases = [
        (1.0, Objective::Course(peaks), (true, false)),
        (1.0, Objective::Speed(peaks), (false, true)),
        (1.0, coupled(0.5), (true, true)),
        (1.0, coupled(1.0), (true, false)),
        (0.0, coupled(0.5), (false, false)),
        (1.0, Objective::SpeedTable(&[1.0; 4]), (false, true)),
        (1.0, Objective::Table(&[1.0; 32]), (true, true)),
    ];
    for (weight, objective, want) in cases {
        let mut problem = Problem::new(grid.clone());
        problem.add(weight, &objective);
        assert_eq!((problem.decides_course(), problem.decides_speed()), want, "{objective:?}");
    }
}

#[test]
#[cfg(not(debug_assertions))]
fn numbers_that_are_none_count_nothing() {
    let grid = Grid::new(36, 9, 3.0);
    let mut stream = Stream::new(1, "ivp/none");
    let closest = scene::closest(&mut stream, &grid);
    let peaks = Peaks::one(Peak::tent(1.0, 1.0));
    let sound = [(10.0, Objective::Course(peaks))];
    let wish = Wish { course_rad: 1.0, speed_m_s: 1.0, keep: None };
    let want = solved(&grid, &sound, wish);
    let none = f64::NAN;
    let unsound = [
        (5.0, Objective::Closest(agent::ivp::Closest { north_m: none, ..closest })),
        (5.0, Objective::Closest(agent::ivp::Closest { horizon_s: f64::INFINITY, ..closest })),
        (5.0, Objective::Course(peaks.moved(|_| none))),
        (5.0, Objective::Speed(peaks.moved(|_| f64::INFINITY))),
        (5.0, Objective::SpeedTable(&[f32::NAN; 9])),
        (none, Objective::Speed(peaks)),
        (-3.0, Objective::Speed(peaks)),
    ];
    for bad in unsound {
        let got = solved(&grid, &[sound[0], bad], wish);
        assert_eq!((got.decision, got.value), (want.decision, want.value), "{bad:?}");
    }
}
