//! What a recorded game tells afterwards: statistics, tables for other programs, and how it differs from another game.
//!
//! Everything here is computed from a [`recording::Recording`]. [`for_each_step`] gives the game decision by decision, so that
//! [`Summary`] (for people), [`table`] (of single topics) and [`alog`] (for MOOS) need no more memory for a longer game.
//! [`GameSeries`] is the game as time series, of long games thinned out, for plots and for [`Comparison`] of a game on the
//! water with its simulation. [`quality`] says how sensibly boats play, of steps of a recording or of a game that is
//! being played. Of a gateway's own recording [`gateway_of`] tells what went over its link.

pub mod alog;
mod compare;
mod gateway;
mod hull_overlap;
mod link_line;
#[cfg(test)]
mod made_up;
pub mod quality;
mod quantile;
mod response;
mod series;
mod statistics;
mod step;
mod summary;
pub mod table;
mod track;

pub use compare::{Comparison, EventDifference, Incomparable, Pair};
pub use gateway::{Gateway, Traffic, gateway_of};
pub use hull_overlap::HullRectangle;
pub use link_line::{Line, Lines};
pub use response::{Response, SETTLED_S};
pub use series::{BoatSeries, GameSeries};
pub use statistics::{BoatStatistics, NavigationError, StatisticsBuilder, SteeringError};
pub use step::{Sample, Step, for_each_step};
pub use summary::{Summary, Topic, topics};
pub use track::{TrackDifference, distances};
