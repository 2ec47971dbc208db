//! What a recorded game tells afterwards: statistics, tables for other programs, and how it differs from another game.
//!
//! Everything here is computed from a [`recording::Recording`]; nothing is read or written. [`GameSeries`] is the game as
//! time series, made in one pass; [`Summary`] is made of it for people, [`Comparison`] of two for those who compare a game
//! on the water with its simulation. [`table`] makes tables of single topics, [`alog`] the logs of MOOS. Of a gateway's own
//! recording [`gateway_of`] tells what went over its link.

pub mod alog;
mod compare;
mod damaged;
mod gateway;
mod link_line;
#[cfg(test)]
mod made_up;
mod response;
mod series;
mod statistics;
mod summary;
pub mod table;
mod track;

pub use compare::{Comparison, EventDifference, Incomparable, Pair};
pub use damaged::Damaged;
pub use gateway::{Gateway, Traffic, gateway_of};
pub use link_line::{Line, Lines};
pub use response::{Response, SETTLED_S};
pub use series::{BoatSeries, GameSeries, Sample};
pub use statistics::{BoatStatistics, NavigationError, SteeringError};
pub use summary::{Summary, Topic, topics};
pub use track::{TrackDifference, distances};
