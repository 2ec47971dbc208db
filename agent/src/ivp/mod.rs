//! Interval programming: which course and speed serve all of a helm's wishes best.
//!
//! Every behaviour of a helm states what it would like as an *objective function*: a utility of 0 to 100
//! for each candidate course and speed, and a priority weight. The helm takes the candidate with the largest
//! weighted sum,
//!
//! ```text
//! x* = arg max  sum_i  w_i f_i(x)        over x on the decision grid.
//!         x
//! ```
//!
//! This is the method of Benjamin ("Interval Programming: A Multi-Objective Optimization Model for Autonomous Vehicle
//! Control", Brown University 2002) and of Benjamin et al. ("An Overview of MOOS-IvP and a Users Guide to the IvP
//! Helm", MIT CSAIL 2009). They tile the decision space with boxes, put a linear function on each, and search the
//! tiles by branch and bound: exact for the tiles, near for what they stand for. Over course and speed alone the
//! functions themselves are cheap to ask, so [`Problem`] asks them, and its answer is exact on the grid:
//!
//! - functions of course only, of speed only, or of one plus the other, are added up in two lists;
//! - the others are asked eight speeds of a course at a time, side by side, and eights whose bound does not reach the
//!   best found so far are passed over;
//! - weight times utility is rounded to [`QUANTUM`] before it is added, so sums are of integers: the order of functions
//!   cannot matter, and two candidates are equal or they are not.
//!
//! With more variables than two the grid grows too large; there tiles are the better tool: [`piecewise`] and [`branch`].
//!
//! Open [`Objective`] first, then [`Problem`].

pub mod branch;
mod closest;
mod closing;
pub mod domain;
mod fixed;
mod grid;
mod limit;
mod objective;
mod peaks;
pub mod piecewise;
mod problem;

pub use closest::{Approach, Closest, Lag};
pub use closing::Closing;
pub use fixed::{FUNCTIONS_MAX, QUANTUM, WEIGHT_MAX};
pub use grid::Grid;
pub use limit::SpeedLimit;
pub use objective::Objective;
pub use peaks::{Combine, Peak, Peaks};
pub use problem::{Choice, Decision, Problem, Wish};
