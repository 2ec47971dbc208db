//! An objective function: what one behaviour would like of course and speed.

use super::closest::{self, Closest};
use super::closing::{self, Closing};
use super::fixed::{self, Weight};
use super::grid::Grid;
use super::limit::SpeedLimit;
use super::peak::Peak;
use super::table::Table;

/// A utility of 0 to 100 for each course and speed.
///
/// Non-finite numbers count as no utility at all (a debug build stops at them). `Course`, `Speed`, `Coupled` and `Limit`
/// cost next to nothing; the others are evaluated point by point.
#[derive(Clone, Copy, Debug)]
pub enum Objective<'a> {
    /// Of course alone.
    Course(Peak),
    /// Of speed alone.
    Speed(Peak),
    /// Of course and speed, added.
    Coupled {
        /// What it would like of course.
        course: Peak,
        /// What it would like of speed.
        speed: Peak,
        /// How much of the utility the course makes, 0 to 1; the speed makes the rest.
        course_share: f64,
    },
    /// A speed limit.
    Limit(SpeedLimit),
    /// Distance at the closest point of approach to a contact.
    Closest(Closest),
    /// Rate of closure.
    Closing(Closing),
    /// Utilities in a table.
    Table(&'a Table),
}

impl Objective<'_> {
    /// Whether it tells courses from each other.
    #[must_use]
    pub fn decides_course(&self) -> bool {
        match self {
            Objective::Speed(_) | Objective::Limit(_) => false,
            Objective::Coupled { course_share, .. } => *course_share > 0.0,
            _ => true,
        }
    }

    /// Whether it tells speeds from each other.
    #[must_use]
    pub fn decides_speed(&self) -> bool {
        match self {
            Objective::Course(_) => false,
            Objective::Coupled { course_share, .. } => *course_share < 1.0,
            _ => true,
        }
    }

    /// The utility of course `k` at speed `j`, in the arithmetic of the solver.
    ///
    /// # Panics
    /// Beyond the grid, and with a table that is not of its size.
    #[must_use]
    pub fn utility(&self, grid: &Grid, k: usize, j: usize) -> f32 {
        assert!(k < grid.courses() && j < grid.speeds(), "course {k}, speed {j}");
        match self.parts(grid) {
            Parts::Separable => {
                let (course, speed, share) = (self.of_course(grid, k), self.of_speed(grid, j), self.course_share());
                // For display: the search adds the two parts as integers, each with its own
                // weight, as `contribution` does.
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

    /// What it adds to the sum at course `k` and speed `j` with this weight, in steps of [`QUANTUM`](super::QUANTUM): the
    /// weighted utility, rounded; for `Coupled` the two parts are rounded one by one.
    #[must_use]
    pub fn contribution(&self, grid: &Grid, weight: f64, k: usize, j: usize) -> i32 {
        let weight = Weight::new(weight);
        match self {
            Objective::Coupled { .. } => {
                let (course, speed) = self.weights(weight);
                course.quanta(self.of_course(grid, k)) + speed.quanta(self.of_speed(grid, j))
            }
            _ => weight.quanta(self.utility(grid, k, j)),
        }
    }

    /// How much of the utility the course makes, of functions that are a sum of two.
    fn course_share(&self) -> f64 {
        match self {
            Objective::Course(_) => 1.0,
            Objective::Coupled { course_share, .. } if course_share.is_finite() => course_share.clamp(0.0, 1.0),
            _ => 0.0,
        }
    }

    /// The weights of course and speed, of functions that are a sum of two.
    pub(super) fn weights(&self, weight: Weight) -> (Weight, Weight) {
        let share = self.course_share();
        (weight.share(share), weight.share(1.0 - share))
    }

    /// Its peak in courses, if it has one.
    pub(super) fn course_peak(&self) -> Option<&Peak> {
        match self {
            Objective::Course(peak) | Objective::Coupled { course: peak, .. } => Some(peak),
            _ => None,
        }
    }

    /// Utility of course alone.
    fn of_course(&self, grid: &Grid, k: usize) -> f32 {
        self.course_peak().map_or(0.0, |peak| peak.of_course(grid, k))
    }

    /// Utility of speed alone.
    fn of_speed(&self, grid: &Grid, j: usize) -> f32 {
        match self {
            Objective::Speed(peak) | Objective::Coupled { speed: peak, .. } => peak.of_speed(grid, j),
            Objective::Limit(limit) => limit.of_speed(grid, j),
            _ => 0.0,
        }
    }

    /// How the solver goes about it.
    pub(super) fn parts(&self, grid: &Grid) -> Parts<'_> {
        let field = |field: Option<Field>| field.map_or(Parts::Nothing, Parts::Field);
        let fastest_m_s = grid.speed_max_m_s();
        match self {
            Objective::Closest(closest) => field(closest.ready(fastest_m_s).map(Field::Closest)),
            Objective::Closing(closing) => field(closing.ready(fastest_m_s).map(Field::Closing)),
            Objective::Table(table) => {
                let size = (grid.courses(), grid.speeds());
                // A mistake of the caller, not of a file: a table of another grid would be read
                // beyond its end.
                assert!(table.size() == size, "a table of {:?} courses and speeds, not {size:?}", table.size());
                Parts::Table(table)
            }
            _ => Parts::Separable,
        }
    }
}

/// How a function is evaluated.
pub(super) enum Parts<'a> {
    /// A function of course plus one of speed.
    Separable,
    /// A formula in both.
    Field(Field),
    /// Numbers for both.
    Table(&'a Table),
    /// It has a number that is not finite.
    Nothing,
}

/// A formula in course and speed.
#[derive(Clone, Copy, Debug)]
pub(super) enum Field {
    Closest(closest::Ready),
    Closing(closing::Ready),
}

impl Field {
    /// Utility of a course, a unit vector, at a speed.
    pub(super) fn utility(&self, north: f32, east: f32, speed: f32) -> f32 {
        match self {
            Field::Closest(ready) => ready.utility(north, east, speed),
            Field::Closing(ready) => ready.utility(north, east, speed),
        }
    }
}
