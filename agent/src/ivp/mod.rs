//! Interval programming: selects the course and speed that best serve all behaviours' objective
//! functions.
//!
//! Every behaviour of a helm expresses its preferences as an *objective function*: a utility of 0
//! to 100 for each candidate course and speed, and a priority weight. The helm takes the candidate
//! with the largest weighted sum,
//!
//! ```text
//! x* = arg max  sum_i  w_i f_i(x)        over x on the decision grid.
//!         x
//! ```
//!
//! This is the method of Benjamin ("Interval Programming: A Multi-Objective Optimization Model for
//! Autonomous Vehicle Control", Brown University 2002) and of Benjamin et al. ("An Overview of
//! MOOS-IvP and a Users Guide to the IvP Helm", MIT CSAIL 2009). They tile the decision space with
//! boxes, fit a linear function to each, and search the tiles by branch and bound: exact for the
//! tiles, approximate for the functions. With course and speed as the only variables, the functions
//! themselves are cheap, so [`Problem`] evaluates them, and its result is exact on the grid:
//!
//! - functions of course only, of speed only, or sums of both, are added up in two lists;
//! - the others are evaluated for tiles of four courses by four speeds. Tiles whose bound is below
//!   the best value so far are skipped, often many at once;
//! - weight times utility is rounded to [`QUANTUM`] before it is added. Sums are therefore
//!   integers: the order of functions does not matter, and ties are exact.
//!
//! Open [`Objective`] first, then [`Problem`].

mod cell;
mod closest;
mod closing;
mod fixed;
mod grid;
mod lanes;
mod measured;
mod objective;
mod peak;
mod problem;
mod search;
mod sums;
mod table;
mod turn;

pub use closest::{Approach, Closest, Side};
pub use closing::Closing;
pub use fixed::{FUNCTIONS_MAX, QUANTUM, WEIGHT_MAX};
pub(crate) use grid::Courses;
pub use grid::Grid;
pub(crate) use lanes::{LANES, Lanes, larger, smaller};
pub use objective::Objective;
pub use peak::Peak;
pub use problem::{Choice, Decision, Preference, Problem};
pub use table::Table;
pub use turn::Lag;
