//! A rotated or mirrored scene must give the rotated or mirrored decision.

use crate::scene::{self, random_table, solved};
use agent::ivp::{Approach, Closest, Closing, Grid, Lag, Objective, Peak, Preference, Side, Table};
use primitives::Ned;
use primitives::stream::Stream;
use std::f64::consts::{FRAC_PI_2, PI};

/// An isometry of the plane that fixes own ship.
#[derive(Clone, Copy, Debug)]
enum Motion {
    HalfTurn,
    QuarterTurn,
    Mirror,
}

impl Motion {
    fn vector(self, Ned { north, east }: Ned) -> Ned {
        match self {
            Motion::HalfTurn => Ned {
                north: -north,
                east: -east,
            },
            Motion::QuarterTurn => Ned {
                north: -east,
                east: north,
            },
            Motion::Mirror => Ned { north, east: -east },
        }
    }

    fn angle(self, angle_rad: f64) -> f64 {
        match self {
            Motion::HalfTurn => angle_rad + PI,
            Motion::QuarterTurn => angle_rad + FRAC_PI_2,
            Motion::Mirror => -angle_rad,
        }
    }

    fn approach(self, approach: Approach) -> Approach {
        let mirrored = |side| match side {
            Side::Port => Side::Starboard,
            Side::Starboard => Side::Port,
        };
        match (self, approach) {
            (Motion::Mirror, Approach::Avoid { at_min, leave_to }) => Approach::Avoid {
                at_min,
                leave_to: leave_to.map(mirrored),
            },
            _ => approach,
        }
    }

    /// The index of course `k` of `n` after the motion.
    fn course(self, k: usize, n: usize) -> usize {
        match self {
            Motion::HalfTurn => (k + n / 2) % n,
            Motion::QuarterTurn => (k + n / 4) % n,
            Motion::Mirror => (n - k) % n,
        }
    }

    /// The index of the course of `n` that the motion maps to `k`.
    fn back(self, k: usize, n: usize) -> usize {
        match self {
            Motion::QuarterTurn => (k + n - n / 4) % n,
            _ => self.course(k, n),
        }
    }

    fn peak(self, peak: Peak) -> Peak {
        Peak {
            summit: self.angle(peak.summit),
            ..peak
        }
    }

    fn objective<'a>(self, objective: &Objective<'a>, table: &'a Table) -> Objective<'a> {
        match *objective {
            Objective::Coupled {
                course,
                speed,
                course_share,
            } => Objective::Coupled {
                course: self.peak(course),
                speed,
                course_share,
            },
            Objective::Closest(c) => {
                let turned = |lag: Lag| Lag {
                    velocity: self.vector(lag.velocity),
                    heading: self.vector(lag.heading),
                    ..lag
                };
                let offset = self.vector(c.offset);
                let velocity = self.vector(c.velocity);
                let lag = c.lag.map(turned);
                Objective::Closest(Closest {
                    offset,
                    velocity,
                    lag,
                    approach: self.approach(c.approach),
                    ..c
                })
            }
            Objective::Closing(Closing { offset, velocity }) => Objective::Closing(Closing {
                offset: self.vector(offset),
                velocity: self.vector(velocity),
            }),
            Objective::Table(_) => Objective::Table(table),
        }
    }
}

fn holds_under(motion: Motion, grid: &Grid, seed: u64) {
    let mut stream = Stream::new(seed, "ivp/symmetry");
    let table = random_table(&mut stream, grid);
    let functions = scene::functions(&mut stream, grid, &table);
    let preference = scene::preference(&mut stream, grid);
    let moved_table = Table::of(grid, |k, j| {
        table.utility(motion.back(k, grid.courses()), j)
    });
    let moved: Vec<(f64, Objective)> = functions
        .iter()
        .map(|(w, f)| (*w, motion.objective(f, &moved_table)))
        .collect();
    let mut want = solved(grid, &functions, preference);
    let got = solved(
        grid,
        &moved,
        Preference {
            course_rad: motion.angle(preference.course_rad),
            ..preference
        },
    );
    want.decision.course = motion.course(want.decision.course, grid.courses());
    // The number of evaluated points depends on the starting point of the search.
    want.evaluated = got.evaluated;
    assert_eq!(got, want, "seed {seed}, {motion:?}: {functions:?}");
}

#[test]
fn a_turned_or_mirrored_scene_gives_the_turned_or_mirrored_decision() {
    let full = Grid::new(360, 36, 3.5);
    for (motion, grid) in [
        (Motion::HalfTurn, Grid::new(90, 21, 4.0)),
        (Motion::QuarterTurn, Grid::new(72, 9, 4.0)),
        (Motion::Mirror, Grid::new(90, 21, 4.0)),
    ] {
        (0..2_000).for_each(|seed| holds_under(motion, &grid, seed));
        (0..50).for_each(|seed| holds_under(motion, &full, seed));
    }
}

#[test]
fn directions_are_exact_images_of_each_other() {
    for courses in [4, 8, 36, 90, 360, 1000] {
        let grid = Grid::new(courses, 2, 1.0);
        for k in 0..courses {
            let (north, east) = grid.direction(k);
            assert_eq!(
                grid.direction((courses - k) % courses),
                (north, 0.0 - east),
                "{k} of {courses}"
            );
            assert_eq!(
                grid.direction((k + courses / 2) % courses),
                (0.0 - north, 0.0 - east),
                "{k} of {courses}"
            );
            if courses % 4 == 0 {
                assert_eq!(
                    grid.direction((k + courses / 4) % courses),
                    (0.0 - east, north),
                    "{k} of {courses}"
                );
            }
            let (sin, cos) = primitives::math::sin_cos(grid.course_rad(k));
            assert!(
                (f64::from(north) - cos).abs() < 1e-7 && (f64::from(east) - sin).abs() < 1e-7,
                "{k}"
            );
        }
    }
}
