//! What a recorded game tells afterwards: figures, tables for other programs, and how it differs from another game.
//!
//! Everything here is computed from a [`recording::Recording`]; nothing is read or written. [`Book`] is the game as
//! series, made in one pass; [`Summary`] is made of it for people, [`Comparison`] of two for those who lay a game on
//! the water beside its simulation. [`sheet`] makes tables of single topics, [`alog`] the logs of MOOS.

pub mod alog;
mod book;
mod compare;
mod figure;
mod gateway;
mod response;
#[cfg(test)]
mod sample;
mod sentence;
pub mod sheet;
mod summary;
mod track;
pub mod utc;

pub use book::{Boat, Book, Moment};
pub use compare::{Comparison, EventDifference, Incomparable, Pair};
pub use figure::{Figures, NavigationError, SteeringError};
pub use gateway::{Gateway, Traffic};
pub use response::{Response, SETTLED_S};
pub use sentence::{Line, Lines};
pub use summary::{Summary, Topic};
pub use track::{Apart, distances};
