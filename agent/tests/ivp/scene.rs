//! Random decisions, with functions of every kind and many ties.

use agent::ivp::{Approach, Choice, Closest, Closing, Grid, Lag, Objective, Peak};
use agent::ivp::{Preference, Problem, Side, Table};
use primitives::Ned;
use primitives::instructions::Instructions;
use primitives::stream::Stream;

/// A random table of utilities.
pub(crate) fn random_table(stream: &mut Stream, grid: &Grid) -> Table {
    // Multiples of ten, to cause ties; every second course with full utility, or almost none.
    let most = [2, 20][stream.below(2) as usize];
    let is_full: Vec<bool> = (0..grid.courses())
        .map(|_| stream.below(most) == 0)
        .collect();
    let tens: Vec<u64> = (0..grid.courses() * grid.speeds())
        .map(|_| stream.below(11))
        .collect();
    Table::of(grid, |k, j| {
        if is_full[k] {
            100.0
        } else {
            10.0 * tens[k * grid.speeds() + j] as f32
        }
    })
}

/// A small grid, of any shape.
pub(crate) fn grid(stream: &mut Stream) -> Grid {
    const COURSES: [usize; 8] = [4, 7, 12, 24, 30, 36, 72, 90];
    const SPEEDS: [usize; 5] = [2, 7, 8, 9, 21];
    let courses = COURSES[stream.below(COURSES.len() as u64) as usize];
    let speeds = SPEEDS[stream.below(SPEEDS.len() as u64) as usize];
    Grid::new(courses, speeds, stream.between(0.5, 12.0))
}

/// One to five functions with their weights.
pub(crate) fn functions<'a>(
    stream: &mut Stream,
    grid: &Grid,
    table: &'a Table,
) -> Vec<(f64, Objective<'a>)> {
    let count = 1 + stream.below(5);
    let weight = |stream: &mut Stream| match stream.below(8) {
        0 => 0.0,
        1 => 1000.0,
        2 | 3 => 100.0,
        _ => stream.between(0.01, 900.0),
    };
    (0..count)
        .map(|_| (weight(stream), function(stream, grid, table)))
        .collect()
}

fn function<'a>(stream: &mut Stream, grid: &Grid, table: &'a Table) -> Objective<'a> {
    match stream.below(13) {
        0 => Objective::course(course_peak(stream)),
        1 => Objective::speed(speed_peak(stream, grid)),
        2 | 3 => Objective::Coupled {
            course: course_peak(stream),
            speed: speed_peak(stream, grid),
            course_share: [0.0, 0.3, 0.5, 1.0][stream.below(4) as usize],
        },
        4 => {
            // A limit.
            let high = stream.between(0.0, 1.1);
            let base = [0.0, stream.between(0.0, 1.1)][stream.below(2) as usize];
            let fastest_m_s = grid.speed_max_m_s();
            Objective::speed(Peak {
                peak_width: high * fastest_m_s,
                ..Peak::tent(0.0, base * fastest_m_s)
            })
        }
        5..=8 => Objective::Closest(closest(stream, grid)),
        9 | 10 => Objective::Closing(closing(stream)),
        _ => Objective::Table(table),
    }
}

fn course_peak(stream: &mut Stream) -> Peak {
    Peak {
        summit: stream.between(-7.0, 7.0),
        peak_width: stream.between(0.0, 1.0),
        base_width: stream.between(0.0, 3.0),
        summit_delta: stream.between(0.0, 60.0),
        height: [100.0, 60.0][stream.below(2) as usize],
    }
}

fn speed_peak(stream: &mut Stream, grid: &Grid) -> Peak {
    let fastest = grid.speed_max_m_s();
    Peak {
        summit: stream.between(-0.2, 1.2) * fastest,
        peak_width: stream.between(0.0, 0.5) * fastest,
        base_width: stream.between(0.0, 1.0) * fastest,
        summit_delta: stream.between(0.0, 60.0),
        height: 100.0,
    }
}

pub(crate) fn closest(stream: &mut Stream, grid: &Grid) -> Closest {
    let range = [3.0, 60.0, 400.0, 5000.0][stream.below(4) as usize];
    let speed = [0.0, 1.0, 3.0][stream.below(3) as usize] * grid.speed_max_m_s();
    let offset = within(stream, range);
    let velocity = within(stream, speed);
    let min_m = stream.between(0.0, 0.5) * range;
    Closest {
        offset,
        velocity,
        horizon_s: [0.0, 15.0, 120.0][stream.below(3) as usize],
        min_m,
        max_m: min_m + [0.0, 0.3, 1.0][stream.below(3) as usize] * range,
        touch_m: 0.0,
        approach: match stream.below(4) {
            0 => Approach::Avoid {
                at_min: 25.0,
                leave_to: None,
            },
            1 => Approach::Avoid {
                at_min: 0.0,
                leave_to: Some(Side::Port),
            },
            2 => Approach::Avoid {
                at_min: 25.0,
                leave_to: Some(Side::Starboard),
            },
            _ => Approach::Seek,
        },
        lag: (stream.below(2) == 0).then(|| lag(stream, grid)),
    }
}

fn lag(stream: &mut Stream, grid: &Grid) -> Lag {
    let (heading_east, heading_north) = primitives::math::sin_cos(stream.between(-4.0, 4.0));
    Lag {
        velocity: within(stream, grid.speed_max_m_s()),
        heading: Ned {
            north: heading_north,
            east: heading_east,
        },
        reaction_s: stream.between(0.0, 2.0),
        turn_rad_s: stream.between(0.1, 2.0),
        acceleration_m_s2: stream.between(0.1, 3.0),
        deceleration_m_s2: stream.between(0.1, 3.0),
    }
}

fn closing(stream: &mut Stream) -> Closing {
    Closing {
        offset: within(stream, 300.0),
        velocity: within(stream, 3.0),
    }
}

/// A vector with components up to `most`.
pub(crate) fn within(stream: &mut Stream, most: f64) -> Ned {
    Ned {
        north: stream.between(-most, most),
        east: stream.between(-most, most),
    }
}

/// Own ship's present motion.
pub(crate) fn preference(stream: &mut Stream, grid: &Grid) -> Preference {
    Preference {
        course_rad: stream.between(-7.0, 7.0),
        speed_m_s: stream.between(-0.1, 1.1) * grid.speed_max_m_s(),
    }
}

/// The solver's choice: identical with all instruction sets of this machine.
pub(crate) fn solved(
    grid: &Grid,
    functions: &[(f64, Objective)],
    preference: Preference,
) -> Choice {
    let with = |instructions| {
        let mut problem = Problem::with_instructions(grid.clone(), instructions);
        for (weight, objective) in functions {
            problem.add(*weight, objective);
        }
        problem.solve(preference)
    };
    let sets = Instructions::of_this_machine();
    let plainest = with(sets[0]);
    for set in &sets[1..] {
        assert_eq!(
            with(*set),
            plainest,
            "{set:?}: {functions:?} {preference:?}"
        );
    }
    plainest
}
