//! An objective function: one behaviour's preference for course and speed.

use super::closest::{self, Closest};
use super::closing::{self, Closing};
use super::fixed::{self, Weight};
use super::grid::Grid;
use super::limit::SpeedLimit;
use super::peak::Peak;
use super::table::Table;

/// A utility of 0 to 100 for each course and speed.
///
/// Non-finite numbers count as no utility (a debug build panics). `Course`, `Speed`, `Coupled` and
/// `Limit` are almost free; the others are evaluated point by point.
#[derive(Clone, Copy, Debug)]
pub enum Objective<'a> {
    /// Course only.
    Course(Peak),
    /// Speed only.
    Speed(Peak),
    /// A sum of course and speed.
    Coupled {
        /// Preference for the course.
        course: Peak,
        /// Preference for the speed.
        speed: Peak,
        /// The course's share of the utility, 0 to 1; the rest is the speed's.
        course_share: f64,
    },
    /// A speed limit.
    Limit(SpeedLimit),
    /// Distance at the closest point of approach to a contact.
    Closest(Closest),
    /// Closing speed.
    Closing(Closing),
    /// Utilities in a table.
    Table(&'a Table),
}

impl Objective<'_> {
    /// Whether it distinguishes courses.
    #[must_use]
    pub fn decides_course(&self) -> bool {
        match self {
            Objective::Speed(_) | Objective::Limit(_) => false,
            Objective::Coupled { course_share, .. } => *course_share > 0.0,
            _ => true,
        }
    }

    /// Whether it distinguishes speeds.
    #[must_use]
    pub fn decides_speed(&self) -> bool {
        match self {
            Objective::Course(_) => false,
            Objective::Coupled { course_share, .. } => *course_share < 1.0,
            _ => true,
        }
    }

    /// The utility of course `k` at speed `j`, in the solver's arithmetic.
    ///
    /// # Panics
    /// Beyond the grid, or with a table of another size.
    #[must_use]
    pub fn utility(&self, grid: &Grid, k: usize, j: usize) -> f32 {
        assert!(k < grid.courses() && j < grid.speeds(), "course {k}, speed {j}");
        match self.parts(grid) {
            Parts::Separable => {
                let (course, speed, share) = (self.of_course(grid, k), self.of_speed(grid, j), self.course_share());
                // For display: the search adds the two parts as integers, each with its own weight,
                // as `contribution` does.
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

    /// Its contribution to the sum at course `k` and speed `j`, in steps of
    /// [`QUANTUM`](super::QUANTUM): the rounded weighted utility. For `Coupled` the two parts are
    /// rounded separately.
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

    /// The course's share of the utility, for functions that are a sum of two.
    fn course_share(&self) -> f64 {
        match self {
            Objective::Course(_) => 1.0,
            Objective::Coupled { course_share, .. } if course_share.is_finite() => course_share.clamp(0.0, 1.0),
            _ => 0.0,
        }
    }

    /// The weights of course and speed, for functions that are a sum of two.
    pub(super) fn weights(&self, weight: Weight) -> (Weight, Weight) {
        let share = self.course_share();
        (weight.share(share), weight.share(1.0 - share))
    }

    pub(super) fn course_peak(&self) -> Option<&Peak> {
        match self {
            Objective::Course(peak) | Objective::Coupled { course: peak, .. } => Some(peak),
            _ => None,
        }
    }

    /// Utility of the course alone.
    fn of_course(&self, grid: &Grid, k: usize) -> f32 {
        self.course_peak().map_or(0.0, |peak| peak.of_course(grid, k))
    }

    /// Utility of the speed alone.
    fn of_speed(&self, grid: &Grid, j: usize) -> f32 {
        match self {
            Objective::Speed(peak) | Objective::Coupled { speed: peak, .. } => peak.of_speed(grid, j),
            Objective::Limit(limit) => limit.of_speed(grid, j),
            _ => 0.0,
        }
    }

    /// How the solver evaluates it.
    pub(super) fn parts(&self, grid: &Grid) -> Parts<'_> {
        let field = |field: Option<Field>| field.map_or(Parts::Nothing, Parts::Field);
        let fastest_m_s = grid.speed_max_m_s();
        match self {
            Objective::Closest(closest) => field(closest.ready(fastest_m_s).map(Field::Closest)),
            Objective::Closing(closing) => field(closing.ready(fastest_m_s).map(Field::Closing)),
            Objective::Table(table) => {
                let size = (grid.courses(), grid.speeds());
                // A bug of the caller, not a fault of a file: a table of another grid would be read
                // beyond its end.
                assert!(table.size() == size, "table of {:?} courses and speeds, expected {size:?}", table.size());
                Parts::Table(table)
            }
            _ => Parts::Separable,
        }
    }
}

/// How a function is evaluated.
pub(super) enum Parts<'a> {
    /// A function of course plus a function of speed.
    Separable,
    /// A formula of both.
    Field(Field),
    /// A table over both.
    Table(&'a Table),
    /// A function with a non-finite number.
    Nothing,
}

/// A formula in course and speed.
#[derive(Clone, Copy, Debug)]
pub(super) enum Field {
    Closest(closest::Ready),
    Closing(closing::Ready),
}

impl Field {
    /// Utility of a course, a unit vector, at a speed, m/s.
    pub(super) fn utility(&self, north: f32, east: f32, speed: f32) -> f32 {
        match self {
            Field::Closest(ready) => ready.utility(north, east, speed),
            Field::Closing(ready) => ready.utility(north, east, speed),
        }
    }
}
