//! What people use ashore: recordings of games, what can be learnt from them, and a page to watch games.

pub mod log;
pub mod page;
pub mod recording;
