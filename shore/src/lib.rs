//! What people use ashore: recordings of games, and a page to watch them.

pub mod page;
pub mod recording;
