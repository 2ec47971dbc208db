//! Tournaments: every strategy against every other, over many seeds and from both sides.
//!
//! A [`Plan`] lists the games, [`play()`] plays them on several threads, and a [`Report`]
//! summarises the results. The report depends only on the plan, not on the number of threads.

mod cycle;
mod file;
mod league;
mod nash;
mod plan;
mod play;
mod rating;
mod rating_table;
mod report;
mod result;
mod table;

pub(crate) use file::check_entries;
pub use file::{Entrant, EntryKind, Tournament};
pub use league::{League, LeagueError};
pub use nash::{Nash, nash};
pub use plan::{Match, Plan};
pub use play::{Observer, Record, play, play_observed};
pub use rating::{Meeting, Rating, ratings};
pub use report::{Cell, Failure, MatchRow, Report, Row, SeaReport, Seeds, Standings};
pub use table::{WIDTH, csv, text};
