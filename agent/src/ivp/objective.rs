//! An objective function: one behaviour's preference for course and speed.

use super::closest::{self, Closest};
use super::closing::{self, Closing};
use super::fixed::{self, Weight};
use super::grid::Grid;
use super::peak::Peak;
use super::table::Table;

/// A utility of 0 to 100 for each course and speed.
///
/// Non-finite numbers count as zero utility (a debug build panics). `Coupled` is almost free; the
/// others are evaluated point by point.
#[derive(Clone, Copy, Debug)]
pub enum Objective<'a> {
    /// The sum of a function of course and a function of speed.
    Coupled {
        /// Preference for the course.
        course: Peak,
        /// Preference for the speed.
        speed: Peak,
        /// The course's fraction of the utility, 0 to 1; the rest is the speed's.
        course_share: f64,
    },
    /// Distance at the closest point of approach to a contact.
    Closest(Closest),
    /// Closing speed.
    Closing(Closing),
    /// Utilities in a table.
    Table(&'a Table),
}

impl Objective<'_> {
    /// A function of the course only.
    pub fn course(course: Peak) -> Objective<'static> {
        Objective::Coupled {
            course,
            speed: Peak::default(),
            course_share: 1.0,
        }
    }

    /// A function of the speed only.
    pub fn speed(speed: Peak) -> Objective<'static> {
        Objective::Coupled {
            course: Peak::default(),
            speed,
            course_share: 0.0,
        }
    }

    /// Whether the function distinguishes courses.
    pub fn decides_course(&self) -> bool {
        match self {
            Objective::Coupled { course_share, .. } => *course_share > 0.0,
            _ => true,
        }
    }

    /// Whether the function distinguishes speeds.
    pub fn decides_speed(&self) -> bool {
        match self {
            Objective::Coupled { course_share, .. } => *course_share < 1.0,
            _ => true,
        }
    }

    /// The utility of course `k` at speed `j`, in the solver's arithmetic.
    ///
    /// # Panics
    /// If `k` or `j` is outside the grid, or with a table of a different size.
    pub fn utility(&self, grid: &Grid, k: usize, j: usize) -> f32 {
        assert!(
            k < grid.courses() && j < grid.speeds(),
            "course {k}, speed {j}"
        );
        match self.parts(grid) {
            Parts::Separable(Separable {
                course,
                speed,
                share,
            }) => {
                let course = course.of_course(grid, k);
                let speed = speed.of_speed(grid, j);
                // This sum is for display only: the search adds the two parts as integers, each
                // with its own weight, as in `contribution`.
                (f64::from(course) * share + f64::from(speed) * (1.0 - share)) as f32
            }
            Parts::Field(field) => {
                let (north, east) = grid.direction(k);
                field.utility(north, east, grid.speed_m_s(j) as f32)
            }
            Parts::Table(table) => fixed::single(table.utility(k, j)),
            Parts::Nothing => 0.0,
        }
    }

    /// The function's contribution to the sum at course `k` and speed `j`, in steps of
    /// [`QUANTUM`](super::QUANTUM): the rounded weighted utility. For `Coupled` the two parts are
    /// rounded separately.
    pub fn contribution(&self, grid: &Grid, weight: f64, k: usize, j: usize) -> i32 {
        let weight = Weight::new(weight);
        match self.parts(grid) {
            Parts::Separable(separable) => {
                let (of_course, of_speed) = separable.weights(weight);
                of_course.quanta(separable.course.of_course(grid, k))
                    + of_speed.quanta(separable.speed.of_speed(grid, j))
            }
            _ => weight.quanta(self.utility(grid, k, j)),
        }
    }

    /// How the solver evaluates the function.
    pub(super) fn parts(&self, grid: &Grid) -> Parts<'_> {
        let field = |field: Option<Field>| field.map_or(Parts::Nothing, Parts::Field);
        let fastest_m_s = grid.speed_max_m_s();
        match self {
            Objective::Coupled {
                course,
                speed,
                course_share,
            } => {
                let share = if course_share.is_finite() {
                    course_share.clamp(0.0, 1.0)
                } else {
                    0.0
                };
                Parts::Separable(Separable {
                    course,
                    speed,
                    share,
                })
            }
            Objective::Closest(closest) => field(closest.ready(fastest_m_s).map(Field::Closest)),
            Objective::Closing(closing) => field(closing.ready(fastest_m_s).map(Field::Closing)),
            Objective::Table(table) => {
                let found = (table.courses, table.speeds);
                let size = (grid.courses(), grid.speeds());
                // A bug in the caller, not a fault in a file: a table of a different grid would be
                // read beyond its end.
                assert!(
                    found == size,
                    "table of {found:?} courses and speeds, expected {size:?}"
                );
                Parts::Table(table)
            }
        }
    }
}

/// How a function is evaluated.
pub(super) enum Parts<'a> {
    Separable(Separable<'a>),
    /// A formula in course and speed.
    Field(Field),
    /// A table over course and speed.
    Table(&'a Table),
    /// A function with a non-finite number.
    Nothing,
}

/// A function of course plus a function of speed.
pub(super) struct Separable<'a> {
    pub(super) course: &'a Peak,
    pub(super) speed: &'a Peak,
    /// The course's fraction of the utility, 0 to 1.
    share: f64,
}

impl Separable<'_> {
    /// The weights of course and speed.
    pub(super) fn weights(&self, weight: Weight) -> (Weight, Weight) {
        (weight.share(self.share), weight.share(1.0 - self.share))
    }
}

/// A formula in course and speed.
#[derive(Clone, Copy, Debug)]
pub(super) enum Field {
    Closest(closest::Ready),
    Closing(closing::Ready),
}

impl Field {
    /// Utility of a course (a unit vector) at a speed (m/s).
    pub(super) fn utility(&self, north: f32, east: f32, speed: f32) -> f32 {
        match self {
            Field::Closest(ready) => ready.utility(north, east, speed),
            Field::Closing(ready) => ready.utility(north, east, speed),
        }
    }
}
