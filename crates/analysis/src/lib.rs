//! Analysis of recorded games: statistics, tables for other programs, and comparison with another
//! game.
//!
//! All results are computed from a [`recording::Recording`]. [`for_each_step`] yields the game
//! decision by decision, so that [`Summary`] (for display), [`table`] (of single topics) and
//! [`alog`] (for MOOS) need no more memory for a longer game. [`GameSeries`] holds the game as time
//! series, downsampled if long, for plots and for [`Comparison`] of a game on the water with its
//! simulation. [`quality`] measures how sensibly boats play, from the steps of a recording or of a
//! running game. [`gateway_of`] reports the link traffic in a gateway's own recording.

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
pub use step::{Sample, Step, for_each_step, ordered_m_s};
pub use summary::{Summary, Topic, topics};
pub use track::TrackDifference;
